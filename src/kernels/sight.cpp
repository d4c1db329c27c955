#include "kernels/sight.h"

#include "kernels/meet.h"
#include "kernels/ray_offset.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

// The least and the greatest coordinate of a shape along an axis.
struct Range {
  Float low, high;
};

// What kLanes points see: three corners, or a box around a middle.
struct Corners3 {
  Vec3T<Float> corner[3];
};
struct Halves {
  Vec3T<Float> middle, half;
};

inline Float highest_along(const Corners3& t, const Vec3T<Float>& axis) {
  return greatest_of(dot(axis, t.corner[0]), dot(axis, t.corner[1]), dot(axis, t.corner[2]));
}
inline Float half_along(const Halves& b, const Vec3T<Float>& axis) {
  return dot(Vec3T<Float>{absolute(axis.x), absolute(axis.y), absolute(axis.z)}, b.half);
}
inline Float highest_along(const Halves& b, const Vec3T<Float>& axis) {
  return dot(axis, b.middle) + half_along(b, axis);
}

// A shape's coordinates along the tangents, and from them how far it reaches to the left of a line through
// the eye: for boxes no less than that.
struct FlatCorners {
  Float x[3], y[3];
};
inline FlatCorners flatten(const Corners3& t, const Vec3T<Float>& tangent, const Vec3T<Float>& bitangent,
                           Float own_x, Float own_y) {
  FlatCorners out;
  for (int k = 0; k < 3; ++k) {
    out.x[k] = dot(tangent, t.corner[k]) - own_x;
    out.y[k] = dot(bitangent, t.corner[k]) - own_y;
  }
  return out;
}
inline Range across(const FlatCorners& t, Float cosine, Float sine) {
  const Float a = t.y[0] * cosine - t.x[0] * sine, b = t.y[1] * cosine - t.x[1] * sine,
              c = t.y[2] * cosine - t.x[2] * sine;
  return {least_of(a, b, c), greatest_of(a, b, c)};
}
struct FlatHalves {
  Float x, y, half_x, half_y;
};
inline FlatHalves flatten(const Halves& b, const Vec3T<Float>& tangent, const Vec3T<Float>& bitangent,
                          Float own_x, Float own_y) {
  return {dot(tangent, b.middle) - own_x, dot(bitangent, b.middle) - own_y, half_along(b, tangent),
          half_along(b, bitangent)};
}
inline Range across(const FlatHalves& b, Float cosine, Float sine) {
  const Float middle = b.y * cosine - b.x * sine,
              give = b.half_y * absolute(cosine) + b.half_x * absolute(sine);
  return {middle - give, middle + give};
}

// In which columns a shape lies, one bit each, seen from the origin give or take `room`. A column lies left
// of the line at which it begins and right of that at which it ends; what lies wholly on the other side of
// one of them is not in it.
template <class Flat>
inline Uint columns_of(const Parts& parts, const Flat& shape, Float room) {
  const auto bit = [](Mask m, int column) { return select(m, Uint(1u << column), Uint(0u)); };
  if (parts.count == 1) return Uint(1u);
  Uint begins = Uint(0u), ends = Uint(0u);  // bit c: of column c
  const int before = parts.count - 1;
  for (int l = 0; l < parts.lines; ++l) {
    const Range range = across(shape, Float(parts.cosine[l]), Float(parts.sine[l]));
    const Mask left = range.high >= -room, right = range.low <= room;
    begins = begins | bit(left, l);
    ends = ends | bit(right, (l + before) % parts.count);
    if (parts.lines == parts.count) continue;
    begins = begins | bit(right, l + parts.lines);
    ends = ends | bit(left, (l + parts.lines + before) % parts.count);
  }
  return begins & ends;
}

// Does the triangle rise over the origins of the points' rays, by more than rounding can make of one that
// does not? Triangles in the plane of a point's own, that one first of all, do not.
inline Mask rises(const Corners3& t, const Vec3T<Float>& p, const Vec3T<Float>& geometric, Float offset) {
  const Vec3T<Float> n = absolute(geometric), to[3] = {t.corner[0] - p, t.corner[1] - p, t.corner[2] - p};
  const Float over = greatest_of(dot(geometric, to[0]), dot(geometric, to[1]), dot(geometric, to[2]));
  const Vec3T<Float> away = greatest(absolute(to[0]), greatest(absolute(to[1]), absolute(to[2])));
  const Float error = dot(n, absolute(p)) * Float(kUnitRoundoff) + plane_error(n, away);
  return over > offset * Float(1 / kSecondOrder) - error * Float(kSecondOrder);
}

// How far a point is from a box, squared.
inline Float distance_squared(const Vec3T<Float>& p, const Vec3& low, const Vec3& high) {
  const Float zero = Float(0.0f);
  const Float x = greatest(greatest(Float(low.x) - p.x, p.x - Float(high.x)), zero);
  const Float y = greatest(greatest(Float(low.y) - p.y, p.y - Float(high.y)), zero);
  const Float z = greatest(greatest(Float(low.z) - p.z, p.z - Float(high.z)), zero);
  return (x * x + y * y) + z * z;
}

template <class Shape>
bool look_at(const Shape& shape, const Box& box, const Vec3& plane, const Block& block, uint64_t* ring,
             uint64_t* column) {
  const PointPacket& points = block.points;
  const Parts& parts = block.parts;
  const float distance = block.reach.distance;
  const Float margin =
      Float(2 * margin_of(vitral::greatest(magnitude(box), block.reach.magnitude) + distance, distance));
  const Float zero = Float(0.0f), one = Float(1.0f);
  const float step = 1.0f / static_cast<float>(parts.count);
  uint64_t seen = 0;
  for (int p = 0; p < parts.count; ++p) ring[p] = column[p] = 0;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(points.live, g)) continue;
    const Vec3T<Float> geometric = load3(points.gx, points.gy, points.gz, g);
    const Float offset = load(points.offset + g);
    const Float over = highest_along(shape, geometric) - load(block.sights.geometric + g);
    Mask above = both(over > offset - margin, group_mask(points.live, g));
    if (!any(above)) continue;
    const Vec3T<Float> p = load3(points.px, points.py, points.pz, g),
                       n = load3(points.nx, points.ny, points.nz, g);
    if constexpr (std::is_same_v<Shape, Corners3>) {
      if (any(both(above, over < offset + margin))) {
        above = both(above, rises(shape, p, geometric, offset));
        if (!any(above)) continue;
      }
    }

    // Seen from the ray's origin, `offset` above the point: its height is at most the highest coordinate at
    // the least distance, whose square rounding makes less than 2^-14 too large.
    const Float give = offset + margin;
    const Float away = greatest(square_root(distance_squared(p, box.min, box.max)) - give, zero);
    const Mask near = both(above, away <= Float(distance * 1.00001f));
    if (!any(near)) continue;
    const Float high = greatest(highest_along(shape, n) - load(block.sights.normal + g) + give, zero);
    const Float high_squared = high * high, away_squared = away * away * Float(0.9999f);

    // A ray that runs away from the triangle's plane cannot meet it: from its upper side those that are
    // higher over the horizon than the plane is tilted. A box has no plane, and what is not a number says
    // nothing.
    Float steepest = one;
    if constexpr (std::is_same_v<Shape, Corners3>) {
      const Vec3T<Float> m = splat(plane);
      const Float side = (dot(m, shape.corner[0]) - dot(m, p)) - dot(m, geometric) * offset;
      const Float slope = dot(m, n);
      const Mask on_upper_side = side * copy_sign(one, slope) < -(margin + margin);
      steepest = select(on_upper_side, Float(1.00002f) - slope * slope * Float(0.9999f), one);
    }
    for (int r = 0; r < parts.count; ++r) {
      const Float least_squared = Float(static_cast<float>(r) * step);
      const Mask here = both(high_squared >= away_squared * least_squared, steepest >= least_squared);
      ring[r] |= static_cast<uint64_t>(bits(both(near, here))) << g;
    }

    const auto flat = flatten(shape, load3(block.frames.tx, block.frames.ty, block.frames.tz, g),
                              load3(block.frames.bx, block.frames.by, block.frames.bz, g),
                              load(block.sights.tangent + g), load(block.sights.bitangent + g));
    const Uint columns = columns_of(parts, flat, (give + load(block.sights.turn + g)) * Float(1.5f));
    for (int c = 0; c < parts.count; ++c) {
      const Mask here = invert((columns & Uint(1u << c)) == Uint(0u));
      column[c] |= static_cast<uint64_t>(bits(both(near, here))) << g;
    }
    seen |= static_cast<uint64_t>(bits(near)) << g;
  }
  return seen != 0;
}

}  // namespace

void make_sights(const PointPacket& points, const Frames& frames, float distance, Sights& out) {
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Vec3T<Float> p = load3(points.px, points.py, points.pz, g);
    const Vec3T<Float> geometric = load3(points.gx, points.gy, points.gz, g);
    const Vec3T<Float> n = load3(points.nx, points.ny, points.nz, g);
    store(out.geometric + g, dot(geometric, p));
    store(out.normal + g, dot(n, p));
    store(out.tangent + g, dot(load3(frames.tx, frames.ty, frames.tz, g), p));
    store(out.bitangent + g, dot(load3(frames.bx, frames.by, frames.bz, g), p));
    const Float cosine = dot(n, geometric);
    store(out.turn + g, greatest(Float(1.0f) - cosine * cosine, Float(0.0f)) * Float(2.0f * distance));
  }
}

bool look(const KdTriangle& t, const Vec3& plane, const Block& block, uint64_t* ring, uint64_t* column) {
  const Vec3 a{t.corner[0][0], t.corner[0][1], t.corner[0][2]},
      b{t.corner[1][0], t.corner[1][1], t.corner[1][2]}, c{t.corner[2][0], t.corner[2][1], t.corner[2][2]};
  Box box{a, a};
  extend(box, b), extend(box, c);
  return look_at(Corners3{{splat(a), splat(b), splat(c)}}, box, plane, block, ring, column);
}

bool look(const PlainBox& box, const Block& block, uint64_t* ring, uint64_t* column) {
  return look_at(Halves{splat((box.min + box.max) * 0.5f), splat((box.max - box.min) * 0.5f)}, as_box(box),
                 Vec3{0, 0, 0}, block, ring, column);
}

}  // namespace VITRAL_ISA
}  // namespace vitral
