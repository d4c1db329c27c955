// The rasterizer by itself: what a frame's pixels see, written into memory in one of two layouts.
#pragma once
#include "kernels/layout.h"
#include "render/frame.h"
#include "render/measure.h"
#include "render/tile.h"

#include <cstddef>
#include <vector>

namespace vitral {

// The blocks of a tile stand side by side, row by row, and so do the tiles. Blocks without a pixel of the
// crop are never written.
struct GBuffer {
  Rectangle crop;
  Tiles tiles;
  std::vector<FullBlock> full;  // Layout::full
  std::vector<MinBlock> min;    // Layout::min
};

// Throws UsageError when the layout has no room for the number of the scene's materials.
GBuffer make_gbuffer(const FrameContext& frame, Layout layout);

size_t gbuffer_bytes(const Settings& settings, Layout layout);

// Where the block with the frame's pixel (x, y) is, in whichever vector is used.
size_t block_of(const GBuffer& buffer, int x, int y);

// Writes all of it, tile by tile, with all threads. `raster` is kept from frame to frame. Throws Interrupted.
void write_gbuffer(const FrameContext& frame, ThreadPool& pool, const Control& control, RasterFrame& raster,
                   GBuffer& out, RasterTimes& times);

// Pixels of the crop that see a triangle.
uint64_t count_covered(const GBuffer& buffer);

}  // namespace vitral
