// Ambient occlusion: the share of a cosine-weighted hemisphere that is free up to a distance
// (Zhukov, Iones and Kronin, "An ambient light illumination model", 1998).
#include "render/frame.h"

namespace vitral {

void count_free_rays(const FrameContext& frame, const PointPacket* const* points, int count, PassTally& tally,
                     FreeRays* out, LaneWork* work) {
  const PassTimer timer(tally, Pass::ao);
  AmbientSettings settings{frame.ao_strata, frame.settings.ao_distance, frame.sample_step};
  settings.first_sample =
      static_cast<uint32_t>(frame.sample) * static_cast<uint32_t>(frame.settings.ao_samples);
  run_ambient(frame, points, count, settings, tally, out, work);
  for (int i = 0; i < count; ++i) {
    tally.rays[static_cast<size_t>(Pass::ao)] +=
        static_cast<uint64_t>(__builtin_popcountll(points[i]->live)) *
        static_cast<uint64_t>(frame.ao_strata * frame.ao_strata);
  }
}

void ambient_visibility(const FrameContext& frame, const PointPacket& points, const FreeRays& free_rays,
                        float* visibility) {
  for (int lane = 0; lane < kPacketSize; ++lane) {
    visibility[lane] = points.live >> lane & 1 ? frame.ao_of_free_rays[free_rays.count[lane]] : 1.0f;
  }
}

}  // namespace vitral
