#include "kernels/candidates.h"

#include "kernels/counts.h"
#include "kernels/lanes.h"
#include "kernels/meet.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

inline Vec3T<Float> splat(const Vec3& v) {
  return {Float(v.x), Float(v.y), Float(v.z)};
}
inline void set_component(Vec3& v, int axis, float x) {
  (axis == 0 ? v.x : axis == 1 ? v.y : v.z) = x;
}

// Rounding moves a point of a triangle, and a point of a ray, by less than 2^-20 of the largest
// coordinates that go in. Directions are unit within 2^-20, and their polynomials off by 2^-19.
template <class F>
inline F margin_of(const F& magnitude, float distance) {
  return magnitude * F(1.0f / 1048576) + F(distance * (1.0f / 262144));
}

}  // namespace

Reach reach_of(const KdView& tree, const PointPacket* const* points, int count, float distance) {
  Vec3T<Float> low = splat({kInfinity, kInfinity, kInfinity}), high = -low, sum = splat({0, 0, 0});
  Float least_offset = Float(kInfinity), most_offset = Float(0.0f);
  const Float zero = Float(0.0f);
  for (int i = 0; i < count; ++i) {
    const PointPacket& p = *points[i];
    for (int g = 0; g < kPacketSize; g += kLanes) {
      const Mask live = group_mask(p.live, g);
      const Vec3T<Float> at = load3(p.px, p.py, p.pz, g), n = load3(p.gx, p.gy, p.gz, g);
      low = {least(select(live, at.x, low.x), low.x), least(select(live, at.y, low.y), low.y),
             least(select(live, at.z, low.z), low.z)};
      high = {greatest(select(live, at.x, high.x), high.x), greatest(select(live, at.y, high.y), high.y),
              greatest(select(live, at.z, high.z), high.z)};
      sum = sum + Vec3T<Float>{select(live, n.x, zero), select(live, n.y, zero), select(live, n.z, zero)};
      const Float offset = load(p.offset + g);
      least_offset = least(select(live, offset, least_offset), least_offset);
      most_offset = greatest(select(live, offset, most_offset), most_offset);
    }
  }
  Reach reach;
  reach.start = {{least_lane(low.x), least_lane(low.y), least_lane(low.z)},
                 {greatest_lane(high.x), greatest_lane(high.y), greatest_lane(high.z)}};
  reach.radius = 0.50001f * length(extent(as_box(reach.start))) + greatest_lane(most_offset);
  reach.distance = distance;
  reach.magnitude = magnitude(as_box(reach.start));
  const float far = distance * 1.00001f + greatest_lane(most_offset);
  const float grow = far + traversal_slack(vitral::greatest(tree.magnitude, reach.magnitude + far));
  reach.box = {reach.start.min - Vec3{grow, grow, grow}, reach.start.max + Vec3{grow, grow, grow}};

  // Any unit vector would do; near the mean the planes of the points differ least from the common one.
  const Vec3 mean{sum_of_lanes(sum.x), sum_of_lanes(sum.y), sum_of_lanes(sum.z)};
  const float squared = dot(mean, mean);
  reach.normal = squared > 1e-6f ? mean * (1.0f / vitral::square_root(squared)) : Vec3{0, 0, 1};
  Float lowest = Float(kInfinity), deviation = zero;
  for (int i = 0; i < count; ++i) {
    const PointPacket& p = *points[i];
    for (int g = 0; g < kPacketSize; g += kLanes) {
      const Mask live = group_mask(p.live, g);
      const Float height = dot(load3(p.px, p.py, p.pz, g), splat(reach.normal));
      lowest = least(select(live, height, lowest), lowest);
      const Vec3T<Float> d = load3(p.gx, p.gy, p.gz, g) - splat(reach.normal);
      deviation = greatest(select(live, dot(d, d), deviation), deviation);
    }
  }
  reach.far = far;
  reach.tilt = vitral::square_root(greatest_lane(deviation)) * 1.00001f;
  reach.floor =
      least_lane(lowest) + least_lane(least_offset) - 3 * margin_of(reach.magnitude + far, distance);
  return reach;
}

namespace {

// --- collecting ------------------------------------------------------------------------------------

struct CornerLanes {
  Vec3T<Float> a, b, c;
};

// The triangles that overlap the box and rise above the floor.
Mask within(const CornerLanes& t, const Reach& reach) {
  const Box box = as_box(reach.box);
  const auto overlap = [](Float x, Float y, Float z, float low, float high) {
    return both(greatest_of(x, y, z) >= Float(low), least_of(x, y, z) <= Float(high));
  };
  Mask wanted = overlap(t.a.x, t.b.x, t.c.x, box.min.x, box.max.x);
  wanted = both(wanted, overlap(t.a.y, t.b.y, t.c.y, box.min.y, box.max.y));
  wanted = both(wanted, overlap(t.a.z, t.b.z, t.c.z, box.min.z, box.max.z));
  const Vec3T<Float> n = splat(reach.normal);
  const Float height = greatest_of(dot(n, t.a), dot(n, t.b), dot(n, t.c));
  // What rounding does to the height, for any unit normal.
  const Float size = greatest_of(greatest_of(absolute(t.a.x), absolute(t.a.y), absolute(t.a.z)),
                                 greatest_of(absolute(t.b.x), absolute(t.b.y), absolute(t.b.z)),
                                 greatest_of(absolute(t.c.x), absolute(t.c.y), absolute(t.c.z)));
  // How far the triangle is at most from any point.
  const Vec3T<Float> middle = splat((box.min + box.max) * 0.5f);
  const Vec3T<Float> da = t.a - middle, db = t.b - middle, dc = t.c - middle;
  const Float away =
      square_root(greatest_of(dot(da, da), dot(db, db), dot(dc, dc))) * Float(1.00001f) + Float(reach.radius);
  const Float floor = Float(reach.floor) - least(away, Float(reach.far)) * Float(reach.tilt);
  return both(wanted, invert(height < floor - size * Float(1.0f / 262144)));
}

// Adds those of up to kLanes triangles that are within reach.
void add(const KdView& tree, const Reach& reach, const uint32_t* ids, int count, TrianglePool& out) {
  alignas(64) float corner[9][kLanes];
  alignas(64) uint32_t id[kLanes];
  for (int i = 0; i < kLanes; ++i) {
    id[i] = ids[i < count ? i : 0];
    const float* c = tree.triangles[id[i]].corner[0];
    for (int k = 0; k < 9; ++k) corner[k][i] = c[k];
  }
  const CornerLanes t{{load(corner[0]), load(corner[1]), load(corner[2])},
                      {load(corner[3]), load(corner[4]), load(corner[5])},
                      {load(corner[6]), load(corner[7]), load(corner[8])}};
  const Mask wanted = both(within(t, reach), mask_of_bits((1ull << count) - 1));
  for (int k = 0; k < 9; ++k) compress(out.corner[k] + out.count, load(corner[k]), wanted);
  compress(out.id + out.count, load(id), wanted);
  out.count += __builtin_popcount(bits(wanted));
}

// The cell of a node, as far as the reach's box goes, is it above the floor?
bool rises(const Box& cell, const Reach& reach) {
  float height = 0, size = 0;
  for (int a = 0; a < 3; ++a) {
    const float n = component(reach.normal, a);
    const float low = component(cell.min, a) * n, high = component(cell.max, a) * n;
    height += vitral::greatest(low, high);
    size += vitral::greatest(vitral::absolute(low), vitral::absolute(high));
  }
  return !(height < reach.floor - reach.tilt * reach.far - size * (1.0f / 1048576));
}

}  // namespace

uint32_t entry_node(const KdView& tree, const Box& box) {
  uint32_t node = 0;
  while (!is_leaf(tree.nodes[node])) {
    const KdNode& n = tree.nodes[node];
    const bool below = component(box.min, axis(n)) <= split(n),
               above = component(box.max, axis(n)) >= split(n);
    if (below && above) break;
    node = child(n) + (above ? 1u : 0u);
  }
  return node;
}

template <class Counts>
Collected collect(const KdView& tree, const Reach& reach, int most_leaves, TrianglePool& out, Counts counts) {
  constexpr int kSeen = 1024;  // triangles met lately, so that few are taken twice
  uint32_t seen[kSeen];
  for (int i = 0; i < kSeen; ++i) seen[i] = kNoTriangle;
  uint32_t ids[kLanes];
  int pending = 0, leaves = 0, waiting = 0;
  struct Waiting {
    PlainBox cell;
    uint32_t node;
  } stack[kMaxTreeDepth];
  const float slack = traversal_slack(vitral::greatest(tree.magnitude, reach.magnitude + reach.distance));
  uint32_t node = entry_node(tree, as_box(reach.box));
  Box cell = as_box(reach.box);
  out.count = 0;
  for (;;) {
    counts.group_node();
    const KdNode& n = tree.nodes[node];
    if (!is_leaf(n)) {
      // A cell is as large as the planes above it say, and a little larger.
      const int a = axis(n);
      const float low = component(cell.min, a), high = component(cell.max, a), s = split(n);
      const bool below = low <= s, above = high >= s;
      Box upper = cell;
      set_component(upper.min, a, vitral::greatest(low, s - slack));
      if (below) set_component(cell.max, a, vitral::least(high, s + slack));
      if (below && above) {
        if (rises(upper, reach)) stack[waiting++] = {plain(upper), child(n) + 1};
        node = child(n);
      } else {
        if (!below) cell = upper;
        node = child(n) + (below ? 0u : 1u);
        continue;
      }
      if (rises(cell, reach)) continue;
    } else {
      counts.group_leaf();
      if (++leaves > most_leaves) return Collected::too_many;
      for (uint32_t i = 0; i < count(n); ++i) {
        const uint32_t id = tree.references[first_reference(n) + i];
        if (seen[id % kSeen] == id) continue;
        seen[id % kSeen] = id;
        if (tree.triangles[id].flags & kGlassTriangle) continue;
        ids[pending++] = id;
        if (pending < kLanes) continue;
        counts.group_test(pending);
        add(tree, reach, ids, pending, out);
        pending = 0;
        if (out.count > kMaxPool - kLanes) return Collected::too_many;
      }
    }
    if (waiting == 0) break;
    --waiting;
    node = stack[waiting].node, cell = as_box(stack[waiting].cell);
  }
  counts.group_test(pending);
  if (pending > 0) add(tree, reach, ids, pending, out);
  return Collected::all;
}
template Collected collect(const KdView&, const Reach&, int, TrianglePool&, NoCounts);
template Collected collect(const KdView&, const Reach&, int, TrianglePool&, Counting);

namespace {

// --- classifying -----------------------------------------------------------------------------------

// How far a point is from the triangle's box, squared: no more than how far it is from the triangle.
inline Float distance_squared(const Vec3T<Float>& p, const Vec3& low, const Vec3& high) {
  const Float zero = Float(0.0f);
  const Float x = greatest(greatest(Float(low.x) - p.x, p.x - Float(high.x)), zero);
  const Float y = greatest(greatest(Float(low.y) - p.y, p.y - Float(high.y)), zero);
  const Float z = greatest(greatest(Float(low.z) - p.z, p.z - Float(high.z)), zero);
  return (x * x + y * y) + z * z;
}

// The points' own coordinates along their frames' axes.
struct alignas(64) OwnHeights {
  float geometric[kPacketSize], normal[kPacketSize], tangent[kPacketSize], bitangent[kPacketSize];
};
void make_heights(const PointPacket& points, const Frames& frames, OwnHeights& out) {
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Vec3T<Float> p = load3(points.px, points.py, points.pz, g);
    store(out.geometric + g, dot(load3(points.gx, points.gy, points.gz, g), p));
    store(out.normal + g, dot(load3(points.nx, points.ny, points.nz, g), p));
    store(out.tangent + g, dot(load3(frames.tx, frames.ty, frames.tz, g), p));
    store(out.bitangent + g, dot(load3(frames.bx, frames.by, frames.bz, g), p));
  }
}

// Least and greatest of axis . corner, beyond a point's own.
struct Extent {
  Float low, high;
};
inline Extent extent_along(const Vec3T<Float>& axis, const Vec3T<Float>* corner, Float own) {
  const Float a = dot(axis, corner[0]), b = dot(axis, corner[1]), c = dot(axis, corner[2]);
  return {least_of(a, b, c) - own, greatest_of(a, b, c) - own};
}

// Of length 1, in double so that the normal of a sliver points the right way; a triangle without area has
// none, and its NaN decides nothing.
Vec3 plane_normal(const Vec3* c) {
  return to_float(normalize(cross(to_double(c[1]) - to_double(c[0]), to_double(c[2]) - to_double(c[0]))));
}

// Which points may see a triangle, how high and where. A direction that dips under the geometric surface
// is mirrored back above it: that raises it over the shading normal's horizon, and turns it by no more
// than twice the squared sine between the normals.
void classify(const KdTriangle& t, const PointPacket& points, const Frames& frames, const OwnHeights& own,
              const Reach& reach, Candidate& out) {
  const Vec3 c[3] = {{t.corner[0][0], t.corner[0][1], t.corner[0][2]},
                     {t.corner[1][0], t.corner[1][1], t.corner[1][2]},
                     {t.corner[2][0], t.corner[2][1], t.corner[2][2]}};
  const Vec3T<Float> corner[3] = {splat(c[0]), splat(c[1]), splat(c[2])};
  Box box{c[0], c[0]};
  extend(box, c[1]), extend(box, c[2]);
  const float margin =
      2 * margin_of(vitral::greatest(magnitude(box), reach.magnitude) + reach.distance, reach.distance);
  for (int h = 0; h < kHeights; ++h) out.height[h] = 0;
  for (int q = 0; q < kQuadrants; ++q) out.quadrant[q] = 0;
  Vec3T<Float> plane;
  bool has_plane = false;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(points.live, g)) continue;
    const Vec3T<Float> geometric = load3(points.gx, points.gy, points.gz, g);
    const Float offset = load(points.offset + g);
    const Extent over = extent_along(geometric, corner, load(own.geometric + g));
    const Mask above = both(over.high > offset - Float(margin), group_mask(points.live, g));
    if (!any(above)) continue;
    if (!has_plane) {
      plane = splat(plane_normal(c));
      has_plane = true;
    }

    // Seen from the ray's origin, `offset` above the point.
    const Vec3T<Float> p = load3(points.px, points.py, points.pz, g),
                       n = load3(points.nx, points.ny, points.nz, g);
    const Float give = offset + Float(margin);
    const Float away = greatest(square_root(distance_squared(p, box.min, box.max)) - give, Float(0.0f));
    const Mask near = both(above, away <= Float(reach.distance * 1.00001f));
    const Float away_squared = away * away * Float(0.9999f);
    const Float height = greatest(extent_along(n, corner, load(own.normal + g)).high + give, Float(0.0f));
    const Float height_squared = height * height;
    // A ray that runs away from the triangle's plane cannot meet it: from its upper side those that
    // are higher over the horizon than the plane is tilted.
    const Float side = (dot(plane, corner[0]) - dot(plane, p)) - dot(plane, geometric) * offset;
    const Float slope = dot(plane, n), slope_squared = slope * slope;
    const Mask on_upper_side = side * copy_sign(Float(1.0f), slope) < Float(-2 * margin);
    for (int h = 0; h < kHeights; ++h) {
      const float least_squared = static_cast<float>(h) * (1.0f / kHeights);
      const Mask runs_away =
          both(on_upper_side, slope_squared > Float((1 - least_squared) * 1.0001f + 1e-5f));
      const Mask high = both(height_squared >= away_squared * Float(least_squared), invert(runs_away));
      out.height[h] |= static_cast<uint64_t>(bits(both(near, high))) << g;
    }
    const Float cosine = dot(n, geometric);
    const Float turn = greatest(Float(1.0f) - cosine * cosine, Float(0.0f)) * Float(2.0f * reach.distance);
    const Float room = give + turn;
    const Extent x = extent_along(load3(frames.tx, frames.ty, frames.tz, g), corner, load(own.tangent + g));
    const Extent y = extent_along(load3(frames.bx, frames.by, frames.bz, g), corner, load(own.bitangent + g));
    const Mask right = x.high >= -room, left = x.low <= room, up = y.high >= -room, down = y.low <= room;
    const Mask quadrant[kQuadrants] = {both(right, up), both(left, up), both(left, down), both(right, down)};
    for (int q = 0; q < kQuadrants; ++q)
      out.quadrant[q] |= static_cast<uint64_t>(bits(both(near, quadrant[q]))) << g;
  }
}

// The greatest height at which any point may see it.
int highest(const Candidate& c) {
  int h = 0;
  while (h + 1 < kHeights && c.height[h + 1] != 0) ++h;
  return h;
}

}  // namespace

void choose_candidates(const KdView& tree, const TrianglePool& pool, const PointPacket& points,
                       const Frames& frames, float distance, int most, Candidates& out) {
  const PointPacket* const packet = &points;
  const Reach reach = reach_of(tree, &packet, 1, distance);
  uint32_t ids[kMaxCandidates + kLanes];
  int count = 0;
  for (int i = 0; i < pool.count; i += kLanes) {
    const CornerLanes t{{load(pool.corner[0] + i), load(pool.corner[1] + i), load(pool.corner[2] + i)},
                        {load(pool.corner[3] + i), load(pool.corner[4] + i), load(pool.corner[5] + i)},
                        {load(pool.corner[6] + i), load(pool.corner[7] + i), load(pool.corner[8] + i)}};
    const int left = pool.count - i;
    const Mask filled = mask_of_bits(left >= kLanes ? ~0ull : (1ull << left) - 1);
    const Mask wanted = both(within(t, reach), filled);
    if (!any(wanted)) continue;
    compress(ids + count, load(pool.id + i), wanted);
    count += __builtin_popcount(bits(wanted));
    if (count > most) {
      out.count = kTooMany;
      return;
    }
  }

  // Those that no point can see are dropped, and those that are seen highest stand first.
  OwnHeights own;
  make_heights(points, frames, own);
  Candidate found[kMaxCandidates];
  int kept = 0, of_height[kHeights] = {};
  for (int i = 0; i < count; ++i) {
    Candidate& c = found[kept];
    c.triangle = ids[i];
    classify(tree.triangles[c.triangle], points, frames, own, reach, c);
    if (c.height[0] == 0) continue;
    ++of_height[highest(c)];
    ++kept;
  }
  int first[kHeights];
  int sum = 0;
  for (int h = kHeights - 1; h >= 0; --h) {
    first[h] = sum;
    sum += of_height[h];
    out.seen_at[h] = sum;
  }
  for (int i = 0; i < kept; ++i) out.list[first[highest(found[i])]++] = found[i];
  out.count = kept;
}

}  // namespace VITRAL_ISA
}  // namespace vitral
