// The rasterizer: which triangle does each pixel centre see. Only visibility is decided here; what
// the surface is like at the pixel is computed once per visible pixel afterwards, from the camera
// ray and the triangle, by the same formula as for traced rays (kernels/visible.h).
//
// How to read this folder: this file (what the stages hand to each other), project.h (points to pixels,
// triangles to planes), setup.cpp (which triangle goes which way), clip.cpp, bin.cpp, coverage.h (the
// fill rule), then kernels/setup.cpp, where most triangles are set up and those of a few pixels are
// done with, kernels/fill.cpp, which fills one tile, and drawn.h, for objects. The stages are those of
// Laine and Karras, "High-Performance Software Rasterization on GPUs", HPG 2011.
//
// Screen coordinates: pixel (x, y) has its centre at (x + 0.5, y + 0.5), y down. Vertices are snapped
// to 1/256 pixel; from there on coverage is integer arithmetic and exact. Depth is kept as its
// inverse, 1/w, which is linear on the screen; greater is nearer.
#pragma once
#include "math/pinhole.h"
#include "vitral/ray.h"
#include "vitral/vec.h"

#include <cstddef>
#include <cstdint>

namespace vitral {

struct KdTriangle;  // kdtree/kdtree.h
struct CutOuts;
struct ObjectsView;   // kdtree/objects.h
struct DrawnObjects;  // raster/drawn.h

inline constexpr int kSubpixelBits = 8;
inline constexpr int kSubpixels = 1 << kSubpixelBits;

// Triangles are clipped to this many pixels around the frame's corner (0, 0): far more than the
// largest frame, so that few are. Snapped coordinates stay within 2^24 + 2^8, a
// triangle's sides within 2^25 + 2^9, which fill.cpp relies on for its 32-bit sums.
inline constexpr int kGuardBand = 65536;

inline constexpr int kTileSide = 32;
inline constexpr int kTileBlocksAcross = kTileSide / 8;
inline constexpr int kTileBlocks = kTileBlocksAcross * kTileBlocksAcross;  // of 8x8 pixels, row by row

// Pixels [x0, x1) x [y0, y1).
template <class I>
struct PixelBoxT {
  I x0, y0, x1, y1;
};
using PixelBox = PixelBoxT<int32_t>;

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

// A vertex on the screen, if it lies within the clip volume. The finer place is for the depth of small
// triangles: coverage only knows snapped() ones.
inline constexpr int kFineBits = 14;
struct ScreenVertex {
  int32_t x, y;         // 2^-kFineBits pixel, rounded down
  float inverse_depth;  // 1 / W
  uint32_t outside;     // of which clip planes; when not 0, the other members mean nothing
};

// A triangle ready to be filled: of non-zero area, its corners in the order that makes the inside
// positive for every edge. The plane gives the inverse depth at a point of the screen in pixels; it
// belongs to the true triangle, not the snapped one, and the range is that of its visible corners.
struct alignas(64) SetupTriangle {
  int32_t x[3], y[3];         // 1/256 pixel
  uint32_t triangle;          // its number; parts of a clipped triangle share it
  float least, greatest;      // inverse depth
  uint32_t object;            // in RasterView::placed, where there are any
  double across, down, at_0;  // inverse depth = across * x + down * y + at_0
};
static_assert(sizeof(SetupTriangle) == 64);

// A triangle whose bounding box holds no more than kSmallSide x kSmallSide pixel centres is not set up for
// filling: the pixels it covers are found at once, for a register of triangles at a time.
inline constexpr int kSmallSide = 4;
struct Fragment {
  int32_t x_y;  // pixel: x in the lower half, y in the upper one
  float inverse_depth;
  uint32_t triangle;  // its number
};

// A mesh on the screen, as setup reads it. Its triangles are numbered from first_number on in all that comes
// out of setup; kernels/setup.cpp counts from 0.
struct SetupInput {
  Projection projection;
  const ScreenVertex* vertices;
  const Vec3* positions;
  const uint32_t* corners;     // into both, three per triangle
  const KdTriangle* flags_of;  // of each triangle; null where none is a cut-out
  uint32_t first_number = 0;
  uint32_t object = 0;  // for SetupTriangle::object
};

// Triangles are set up in chunks of this many.
inline constexpr uint32_t kChunkTriangles = 4096;

// What kernels/setup.cpp makes of a chunk. The arrays end in what a register may overwrite.
struct SetupOutput {
  static constexpr uint32_t kMostFragments = kChunkTriangles * kSmallSide * kSmallSide;
  uint32_t other_count, triangle_count, fragment_count;
  uint32_t others[kChunkTriangles + 16];  // numbers: to be clipped, or too large for 32-bit areas
  SetupTriangle triangles[kChunkTriangles];
  int32_t x_y[kMostFragments + 16];  // of the fragments, component by component
  float inverse_depth[kMostFragments + 16];
  uint32_t triangle[kMostFragments + 16];
};

// The kernels that come before any tile (kernels/kernels.h).
using ProjectKernel = void (*)(const Projection& projection, const Vec3* positions, size_t count,
                               ScreenVertex* out);
using SetupKernel = void (*)(const SetupInput& in, uint32_t begin, uint32_t end, SetupOutput& out);
struct FrontEnd {
  ProjectKernel project_vertices;
  SetupKernel setup_triangles;
};

// Bins are squares of 32, 128, 512, 2048 and 8192 pixels: a triangle goes to the bins of the finest
// level of which it touches no more than kMaxBinsTouched, so that the memory is bounded whatever the
// triangles' sizes. A tile reads one bin of each level. All bins are numbered in one sequence.
inline constexpr int kBinLevels = 5;
inline constexpr int kBinLevelShift = 2;  // the side grows by 2^2 from level to level
inline constexpr int kMaxBinsTouched = 16;
struct BinGrid {
  int across[kBinLevels];          // bins in a row
  uint32_t first_bin[kBinLevels];  // number of the level's bin (0, 0)
  uint32_t bins;                   // of all levels
};
// The bin of a level that a tile lies in.
static inline uint32_t bin_of(const BinGrid& grid, int level, int tile_x, int tile_y) {
  const int shift = level * kBinLevelShift;
  return grid.first_bin[level] +
         static_cast<uint32_t>((tile_y >> shift) * grid.across[level] + (tile_x >> shift));
}

// Names a setup triangle: its chunk in the upper bits, its place there in the lower ones.
using SetupReference = uint32_t;
inline constexpr int kPlaceBits = 15;

// Fragments of one tile that follow each other.
struct FragmentRun {
  const Fragment* first;
  uint32_t count;
};

// The binned frame as the fill kernel sees it: pointers only.
struct RasterView {
  const SetupTriangle* const* chunks;
  const SetupReference* references;
  const uint64_t* first_reference;  // of bin b: [first_reference[b], first_reference[b + 1])
  const FragmentRun* runs;
  const uint64_t* first_run;  // of bin b of the finest level, likewise
  BinGrid grid;
  PixelBox window;            // the pixels wanted; the others of a tile come out empty
  float least_inverse_depth;  // 1 / far: what lies beyond is not seen
  const Pinhole* camera;
  const KdTriangle* triangles;  // by triangle number
  const CutOuts* cut_outs;      // null: no triangle is a cut-out
  const ObjectsView* placed;  // whose triangles these are; null: the scene's own, of which the two above tell
  const DrawnObjects* drawn;  // what is filled already, objects and the scene's own triangles; null: nothing
};

// What a tile of 32x32 pixels sees, in blocks of 64 pixels, row by row inside and among blocks.
struct alignas(64) TileVisibility {
  float inverse_depth[kTileBlocks * 64];  // 0: nothing
  uint32_t triangle[kTileBlocks * 64];    // kNoTriangle: nothing
};

// Fills a tile of the view: what its triangles look like alone, or together with what the tile shows already.
using FillKernel = void (*)(const RasterView& view, int tile_x, int tile_y, TileVisibility& tile);

}  // namespace vitral
