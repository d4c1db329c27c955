// Ambient occlusion: the share of a cosine-weighted hemisphere that is free up to a distance
// (Zhukov, Iones and Kronin, "An ambient light illumination model", 1998).
#include "render/frame.h"

namespace vitral {

void count_free_rays(const FrameContext& frame, const PointPacket& points, PassTally& tally,
                     uint32_t* free_rays) {
  const PassTimer timer(tally, Pass::ao);
  frame.kernels.ambient_occlusion(frame.accelerator.view, points,
                                  {frame.ao_strata, frame.settings.ao_distance, frame.sample_step},
                                  free_rays);
  tally.rays[static_cast<size_t>(Pass::ao)] += static_cast<uint64_t>(__builtin_popcountll(points.live)) *
                                               static_cast<uint64_t>(frame.ao_strata * frame.ao_strata);
}

void ambient_visibility(const FrameContext& frame, const PointPacket& points, PassTally& tally,
                        float* visibility) {
  for (int lane = 0; lane < kPacketSize; ++lane) visibility[lane] = 1;
  if (!frame.settings.effects.ambient_occlusion || points.live == 0) return;
  alignas(64) uint32_t free_rays[kPacketSize];
  count_free_rays(frame, points, tally, free_rays);
  for (int lane = 0; lane < kPacketSize; ++lane) {
    if (points.live >> lane & 1) visibility[lane] = frame.ao_of_free_rays[free_rays[lane]];
  }
}

}  // namespace vitral
