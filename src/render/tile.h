// One tile through all passes.
#pragma once
#include "render/aov.h"
#include "render/frame.h"

#include <vector>

namespace vitral {

// The pixels that a frame consists of: the crop, or all.
Rectangle crop_of(const Settings& settings);

// The tiles that a crop touches, anchored at the frame's corner, so that its pixels see the same neighbours
// as in the whole frame.
struct Tiles {
  int x, y, across, down;  // the first one's column and row, and how many there are
};
Tiles tiles_of(const Rectangle& crop);

// The lanes of the block at (x, y) that lie in the crop.
uint64_t lanes_inside(const Rectangle& crop, int x, int y);

// A worker's own memory, kept from tile to tile.
struct Worker {
  PassTally tally;
  TileHits seen;
  PathScratch paths;
  std::vector<SurfacePacket> surfaces;              // of the tile's blocks
  std::vector<Vec3> color, reflection, refraction;  // of the tile
  std::vector<float> cost;                          // of the tile
  uint64_t covered = 0, not_finite = 0;
};

// Where the frame goes.
struct FrameTargets {
  Frame& frame;
  AovTargets aovs;
  Image<Vec3d> sums;  // of the samples so far; empty with one sample
};

// Carries one tile through all passes while it is in cache. (tile_x, tile_y) is its corner's pixel in
// the frame; only pixels of the crop are rendered, into the pictures of `out`, where the samples of a pixel
// add up.
void render_tile(const FrameContext& frame, const Rectangle& crop, int tile_x, int tile_y, Worker& worker,
                 FrameTargets& out);

}  // namespace vitral
