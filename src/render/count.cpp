// The kernels that trace, in the variant that counts or in the one that does not.
#include "render/frame.h"

#include <algorithm>

namespace vitral {
namespace {

WorkCounts counts_of(const FrameContext& frame, Pass pass, PassTally& tally, LaneWork* work) {
  return {&tally.traversal[static_cast<size_t>(pass)], frame.count == Count::pixels ? work : nullptr};
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
  if (frame.count == Count::nothing) {
    frame.kernels.trace_closest(tree, rays, hits);
  } else {
    frame.kernels.count_closest(tree, rays, hits, counts_of(frame, pass, tally, work));
  }
}

void run_closest_blocks(const FrameContext& frame, Pass pass, const RayPacket* rays, int count,
                        PassTally& tally, HitPacket* hits, LaneWork* work) {
  const KdView& tree = frame.accelerator.view;
  if (frame.count == Count::nothing) {
    frame.kernels.closest_blocks(tree, rays, count, Shortcuts::taken, hits);
  } else {
    frame.kernels.count_closest_blocks(tree, rays, count, Shortcuts::taken, hits,
                                       counts_of(frame, pass, tally, work));
  }
}

void run_shadows(const FrameContext& frame, const Light& light, const PointPacket* const* points, int count,
                 PassTally& tally, ShadowAnswer* out, LaneWork* work) {
  const KdView& tree = frame.accelerator.view;
  if (frame.count == Count::nothing) {
    frame.kernels.trace_shadows(tree, light, GlassRule::passes, points, count, out);
  } else {
    frame.kernels.count_shadows(tree, light, GlassRule::passes, points, count, out,
                                counts_of(frame, Pass::shadows, tally, work));
  }
}

void run_ambient(const FrameContext& frame, const PointPacket* const* points, int count,
                 const AmbientSettings& settings, PassTally& tally, FreeRays* out, LaneWork* work) {
  const KdView& tree = frame.accelerator.view;
  if (frame.count == Count::nothing) {
    frame.kernels.ambient_blocks(tree, points, count, settings, out);
  } else {
    frame.kernels.count_ambient(tree, points, count, settings, out, counts_of(frame, Pass::ao, tally, work));
  }
}

}  // namespace vitral
