// What the camera sees: the rasterizer's answer, or the tracer's. Where both see
// the same triangle they give the same hit; at silhouettes the rasterizer's snapped edges decide.
#include "render/frame.h"
#include "vitral/error.h"

#include <algorithm>

namespace vitral {

RasterView setup_raster(const FrameContext& frame, const Rectangle& crop, ThreadPool& pool,
                        const Control& control, RasterFrame& raster) {
  const ForEach for_each = [&](size_t count, const std::function<void(size_t)>& body) {
    pool.parallel_for(count, [&](size_t i, size_t) {
      if (control.stop.load(std::memory_order_relaxed)) throw Interrupted();
      body(i);
    });
  };
  setup_frame(frame.camera, frame.settings.width, frame.settings.height, crop, frame.scene.mesh, for_each,
              raster);
  return make_view(raster, frame.camera, frame.accelerator.triangles.data(),
                   &frame.accelerator.view.cut_outs);
}

void rasterize_tile(const FrameContext& frame, int tile_x, int tile_y, PassTally& tally,
                    TileVisibility& visibility) {
  if (!frame.raster) return;
  const PassTimer timer(tally, Pass::raster);
  frame.kernels.fill_tile(*frame.raster, tile_x / kTileSide, tile_y / kTileSide, visibility);
}

bool is_background(const FrameContext& frame, const TileVisibility& visibility, int block) {
  if (!frame.raster) return false;
  const uint32_t* triangles = visibility.triangle + block * kPacketSize;
  return std::all_of(triangles, triangles + kPacketSize, [](uint32_t t) { return t == kNoTriangle; });
}

void primary_hits(const FrameContext& frame, const TileVisibility& visibility, int block, int x, int y,
                  uint64_t lanes, PassTally& tally, RayPacket& rays, HitPacket& hits, LaneWork* work) {
  const PassTimer timer(tally, Pass::raster);
  frame.kernels.primary_rays(frame.camera, x, y, rays);
  rays.live = lanes;
  if (frame.raster) {
    frame.kernels.intersect_visible(frame.camera, frame.accelerator.triangles.data(), x, y,
                                    visibility.triangle + block * kPacketSize, hits);
  } else {
    count_rays(tally, Pass::raster, lanes);
    run_closest(frame, Pass::raster, rays, tally, hits, work);
  }
}

}  // namespace vitral
