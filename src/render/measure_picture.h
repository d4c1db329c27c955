// The whole picture's blocks, kept from pass to pass, and the clock that passes run against.
#pragma once
#include "render/frame.h"
#include "render/measure.h"

#include <array>
#include <functional>
#include <vector>

namespace vitral {

// What the camera sees in one block.
struct Block {
  int x = 0, y = 0;
  uint64_t lanes = 0;  // pixels in the picture
  SurfacePacket surfaces;
};

struct Counts {
  uint64_t rays = 0, hits = 0, blocked = 0, free = 0;
};

// A worker's own memory.
struct Scratch {
  Counts counts;
  PassTally tally;
  TileHits tile_hits;
  PathScratch paths;
  std::vector<Vec3> color;
  std::array<Block, kTileBlocks> tile;
  std::vector<SurfacePacket> seen;  // in mirrors
};

// The blocks of a tile stand side by side, tiles row by row.
struct Picture {
  const FrameContext& frame;
  Rectangle crop;  // the pixels that take part
  ThreadPool& pool;
  const Control& control;
  const Runs& runs;
  std::vector<Block> blocks;
  std::vector<Scratch> scratch;  // one a worker
};

// Every block has its place, whatever it sees.
Picture lay_out(const FrameContext& frame, ThreadPool& pool, const Control& control, const Runs& runs);

// Runs body(first block, scratch) for all tiles, on all threads. Throws Interrupted.
using TileBody = std::function<void(Block*, Scratch&)>;
void for_each_tile(Picture& picture, const TileBody& body);

// Milliseconds of each run by the clock, after one to warm up (measure.h, Runs).
std::vector<double> time_runs(const Runs& runs, const char* name, const std::function<void()>& run);

// Times `run`, and sums what the workers counted in the last one.
PassTimes time_pass(Picture& picture, const char* name, Counts& counts, const std::function<void()>& run);

}  // namespace vitral
