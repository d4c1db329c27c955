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

// From the world to homogeneous pixel coordinates: (X, Y, W) with X / W and Y / W in pixels and W the
// depth. The rows are the inverse of primary_direction(), so that a point on the ray of a pixel's
// centre is found at that centre.
struct Projection {
  Vec3d origin;
  Vec3d row_x, row_y, row_w;
  double near;                // > 0
  float least_inverse_depth;  // 1 / far
  PixelBox window;            // the crop within the frame
};

// An empty crop means the whole frame.
Projection make_projection(const Pinhole& camera, int width, int height, const Rectangle& crop);

// A vertex on the screen, if it lies within the clip volume.
struct ScreenVertex {
  int32_t x, y;         // 1/256 pixel
  float inverse_depth;  // 1 / W
  uint32_t outside;     // of which clip planes; when not 0, the other members mean nothing
};

// Positions that are not finite come out as outside of every plane.
void project_vertices(const Projection& projection, const Vec3* positions, size_t count, ScreenVertex* out);

// What one chunk of the mesh's triangles becomes. Entries are in the order of the triangles.
struct BinEntry {
  uint32_t bin;
  uint32_t place;  // in `triangles`
};
struct SetupChunk {
  std::vector<SetupTriangle> triangles;
  std::vector<BinEntry> entries;
};

// A triangle can become up to kMaxClippedCorners - 2 parts; the place of each fits kPlaceBits.
inline constexpr size_t kChunkTriangles = 4096;
static_assert(kChunkTriangles * (kMaxClippedCorners - 2) <= (size_t{1} << kPlaceBits));

// Chunks of a mesh with that many triangles.
static inline size_t chunk_count(size_t triangles) {
  return (triangles + kChunkTriangles - 1) / kChunkTriangles;
}

// Sets up the triangles [chunk * kChunkTriangles, ...) of the mesh. Those that cannot cover a pixel
// centre of the window are left out.
void setup_chunk(const Projection& projection, const BinGrid& grid, const Mesh& mesh,
                 const ScreenVertex* vertices, size_t chunk, SetupChunk& out);

}  // namespace vitral
