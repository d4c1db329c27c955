// What the camera sees: the rasterizer's answer, or the tracer's.
#include "render/frame.h"

namespace vitral {

void trace_primary(const FrameContext& frame, int x, int y, uint64_t lanes, PassTally& tally, RayPacket& rays, HitPacket& hits) {
  const PassTimer timer(tally, Pass::raster);
  count_rays(tally, Pass::raster, lanes);
  frame.kernels.primary_rays(frame.camera, x, y, rays);
  rays.live = lanes;
  frame.kernels.trace_closest(frame.accelerator.view, rays, hits);
}

}  // namespace vitral
