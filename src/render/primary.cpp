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
  const Kernels& kernels = frame.kernels;
  const Accelerator& accelerator = frame.accelerator;
  const KdTriangle* triangles = accelerator.triangles.data();
  const bool holes = accelerator.has_cut_outs;
  const Clock::time_point start = Clock::now();
  transform_vertices(kernels.front_end.project_vertices, frame.camera, frame.settings.width,
                     frame.settings.height, crop, mesh, for_each, raster);
  const Clock::time_point transformed = Clock::now();
  setup_triangles(kernels.front_end.setup_triangles, mesh, holes ? triangles : nullptr, for_each, raster);
  const Clock::time_point set_up = Clock::now();
  bin_triangles(for_each, raster);
  times = {seconds_between(start, transformed), seconds_between(transformed, set_up),
           seconds_between(set_up, Clock::now()), 0};
  RasterView view = make_view(raster, frame.camera, triangles, holes ? &accelerator.view.cut_outs : nullptr);
  if (accelerator.placed.view.count == 0) return view;
  const DrawStats drawing =
      draw_objects({kernels.front_end, kernels.fill_tile, kernels.fill_over}, view, raster.projection,
                   accelerator.placed.view, accelerator.drawn_models, {}, for_each, raster.objects);
  times.setup += drawing.setup, times.bin += drawing.bin, times.fill += drawing.fill;
  view.drawn = &raster.objects;
  return view;
}

namespace {

float farthest_of(const HitPacket& hits, uint64_t lanes) {
  float farthest = 0;
  for (; lanes != 0; lanes &= lanes - 1) farthest = greatest(farthest, hits.t[__builtin_ctzll(lanes)]);
  return farthest;
}

// The exact shapes of the tile that can be seen in the block at (x, y), the nearest first, against what the
// rays meet there.
void meet_shapes(const FrameContext& frame, const DrawnObjects& drawn, size_t tile, int x, int y,
                 const RayPacket& rays, HitPacket& hits) {
  const BinLists<uint32_t>& lists = drawn.shapes_of_tile;
  float farthest = farthest_of(hits, rays.live);
  for (uint64_t k = lists.first[tile]; k < lists.first[tile + 1]; ++k) {
    const ObjectOnScreen& shape = drawn.shapes[lists.items[k]];
    // All that follow are as far, or farther. The margin is more than t of a hit is rounded by.
    if (shape.bound.nearest * farthest < 1 - 1.0f / (1 << 18)) break;
    if (!touches_block(shape, x, y)) continue;
    frame.kernels.closest_shape(frame.accelerator.placed.view, shape.object, rays, hits);
    farthest = farthest_of(hits, rays.live);
  }
}

// The rays and hits of a block: where its pixels meet the triangles that the rasterizer found, and the shapes
// that are nearer. False where it sees no objects.
bool see_objects(const FrameContext& frame, const DrawnObjects& drawn, size_t tile, const uint32_t* numbers,
                 int x, int y, uint64_t lanes, RayPacket& rays, HitPacket& hits) {
  const ObjectsView& objects = frame.accelerator.placed.view;
  const bool on_meshes = std::any_of(numbers, numbers + kPacketSize,
                                     [&](uint32_t number) { return is_object(objects, number); });
  const uint64_t first = drawn.shapes_of_tile.first[tile], end = drawn.shapes_of_tile.first[tile + 1];
  const uint32_t* shapes = drawn.shapes_of_tile.items.data();
  const bool near_shapes = std::any_of(shapes + first, shapes + end,
                                       [&](uint32_t s) { return touches_block(drawn.shapes[s], x, y); });
  if (!on_meshes && !near_shapes) return false;

  alignas(64) uint32_t own[kPacketSize];
  for (int i = 0; i < kPacketSize; ++i) own[i] = is_object(objects, numbers[i]) ? kNoTriangle : numbers[i];
  frame.kernels.intersect_visible(frame.camera, frame.accelerator.triangles.data(), x, y, own, hits);
  if (on_meshes) frame.kernels.intersect_placed(objects, frame.camera, x, y, numbers, hits);
  frame.kernels.primary_rays(frame.camera, x, y, rays);
  rays.live = lanes;
  if (near_shapes) meet_shapes(frame, drawn, tile, x, y, rays, hits);
  return std::any_of(hits.triangle, hits.triangle + kPacketSize,
                     [&](uint32_t number) { return is_object(objects, number); });
}

int block_x(int tile_x, size_t i) {
  return tile_x + kBlocksInOrder[i] % kTileBlocksAcross * kBlockSide;
}
int block_y(int tile_y, size_t i) {
  return tile_y + kBlocksInOrder[i] / kTileBlocksAcross * kBlockSide;
}

}  // namespace

void find_primary_hits(const FrameContext& frame, int tile_x, int tile_y, const uint64_t* lanes,
                       PassTally& tally, TileHits& out) {
  const PassTimer timer(tally, Pass::raster);
  out.has_hits = 0;
  if (frame.raster && !frame.raster->drawn) {
    frame.kernels.fill_tile(*frame.raster, tile_x / kTileSide, tile_y / kTileSide, out.visibility);
    return;
  }
  if (frame.raster) {
    const DrawnObjects& drawn = *frame.raster->drawn;
    const size_t tile = tile_of(drawn, tile_x / kTileSide, tile_y / kTileSide);
    out.visibility = drawn.tiles[tile];
    for (size_t i = 0; i < kTileBlocks; ++i) {
      const uint32_t* numbers = out.visibility.triangle + kBlocksInOrder[i] * kPacketSize;
      if (see_objects(frame, drawn, tile, numbers, block_x(tile_x, i), block_y(tile_y, i), lanes[i],
                      out.rays[i], out.hits[i]))
        out.has_hits |= 1u << i;
    }
    return;
  }
  for (size_t i = 0; i < kTileBlocks; ++i) {
    const int x = block_x(tile_x, i), y = block_y(tile_y, i);
    if (frame.lens.radius > 0) {
      frame.kernels.lens_rays(frame.camera, frame.lens, x, y, out.rays[i]);
    } else {
      frame.kernels.primary_rays(frame.camera, x, y, out.rays[i]);
    }
    out.rays[i].live = lanes[i];
    if (lanes[i] != 0) out.has_hits |= 1u << i;
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
  if (tile.has_hits >> i & 1) {
    make_surfaces(frame, tile.rays[i], tile.hits[i], out);
  } else if (frame.raster) {
    const uint32_t* triangles = tile.visibility.triangle + kBlocksInOrder[i] * kPacketSize;
    if (!is_background(triangles)) make_visible_surfaces(frame, x, y, triangles, out);
  }
  return out.points.live != 0;
}

}  // namespace vitral
