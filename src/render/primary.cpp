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
  const KdTriangle* triangles = frame.accelerator.triangles.data();
  const bool holes = frame.accelerator.has_cut_outs;
  setup_frame(frame.kernels.front_end, frame.camera, frame.settings.width, frame.settings.height, crop,
              frame.scene.mesh, holes ? triangles : nullptr, for_each, raster);
  return make_view(raster, frame.camera, triangles, holes ? &frame.accelerator.view.cut_outs : nullptr);
}

namespace {

bool is_background(const TileVisibility& visibility, int block) {
  const uint32_t* triangles = visibility.triangle + block * kPacketSize;
  return std::all_of(triangles, triangles + kPacketSize, [](uint32_t t) { return t == kNoTriangle; });
}

}  // namespace

void find_primary_hits(const FrameContext& frame, int tile_x, int tile_y, const uint64_t* lanes,
                       PassTally& tally, TileHits& out) {
  const PassTimer timer(tally, Pass::raster);
  if (frame.raster)
    frame.kernels.fill_tile(*frame.raster, tile_x / kTileSide, tile_y / kTileSide, out.visibility);
  for (size_t i = 0; i < kTileBlocks; ++i) {
    const int block = kBlocksInOrder[i];
    const int x = tile_x + block % kTileBlocksAcross * kBlockSide,
              y = tile_y + block / kTileBlocksAcross * kBlockSide;
    out.rays[i].live = 0;
    if (lanes[i] == 0 || (frame.raster && is_background(out.visibility, block))) continue;
    frame.kernels.primary_rays(frame.camera, x, y, out.rays[i]);
    out.rays[i].live = lanes[i];
    if (!frame.raster) continue;
    frame.kernels.intersect_visible(frame.camera, frame.accelerator.triangles.data(), x, y,
                                    out.visibility.triangle + block * kPacketSize, out.hits[i]);
  }
  if (frame.raster) return;
  for (const RayPacket& rays : out.rays) count_rays(tally, Pass::raster, rays.live);
  run_closest_blocks(frame, Pass::raster, out.rays.data(), kTileBlocks, tally, out.hits.data(),
                     out.work.data());
}

}  // namespace vitral
