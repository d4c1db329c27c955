// 64 rays through the tree at once.
//
// The packet walks the tree as walk.cpp does for one ray, with an interval [t0, t1] per ray: a child
// is visited when any live ray wants it, and its rays are those that do. Rays whose directions have
// different signs meet the children of a node in different order; they are traced one octant after
// the other (Wald, "Realtime Ray Tracing and Interactive Global Illumination", 2004, chapter 7).
//
// Every ray's answer is a function of the ray and the triangles alone: the same bits as walk.cpp.
#include "kernels/trace.h"
#include "kdtree/kdtree.h"
#include "kernels/counts.h"
#include "kernels/meet.h"
#include "kernels/tables.h"
#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

// What is derived from the packet's rays before the walk.
struct alignas(64) Derived {
  Shears shears;
  float rx[kPacketSize], ry[kPacketSize], rz[kPacketSize];  // safe reciprocals of the direction
  float t0[kPacketSize], t1[kPacketSize];                   // interval in the tree's box
  float slack;
};

// Reciprocals, and the intervals of the rays in the tree's box.
void derive_intervals(const KdView& tree, const RayPacket& rays, Derived& d) {
  d.slack = traversal_slack(vitral::greatest(tree.magnitude, d.shears.reach));
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(d.shears.traceable, g)) continue;
    const Float r[3] = {safe_reciprocal(load(rays.dx + g)), safe_reciprocal(load(rays.dy + g)),
                        safe_reciprocal(load(rays.dz + g))};
    store(d.rx + g, r[0]), store(d.ry + g, r[1]), store(d.rz + g, r[2]);
    const float* origin[3] = {rays.ox + g, rays.oy + g, rays.oz + g};
    Float t0 = Float(rays.tmin), t1 = load(rays.tmax + g);
    for (int a = 0; a < 3; ++a) {
      const Float o = load(origin[a]);
      const Float below = (Float(component(tree.bounds.min, a) - d.slack) - o) * r[a];
      const Float above = (Float(component(tree.bounds.max, a) + d.slack) - o) * r[a];
      t0 = greatest(least(below, above), t0);
      t1 = least(greatest(below, above), t1);
    }
    store(d.t0 + g, t0), store(d.t1 + g, t1);
  }
}

// The rays' intervals in the current cell. Lanes that are not being walked hold anything.
struct alignas(64) Intervals {
  float t0[kPacketSize], t1[kPacketSize];
};

struct alignas(64) Waiting {
  Intervals interval;
  uint64_t lanes;
  uint32_t node;
  float t0, t1;  // hold the interval of every lane
};

// Bounds of the packet along one axis, mirrored where the rays run backwards: all of them cross the plane
// at a t between those of four products.
struct AxisBounds {
  float sign;                 // of the directions
  float least_o, greatest_o;  // of sign * origin
  float least_r, greatest_r;  // of |reciprocal|
};

AxisBounds bounds_along(const float* origin, const float* reciprocal, uint64_t lanes, float sign) {
  Float o0 = Float(kInfinity), o1 = Float(-kInfinity), r0 = o0, r1 = o1;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(lanes, g)) continue;
    const Mask m = group_mask(lanes, g);
    const Float o = load(origin + g) * Float(sign), r = absolute(load(reciprocal + g));
    o0 = least(select(m, o, o0), o0), o1 = greatest(select(m, o, o1), o1);
    r0 = least(select(m, r, r0), r0), r1 = greatest(select(m, r, r1), r1);
  }
  return {sign, least_lane(o0), greatest_lane(o1), least_lane(r0), greatest_lane(r1)};
}

// Which of the lanes want the near and the far child.
struct Wanted {
  uint64_t near, far;
};

// Cuts the intervals at the plane: the near part stays in `now`, the far part goes to `w`. A ray that
// does not reach the plane keeps its interval; one that begins behind it is left with nothing in `now`.
inline Wanted cut_intervals(uint64_t lanes, float split, const float* origin, const float* reciprocal,
                            float slack, Intervals& now, Waiting& w) {
  Wanted wanted{0, 0};
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(lanes, g)) continue;
    const Float r = load(reciprocal + g);
    const Float t = (Float(split) - load(origin + g)) * r;
    const Float give = Float(slack) * absolute(r);
    const Float t0 = load(now.t0 + g), t1 = load(now.t1 + g), first = t - give, last = t + give;
    const Mask only_near = first > t1;
    const Mask only_far = both(invert(only_near), last < t0);
    wanted.near |= static_cast<uint64_t>(bits(invert(only_far))) << g;
    wanted.far |= static_cast<uint64_t>(bits(invert(only_near))) << g;
    store(w.interval.t0 + g, greatest(first, t0));
    store(w.interval.t1 + g, t1);
    store(now.t1 + g, least(last, t1));
  }
  wanted.near &= lanes;
  wanted.far &= lanes;
  return wanted;
}

// Walks the tree from `node` with `lanes`, whose directions all have the signs of bit 0-2 of `octant` (set:
// negative). Returns the lanes that met something.
//
// Where the bounds of all rays agree that none wants one of the children, no ray is looked at.
template <Query query, class Counts>
uint64_t walk_octant(const KdView& tree, const RayPacket& rays, const Derived& d, uint64_t lanes, int octant,
                     uint32_t node, GlassRule glass, HitPacket* hits, Counts counts) {
  const float* origin[3] = {rays.ox, rays.oy, rays.oz};
  const float* reciprocal[3] = {d.rx, d.ry, d.rz};
  Viewer viewer;
  const bool same_axis = find_viewer(rays, d.shears, lanes, viewer);
  AxisBounds bounds[3];
  for (int a = 0; a < 3; ++a)
    bounds[a] = bounds_along(origin[a], reciprocal[a], lanes, octant >> a & 1 ? -1.0f : 1.0f);

  Intervals now;
  Float least_t0 = Float(kInfinity), greatest_t1 = Float(-kInfinity);
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Float t0 = load(d.t0 + g), t1 = load(d.t1 + g);
    store(now.t0 + g, t0);
    store(now.t1 + g, t1);
    const Mask m = group_mask(lanes, g);
    least_t0 = least(select(m, t0, least_t0), least_t0);
    greatest_t1 = greatest(select(m, t1, greatest_t1), greatest_t1);
  }
  float all_t0 = least_lane(least_t0), all_t1 = greatest_lane(greatest_t1);
  Waiting stack[kMaxTreeDepth];
  int waiting = 0;
  uint64_t open = lanes;  // rays that may still meet something new
  uint64_t met = 0;
  for (;;) {
    while (!is_leaf(tree.nodes[node])) {
      counts.node(lanes);
      const KdNode& n = tree.nodes[node];
      const int a = axis(n);
      const uint32_t negative = static_cast<uint32_t>(octant >> a) & 1u;
      const uint32_t near = child(n) + negative, far = child(n) + 1 - negative;
      const AxisBounds& b = bounds[a];
      const float s = split(n) * b.sign, soonest = s - b.greatest_o, latest = s - b.least_o;
      const float give = d.slack * b.greatest_r;
      const float first = soonest * (soonest < 0 ? b.greatest_r : b.least_r) - give;
      const float last = latest * (latest < 0 ? b.least_r : b.greatest_r) + give;
      if (first > all_t1) {
        node = near;
        continue;
      }
      if (last < all_t0) {
        node = far;
        continue;
      }
      Waiting& w = stack[waiting];
      const Wanted wanted = cut_intervals(lanes, split(n), origin[a], reciprocal[a], d.slack, now, w);
      if (wanted.far == 0) {
        node = near;
      } else if (wanted.near == 0) {
        for (int g = 0; g < kPacketSize; g += kLanes) store(now.t1 + g, load(w.interval.t1 + g));
        node = far;
      } else {
        w.node = far;
        w.lanes = wanted.far;
        w.t0 = vitral::greatest(first, all_t0), w.t1 = all_t1;
        all_t1 = vitral::least(last, all_t1);
        ++waiting;
        node = near;
        lanes = wanted.near;
      }
    }

    counts.leaf(lanes);
    const KdNode& leaf = tree.nodes[node];
    const uint32_t* ids = tree.references + first_reference(leaf);
    for (uint32_t i = 1; i < count(leaf); ++i) __builtin_prefetch(&tree.triangles[ids[i]]);
    for (uint32_t i = 0; i < count(leaf) && lanes != 0; ++i) {
      const uint32_t id = ids[i];
      if (glass == GlassRule::passes && (tree.triangles[id].flags & kGlassTriangle)) continue;
      counts.test(lanes);
      const uint64_t here = same_axis
                                ? test_triangle<query, true>(tree, rays, d.shears, viewer, lanes, id, hits)
                                : test_triangle<query, false>(tree, rays, d.shears, viewer, lanes, id, hits);
      met |= here;
      if constexpr (query == Query::any) lanes &= ~here;
    }
    if constexpr (query == Query::any) open &= ~met;

    // Go on with the nearest cell that waits and the rays for which it can still matter.
    do {
      if (waiting == 0 || open == 0) return met;
      const Waiting& w = stack[--waiting];
      node = w.node;
      lanes = w.lanes & open;
      all_t0 = w.t0, all_t1 = w.t1;
      for (int g = 0; g < kPacketSize; g += kLanes) {
        if (group_empty(lanes, g)) continue;
        const Float t0 = load(w.interval.t0 + g);
        Float t1 = load(w.interval.t1 + g);
        if constexpr (query == Query::closest) {
          const Float best = load(hits->t + g);
          lanes &= ~(static_cast<uint64_t>(bits(best < t0)) << g);
          t1 = least(best, t1);
        }
        store(now.t0 + g, t0), store(now.t1 + g, t1);
      }
    } while (lanes == 0);
  }
}

template <Query query, class Counts>
uint64_t trace(const KdView& tree, const RayPacket& rays, uint32_t node, GlassRule glass, HitPacket* hits,
               Counts counts) {
  Derived d;
  derive_shears(rays, d.shears);
  derive_intervals(tree, rays, d);
  uint64_t lanes = 0, negative[3] = {0, 0, 0};
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(d.shears.traceable, g)) continue;
    lanes |= static_cast<uint64_t>(bits(load(d.t0 + g) <= load(d.t1 + g))) << g;
    negative[0] |= static_cast<uint64_t>(bits(load(d.rx + g) < Float(0.0f))) << g;
    negative[1] |= static_cast<uint64_t>(bits(load(d.ry + g) < Float(0.0f))) << g;
    negative[2] |= static_cast<uint64_t>(bits(load(d.rz + g) < Float(0.0f))) << g;
  }
  lanes &= d.shears.traceable;
  counts.trace(lanes);
  uint64_t met = 0;
  for (int octant = 0; octant < 8; ++octant) {
    uint64_t mine = lanes;
    for (int a = 0; a < 3; ++a) mine &= octant >> a & 1 ? negative[a] : ~negative[a];
    if (mine != 0) met |= walk_octant<query>(tree, rays, d, mine, octant, node, glass, hits, counts);
  }
  return met;
}

void clear(HitPacket& hits) {
  for (int g = 0; g < kPacketSize; g += kLanes) {
    store(hits.t + g, Float(kInfinity));
    store(hits.u + g, Float(0.0f));
    store(hits.v + g, Float(0.0f));
    store(hits.triangle + g, Uint(kNoTriangle));
  }
}

}  // namespace

#ifdef VITRAL_COUNTED

void count_closest(const KdView& tree, const RayPacket& rays, HitPacket& hits, const WorkCounts& out) {
  clear(hits);
  trace<Query::closest>(tree, rays, 0, GlassRule::blocks, &hits, Counting{out.totals, out.work});
}

uint64_t improve_closest(const KdView& tree, const RayPacket& rays, HitPacket& hits, Counting counts) {
  return trace<Query::closest>(tree, rays, 0, GlassRule::blocks, &hits, counts);
}

uint64_t count_any(const KdView& tree, const RayPacket& rays, GlassRule glass, const WorkCounts& work) {
  return trace<Query::any>(tree, rays, 0, glass, nullptr, Counting{work.totals, work.work});
}

uint64_t trace_any_from(const KdView& tree, uint32_t node, const RayPacket& rays, GlassRule glass,
                        Counting counts) {
  return trace<Query::any>(tree, rays, node, glass, nullptr, counts);
}

#else

void trace_closest(const KdView& tree, const RayPacket& rays, HitPacket& hits) {
  clear(hits);
  trace<Query::closest>(tree, rays, 0, GlassRule::blocks, &hits, NoCounts{});
}

uint64_t improve_closest(const KdView& tree, const RayPacket& rays, HitPacket& hits, NoCounts counts) {
  return trace<Query::closest>(tree, rays, 0, GlassRule::blocks, &hits, counts);
}

uint64_t trace_any(const KdView& tree, const RayPacket& rays, GlassRule glass) {
  return trace<Query::any>(tree, rays, 0, glass, nullptr, NoCounts{});
}

uint64_t trace_any_from(const KdView& tree, uint32_t node, const RayPacket& rays, GlassRule glass,
                        NoCounts counts) {
  return trace<Query::any>(tree, rays, node, glass, nullptr, counts);
}

#endif

}  // namespace VITRAL_ISA
}  // namespace vitral
