// 64 rays through the tree over the objects, as kdtree/objects.cpp does it for one: in a leaf the rays that
// come there go into the object's space and meet a shape, or walk the model's tree as a packet of their own.
//
// Every ray's answer is a function of the ray and the objects alone: the same bits as kdtree/objects.cpp.
#include "kdtree/objects.h"
#include "kdtree/shapes.h"
#include "kernels/counts.h"
#include "kernels/lanes.h"
#include "kernels/meet.h"
#include "kernels/strata.h"
#include "kernels/tables.h"
#include "kernels/trace.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

// More than any path from the root has boxes (kdtree/object_tree.h).
inline constexpr int kMostWaiting = 128;

// What the packet's rays bring to the boxes.
struct alignas(64) BoxRays {
  float rx[kPacketSize], ry[kPacketSize], rz[kPacketSize];  // safe reciprocals of the directions
  uint64_t traceable;
  float slack;
};

void derive_boxes(const ObjectsView& view, const RayPacket& rays, BoxRays& out) {
  out.traceable = 0;
  Float reach = Float(0.0f);
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(rays.live, g)) continue;
    const Vec3T<Float> o = load3(rays.ox, rays.oy, rays.oz, g), d = load3(rays.dx, rays.dy, rays.dz, g);
    const Mask good = both(is_traceable(o, d), group_mask(rays.live, g));
    out.traceable |= static_cast<uint64_t>(bits(good)) << g;
    const Float farthest = greatest(absolute(o.x), greatest(absolute(o.y), absolute(o.z)));
    reach = greatest(select(good, farthest, Float(0.0f)), reach);
    store3(out.rx, out.ry, out.rz, g, {safe_reciprocal(d.x), safe_reciprocal(d.y), safe_reciprocal(d.z)});
  }
  out.slack = traversal_slack(vitral::greatest(view.magnitude, greatest_lane(reach)));
}

// Those of the lanes that enter a node's box before they end, or before what they have met.
template <Query query>
uint64_t enter_box(const ObjectNode& node, const RayPacket& rays, const BoxRays& d, const HitPacket* hits,
                   uint64_t lanes) {
  const float slack = d.slack * node.slack;
  uint64_t inside = 0;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(lanes, g)) continue;
    Float t0 = Float(rays.tmin), t1 = load(rays.tmax + g);
    if constexpr (query == Query::closest) t1 = least(load(hits->t + g), t1);
    const auto cut = [&](float low, float high, const float* origin, const float* reciprocal) {
      const Float o = load(origin + g), r = load(reciprocal + g);
      const Float below = (Float(low - slack) - o) * r, above = (Float(high + slack) - o) * r;
      t0 = greatest(least(below, above), t0);
      t1 = least(greatest(below, above), t1);
    };
    cut(node.bounds.min.x, node.bounds.max.x, rays.ox, d.rx);
    cut(node.bounds.min.y, node.bounds.max.y, rays.oy, d.ry);
    cut(node.bounds.min.z, node.bounds.max.z, rays.oz, d.rz);
    inside |= static_cast<uint64_t>(bits(t0 <= t1)) << g;
  }
  return inside & lanes;
}

// Records t of the lanes where it is closer than what they have met; returns them.
uint64_t keep_closer(uint32_t number, Float t, Mask met, int g, HitPacket& hits) {
  const Float best = load(hits.t + g);
  const Uint other = load(hits.triangle + g);
  const Mask closer = both(met, either(t < best, both(t == best, Uint(number) < other)));
  store(hits.t + g, select(closer, t, best));
  store(hits.u + g, select(closer, Float(0.0f), load(hits.u + g)));
  store(hits.v + g, select(closer, Float(0.0f), load(hits.v + g)));
  store(hits.triangle + g, select(closer, Uint(number), other));
  return bits(closer);
}

// A texture is asked for each ray by itself.
Mask meet_cut_out_lanes(const ObjectsView& view, uint32_t object, const RayPacket& rays, uint64_t lanes, int g,
                        Float& t) {
  alignas(64) float ts[kLanes] = {};
  uint64_t met = 0;
  for (int lane = 0; lane < kLanes; ++lane) {
    if ((lanes >> (g + lane) & 1) && meet_cut_out(view, object, ray_of(rays, g + lane), ts[lane]))
      met |= 1ull << lane;
  }
  t = load(ts);
  return mask_of_bits(met);
}

template <Query query>
uint64_t meet_shape(const ObjectsView& view, uint32_t number, const RayPacket& rays, uint64_t lanes,
                    HitPacket* hits) {
  const PlacedObject& object = view.objects[number];
  uint64_t met = 0;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(lanes, g)) continue;
    Float t;
    Mask here;
    if (object.flags & kCutOutTriangle) {
      here = meet_cut_out_lanes(view, number, rays, lanes, g, t);
    } else {
      const auto there = ray_to_object(object, load3(rays.ox, rays.oy, rays.oz, g),
                                       load3(rays.dx, rays.dy, rays.dz, g));
      const auto found = nearest_end(shape_span(object.shape, there.origin, there.direction),
                                     Float(rays.tmin), load(rays.tmax + g));
      here = both(found.hit, group_mask(lanes, g)), t = found.t;
    }
    uint64_t kept = bits(here);
    if constexpr (query == Query::closest) kept = keep_closer(object.first_number, t, here, g, *hits);
    met |= kept << g;
  }
  return met;
}

// The lanes' rays in an object's space. Those that have met something end just above it: at the same t the
// lower number is the closer one.
template <Query query>
void move_rays(const PlacedObject& object, const RayPacket& rays, uint64_t lanes, const HitPacket* hits,
               RayPacket& out) {
  out.tmin = rays.tmin;
  out.live = lanes;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(lanes, g)) continue;
    const auto there =
        ray_to_object(object, load3(rays.ox, rays.oy, rays.oz, g), load3(rays.dx, rays.dy, rays.dz, g));
    store3(out.ox, out.oy, out.oz, g, narrowed(there.origin));
    store3(out.dx, out.dy, out.dz, g, narrowed(there.direction));
    Float tmax = load(rays.tmax + g);
    if constexpr (query == Query::closest) {
      const Float best = load(hits->t + g);
      tmax = least(tmax, select(best < Float(kInfinity), from_bits(as_bits(best) + Uint(1)), best));
    }
    store(out.tmax + g, tmax);
  }
}

// The walk sees the best hits so far under the number 0 where they are not to be replaced at the same t, as
// no number where they are.
template <class Counts>
void meet_model_closest(const ObjectsView& view, const PlacedObject& object, const RayPacket& rays,
                        uint64_t lanes, HitPacket& hits, Counts counts) {
  RayPacket there;
  HitPacket found;
  move_rays<Query::closest>(object, rays, lanes, &hits, there);
  for (int g = 0; g < kPacketSize; g += kLanes) {
    store(found.t + g, load(hits.t + g));
    store(found.u + g, Float(0.0f)), store(found.v + g, Float(0.0f));
    store(found.triangle + g,
          select(load(hits.triangle + g) < Uint(object.first_number), Uint(0), Uint(kNoTriangle)));
  }
  const uint64_t met = improve_closest(view.models[object.model].tree, there, found, counts);
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(met, g)) continue;
    const Mask m = group_mask(met, g);
    store(hits.t + g, select(m, load(found.t + g), load(hits.t + g)));
    store(hits.u + g, select(m, load(found.u + g), load(hits.u + g)));
    store(hits.v + g, select(m, load(found.v + g), load(hits.v + g)));
    store(hits.triangle + g, select(m, load(found.triangle + g) + Uint(object.first_number),
                                    load(hits.triangle + g)));
  }
}

template <Query query, class Counts>
uint64_t meet_object(const ObjectsView& view, uint32_t number, const RayPacket& rays, uint64_t lanes,
                     GlassRule glass, HitPacket* hits, Counts counts) {
  const PlacedObject& object = view.objects[number];
  if (object.shape != Shape::mesh) {
    if (glass == GlassRule::passes && (object.flags & kGlassTriangle)) return 0;
    counts.test(lanes);
    return meet_shape<query>(view, number, rays, lanes, hits);
  }
  if constexpr (query == Query::closest) {
    meet_model_closest(view, object, rays, lanes, *hits, counts);
    return 0;
  } else {
    RayPacket there;
    move_rays<query>(object, rays, lanes, nullptr, there);
    return trace_any_from(view.models[object.model].tree, 0, there, glass, counts);
  }
}

// Returns the lanes that met something (any); closest: improves the hits.
template <Query query, class Counts>
uint64_t walk_objects(const ObjectsView& view, const RayPacket& rays, GlassRule glass, HitPacket* hits,
                      Counts counts) {
  BoxRays d;
  derive_boxes(view, rays, d);
  if (d.traceable == 0) return 0;
  const int first = __builtin_ctzll(d.traceable);
  const float ahead[3] = {rays.dx[first], rays.dy[first], rays.dz[first]};
  struct {
    uint64_t lanes;
    uint32_t node;
  } stack[kMostWaiting];
  int waiting = 0;
  uint64_t met = 0;
  if (view.nodes) stack[waiting++] = {d.traceable, 0};
  while (waiting > 0) {
    --waiting;
    const ObjectNode& node = view.nodes[stack[waiting].node];
    uint64_t lanes = stack[waiting].lanes;
    if constexpr (query == Query::any) lanes &= ~met;
    if (lanes != 0) lanes = enter_box<query>(node, rays, d, hits, lanes);
    if (lanes == 0) continue;
    if (node.axis == 3) {
      counts.leaf(lanes);
      met |= meet_object<query>(view, node.left, rays, lanes, glass, hits, counts);
      continue;
    }
    counts.node(lanes);
    const uint32_t near = ahead[node.axis] < 0 ? 1u : 0u;
    stack[waiting++] = {lanes, node.left + (1 - near)};
    stack[waiting++] = {lanes, node.left + near};
  }
  for (uint32_t i = 0; i < view.unbounded_count; ++i) {
    uint64_t lanes = d.traceable;
    if constexpr (query == Query::any) lanes &= ~met;
    if (lanes != 0) met |= meet_object<query>(view, view.unbounded[i], rays, lanes, glass, hits, counts);
  }
  return met;
}

void remove_blocked(uint64_t blocked, FreeRays& rays) {
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(blocked, g)) continue;
    const Uint free = load(rays.count + g);
    store(rays.count + g, select(group_mask(blocked, g), free - Uint(1u), free));
  }
}

// Stratum by stratum: what an object blocks the mesh need not be asked for.
template <class Counts>
void trace_strata(const KdView& tree, const ObjectsView& view, const PointPacket& points,
                  const AmbientSettings& settings, FreeRays& out, Counts counts) {
  const int samples = settings.strata * settings.strata;
  for (int g = 0; g < kPacketSize; g += kLanes) store(out.count + g, Uint(static_cast<uint32_t>(samples)));
  for (int s = 0; s < samples; ++s) {
    RayPacket rays;
    stratum_rays(points, settings, s, rays);
    const uint64_t blocked = walk_objects<Query::any>(view, rays, GlassRule::passes, nullptr, counts);
    remove_blocked(blocked, out);
    rays.live &= ~blocked;
    if (rays.live != 0) remove_blocked(trace_any_from(tree, 0, rays, GlassRule::passes, counts), out);
  }
}

}  // namespace

#ifdef VITRAL_COUNTED

void count_closest_objects(const ObjectsView& view, const RayPacket& rays, HitPacket& hits,
                           const WorkCounts& out) {
  const uint64_t traced = out.totals->rays_traced;
  walk_objects<Query::closest>(view, rays, GlassRule::blocks, &hits, Counting{out.totals, out.work});
  out.totals->rays_traced = traced;
}

uint64_t count_any_objects(const ObjectsView& view, const RayPacket& rays, GlassRule glass,
                           const WorkCounts& out) {
  const uint64_t traced = out.totals->rays_traced;
  const uint64_t met =
      walk_objects<Query::any>(view, rays, glass, nullptr, Counting{out.totals, out.work});
  out.totals->rays_traced = traced;
  return met;
}

void count_ambient_objects(const KdView& tree, const ObjectsView& view, const PointPacket& points,
                           const AmbientSettings& settings, FreeRays& free_rays, const WorkCounts& out) {
  const uint64_t traced = out.totals->rays_traced;
  trace_strata(tree, view, points, settings, free_rays, Counting{out.totals, out.work});
  out.totals->rays_traced = traced;
}

#else

void closest_objects(const ObjectsView& view, const RayPacket& rays, HitPacket& hits) {
  walk_objects<Query::closest>(view, rays, GlassRule::blocks, &hits, NoCounts{});
}

void closest_shape(const ObjectsView& view, uint32_t shape, const RayPacket& rays, HitPacket& hits) {
  BoxRays d;
  derive_boxes(view, rays, d);
  meet_shape<Query::closest>(view, shape, rays, d.traceable, &hits);
}

uint64_t any_objects(const ObjectsView& view, const RayPacket& rays, GlassRule glass) {
  return walk_objects<Query::any>(view, rays, glass, nullptr, NoCounts{});
}

void ambient_objects(const KdView& tree, const ObjectsView& view, const PointPacket& points,
                     const AmbientSettings& settings, FreeRays& free_rays) {
  trace_strata(tree, view, points, settings, free_rays, NoCounts{});
}

#endif

}  // namespace VITRAL_ISA
}  // namespace vitral
