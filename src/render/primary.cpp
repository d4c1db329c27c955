// What the camera sees: the rasterizer's answer, or the tracer's. Where both see
// the same triangle they give the same hit; at silhouettes the rasterizer's snapped edges decide.
#include "render/frame.h"
#include "vitral/error.h"

#include <algorithm>

namespace vitral {

RasterView setup_raster(const FrameContext& frame, const Rectangle& crop, ThreadPool& pool,
                        const Control& control, RasterFrame& raster, SetupTimes& times) {
  const ForEach for_each = [&](size_t count, const std::function<void(size_t)>& body) {
    pool.parallel_for(count, [&](size_t i, size_t) {
      if (control.stop.load(std::memory_order_relaxed)) throw Interrupted();
      body(i);
    });
  };
  const Mesh& mesh = frame.scene.mesh;
  const KdTriangle* triangles = frame.accelerator.triangles.data();
  const bool holes = frame.accelerator.has_cut_outs;
  const Clock::time_point start = Clock::now();
  transform_vertices(frame.kernels.front_end.project_vertices, frame.camera, frame.settings.width,
                     frame.settings.height, crop, mesh, for_each, raster);
  const Clock::time_point transformed = Clock::now();
  setup_triangles(frame.kernels.front_end.setup_triangles, mesh, holes ? triangles : nullptr, for_each,
                  raster);
  const Clock::time_point set_up = Clock::now();
  bin_triangles(for_each, raster);
  times = {seconds_between(start, transformed), seconds_between(transformed, set_up),
           seconds_between(set_up, Clock::now())};
  return make_view(raster, frame.camera, triangles, holes ? &frame.accelerator.view.cut_outs : nullptr);
}

void find_primary_hits(const FrameContext& frame, int tile_x, int tile_y, const uint64_t* lanes,
                       PassTally& tally, TileHits& out) {
  const PassTimer timer(tally, Pass::raster);
  if (frame.raster) {
    frame.kernels.fill_tile(*frame.raster, tile_x / kTileSide, tile_y / kTileSide, out.visibility);
    return;
  }
  for (size_t i = 0; i < kTileBlocks; ++i) {
    const int block = kBlocksInOrder[i];
    const int x = tile_x + block % kTileBlocksAcross * kBlockSide,
              y = tile_y + block / kTileBlocksAcross * kBlockSide;
    if (frame.lens.radius > 0) {
      frame.kernels.lens_rays(frame.camera, frame.lens, x, y, out.rays[i]);
    } else {
      frame.kernels.primary_rays(frame.camera, x, y, out.rays[i]);
    }
    out.rays[i].live = lanes[i];
    count_rays(tally, Pass::raster, lanes[i]);
  }
  run_closest_blocks(frame, Pass::raster, out.rays.data(), kTileBlocks, tally, out.hits.data(),
                     out.work.data());
}

namespace {

bool is_background(const uint32_t* triangles) {
  return std::all_of(triangles, triangles + kPacketSize, [](uint32_t t) { return t == kNoTriangle; });
}

}  // namespace

bool see_surfaces(const FrameContext& frame, const TileHits& tile, size_t i, int x, int y,
                  SurfacePacket& out) {
  out.points.live = 0;
  if (frame.raster) {
    const uint32_t* triangles = tile.visibility.triangle + kBlocksInOrder[i] * kPacketSize;
    if (!is_background(triangles)) make_visible_surfaces(frame, x, y, triangles, out);
  } else if (tile.rays[i].live != 0) {
    make_surfaces(frame, tile.rays[i], tile.hits[i], out);
  }
  return out.points.live != 0;
}

}  // namespace vitral
