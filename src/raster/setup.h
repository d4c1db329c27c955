// Triangle setup: from the mesh to triangles ready to be filled.
#pragma once
#include "math/pinhole.h"
#include "math/scalar.h"
#include "raster/clip.h"
#include "raster/raster.h"
#include "vitral/render.h"
#include "vitral/scene.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace vitral {

// An empty crop means the whole frame.
Projection make_projection(const Pinhole& camera, int width, int height, const Rectangle& crop);

// What one chunk of the mesh's triangles becomes: triangles to be filled, and pixels that are already.
struct BinEntry {
  uint32_t bin;
  uint32_t place;  // in `triangles`
};
struct RunEntry {
  uint32_t bin;           // of the finest level
  uint32_t first, count;  // in `fragments`
};
struct SetupChunk {
  std::vector<SetupTriangle> triangles;
  std::vector<BinEntry> entries;
  std::vector<Fragment> fragments;  // tile by tile
  std::vector<RunEntry> runs;
};

// A triangle can become up to kMaxClippedCorners - 2 parts; the place of each fits kPlaceBits.
static_assert(kChunkTriangles * (kMaxClippedCorners - 2) <= (size_t{1} << kPlaceBits));

// Chunks of a mesh with that many triangles.
static inline size_t chunk_count(size_t triangles) {
  return (triangles + kChunkTriangles - 1) / kChunkTriangles;
}

// Sets up the triangles [begin, end), no more than kChunkTriangles, and appends them. Those that cannot cover
// a pixel centre of the window are left out. A chunk has room for kChunkTriangles in all. What `output` holds
// before and after means nothing.
void setup_range(SetupKernel kernel, const SetupInput& in, const BinGrid& grid, uint32_t begin, uint32_t end,
                 SetupOutput& output, SetupChunk& out);

// Sets up [chunk * kChunkTriangles, ...) of that many triangles, anew.
void setup_chunk(SetupKernel kernel, const SetupInput& in, const BinGrid& grid, size_t triangles,
                 size_t chunk, SetupChunk& out);
void clear(SetupChunk& chunk);

}  // namespace vitral
