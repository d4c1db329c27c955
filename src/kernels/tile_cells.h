// A tile while it is filled: cells of 4x4 pixels, so that a small triangle meets few of them.
#pragma once
#include "raster/coverage.h"
#include "raster/raster.h"
#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {

inline constexpr int kCellSide = 4;
inline constexpr int kWindowSide = kCellSide * kCellSide;
inline constexpr int kCellPixels = kCellSide * kCellSide;
inline constexpr int kTileCellsAcross = kTileSide / kCellSide;
inline constexpr int kTileCells = kTileCellsAcross * kTileCellsAcross;
inline constexpr int kCellRegisters =
    kCellPixels / kLanes;  // registers for the pixels of a cell, or for the cells of a window

// Place of a pixel in a cell, and of a cell in a window of 4x4 cells.
alignas(64) inline constexpr int32_t kLaneX[16] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
alignas(64) inline constexpr int32_t kLaneY[16] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};

// Cells row by row, and the pixels in each. A pixel without a triangle has the least inverse depth that is
// seen, so that what lies beyond far loses against nothing; one that is not wanted has an infinite one.
struct Tile {
  alignas(64) float inverse_depth[kTileCells * kCellPixels];
  alignas(64) uint32_t triangle[kTileCells * kCellPixels];
  alignas(64) float least[kTileCells];  // no more than any inverse depth of the cell
  float least_of_all;                   // no more than any of `least`
  bool least_of_all_is_old;
  int x, y;         // pixel at its corner
  PixelBox window;  // pixels of the tile that are wanted, relative to the corner
};

static inline void set_place(const RasterView& view, int tile_x, int tile_y, Tile& tile) {
  tile.x = tile_x * kTileSide;
  tile.y = tile_y * kTileSide;
  const PixelBox& w = view.window;
  tile.window = intersection({w.x0 - tile.x, w.y0 - tile.y, w.x1 - tile.x, w.y1 - tile.y},
                             {0, 0, kTileSide, kTileSide});
}

static inline void clear(const RasterView& view, Tile& tile) {
  for (int i = 0; i < kTileCells * kCellPixels; i += kLanes) {
    store(tile.inverse_depth + i, Float(view.least_inverse_depth));
    store(tile.triangle + i, Uint(kNoTriangle));
  }
  for (int cell = 0; cell < kTileCells; ++cell) tile.least[cell] = view.least_inverse_depth;
  tile.least_of_all = view.least_inverse_depth;
  tile.least_of_all_is_old = false;
}

// Nothing is nearer than a pixel that is not wanted.
static inline void mask_unwanted(Tile& tile) {
  const PixelBox& w = tile.window;
  if (w.x0 == 0 && w.y0 == 0 && w.x1 == kTileSide && w.y1 == kTileSide) return;
  for (int i = 0; i < kTileCells * kCellPixels; ++i) {
    const int cell = i / kCellPixels, pixel = i % kCellPixels;
    const int x = cell % kTileCellsAcross * kCellSide + kLaneX[pixel];
    const int y = cell / kTileCellsAcross * kCellSide + kLaneY[pixel];
    if (x >= w.x0 && x < w.x1 && y >= w.y0 && y < w.y1) continue;
    tile.inverse_depth[i] = __builtin_inff();
  }
}

static inline void update_least_of_all(Tile& tile) {
  Float low = load(tile.least);
  for (int cell = kLanes; cell < kTileCells; cell += kLanes) low = least(load(tile.least + cell), low);
  tile.least_of_all = least_lane(low);
  tile.least_of_all_is_old = false;
}

// Calls body(pixel of the cells, pixel of the blocks) for every row of a cell, or for every pixel where a
// register holds just one.
inline constexpr int kRowLanes = kLanes < 4 ? kLanes : 4;
template <class Body>
static inline void for_each_row(int first, const Body& body) {
  for (int i = 0; i < kLanes; i += kRowLanes) {
    const int cell = (first + i) / kCellPixels, pixel = (first + i) % kCellPixels;
    const int x = cell % kTileCellsAcross * kCellSide + pixel % kCellSide;
    const int y = cell / kTileCellsAcross * kCellSide + pixel / kCellSide;
    const int block = y / kBlockSide * kTileBlocksAcross + x / kBlockSide;
    body(i, block * kPacketSize + y % kBlockSide * kBlockSide + x % kBlockSide);
  }
}

// From cells to blocks.
static inline void hand_over(const Tile& tile, TileVisibility& out) {
  for (int g = 0; g < kTileCells * kCellPixels; g += kLanes) {
    const Mask nothing = load(tile.triangle + g) == Uint(kNoTriangle);
    alignas(64) float depth[kLanes];
    store(depth, select(nothing, Float(0.0f), load(tile.inverse_depth + g)));
    for_each_row(g, [&](int i, int to) {
      __builtin_memcpy(out.inverse_depth + to, depth + i, sizeof(float) * kRowLanes);
      __builtin_memcpy(out.triangle + to, tile.triangle + g + i, sizeof(uint32_t) * kRowLanes);
    });
  }
}

// From blocks back to cells, and how far each cell's farthest pixel is.
static inline void take_over(const RasterView& view, const TileVisibility& seen, Tile& tile) {
  for (int g = 0; g < kTileCells * kCellPixels; g += kLanes) {
    for_each_row(g, [&](int i, int from) {
      __builtin_memcpy(tile.inverse_depth + g + i, seen.inverse_depth + from, sizeof(float) * kRowLanes);
      __builtin_memcpy(tile.triangle + g + i, seen.triangle + from, sizeof(uint32_t) * kRowLanes);
    });
    // What is seen is nearer than far, or as near.
    store(tile.inverse_depth + g, greatest(load(tile.inverse_depth + g), Float(view.least_inverse_depth)));
  }
  for (int cell = 0; cell < kTileCells; ++cell) {
    tile.least[cell] = tile.inverse_depth[cell * kCellPixels];
    for (int i = 1; i < kCellPixels; ++i)
      tile.least[cell] = vitral::least(tile.inverse_depth[cell * kCellPixels + i], tile.least[cell]);
  }
  update_least_of_all(tile);
}

}  // namespace VITRAL_ISA
}  // namespace vitral
