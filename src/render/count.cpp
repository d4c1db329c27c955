// The kernels that trace, in the variant that counts or in the one that does not.
#include "render/frame.h"

#include <algorithm>

namespace vitral {
namespace {

WorkCounts counts_of(const FrameContext& frame, Pass pass, PassTally& tally, LaneWork* work) {
  return {&tally.traversal[static_cast<size_t>(pass)], frame.count == Count::pixels ? work : nullptr};
}

bool has_objects(const FrameContext& frame) {
  return frame.accelerator.placed.view.count > 0;
}

// The kernels for objects count no rays: those that walk the mesh's tree mostly walk the objects', too. Keeps
// rays_traced at what the mesh's kernel made of it, or at the rays that walk the objects if these are more.
class TracedRays {
 public:
  TracedRays(Pass pass, PassTally& tally)
      : traced_(tally.traversal[static_cast<size_t>(pass)].rays_traced), before_(traced_) {}
  ~TracedRays() { traced_ = std::max(traced_, before_ + walked_); }
  TracedRays(const TracedRays&) = delete;
  TracedRays& operator=(const TracedRays&) = delete;
  void walked(uint64_t lanes) { walked_ += static_cast<uint64_t>(__builtin_popcountll(lanes)); }

 private:
  uint64_t& traced_;
  uint64_t before_, walked_ = 0;
};

void closest_of_objects(const FrameContext& frame, Pass pass, const RayPacket& rays, PassTally& tally,
                        HitPacket& hits, LaneWork* work) {
  const ObjectsView& objects = frame.accelerator.placed.view;
  if (frame.count == Count::nothing) {
    frame.kernels.closest_objects(objects, rays, hits);
  } else {
    frame.kernels.count_closest_objects(objects, rays, hits, counts_of(frame, pass, tally, work));
  }
}

uint64_t any_of_objects(const FrameContext& frame, Pass pass, const RayPacket& rays, GlassRule glass,
                        PassTally& tally, LaneWork* work) {
  const ObjectsView& objects = frame.accelerator.placed.view;
  if (frame.count == Count::nothing) return frame.kernels.any_objects(objects, rays, glass);
  return frame.kernels.count_any_objects(objects, rays, glass, counts_of(frame, pass, tally, work));
}

// Those of the rays that are not in `met`.
RayPacket without(const RayPacket& rays, uint64_t met) {
  RayPacket left = rays;
  left.live &= ~met;
  return left;
}

// Where the live points' rays of a length may lie.
Box reach_of(const PointPacket& points, float distance) {
  Box box;
  for (uint64_t left = points.live; left != 0; left &= left - 1) {
    const int lane = __builtin_ctzll(left);
    const float around = (distance + points.offset[lane]) * 1.0001f;
    const Vec3 p = get(points.px, points.py, points.pz, lane), all{around, around, around};
    extend(box, Box{p - all, p + all});
  }
  return box;
}

}  // namespace

Count what_to_count(const Settings& settings) {
  if (std::find(settings.aovs.begin(), settings.aovs.end(), "cost") != settings.aovs.end())
    return Count::pixels;
  return settings.count_traversal ? Count::totals : Count::nothing;
}

void run_closest(const FrameContext& frame, Pass pass, const RayPacket& rays, PassTally& tally,
                 HitPacket& hits, LaneWork* work) {
  const KdView& tree = frame.accelerator.view;
  TracedRays traced(pass, tally);
  if (frame.count == Count::nothing) {
    frame.kernels.trace_closest(tree, rays, hits);
  } else {
    frame.kernels.count_closest(tree, rays, hits, counts_of(frame, pass, tally, work));
  }
  if (!has_objects(frame)) return;
  closest_of_objects(frame, pass, rays, tally, hits, work);
  traced.walked(rays.live);
}

void run_closest_blocks(const FrameContext& frame, Pass pass, const RayPacket* rays, int count,
                        PassTally& tally, HitPacket* hits, LaneWork* work) {
  const KdView& tree = frame.accelerator.view;
  TracedRays traced(pass, tally);
  if (frame.count == Count::nothing) {
    frame.kernels.closest_blocks(tree, rays, count, Shortcuts::taken, hits);
  } else {
    frame.kernels.count_closest_blocks(tree, rays, count, Shortcuts::taken, hits,
                                       counts_of(frame, pass, tally, work));
  }
  if (!has_objects(frame)) return;
  for (int i = 0; i < count; ++i) {
    closest_of_objects(frame, pass, rays[i], tally, hits[i], work + i);
    traced.walked(rays[i].live);
  }
}

uint64_t run_any(const FrameContext& frame, Pass pass, const RayPacket& rays, GlassRule glass,
                 PassTally& tally, LaneWork* work) {
  const KdView& tree = frame.accelerator.view;
  TracedRays traced(pass, tally);
  const uint64_t met = frame.count == Count::nothing
                           ? frame.kernels.trace_any(tree, rays, glass)
                           : frame.kernels.count_any(tree, rays, glass, counts_of(frame, pass, tally, work));
  if (!has_objects(frame) || met == rays.live) return met;
  const RayPacket left = without(rays, met);
  traced.walked(left.live);
  return met | any_of_objects(frame, pass, left, glass, tally, work);
}

uint64_t run_any_glass(const FrameContext& frame, Pass pass, const RayPacket& rays, PassTally& tally,
                       LaneWork* work) {
  const KdView& tree = frame.accelerator.glass_view;
  uint64_t met;
  if (frame.count == Count::nothing) {
    met = frame.kernels.trace_any(tree, rays, GlassRule::blocks);
  } else {
    TraversalCounts counts{};
    const WorkCounts out{&counts, frame.count == Count::pixels ? work : nullptr};
    met = frame.kernels.count_any(tree, rays, GlassRule::blocks, out);
    counts.rays_traced = 0;  // they have been counted
    add(tally.traversal[static_cast<size_t>(pass)], counts);
  }
  // What is not glass does not meet these rays.
  if (!has_objects(frame) || met == rays.live) return met;
  return met | any_of_objects(frame, pass, without(rays, met), GlassRule::blocks, tally, work);
}

void run_shadows(const FrameContext& frame, const Light& light, const PointPacket* const* points, int count,
                 PassTally& tally, ShadowAnswer* out, LaneWork* work) {
  const KdView& tree = frame.accelerator.view;
  TracedRays traced(Pass::shadows, tally);
  if (frame.count == Count::nothing) {
    frame.kernels.trace_shadows(tree, light, GlassRule::passes, points, count, out);
  } else {
    frame.kernels.count_shadows(tree, light, GlassRule::passes, points, count, out,
                                counts_of(frame, Pass::shadows, tally, work));
  }
  if (!has_objects(frame)) return;
  for (int i = 0; i < count; ++i) {
    RayPacket rays;
    frame.kernels.shadow_rays(light, *points[i], rays);
    rays.live = out[i].facing & ~out[i].blocked;
    if (rays.live == 0) continue;
    out[i].blocked |= any_of_objects(frame, Pass::shadows, rays, GlassRule::passes, tally, work + i);
    traced.walked(rays.live);
  }
}

void run_ambient(const FrameContext& frame, const PointPacket* const* points, int count,
                 const AmbientSettings& settings, PassTally& tally, FreeRays* out, LaneWork* work) {
  const KdView& tree = frame.accelerator.view;
  TracedRays traced(Pass::ao, tally);
  if (frame.count == Count::nothing) {
    frame.kernels.ambient_blocks(tree, points, count, settings, out);
  } else {
    frame.kernels.count_ambient(tree, points, count, settings, out, counts_of(frame, Pass::ao, tally, work));
  }
  if (!has_objects(frame)) return;
  // The mesh's answer does not say which rays it was: blocks with objects near begin anew.
  const ObjectsView& objects = frame.accelerator.placed.view;
  for (int i = 0; i < count; ++i) {
    if (points[i]->live == 0 || !comes_near(objects, reach_of(*points[i], settings.distance))) continue;
    if (frame.count == Count::nothing) {
      frame.kernels.ambient_objects(tree, objects, *points[i], settings, out[i]);
    } else {
      frame.kernels.count_ambient_objects(tree, objects, *points[i], settings, out[i],
                                          counts_of(frame, Pass::ao, tally, work + i));
    }
    for (int s = 0; s < settings.strata * settings.strata; ++s) traced.walked(points[i]->live);
  }
}

}  // namespace vitral
