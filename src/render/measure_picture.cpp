#include "render/measure_picture.h"

#include "render/gbuffer.h"
#include "render/tile.h"
#include "vitral/error.h"

#include <chrono>

namespace vitral {
namespace {

// A warm-up goes on for so long: until the system has spread the threads over the processors.
constexpr double kWarmMs = 30;

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

size_t measurement_bytes(const Settings& settings, Layout layout) {
  const Tiles tiles = tiles_of(crop_of(settings));
  return static_cast<size_t>(tiles.across) * static_cast<size_t>(tiles.down) * kTileBlocks * sizeof(Block) +
         gbuffer_bytes(settings, layout);
}

Picture lay_out(const FrameContext& frame, ThreadPool& pool, const Control& control, const Runs& runs) {
  const Rectangle crop = crop_of(frame.settings);
  const Tiles tiles = tiles_of(crop);
  Picture p{frame, crop, pool, control, runs, {}, std::vector<Scratch>(pool.workers())};
  p.blocks.resize(static_cast<size_t>(tiles.across) * static_cast<size_t>(tiles.down) * kTileBlocks);
  for (size_t i = 0; i < p.blocks.size(); ++i) {
    const int tile = static_cast<int>(i / kTileBlocks), inside = static_cast<int>(i % kTileBlocks);
    Block& b = p.blocks[i];
    b.x = (tiles.x + tile % tiles.across) * kTileSide + inside % kTileBlocksAcross * kBlockSide;
    b.y = (tiles.y + tile / tiles.across) * kTileSide + inside / kTileBlocksAcross * kBlockSide;
    b.lanes = lanes_inside(p.crop, b.x, b.y);
  }
  return p;
}

void for_each_tile(Picture& p, const TileBody& body) {
  p.pool.parallel_for(p.blocks.size() / kTileBlocks, [&](size_t tile, size_t worker) {
    if (p.control.stop.load(std::memory_order_relaxed)) throw Interrupted();
    body(&p.blocks[tile * kTileBlocks], p.scratch[worker]);
  });
}

std::vector<double> time_runs(const Runs& runs, const char* name, const std::function<void()>& run) {
  std::vector<double> ms;
  double spent = 0;
  for (int i = 0; i <= runs.repeat; ++i) {
    if (runs.on_progress) runs.on_progress({name, static_cast<double>(i) / (runs.repeat + 1), 0});
    double took = 0;
    do {
      const auto start = std::chrono::steady_clock::now();
      run();
      took = milliseconds_since(start);
      spent += took;
    } while (i == 0 && spent < kWarmMs);
    const bool enough = spent >= runs.enough_seconds * 1e3;
    if (i > 0 || enough) ms.push_back(took);
    if (enough) break;
  }
  return ms;
}

PassTimes time_pass(Picture& p, const char* name, Counts& counts, const std::function<void()>& run) {
  PassTimes pass{name, {}, 0, 0, {}};
  pass.ms = time_runs(p.runs, name, [&] {
    for (Scratch& s : p.scratch) s.counts = {}, s.tally = {};
    run();
  });
  counts = {};
  for (const Scratch& s : p.scratch) {
    counts.rays += s.counts.rays;
    counts.hits += s.counts.hits;
    counts.blocked += s.counts.blocked;
    counts.free += s.counts.free;
    for (const uint64_t rays : s.tally.rays) counts.rays += rays;
  }
  pass.rays = counts.rays;
  return pass;
}

}  // namespace vitral
