// The rasterizer: which triangle does each pixel centre see. Only visibility is decided here; what
// the surface is like at the pixel is computed once per visible pixel afterwards, from the camera
// ray and the triangle, by the same formula as for traced rays.
//
// Stages (Laine and Karras, "High-Performance Software Rasterization on GPUs", HPG 2011): triangle
// setup and binning over the whole frame (setup.h, bin.h), then fill, tile by tile (kernels/fill.cpp).
#pragma once
#include "math/pinhole.h"
#include "vitral/render.h"
#include "vitral/scene.h"

#include <cstdint>

namespace vitral {

inline constexpr int kTileSide = 32;
inline constexpr int kTileBlocks = (kTileSide / 8) * (kTileSide / 8);  // of 8x8 pixels, row by row

// What a tile of 32x32 pixels sees, in blocks of 64 pixels, row by row inside and among blocks.
struct alignas(64) TileVisibility {
  float inverse_depth[kTileBlocks * 64];  // 0: nothing
  uint32_t triangle[kTileBlocks * 64];    // kNoTriangle: nothing
};

}  // namespace vitral
