// 64 rays through the tree at once.
//
// The packet walks the tree as walk.cpp does for one ray, with an interval [t0, t1] per ray: a child
// is visited when any live ray wants it, and its rays are those that do. Rays whose directions have
// different signs meet the children of a node in different order; they are traced one octant after
// the other (Wald, "Realtime Ray Tracing and Interactive Global Illumination", 2004, chapter 7).
//
// Every ray's answer is a function of the ray and the triangles alone: the same bits as walk.cpp.
#include "kdtree/kdtree.h"
#include "kdtree/triangle.h"
#include "kernels/candidates.h"
#include "kernels/packet.h"
#include "kernels/tables.h"
#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

enum class Query { closest, any };

// What is derived from the packet's rays before the walk.
struct alignas(64) Derived {
  float rx[kPacketSize], ry[kPacketSize], rz[kPacketSize];  // safe reciprocals of the direction
  float sx[kPacketSize], sy[kPacketSize], sz[kPacketSize];  // shear
  float t0[kPacketSize], t1[kPacketSize];                   // interval in the tree's box
  uint64_t z_is[3];                                         // rays whose dominant axis is x, y, z
  uint64_t traceable;
  float reach;  // largest absolute coordinate of the origins
  float slack;
};

inline Mask group_mask(uint64_t lanes, int g) {
  return mask_of_bits(lanes >> g);
}
inline bool group_empty(uint64_t lanes, int g) {
  constexpr uint64_t all = kLanes == 64 ? ~0ull : (1ull << kLanes) - 1;
  return ((lanes >> g) & all) == 0;
}

// The largest number of a register.
inline float greatest_lane(Float v) {
  alignas(64) float lanes[kLanes];
  store(lanes, v);
  float most = lanes[0];
  for (int i = 1; i < kLanes; ++i) most = vitral::greatest(lanes[i], most);
  return most;
}

// Which rays can be traced at all, how far out their origins lie, and their shears.
void derive_shears(const RayPacket& rays, Derived& d) {
  d.z_is[0] = d.z_is[1] = d.z_is[2] = d.traceable = 0;
  Float reach = Float(0.0f);
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(rays.live, g)) continue;
    const Vec3T<Float> o{load(rays.ox + g), load(rays.oy + g), load(rays.oz + g)};
    const Float x = load(rays.dx + g), y = load(rays.dy + g), z = load(rays.dz + g);
    const Mask good = both(is_traceable(o, Vec3T<Float>{x, y, z}), group_mask(rays.live, g));
    d.traceable |= static_cast<uint64_t>(bits(good)) << g;
    const Float farthest = greatest(absolute(o.x), greatest(absolute(o.y), absolute(o.z)));
    reach = greatest(select(good, farthest, Float(0.0f)), reach);

    const Float ax = absolute(x), ay = absolute(y), az = absolute(z);
    // As dominant_axis() decides it.
    const Mask x_over_y = ax > ay;
    const Mask is_x = both(x_over_y, ax > az);
    const Mask is_y = both(invert(x_over_y), ay > az);
    d.z_is[0] |= static_cast<uint64_t>(bits(is_x)) << g;
    d.z_is[1] |= static_cast<uint64_t>(bits(is_y)) << g;
    d.z_is[2] |= static_cast<uint64_t>(bits(invert(either(is_x, is_y)))) << g;
    const Vec3T<Float> permuted{select(is_x, y, select(is_y, z, x)), select(is_x, z, select(is_y, x, y)),
                                select(is_x, x, select(is_y, y, z))};
    const Shear<Float> shear = make_shear(permuted);
    store(d.sx + g, shear.x), store(d.sy + g, shear.y), store(d.sz + g, shear.z);
  }
  d.reach = greatest_lane(reach);
}

// Reciprocals, and the intervals of the rays in the tree's box.
void derive_intervals(const KdView& tree, const RayPacket& rays, Derived& d) {
  d.slack = traversal_slack(vitral::greatest(tree.magnitude, d.reach));
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(d.traceable, g)) continue;
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

// The corner of a triangle as the rays of group g see it. When all rays run fastest along the same
// axis the permutation is a choice of pointers, else a choice per lane; the bits are the same.
struct Viewer {
  const float *ox, *oy, *oz;  // origins, permuted
  int kx, ky, kz;
};

inline Vec3T<Float> relative_corner(const float* c, const Viewer& v, int g) {
  return {Float(c[v.kx]) - load(v.ox + g), Float(c[v.ky]) - load(v.oy + g), Float(c[v.kz]) - load(v.oz + g)};
}
inline Vec3T<Float> relative_corner(const float* c, const RayPacket& p, int g, Mask is_x, Mask is_y) {
  const Float x = Float(c[0]) - load(p.ox + g), y = Float(c[1]) - load(p.oy + g),
              z = Float(c[2]) - load(p.oz + g);
  return {select(is_x, y, select(is_y, z, x)), select(is_x, z, select(is_y, x, y)),
          select(is_x, x, select(is_y, y, z))};
}

// Clears the lanes of `hit` where a cut-out triangle is not there.
uint64_t keep_visible(const KdView& tree, uint32_t id, uint64_t hit, const Float& u, const Float& v) {
  alignas(64) float us[kLanes], vs[kLanes];
  store(us, u), store(vs, v);
  for (int lane = 0; lane < kLanes; ++lane) {
    if ((hit >> lane & 1) && !tree.cut_outs.is_there(tree.cut_outs.scene, id, us[lane], vs[lane]))
      hit &= ~(1ull << lane);
  }
  return hit;
}

// Tests one triangle against `lanes`; returns those that meet it (closest: and record it).
template <Query query, bool same_axis>
uint64_t test_triangle(const KdView& tree, const RayPacket& rays, const Derived& d, const Viewer& viewer,
                       uint64_t lanes, uint32_t id, HitPacket* hits) {
  const KdTriangle& triangle = tree.triangles[id];
  uint64_t met = 0;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(lanes, g)) continue;
    const Shear<Float> shear{load(d.sx + g), load(d.sy + g), load(d.sz + g)};
    Vec3T<Float> corner[3];
    for (int k = 0; k < 3; ++k) {
      if constexpr (same_axis) {
        corner[k] = project(relative_corner(triangle.corner[k], viewer, g), shear);
      } else {
        corner[k] = project(
            relative_corner(triangle.corner[k], rays, g, group_mask(d.z_is[0], g), group_mask(d.z_is[1], g)),
            shear);
      }
    }
    const Mask maybe = both(may_surround_origin(corner[0], corner[1], corner[2]), group_mask(lanes, g));
    if (!any(maybe)) continue;

    const auto found = surround_origin(corner[0], corner[1], corner[2], shear);
    Mask hit = both(both(found.hit, maybe), both(found.t > Float(rays.tmin), found.t < load(rays.tmax + g)));
    if constexpr (query == Query::closest) {
      const Float best = load(hits->t + g);
      hit = both(hit, either(found.t < best, both(found.t == best, Uint(id) < load(hits->triangle + g))));
    }
    uint64_t hit_bits = bits(hit);
    if (hit_bits != 0 && (triangle.flags & kCutOutTriangle))
      hit_bits = keep_visible(tree, id, hit_bits, found.u, found.v);
    if (hit_bits == 0) continue;
    met |= hit_bits << g;
    if constexpr (query == Query::closest) {
      const Mask keep = mask_of_bits(hit_bits);
      store(hits->t + g, select(keep, found.t, load(hits->t + g)));
      store(hits->u + g, select(keep, found.u, load(hits->u + g)));
      store(hits->v + g, select(keep, found.v, load(hits->v + g)));
      store(hits->triangle + g, select(keep, Uint(id), load(hits->triangle + g)));
    }
  }
  return met;
}

// The rays' intervals in the current cell. Lanes that are not being walked hold anything.
struct alignas(64) Intervals {
  float t0[kPacketSize], t1[kPacketSize];
};

// Which of the lanes want the near and the far child.
struct Wanted {
  uint64_t near, far;
};

inline Wanted classify(uint64_t lanes, float split, const float* origin, const float* reciprocal, float slack,
                       const Intervals& now) {
  Wanted w{0, 0};
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(lanes, g)) continue;
    const Float r = load(reciprocal + g);
    const Float t = (Float(split) - load(origin + g)) * r;
    const Float give = Float(slack) * absolute(r);
    const Mask only_near = t - give > load(now.t1 + g);
    const Mask only_far = both(invert(only_near), t + give < load(now.t0 + g));
    w.near |= static_cast<uint64_t>(bits(invert(only_far))) << g;
    w.far |= static_cast<uint64_t>(bits(invert(only_near))) << g;
  }
  w.near &= lanes;
  w.far &= lanes;
  return w;
}

struct alignas(64) Waiting {
  Intervals interval;
  uint64_t lanes;
  uint32_t node;
};

// Cuts the intervals at the plane: the near part stays in `now`, the far part goes to `w`.
inline void cut_intervals(uint64_t lanes, float split, const float* origin, const float* reciprocal,
                          float slack, Intervals& now, Waiting& w) {
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(lanes, g)) continue;
    const Float r = load(reciprocal + g);
    const Float t = (Float(split) - load(origin + g)) * r;
    const Float give = Float(slack) * absolute(r);
    const Float t1 = load(now.t1 + g);
    store(w.interval.t0 + g, greatest(t - give, load(now.t0 + g)));
    store(w.interval.t1 + g, t1);
    store(now.t1 + g, least(t + give, t1));
  }
}

// The pointers for rays that run fastest along the same axis; false when they do not.
inline bool find_viewer(const RayPacket& rays, const Derived& d, uint64_t lanes, Viewer& viewer) {
  const float* origin[3] = {rays.ox, rays.oy, rays.oz};
  for (int z = 0; z < 3; ++z) {
    const int x = (z + 1) % 3, y = (z + 2) % 3;
    viewer = {origin[x], origin[y], origin[z], x, y, z};
    if ((lanes & ~d.z_is[z]) == 0) return true;
  }
  return false;
}

// Walks the tree from `node` with `lanes`, whose directions all have the signs of bit 0-2 of `octant` (set:
// negative). Returns the lanes that met something.
template <Query query>
uint64_t walk_octant(const KdView& tree, const RayPacket& rays, const Derived& d, uint64_t lanes, int octant,
                     uint32_t node, GlassRule glass, HitPacket* hits) {
  const float* origin[3] = {rays.ox, rays.oy, rays.oz};
  const float* reciprocal[3] = {d.rx, d.ry, d.rz};
  Viewer viewer;
  const bool same_axis = find_viewer(rays, d, lanes, viewer);

  Intervals now;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    store(now.t0 + g, load(d.t0 + g));
    store(now.t1 + g, load(d.t1 + g));
  }
  Waiting stack[kMaxTreeDepth];
  int waiting = 0;
  uint64_t open = lanes;  // rays that may still meet something new
  uint64_t met = 0;
  for (;;) {
    while (!is_leaf(tree.nodes[node])) {
      const KdNode& n = tree.nodes[node];
      const int a = axis(n);
      const uint32_t negative = static_cast<uint32_t>(octant >> a) & 1u;
      const uint32_t near = child(n) + negative, far = child(n) + 1 - negative;
      const Wanted wanted = classify(lanes, split(n), origin[a], reciprocal[a], d.slack, now);
      if (wanted.far == 0) {
        node = near;
      } else if (wanted.near == 0) {
        node = far;
      } else {
        Waiting& w = stack[waiting++];
        w.node = far;
        w.lanes = wanted.far;
        cut_intervals(lanes, split(n), origin[a], reciprocal[a], d.slack, now, w);
        node = near;
        lanes = wanted.near;
      }
    }

    const KdNode& leaf = tree.nodes[node];
    for (uint32_t i = 0; i < count(leaf) && lanes != 0; ++i) {
      const uint32_t id = tree.references[first_reference(leaf) + i];
      if (glass == GlassRule::passes && (tree.triangles[id].flags & kGlassTriangle)) continue;
      const uint64_t here = same_axis ? test_triangle<query, true>(tree, rays, d, viewer, lanes, id, hits)
                                      : test_triangle<query, false>(tree, rays, d, viewer, lanes, id, hits);
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

template <Query query>
uint64_t trace(const KdView& tree, const RayPacket& rays, uint32_t node, GlassRule glass, HitPacket* hits) {
  Derived d;
  derive_shears(rays, d);
  derive_intervals(tree, rays, d);
  uint64_t lanes = 0, negative[3] = {0, 0, 0};
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(d.traceable, g)) continue;
    lanes |= static_cast<uint64_t>(bits(load(d.t0 + g) <= load(d.t1 + g))) << g;
    negative[0] |= static_cast<uint64_t>(bits(load(d.rx + g) < Float(0.0f))) << g;
    negative[1] |= static_cast<uint64_t>(bits(load(d.ry + g) < Float(0.0f))) << g;
    negative[2] |= static_cast<uint64_t>(bits(load(d.rz + g) < Float(0.0f))) << g;
  }
  lanes &= d.traceable;
  uint64_t met = 0;
  for (int octant = 0; octant < 8; ++octant) {
    uint64_t mine = lanes;
    for (int a = 0; a < 3; ++a) mine &= octant >> a & 1 ? negative[a] : ~negative[a];
    if (mine != 0) met |= walk_octant<query>(tree, rays, d, mine, octant, node, glass, hits);
  }
  return met;
}

}  // namespace

void trace_closest(const KdView& tree, const RayPacket& rays, HitPacket& hits) {
  for (int g = 0; g < kPacketSize; g += kLanes) {
    store(hits.t + g, Float(kInfinity));
    store(hits.u + g, Float(0.0f));
    store(hits.v + g, Float(0.0f));
    store(hits.triangle + g, Uint(kNoTriangle));
  }
  trace<Query::closest>(tree, rays, 0, GlassRule::blocks, &hits);
}

uint64_t trace_any(const KdView& tree, const RayPacket& rays, GlassRule glass) {
  return trace<Query::any>(tree, rays, 0, glass, nullptr);
}

uint64_t trace_any_from(const KdView& tree, uint32_t node, const RayPacket& rays, GlassRule glass) {
  return trace<Query::any>(tree, rays, node, glass, nullptr);
}

uint64_t test_any(const KdView& tree, const Candidates& candidates, const RayPacket& rays) {
  Derived d;
  derive_shears(rays, d);
  Viewer viewer;
  const bool same_axis = find_viewer(rays, d, d.traceable, viewer);
  uint64_t met = 0;
  for (int i = 0; i < candidates.count; ++i) {
    const uint64_t lanes = d.traceable & candidates.lanes[i] & ~met;
    if (lanes == 0) continue;
    const uint32_t id = candidates.triangle[i];
    met |= same_axis ? test_triangle<Query::any, true>(tree, rays, d, viewer, lanes, id, nullptr)
                     : test_triangle<Query::any, false>(tree, rays, d, viewer, lanes, id, nullptr);
  }
  return met;
}

}  // namespace VITRAL_ISA
}  // namespace vitral
