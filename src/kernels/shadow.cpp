// Shadows of a directional light, for the blocks of a tile at once.
//
// All rays run in one direction. In coordinates sheared along it, as the triangle test shears them, a
// ray is a point (x, y) and a depth z, a triangle is flat, and "does the ray meet it" is "is the point
// inside, and does the plane lie beyond its depth". The triangles that the rays of a tile can meet lie
// in the leaves that the box of their origins sweeps over on its way to the light. They are collected
// once for the tile and thinned out for each block by its rectangle and depths: a block that none can
// meet is lit, a block that one covers is dark, and the rest is tested.
//
// None of this decides what it cannot be sure of. Every comparison is by a margin that covers the
// rounding of both this file's arithmetic and the exact test's (kdtree/triangle.h); where it falls in
// between, the exact test is made. So the answer is that of the walk through the tree, ray for ray.
#include "kernels/candidates.h"
#include "kernels/counts.h"
#include "kernels/lanes.h"
#include "kernels/meet.h"
#include "kernels/points.h"
#include "kernels/tables.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

inline constexpr int kMaxCasters = 256;
inline constexpr int kMaxShadowBlocks = 16;

// Sheared coordinates around a reference point: x and y are constant along a ray and z grows along it.
struct LightFrame {
  int kx, ky, kz;
  float sx, sy, forward;  // forward: +1 or -1, the sign of the direction's kz component
  Vec3 reference;
  Vec3 reciprocal;  // safe, of the direction
  float extent;     // largest distance of an origin from the reference, in any coordinate
};

template <class F>
inline Vec3T<F> shear(const LightFrame& frame, const Vec3T<F>& p) {
  const F c[3] = {p.x - F(frame.reference.x), p.y - F(frame.reference.y), p.z - F(frame.reference.z)};
  return {c[frame.kx] - F(frame.sx) * c[frame.kz], c[frame.ky] - F(frame.sy) * c[frame.kz],
          F(frame.forward) * c[frame.kz]};
}

struct Rectangle2 {
  float x0, x1, y0, y1;
};

// Where the rays of some blocks start.
struct Sweep {
  PlainBox box;       // of the origins
  Rectangle2 bounds;  // in the light's frame
  float least_z, greatest_z;
};

// The origins of a block's rays in the light's frame.
struct alignas(64) ShadowBlock {
  float x[kPacketSize], y[kPacketSize], z[kPacketSize];
  uint64_t lanes;    // rays that can be traced
  uint64_t blocked;  // of them
  Sweep sweep;
};

// Triangles in the light's frame, one array per number, so that culling sees kLanes of them at a time.
struct alignas(64) Casters {
  float a[3][kMaxCasters + 16], b[3][kMaxCasters + 16], c[3][kMaxCasters + 16];  // inside: a x + b y + c > 0
  float nx[kMaxCasters + 16], ny[kMaxCasters + 16], nz[kMaxCasters + 16], n0[kMaxCasters + 16];
  float inside[kMaxCasters + 16];   // edge values beyond this are surely positive
  float outside[kMaxCasters + 16];  // edge values below minus this are surely negative
  float gate[kMaxCasters + 16];     // and then the ray misses if another one is above this
  float beyond[kMaxCasters + 16];   // the plane n x + n0 surely lies before (after) the ray beyond this
  uint32_t id[kMaxCasters + 16];
  int count;
};

// --- casters -------------------------------------------------------------------------------------

struct alignas(64) CornerLanes {
  float x[3][kLanes], y[3][kLanes], z[3][kLanes];
  uint32_t flags[kLanes];
};

// A linear function's least and greatest value over the rectangle.
struct Span {
  Float least, greatest;
};
inline Span span_of(Float a, Float b, Float c, const Rectangle2& r) {
  const Float ax0 = a * Float(r.x0), ax1 = a * Float(r.x1), by0 = b * Float(r.y0), by1 = b * Float(r.y1);
  return {(least(ax0, ax1) + least(by0, by1)) + c, (greatest(ax0, ax1) + greatest(by0, by1)) + c};
}

// Up to kLanes triangles: their edges and planes, and which of them the sweep can meet. Returns true
// when one of them keeps all of the sweep's rays from the light.
enum class Cover { some, all };
Cover add_casters(const KdView& tree, const LightFrame& frame, const Sweep& sweep, const uint32_t* ids,
                  int count, Casters& out) {
  CornerLanes corners;
  alignas(64) uint32_t id[kLanes];
  for (int i = 0; i < kLanes; ++i) {
    id[i] = ids[i < count ? i : 0];
    const KdTriangle& t = tree.triangles[id[i]];
    for (int k = 0; k < 3; ++k) {
      corners.x[k][i] = t.corner[k][0], corners.y[k][i] = t.corner[k][1], corners.z[k][i] = t.corner[k][2];
    }
    corners.flags[i] = t.flags;
  }
  Vec3T<Float> p[3];
  for (int k = 0; k < 3; ++k) {
    p[k] = shear(frame, Vec3T<Float>{load(corners.x[k]), load(corners.y[k]), load(corners.z[k])});
  }
  const Float x0 = least_of(p[0].x, p[1].x, p[2].x), x1 = greatest_of(p[0].x, p[1].x, p[2].x);
  const Float y0 = least_of(p[0].y, p[1].y, p[2].y), y1 = greatest_of(p[0].y, p[1].y, p[2].y);
  const Float z0 = least_of(p[0].z, p[1].z, p[2].z), z1 = greatest_of(p[0].z, p[1].z, p[2].z);

  // Every corner as the exact test sees it, and every origin, is within `error` of the one here: they have
  // come about by 15 roundings of numbers no larger than `reach`.
  const Float reach = (greatest(greatest(absolute(x0), absolute(x1)), greatest(absolute(y0), absolute(y1))) +
                       greatest(absolute(z0), absolute(z1))) +
                      Float(frame.extent);
  const Float error = reach * Float(1.0f / 1048576), tiny = Float(1e-35f);
  const Float size = (x1 - x0) + (y1 - y0);
  const Float sweep_size = Float((sweep.bounds.x1 - sweep.bounds.x0) + (sweep.bounds.y1 - sweep.bounds.y0));
  const Float margin = error * ((size + sweep_size) * Float(3.0f) + error * Float(4.0f)) + tiny;

  // Corners in counterclockwise order make all edge values positive inside.
  const Vec3T<Float> ab = p[1] - p[0], ac = p[2] - p[0];
  const Float area = ab.x * ac.y - ab.y * ac.x;
  const Float turn = copy_sign(Float(1.0f), area);
  const Mask sliver = invert(absolute(area) > margin * Float(2.0f));
  Float a[3], b[3], c[3];
  Mask apart = either(either(x1 + error<Float(sweep.bounds.x0), x0 - error> Float(sweep.bounds.x1)),
                      either(y1 + error<Float(sweep.bounds.y0), y0 - error> Float(sweep.bounds.y1)));
  apart = either(apart, z1 + error < Float(sweep.least_z));
  Span edges{Float(kInfinity), Float(kInfinity)};
  Float clear = Float(-kInfinity);
  for (int k = 0; k < 3; ++k) {
    const Vec3T<Float>&from = p[k], &to = p[(k + 1) % 3];
    a[k] = (from.y - to.y) * turn, b[k] = (to.x - from.x) * turn;
    c[k] = -(a[k] * from.x + b[k] * from.y);
    const Span e = span_of(a[k], b[k], c[k], sweep.bounds);
    edges = {least(edges.least, e.least), least(edges.greatest, e.greatest)};
    clear = greatest(clear, e.least);
  }
  apart = either(apart, both(edges.greatest < -margin, either(invert(sliver), clear > margin)));

  // The plane: positive where the ray has the triangle before it.
  const Vec3T<Float> normal = cross(ab, ac) * (-turn);
  const Float n0 = -dot(normal, p[0]);
  const Float area_of_box = size * (z1 - z0) + (x1 - x0) * (y1 - y0);
  const Float beyond = error * (area_of_box * Float(11.0f)) + tiny;
  Span plane = span_of(normal.x, normal.y, n0, sweep.bounds);
  const Float nz0 = normal.z * Float(sweep.least_z), nz1 = normal.z * Float(sweep.greatest_z);
  plane = {plane.least + least(nz0, nz1), plane.greatest + greatest(nz0, nz1)};
  apart = either(apart, both(plane.greatest < -beyond, invert(sliver)));

  const Mask wanted = both(invert(apart), mask_of_bits((1ull << count) - 1));
  if (!any(wanted)) return Cover::some;
  const Mask cut_out = invert((load(corners.flags) & Uint(kCutOutTriangle)) == Uint(0u));
  const Mask unsure = either(cut_out, sliver);
  if (any(both(both(wanted, invert(unsure)), both(edges.least > margin, plane.least > beyond))))
    return Cover::all;
  const int n = out.count;
  for (int k = 0; k < 3; ++k) {
    compress(out.a[k] + n, a[k], wanted), compress(out.b[k] + n, b[k], wanted),
        compress(out.c[k] + n, c[k], wanted);
  }
  compress(out.nx + n, normal.x, wanted), compress(out.ny + n, normal.y, wanted);
  compress(out.nz + n, normal.z, wanted), compress(out.n0 + n, n0, wanted);
  compress(out.inside + n, select(unsure, Float(kInfinity), margin), wanted);
  compress(out.outside + n, margin, wanted);
  compress(out.gate + n, select(sliver, margin, Float(-kInfinity)), wanted);
  compress(out.beyond + n, select(sliver, Float(kInfinity), beyond), wanted);
  compress(out.id + n, load(id), wanted);
  out.count += __builtin_popcount(bits(wanted));
  return Cover::some;
}

// --- the walk ------------------------------------------------------------------------------------

enum class Found { casters, darkness, too_many };

// How far a list may go before it is given up, for one block, for up to four, for more.
struct Budget {
  int casters, leaves;
};
inline constexpr Budget kBudgets[3] = {{96, 96}, {96, 64}, {160, 128}};

// Collects the casters that a sweep can meet: the cells that the box of origins, grown by the slack,
// passes through on its way along the direction, each within a span [t0, t1] of the way.
template <class Counts>
Found collect_casters(const KdView& tree, const LightFrame& frame, const Sweep& sweep, GlassRule glass,
                      const Budget& budget, Casters& out, Counts counts) {
  const float slack = traversal_slack(vitral::greatest(tree.magnitude, magnitude(as_box(sweep.box))));
  const float reciprocal[3] = {frame.reciprocal.x, frame.reciprocal.y, frame.reciprocal.z};
  float low[3], high[3];
  float t0 = 0, t1 = kInfinity;
  for (int a = 0; a < 3; ++a) {
    low[a] = component(sweep.box.min, a) - slack, high[a] = component(sweep.box.max, a) + slack;
    const float r = reciprocal[a];
    const float lower = component(tree.bounds.min, a) - slack, upper = component(tree.bounds.max, a) + slack;
    t0 = vitral::greatest(r > 0 ? (lower - high[a]) * r : (upper - low[a]) * r, t0);
    t1 = vitral::least(r > 0 ? (upper - low[a]) * r : (lower - high[a]) * r, t1);
  }
  out.count = 0;
  if (!(t0 <= t1)) return Found::casters;

  constexpr int kSeen = 256;  // triangles met lately, so that few are taken twice
  uint32_t seen[kSeen];
  for (int i = 0; i < kSeen; ++i) seen[i] = kNoTriangle;
  uint32_t ids[kLanes];
  int pending = 0;
  struct Far {
    uint32_t node;
    float t0, t1;
  } stack[kMaxTreeDepth];
  int waiting = 0, leaves = 0;
  uint32_t node = 0;
  for (;;) {
    while (!is_leaf(tree.nodes[node])) {
      counts.group_node();
      const KdNode& n = tree.nodes[node];
      const int a = axis(n);
      const float r = reciprocal[a], give = slack * vitral::absolute(r);
      const float one = (split(n) - low[a]) * r, other = (split(n) - high[a]) * r;
      const float first = vitral::least(one, other) - give, last = vitral::greatest(one, other) + give;
      const uint32_t negative = r < 0 ? 1u : 0u;
      if (first > t1) {
        node = child(n) + negative;
      } else if (last < t0) {
        node = child(n) + 1 - negative;
      } else {
        stack[waiting++] = {child(n) + 1 - negative, vitral::greatest(first, t0), t1};
        node = child(n) + negative;
        t1 = vitral::least(last, t1);
      }
    }
    counts.group_node(), counts.group_leaf();
    if (++leaves > budget.leaves) return Found::too_many;
    const KdNode& leaf = tree.nodes[node];
    for (uint32_t i = 0; i < count(leaf); ++i) {
      const uint32_t id = tree.references[first_reference(leaf) + i];
      if (seen[id % kSeen] == id) continue;
      seen[id % kSeen] = id;
      if (glass == GlassRule::passes && (tree.triangles[id].flags & kGlassTriangle)) continue;
      ids[pending++] = id;
      if (pending < kLanes) continue;
      counts.group_test(pending);
      if (add_casters(tree, frame, sweep, ids, pending, out) == Cover::all) return Found::darkness;
      if (out.count > budget.casters) return Found::too_many;
      pending = 0;
    }
    if (waiting == 0) break;
    --waiting;
    node = stack[waiting].node, t0 = stack[waiting].t0, t1 = stack[waiting].t1;
  }
  counts.group_test(pending);
  if (pending > 0 && add_casters(tree, frame, sweep, ids, pending, out) == Cover::all) return Found::darkness;
  return Found::casters;
}

// --- a block -------------------------------------------------------------------------------------

// Which of the kLanes casters from `first` on the block's rays can meet; all of its rays are blocked
// when one of them covers it.
uint32_t relevant(const Casters& casters, int first, const Sweep& sweep, Cover& cover) {
  Span edges{Float(kInfinity), Float(kInfinity)};
  Float clear = Float(-kInfinity);
  for (int k = 0; k < 3; ++k) {
    const Span e = span_of(load(casters.a[k] + first), load(casters.b[k] + first), load(casters.c[k] + first),
                           sweep.bounds);
    edges = {least(edges.least, e.least), least(edges.greatest, e.greatest)};
    clear = greatest(clear, e.least);
  }
  Span plane =
      span_of(load(casters.nx + first), load(casters.ny + first), load(casters.n0 + first), sweep.bounds);
  const Float nz = load(casters.nz + first), nz0 = nz * Float(sweep.least_z),
              nz1 = nz * Float(sweep.greatest_z);
  plane = {plane.least + least(nz0, nz1), plane.greatest + greatest(nz0, nz1)};
  const Float beyond = load(casters.beyond + first);
  const Mask filled =
      mask_of_bits(casters.count - first >= kLanes ? ~0u : (1u << (casters.count - first)) - 1);
  const Mask outside = both(edges.greatest<-load(casters.outside + first), clear> load(casters.gate + first));
  const Mask apart = either(outside, plane.greatest < -beyond);
  if (any(both(filled, both(edges.least > load(casters.inside + first), plane.least > beyond))))
    cover = Cover::all;
  return bits(both(filled, invert(apart)));
}

// The lanes that caster i surely blocks, and those of which it is not sure.
struct Verdict {
  uint64_t blocked, unsure;
};
Verdict judge(const Casters& casters, int i, const ShadowBlock& block, uint64_t lanes) {
  Verdict v{0, 0};
  const Float inside = Float(casters.inside[i]), outside = Float(-casters.outside[i]),
              gate = Float(casters.gate[i]);
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(lanes, g)) continue;
    const Float x = load(block.x + g), y = load(block.y + g);
    const Float e0 = (Float(casters.a[0][i]) * x + Float(casters.b[0][i]) * y) + Float(casters.c[0][i]);
    const Float e1 = (Float(casters.a[1][i]) * x + Float(casters.b[1][i]) * y) + Float(casters.c[1][i]);
    const Float e2 = (Float(casters.a[2][i]) * x + Float(casters.b[2][i]) * y) + Float(casters.c[2][i]);
    const Float edge = least_of(e0, e1, e2);
    const Mask misses = both(edge<outside, greatest_of(e0, e1, e2)> gate);
    const Mask maybe = both(invert(misses), group_mask(lanes, g));
    if (!any(maybe)) continue;
    const Float plane = (Float(casters.nx[i]) * x + Float(casters.ny[i]) * y) +
                        (Float(casters.nz[i]) * load(block.z + g) + Float(casters.n0[i]));
    const Mask behind = plane < Float(-casters.beyond[i]);
    const Mask sure = both(both(edge > inside, plane > Float(casters.beyond[i])), maybe);
    v.blocked |= static_cast<uint64_t>(bits(sure)) << g;
    v.unsure |= static_cast<uint64_t>(bits(both(maybe, invert(either(sure, behind))))) << g;
  }
  return v;
}

template <class Counts>
void test_block(const KdView& tree, const Casters& casters, const RayPacket& rays, ShadowBlock& block,
                Counts counts) {
  uint64_t tested = 0, mark = counts.mark();
  counts.group_test(casters.count);
  counts.share(mark, 1, [&](int) { return block.lanes; });
  Shears shears;
  bool sheared = false;
  uint64_t open = block.lanes;
  for (int first = 0; first < casters.count && open != 0; first += kLanes) {
    Cover cover = Cover::some;
    uint32_t wanted = relevant(casters, first, block.sweep, cover);
    if (cover == Cover::all) open = 0;
    for (; wanted != 0 && open != 0; wanted &= wanted - 1) {
      const int i = first + __builtin_ctz(wanted);
      counts.test(open);
      tested |= open;
      const Verdict v = judge(casters, i, block, open);
      open &= ~v.blocked;
      if (v.unsure == 0) continue;
      if (!sheared) {
        derive_shears(rays, shears);
        sheared = true;
      }
      counts.test(v.unsure);
      open &= ~test_any(tree, rays, shears, v.unsure, casters.id[i]);
    }
  }
  counts.trace(tested);
  block.blocked = block.lanes & ~open;
}

// --- a tile --------------------------------------------------------------------------------------

// The directions' common shear, and a reference in the middle of the origins.
LightFrame make_frame(const Vec3& direction, const Box& box) {
  LightFrame f;
  f.kz = dominant_axis(direction);
  f.kx = (f.kz + 1) % 3, f.ky = (f.kz + 2) % 3;
  const Shear<float> s = make_shear(permute(direction, f.kz));
  f.sx = s.x, f.sy = s.y, f.forward = s.z > 0 ? 1.0f : -1.0f;
  f.reference = (box.min + box.max) * 0.5f;
  f.reciprocal = {safe_reciprocal(direction.x), safe_reciprocal(direction.y), safe_reciprocal(direction.z)};
  f.extent = largest_component(box.max - box.min);
  return f;
}

Box box_of(const RayPacket& rays, uint64_t lanes) {
  Vec3T<Float> low{Float(kInfinity), Float(kInfinity), Float(kInfinity)}, high = -low;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Vec3T<Float> o{load(rays.ox + g), load(rays.oy + g), load(rays.oz + g)};
    const Mask live = group_mask(lanes, g);
    low = {least(select(live, o.x, low.x), low.x), least(select(live, o.y, low.y), low.y),
           least(select(live, o.z, low.z), low.z)};
    high = {greatest(select(live, o.x, high.x), high.x), greatest(select(live, o.y, high.y), high.y),
            greatest(select(live, o.z, high.z), high.z)};
  }
  return {{least_lane(low.x), least_lane(low.y), least_lane(low.z)},
          {greatest_lane(high.x), greatest_lane(high.y), greatest_lane(high.z)}};
}

// The live rays that can be traced.
uint64_t traceable(const RayPacket& rays) {
  uint64_t lanes = 0;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Vec3T<Float> o{load(rays.ox + g), load(rays.oy + g), load(rays.oz + g)};
    const Vec3T<Float> d{load(rays.dx + g), load(rays.dy + g), load(rays.dz + g)};
    lanes |= static_cast<uint64_t>(bits(is_traceable(o, d))) << g;
  }
  return lanes & rays.live;
}

// How far along the direction a ray from the origin leaves the scene for good; +inf where rounding might
// put that point beyond all bounds.
float exit_distance(const KdView& tree, const LightFrame& frame, const Vec3& origin) {
  float far = kInfinity;
  for (int a = 0; a < 3; ++a) {
    const float r = component(frame.reciprocal, a);
    const float wall = r > 0 ? component(tree.bounds.max, a) : component(tree.bounds.min, a);
    far = vitral::least((wall - component(origin, a)) * r, far);
  }
  return far > 0 ? far * 1.001f : kInfinity;
}

// Moves the origins of a block's rays to the light's frame.
void enter_frame(const LightFrame& frame, const RayPacket& rays, ShadowBlock& block) {
  Float x0 = Float(kInfinity), y0 = x0, z0 = x0, x1 = Float(-kInfinity), y1 = x1, z1 = x1;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Vec3T<Float> p =
        shear(frame, Vec3T<Float>{load(rays.ox + g), load(rays.oy + g), load(rays.oz + g)});
    store(block.x + g, p.x), store(block.y + g, p.y), store(block.z + g, p.z);
    const Mask live = group_mask(block.lanes, g);
    x0 = least(select(live, p.x, x0), x0), x1 = greatest(select(live, p.x, x1), x1);
    y0 = least(select(live, p.y, y0), y0), y1 = greatest(select(live, p.y, y1), y1);
    z0 = least(select(live, p.z, z0), z0), z1 = greatest(select(live, p.z, z1), z1);
  }
  block.sweep.bounds = {least_lane(x0), greatest_lane(x1), least_lane(y0), greatest_lane(y1)};
  block.sweep.least_z = least_lane(z0), block.sweep.greatest_z = greatest_lane(z1);
}

Sweep join_sweeps(const Sweep& a, const Sweep& b) {
  Sweep s = a;
  Box box = as_box(a.box);
  extend(box, as_box(b.box));
  s.box = plain(box);
  s.bounds = {vitral::least(a.bounds.x0, b.bounds.x0), vitral::greatest(a.bounds.x1, b.bounds.x1),
              vitral::least(a.bounds.y0, b.bounds.y0), vitral::greatest(a.bounds.y1, b.bounds.y1)};
  s.least_z = vitral::least(a.least_z, b.least_z),
  s.greatest_z = vitral::greatest(a.greatest_z, b.greatest_z);
  return s;
}

// Triangles that have kept a group of rays from the light, latest first: they are likely to do so again.
struct Occluders {
  static constexpr int kMost = 4;
  uint32_t id[kMost];
  int count;
};

template <class Counts>
bool covers(const KdView& tree, const LightFrame& frame, const Sweep& sweep, uint32_t id, Casters& scratch,
            Counts counts) {
  counts.group_test(1);
  scratch.count = 0;
  return add_casters(tree, frame, sweep, &id, 1, scratch) == Cover::all;
}

// Does one triangle keep all of the sweep's rays from the light? Asked of those that did so before and,
// if a ray of the sweep followed back from behind the scene meets one, of that: the outermost are often
// walls and roofs.
enum class Probe { dark, unknown };
template <class Counts>
Probe probe(const KdView& tree, const LightFrame& frame, const Sweep& sweep, GlassRule glass, const Ray& ray,
            Occluders& occluders, Casters& scratch, Counts counts) {
  for (int i = 0; i < occluders.count; ++i) {
    if (covers(tree, frame, sweep, occluders.id[i], scratch, counts)) return Probe::dark;
  }
  const float far = exit_distance(tree, frame, ray.origin);
  if (!(far < kInfinity)) return Probe::unknown;
  const Hit hit = counts.group_walk(tree, {ray.origin + ray.direction * far, 0, -ray.direction, far});
  if (hit.triangle == kNoTriangle) return Probe::unknown;
  if (glass == GlassRule::passes && (tree.triangles[hit.triangle].flags & kGlassTriangle))
    return Probe::unknown;
  if (!covers(tree, frame, sweep, hit.triangle, scratch, counts)) return Probe::unknown;
  for (int i = Occluders::kMost - 1; i > 0; --i) occluders.id[i] = occluders.id[i - 1];
  occluders.id[0] = hit.triangle;
  occluders.count = occluders.count < Occluders::kMost ? occluders.count + 1 : Occluders::kMost;
  return Probe::dark;
}

// Rays from all over the scene have little in common.
bool is_narrow(const KdView& tree, const Sweep& sweep) {
  return largest_component(extent(as_box(sweep.box))) * 16 < largest_component(extent(tree.bounds));
}

// Some blocks with one list of casters; where that grows too long, a quarter of them at a time; and
// where a single block still has too many, its rays walk the tree.
template <class Counts>
void trace_group(const KdView& tree, const LightFrame& frame, GlassRule glass, const RayPacket* rays,
                 ShadowBlock* blocks, int count, Occluders& occluders, Counts counts) {
  int first = 0;
  while (first < count && blocks[first].lanes == 0) ++first;
  if (first == count) return;
  Sweep sweep = blocks[first].sweep;
  for (int i = first + 1; i < count; ++i) {
    if (blocks[i].lanes != 0) sweep = join_sweeps(sweep, blocks[i].sweep);
  }
  Casters casters;
  const uint64_t mark = counts.mark();
  Found found = Found::too_many;
  if (is_narrow(tree, sweep)) {
    const Ray ray = ray_of(rays[first], __builtin_ctzll(blocks[first].lanes));
    const Budget& budget = kBudgets[count > 4 ? 2 : count > 1 ? 1 : 0];
    found = probe(tree, frame, sweep, glass, ray, occluders, casters, counts) == Probe::dark
                ? Found::darkness
                : collect_casters(tree, frame, sweep, glass, budget, casters, counts);
  }
  counts.share(mark, count, [&](int i) { return blocks[i].lanes; });
  switch (found) {
    case Found::darkness:
      for (int i = 0; i < count; ++i) blocks[i].blocked = blocks[i].lanes;
      return;
    case Found::casters:
      for (int i = 0; i < count; ++i) {
        if (blocks[i].lanes != 0) test_block(tree, casters, rays[i], blocks[i], counts.of(i));
      }
      return;
    case Found::too_many:
      break;
  }
  if (count == 1) {
    blocks->blocked = trace_any_from(tree, 0, *rays, glass, counts);
    return;
  }
  const int part = count > 4 ? 4 : 1;
  for (int i = 0; i < count; i += part) {
    trace_group(tree, frame, glass, rays + i, blocks + i, count - i < part ? count - i : part, occluders,
                counts.of(i));
  }
}

template <class Counts>
void find_blocked(const KdView& tree, const Light& light, GlassRule glass, const PointPacket* const* points,
                  int count, ShadowAnswer* out, Counts counts) {
  RayPacket rays[kMaxShadowBlocks];
  for (int i = 0; i < count; ++i) {
    shadow_rays(light, *points[i], rays[i]);
    out[i] = {rays[i].live, 0};
  }
  if (light.kind != Light::Kind::directional) {
    for (int i = 0; i < count; ++i) {
      if (rays[i].live != 0) out[i].blocked = trace_any_from(tree, 0, rays[i], glass, counts.of(i));
    }
    return;
  }

  ShadowBlock blocks[kMaxShadowBlocks];
  Box box{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  for (int i = 0; i < count; ++i) {
    blocks[i].lanes = traceable(rays[i]);
    blocks[i].blocked = 0;
    if (blocks[i].lanes == 0) continue;
    const Box starts = box_of(rays[i], blocks[i].lanes);
    blocks[i].sweep.box = plain(starts);
    extend(box, starts);
  }
  const LightFrame frame = make_frame(-light.direction, box);
  for (int i = 0; i < count; ++i) {
    if (blocks[i].lanes != 0) enter_frame(frame, rays[i], blocks[i]);
  }
  Occluders occluders{{}, 0};
  trace_group(tree, frame, glass, rays, blocks, count, occluders, counts);
  for (int i = 0; i < count; ++i) out[i].blocked = blocks[i].blocked;
}

}  // namespace

#ifdef VITRAL_COUNTED

void count_shadows(const KdView& tree, const Light& light, GlassRule glass, const PointPacket* const* points,
                   int count, ShadowAnswer* out, const WorkCounts& work) {
  find_blocked(tree, light, glass, points, count, out, Counting{work.totals, work.work});
}

#else

void trace_shadows(const KdView& tree, const Light& light, GlassRule glass, const PointPacket* const* points,
                   int count, ShadowAnswer* out) {
  find_blocked(tree, light, glass, points, count, out, NoCounts{});
}

#endif

}  // namespace VITRAL_ISA
}  // namespace vitral
