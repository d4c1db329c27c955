#include "render/gbuffer.h"

#include "vitral/error.h"

#include <memory>

namespace vitral {
namespace {

// What a worker keeps to itself; in cache lines of its own.
struct alignas(64) RasterWorker {
  TileVisibility seen;
  std::unique_ptr<TileHits> hits;  // only with objects
  PassTally tally;
  double fill = 0, attributes = 0;  // seconds
};

size_t blocks_of(const Tiles& tiles) {
  return static_cast<size_t>(tiles.across) * static_cast<size_t>(tiles.down) * kTileBlocks;
}

int tile_x(const GBuffer& buffer, size_t tile) {
  return (buffer.tiles.x + static_cast<int>(tile) % buffer.tiles.across) * kTileSide;
}
int tile_y(const GBuffer& buffer, size_t tile) {
  return (buffer.tiles.y + static_cast<int>(tile) / buffer.tiles.across) * kTileSide;
}

// The blocks of a tile that have pixels of the crop, a bit each.
uint32_t blocks_inside(const GBuffer& buffer, size_t tile) {
  uint32_t inside = 0;
  for (int block = 0; block < kTileBlocks; ++block) {
    const int x = tile_x(buffer, tile) + block % kTileBlocksAcross * kBlockSide;
    const int y = tile_y(buffer, tile) + block / kTileBlocksAcross * kBlockSide;
    if (lanes_inside(buffer.crop, x, y) != 0) inside |= 1u << block;
  }
  return inside;
}

// Writes the blocks of a tile that see objects, a bit each, and returns them.
uint32_t write_objects(const FrameContext& frame, size_t tile, RasterWorker& worker, GBuffer& out) {
  const int x = tile_x(out, tile), y = tile_y(out, tile);
  uint64_t lanes[kTileBlocks];
  for (size_t i = 0; i < kTileBlocks; ++i) {
    const int block = kBlocksInOrder[i];
    lanes[i] = lanes_inside(out.crop, x + block % kTileBlocksAcross * kBlockSide,
                            y + block / kTileBlocksAcross * kBlockSide);
  }
  if (!worker.hits) worker.hits = std::make_unique<TileHits>();
  TileHits& hits = *worker.hits;
  find_primary_hits(frame, x, y, lanes, worker.tally, hits);
  worker.seen = hits.visibility;
  uint32_t written = 0;
  for (size_t i = 0; i < kTileBlocks; ++i) {
    if (!(hits.has_hits >> i & 1)) continue;
    const int block = kBlocksInOrder[i];
    SurfacePacket surfaces;
    see_surfaces(frame, hits, i, x + block % kTileBlocksAcross * kBlockSide,
                 y + block / kTileBlocksAcross * kBlockSide, surfaces);
    const size_t place = tile * kTileBlocks + static_cast<size_t>(block);
    if (out.full.empty()) {
      frame.kernels.pack_min(surfaces, out.min[place]);
    } else {
      frame.kernels.pack_full(surfaces, frame.accelerator.colors.data(), out.full[place]);
    }
    written |= 1u << block;
  }
  return written;
}

void write_tile(const FrameContext& frame, size_t tile, RasterWorker& worker, GBuffer& out) {
  const int x = tile_x(out, tile), y = tile_y(out, tile);
  const Clock::time_point start = Clock::now();
  if (!frame.raster->drawn) frame.kernels.fill_tile(*frame.raster, x / kTileSide, y / kTileSide, worker.seen);
  const Clock::time_point filled = Clock::now();
  const SurfaceView& scene = frame.accelerator.surfaces;
  uint32_t wanted = blocks_inside(out, tile);
  if (frame.raster->drawn) wanted &= ~write_objects(frame, tile, worker, out);
  const size_t first = tile * kTileBlocks;
  if (out.full.empty()) {
    frame.kernels.write_min(scene, frame.camera, x, y, worker.seen, wanted, &out.min[first]);
  } else {
    frame.kernels.write_full(scene, frame.camera, x, y, worker.seen, wanted, &out.full[first]);
  }
  worker.fill += seconds_between(start, filled);
  worker.attributes += seconds_between(filled, Clock::now());
}

}  // namespace

GBuffer make_gbuffer(const FrameContext& frame, Layout layout) {
  if (layout == Layout::min && frame.scene.materials.size() > kMaxMinMaterials) {
    throw UsageError("the layout min has room for " + std::to_string(kMaxMinMaterials) +
                     " materials, there are " + std::to_string(frame.scene.materials.size()));
  }
  const Rectangle crop = crop_of(frame.settings);
  GBuffer out{crop, tiles_of(crop), {}, {}};
  if (layout == Layout::full) out.full.resize(blocks_of(out.tiles));
  if (layout == Layout::min) out.min.resize(blocks_of(out.tiles));
  return out;
}

size_t gbuffer_bytes(const Settings& settings, Layout layout) {
  return blocks_of(tiles_of(crop_of(settings))) *
         (layout == Layout::full ? sizeof(FullBlock) : sizeof(MinBlock));
}

size_t block_of(const GBuffer& buffer, int x, int y) {
  const int column = x / kTileSide - buffer.tiles.x, row = y / kTileSide - buffer.tiles.y;
  const int block = y % kTileSide / kBlockSide * kTileBlocksAcross + x % kTileSide / kBlockSide;
  return static_cast<size_t>(row * buffer.tiles.across + column) * kTileBlocks + static_cast<size_t>(block);
}

void write_gbuffer(const FrameContext& frame, ThreadPool& pool, const Control& control, RasterFrame& raster,
                   GBuffer& out, RasterTimes& times) {
  SetupTimes setup;
  const RasterView view = setup_raster(frame, out.crop, pool, control, raster, setup);
  FrameContext viewed = frame;
  viewed.raster = &view;
  std::vector<RasterWorker> workers(pool.workers());
  pool.parallel_for(blocks_of(out.tiles) / kTileBlocks, [&](size_t tile, size_t worker) {
    if (control.stop.load(std::memory_order_relaxed)) throw Interrupted();
    write_tile(viewed, tile, workers[worker], out);
  });
  times = {setup.transform * 1e3, setup.setup * 1e3, setup.bin * 1e3, setup.fill * 1e3, 0};
  for (const RasterWorker& w : workers) {
    times.fill += w.fill * 1e3 / static_cast<double>(workers.size());
    times.attributes += w.attributes * 1e3 / static_cast<double>(workers.size());
  }
}

uint64_t count_covered(const GBuffer& buffer) {
  uint64_t covered = 0;
  for (size_t place = 0; place < blocks_of(buffer.tiles); ++place) {
    if (!(blocks_inside(buffer, place / kTileBlocks) >> place % kTileBlocks & 1)) continue;
    const float* depth = buffer.full.empty() ? buffer.min[place].depth : buffer.full[place].depth;
    for (int i = 0; i < kPacketSize; ++i) covered += depth[i] > 0;
  }
  return covered;
}

}  // namespace vitral
