// Fills one tile: for every pixel the nearest triangle that covers its centre.
//
// A triangle meets the tile in blocks of 8x8 pixels. The edge functions at a block's corners tell
// whether it lies outside an edge (nothing to do), inside (the edge is done with) or across it; only
// then pixels are asked, a register of them at a time, in exact 32-bit integers. The inverse depth
// is evaluated at each pixel's centre from the plane as seen from the block's corner, and the greater
// wins; of equal ones the lower triangle number wins. So neither the order of the triangles nor the
// shape of the tiles can be seen in the result.
//
// A block that is covered whole remembers its least inverse depth: what lies behind that is skipped
// (Greene, Kass and Miller, "Hierarchical Z-Buffer Visibility", SIGGRAPH 1993).
#include "kdtree/kdtree.h"
#include "kernels/tables.h"
#include "kernels/visible.h"
#include "raster/coverage.h"
#include "raster/raster.h"
#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

// Pixel of a lane within the group that starts a row.
alignas(64) constexpr int32_t kLaneX[16] = {0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7};
alignas(64) constexpr int32_t kLaneY[16] = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1};

struct Tile {
  TileVisibility* seen;
  int x, y;                       // pixel at its corner
  PixelBox window;                // pixels of the tile that are wanted, relative to the corner
  uint64_t covered[kTileBlocks];  // pixels with a triangle, or not wanted
  float least[kTileBlocks];       // of the inverse depths, once all pixels are covered; 0 before
  float least_of_all;
};

// A triangle's edges seen from a pixel; `lanes` holds their growth over the lanes of a register.
struct Edges {
  Edge edge[3];
  Int lanes[3];
};

// The inverse depth at the centres of a block: at_corner + across * x + down * y, within the range
// of the triangle. Every pixel's sum is rounded in the same order, so that it is the same number
// whatever the registers' width, and monotone in x and y.
struct DepthPlane {
  float across, down, at_corner, least, greatest;
};

inline float within(const DepthPlane& p, float depth) {
  const float raised = depth > p.least ? depth : p.least;
  return raised < p.greatest ? raised : p.greatest;
}

inline DepthPlane depth_plane(const SetupTriangle& t, int x, int y) {
  const double at_corner = (t.at_0 + t.across * (x + 0.5)) + t.down * (y + 0.5);
  return {vitral::narrow(t.across), vitral::narrow(t.down), vitral::narrow(at_corner), t.least, t.greatest};
}

inline float greatest_in_block(const DepthPlane& p) {
  const float x = p.across > 0 ? 7.0f : 0.0f, y = p.down > 0 ? 7.0f : 0.0f;
  return within(p, (p.at_corner + p.across * x) + p.down * y);
}

// Least and greatest growth of an edge function within a square of pixels.
inline int64_t least_growth(const Edge& e, int side) {
  return static_cast<int64_t>(e.across < 0 ? e.across : 0) * (side - 1) +
         static_cast<int64_t>(e.down < 0 ? e.down : 0) * (side - 1);
}
inline int64_t greatest_growth(const Edge& e, int side) {
  return static_cast<int64_t>(e.across > 0 ? e.across : 0) * (side - 1) +
         static_cast<int64_t>(e.down > 0 ? e.down : 0) * (side - 1);
}

// The edges that cross a block, as 32-bit values at its corner. Such a value cannot exceed the growth
// within the block, 7 * (|across| + |down|) < 2^29, so all sums stay below 2^30.
struct Crossing {
  int32_t value[3], across[3], down[3];
  Int lanes[3];
  int count;
};

// False when the block is outside.
inline bool find_crossing(const Edges& edges, int x, int y, Crossing& crossing) {
  crossing.count = 0;
  for (int k = 0; k < 3; ++k) {
    const Edge& e = edges.edge[k];
    const int64_t value = e.value + static_cast<int64_t>(e.across) * x + static_cast<int64_t>(e.down) * y;
    if (value + greatest_growth(e, kBlockSide) < 0) return false;
    if (value + least_growth(e, kBlockSide) >= 0) continue;
    const int n = crossing.count++;
    crossing.value[n] = static_cast<int32_t>(value);
    crossing.across[n] = e.across;
    crossing.down[n] = e.down;
    crossing.lanes[n] = edges.lanes[k];
  }
  return true;
}

// Clears the pixels where a cut-out triangle is not there; the group's first pixel is (x, y).
uint32_t keep_there(const RasterView& view, const CutOuts& cut_outs, uint32_t number, int x, int y,
                    uint32_t pixels) {
  for (int lane = 0; lane < kLanes; ++lane) {
    if (!(pixels >> lane & 1u)) continue;
    const auto point =
        visible_point(*view.camera, view.triangles[number], x + kLaneX[lane], y + kLaneY[lane]);
    if (!cut_outs.is_there(cut_outs.scene, number, point.u, point.v)) pixels &= ~(1u << lane);
  }
  return pixels;
}

// Recomputes the least inverse depth of a covered block.
void update_least(Tile& tile, int block) {
  const float* depth = tile.seen->inverse_depth + block * kPacketSize;
  Float low = load(depth);
  for (int g = kLanes; g < kPacketSize; g += kLanes) low = least(load(depth + g), low);
  alignas(64) float lanes[kLanes];
  store(lanes, low);
  float lowest = lanes[0];
  for (int i = 1; i < kLanes; ++i) lowest = lanes[i] < lowest ? lanes[i] : lowest;
  tile.least[block] = lowest;

  tile.least_of_all = tile.least[0];
  for (int i = 1; i < kTileBlocks; ++i) {
    if (tile.least[i] < tile.least_of_all) tile.least_of_all = tile.least[i];
  }
}

// Fills rows [y0, y1) of a block whose corner is the pixel (x, y) of the frame. `cut_outs` is null for
// a triangle without holes.
void fill_block(const RasterView& view, uint32_t number, const CutOuts* cut_outs, const Crossing& crossing,
                const DepthPlane& plane, int x, int y, int y0, int y1, Tile& tile, int block) {
  float* depths = tile.seen->inverse_depth + block * kPacketSize;
  uint32_t* numbers = tile.seen->triangle + block * kPacketSize;
  uint64_t written = 0;
  bool least_lost = false;
  for (int g = y0 * kBlockSide / kLanes * kLanes; g < y1 * kBlockSide; g += kLanes) {
    const int gx = g % kBlockSide, gy = g / kBlockSide;
    const Float fx = to_float(load(kLaneX) + Int(gx)), fy = to_float(load(kLaneY) + Int(gy));
    Float depth = (Float(plane.at_corner) + Float(plane.across) * fx) + Float(plane.down) * fy;
    depth = greatest(depth, Float(plane.least));
    depth = least(depth, Float(plane.greatest));

    const Float old_depth = load(depths + g);
    const Uint old_number = load(numbers + g);
    Mask wins = either(depth > old_depth, both(depth == old_depth, Uint(number) < old_number));
    wins = both(wins, depth >= Float(view.least_inverse_depth));
    for (int k = 0; k < crossing.count; ++k) {
      const int32_t value = crossing.value[k] + gx * crossing.across[k] + gy * crossing.down[k];
      wins = both(wins, Int(value) + crossing.lanes[k] >= Int(0));
    }
    uint32_t won = bits(wins);
    if (won != 0 && cut_outs != nullptr) {
      won = keep_there(view, *cut_outs, number, x + gx, y + gy, won);
      wins = mask_of_bits(won);
    }
    if (won == 0) continue;
    least_lost |= any(both(wins, old_depth <= Float(tile.least[block])));
    store(depths + g, select(wins, depth, old_depth));
    store(numbers + g, select(wins, Uint(number), old_number));
    written |= static_cast<uint64_t>(won) << g;
  }
  tile.covered[block] |= written;
  if (least_lost && tile.covered[block] == ~uint64_t{0}) update_least(tile, block);
}

void fill_triangle(const RasterView& view, const SetupTriangle& t, Tile& tile) {
  PixelBox box = centers_within(t.x, t.y);
  box = intersection({box.x0 - tile.x, box.y0 - tile.y, box.x1 - tile.x, box.y1 - tile.y}, tile.window);
  if (vitral::is_empty(box)) return;

  Edges edges;
  for (int k = 0; k < 3; ++k) {
    const int next = k == 2 ? 0 : k + 1;
    Edge& e = edges.edge[k];
    e = make_edge(t.x[k], t.y[k], t.x[next], t.y[next], tile.x, tile.y);
    if (e.value + greatest_growth(e, kTileSide) < 0) return;
    edges.lanes[k] = load(kLaneX) * Int(e.across) + load(kLaneY) * Int(e.down);
  }
  const bool is_cut_out =
      view.cut_outs != nullptr && (view.triangles[t.triangle].flags & kCutOutTriangle) != 0;
  const CutOuts* const cut_outs = is_cut_out ? view.cut_outs : nullptr;

  for (int by = box.y0 & -kBlockSide; by < box.y1; by += kBlockSide) {
    for (int bx = box.x0 & -kBlockSide; bx < box.x1; bx += kBlockSide) {
      const int block = by / kBlockSide * kTileBlocksAcross + bx / kBlockSide;
      Crossing crossing;
      if (!find_crossing(edges, bx, by, crossing)) continue;
      const DepthPlane plane = depth_plane(t, tile.x + bx, tile.y + by);
      if (greatest_in_block(plane) < tile.least[block]) continue;
      const int y0 = box.y0 > by ? box.y0 - by : 0;
      const int y1 = box.y1 < by + kBlockSide ? box.y1 - by : kBlockSide;
      fill_block(view, t.triangle, cut_outs, crossing, plane, tile.x + bx, tile.y + by, y0, y1, tile, block);
    }
  }
}

// Pixels that are not wanted count as covered by something nearer than all.
void mask_unwanted(const PixelBox& window, int block, Tile& tile) {
  const int x = block % kTileBlocksAcross * kBlockSide, y = block / kTileBlocksAcross * kBlockSide;
  for (int i = 0; i < kPacketSize; ++i) {
    const int px = x + i % kBlockSide, py = y + i / kBlockSide;
    if (px >= window.x0 && px < window.x1 && py >= window.y0 && py < window.y1) continue;
    tile.covered[block] |= uint64_t{1} << i;
    tile.seen->inverse_depth[block * kPacketSize + i] = __builtin_inff();
  }
}

void clear(const PixelBox& window, Tile& tile) {
  for (int g = 0; g < kTileBlocks * kPacketSize; g += kLanes) {
    store(tile.seen->inverse_depth + g, Float(0.0f));
    store(tile.seen->triangle + g, Uint(kNoTriangle));
  }
  for (int block = 0; block < kTileBlocks; ++block) tile.covered[block] = 0, tile.least[block] = 0;
  tile.least_of_all = 0;
  const bool whole = window.x0 == 0 && window.y0 == 0 && window.x1 == kTileSide && window.y1 == kTileSide;
  for (int block = 0; block < kTileBlocks && !whole; ++block) mask_unwanted(window, block, tile);
}

void forget_unwanted(const Tile& tile) {
  for (int g = 0; g < kTileBlocks * kPacketSize; g += kLanes) {
    const Mask nothing = load(tile.seen->triangle + g) == Uint(kNoTriangle);
    store(tile.seen->inverse_depth + g, select(nothing, Float(0.0f), load(tile.seen->inverse_depth + g)));
  }
}

inline const SetupTriangle& setup_triangle(const RasterView& view, SetupReference r) {
  return view.chunks[r >> kPlaceBits][r & ((1u << kPlaceBits) - 1)];
}

// The triangles of a bin lie scattered in memory: each is asked for some turns before its own.
void fill_bin(const RasterView& view, uint32_t bin, Tile& tile) {
  constexpr uint64_t ahead = 6;
  const uint64_t first = view.first_reference[bin], end = view.first_reference[bin + 1];
  for (uint64_t i = first; i < first + ahead && i < end; ++i)
    __builtin_prefetch(&setup_triangle(view, view.references[i]));
  for (uint64_t i = first; i < end; ++i) {
    if (i + ahead < end) __builtin_prefetch(&setup_triangle(view, view.references[i + ahead]));
    const SetupTriangle& t = setup_triangle(view, view.references[i]);
    if (t.greatest >= tile.least_of_all) fill_triangle(view, t, tile);
  }
}

// The pixels of small triangles, which are found already.
void fill_runs(const RasterView& view, uint32_t bin, TileVisibility& seen) {
  for (uint64_t r = view.first_run[bin]; r < view.first_run[bin + 1]; ++r) {
    const FragmentRun run = view.runs[r];
    for (const Fragment* f = run.first; f != run.first + run.count; ++f) {
      const uint32_t x = static_cast<uint32_t>(f->x_y) % kTileSide;
      const uint32_t y = static_cast<uint32_t>(f->x_y >> 16) % kTileSide;
      const uint32_t block = y / kBlockSide * kTileBlocksAcross + x / kBlockSide;
      const uint32_t i = block * kPacketSize + y % kBlockSide * kBlockSide + x % kBlockSide;
      float& depth = seen.inverse_depth[i];
      uint32_t& number = seen.triangle[i];
      const bool wins = (f->inverse_depth > depth) | ((f->inverse_depth == depth) & (f->triangle < number));
      depth = wins ? f->inverse_depth : depth;
      number = wins ? f->triangle : number;
    }
  }
}

}  // namespace

void fill_tile(const RasterView& view, int tile_x, int tile_y, TileVisibility& out) {
  Tile tile;
  tile.seen = &out;
  tile.x = tile_x * kTileSide;
  tile.y = tile_y * kTileSide;
  const PixelBox& w = view.window;
  tile.window = intersection({w.x0 - tile.x, w.y0 - tile.y, w.x1 - tile.x, w.y1 - tile.y},
                             {0, 0, kTileSide, kTileSide});
  clear(tile.window, tile);

  for (int level = 0; level < kBinLevels; ++level) {
    const int shift = level * kBinLevelShift;
    const uint32_t bin =
        view.grid.first_bin[level] +
        static_cast<uint32_t>((tile_y >> shift) * view.grid.across[level] + (tile_x >> shift));
    fill_bin(view, bin, tile);
  }
  fill_runs(view, static_cast<uint32_t>(tile_y * view.grid.across[0] + tile_x), out);
  forget_unwanted(tile);
}

}  // namespace VITRAL_ISA
}  // namespace vitral
