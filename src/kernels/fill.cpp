// Fills one tile: for every pixel the nearest triangle that covers its centre.
//
// A triangle meets the tile in cells of 4x4 pixels. The edge functions at the corners of 16 cells at a time
// tell which of them lie outside an edge (nothing to do), inside all (no pixel has to be asked), or across
// one; there the pixels are asked, in exact 32-bit integers. The inverse depth is evaluated at each pixel's
// centre from the plane as seen from the cell's corner, and the greater wins; of equal ones the lower
// triangle number wins. So neither the order of the triangles nor the shape of the tiles can be seen in the
// result.
//
// A cell that lies whole inside a triangle is nowhere farther than that triangle from then on. It remembers
// this, and the tile the farthest of its cells: what lies behind is skipped (Greene, Kass and Miller,
// "Hierarchical Z-Buffer Visibility", SIGGRAPH 1993). What many triangles cover together is not looked for:
// measured, that costs more than it saves.
#include "kdtree/kdtree.h"
#include "kdtree/objects.h"
#include "kernels/facet.h"
#include "kernels/tables.h"
#include "kernels/tile_cells.h"
#include "raster/coverage.h"
#include "raster/project.h"
#include "raster/raster.h"
#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

// A triangle in the tile: how its edge functions and its inverse depth grow over the pixels of a cell.
struct Filling {
  const SetupTriangle* triangle;
  const CutOuts* cut_outs;  // null for a triangle without holes
  int32_t least_growth[3], greatest_growth[3];
  Int edge[3][kCellRegisters];
  Float across[kCellRegisters], down[kCellRegisters];
  float least_across, least_down, greatest_across, greatest_down;  // to the farthest pixel of a cell
};

// Edge values and inverse depths at the corners of 16 cells. Edge values are cut off at 2^30: within a
// window they grow by less than 15 * 2 * (2^25 + 2^9) < 2^30, so that no sign changes and no sum overflows.
struct Window {
  alignas(64) int32_t edge[3][16];
  alignas(64) float at_corner[16], least[16], greatest[16];
};

// The object that a triangle belongs to; null: it is the scene's own.
inline const PlacedObject* object_of(const RasterView& view, const SetupTriangle& t) {
  return view.placed != nullptr ? view.placed->objects + t.object : nullptr;
}

// The rule for the holes of an object's triangle; null where it has none.
[[gnu::noinline]] const CutOuts* placed_cut_outs(const RasterView& view, const SetupTriangle& t) {
  const PlacedObject& object = *object_of(view, t);
  const KdView& model = view.placed->models[object.model].tree;
  const bool is_cut_out = (model.triangles[t.triangle - object.first_number].flags & kCutOutTriangle) != 0;
  return is_cut_out ? &model.cut_outs : nullptr;
}

Filling make_filling(const RasterView& view, const SetupTriangle& t) {
  Filling f;
  f.triangle = &t;
  const bool is_cut_out =
      view.cut_outs != nullptr && (view.triangles[t.triangle].flags & kCutOutTriangle) != 0;
  f.cut_outs = is_cut_out ? view.cut_outs : nullptr;
  if (view.placed != nullptr) f.cut_outs = placed_cut_outs(view, t);
  constexpr int32_t far_side = kCellSide - 1;
  for (int k = 0; k < 3; ++k) {
    const int next = k == 2 ? 0 : k + 1;
    const int32_t across = t.y[k] - t.y[next], down = t.x[next] - t.x[k];
    f.least_growth[k] = far_side * (vitral::least(across, 0) + vitral::least(down, 0));
    f.greatest_growth[k] = far_side * (vitral::greatest(across, 0) + vitral::greatest(down, 0));
    for (int g = 0; g < kCellRegisters; ++g)
      f.edge[k][g] = load(kLaneX + g * kLanes) * Int(across) + load(kLaneY + g * kLanes) * Int(down);
  }
  const float across = vitral::narrow(t.across), down = vitral::narrow(t.down);
  for (int g = 0; g < kCellRegisters; ++g) {
    f.across[g] = to_float(load(kLaneX + g * kLanes)) * Float(across);
    f.down[g] = to_float(load(kLaneY + g * kLanes)) * Float(down);
  }
  f.greatest_across = across > 0 ? across * far_side : 0.0f;
  f.greatest_down = down > 0 ? down * far_side : 0.0f;
  f.least_across = across < 0 ? across * far_side : 0.0f;
  f.least_down = down < 0 ? down * far_side : 0.0f;
  return f;
}

// The sums of every pixel are rounded in the same order, so that they are monotone in x and y: what holds
// for the corner where both are greatest holds for all.
template <class F>
inline F sum_within(const SetupTriangle& t, const F& at_corner, const F& across, const F& down) {
  return least(greatest((at_corner + across) + down, F(t.least)), F(t.greatest));
}

inline int32_t cut_off(int64_t value) {
  constexpr int64_t limit = 1 << 30;
  return static_cast<int32_t>(value < -limit ? -limit : value > limit ? limit : value);
}

struct CellMasks {
  uint32_t touched, inside;
};

// The window whose corner is the pixel (x, y) of the frame, where the edge functions are `at_corner`.
CellMasks classify(const Filling& f, const int32_t at_corner[3], int x, int y, Window& w) {
  const SetupTriangle& t = *f.triangle;
  const InverseDepth<Double> plane{Double(t.across), Double(t.down), Double(t.at_0)};
  CellMasks masks{0, 0};
  for (int g = 0; g < kCellRegisters; ++g) {
    const int first = g * kLanes;
    Mask touched = mask_of_bits(~uint64_t{0}), inside = touched;
    for (int k = 0; k < 3; ++k) {
      const Int value = Int(at_corner[k]) + f.edge[k][g] * Int(kCellSide);
      store(w.edge[k] + first, value);
      touched = both(touched, value + Int(f.greatest_growth[k]) >= Int(0));
      inside = both(inside, value + Int(f.least_growth[k]) >= Int(0));
    }
    masks.touched |= bits(touched) << first;
    masks.inside |= bits(inside) << first;
    const Int px = Int(x) + load(kLaneX + first) * Int(kCellSide);
    const Int py = Int(y) + load(kLaneY + first) * Int(kCellSide);
    const Float depth = narrow(at_center(plane, widen(to_float(px)), widen(to_float(py))));
    store(w.at_corner + first, depth);
    store(w.least + first, sum_within(t, depth, Float(f.least_across), Float(f.least_down)));
    store(w.greatest + first, sum_within(t, depth, Float(f.greatest_across), Float(f.greatest_down)));
  }
  return masks;
}

// Clears the pixels where a cut-out triangle is not there; the cell's corner is (x, y).
[[gnu::noinline]] uint32_t keep_there(const RasterView& view, const Filling& f, int x, int y, int first,
                                      uint32_t pixels) {
  const PlacedObject* object = object_of(view, *f.triangle);
  const Eye eye = eye_of(*view.camera, object);
  const uint32_t number = f.triangle->triangle - (object != nullptr ? object->first_number : 0);
  const KdTriangle* triangles =
      object != nullptr ? view.placed->models[object->model].tree.triangles : view.triangles;
  const KdTriangle& triangle = triangles[number];
  Vec3T<Float> corner[3];
  for (int k = 0; k < 3; ++k) corner[k] = broadcast(corner_from(eye.origin, triangle, k));
  const Float px = to_float(Int(x) + load(kLaneX + first)), py = to_float(Int(y) + load(kLaneY + first));
  const auto hit = meet_from_eye(corner, direction_from(eye, px, py));
  alignas(64) float u[kLanes], v[kLanes];
  store(u, hit.u), store(v, hit.v);
  for (uint32_t left = pixels; left != 0; left &= left - 1) {
    const int lane = __builtin_ctz(left);
    if (!(bits(hit.hit) >> lane & 1u)) {
      const auto point = visible_point(eye, triangle, x + kLaneX[first + lane], y + kLaneY[first + lane]);
      u[lane] = point.u, v[lane] = point.v;
    }
    if (!f.cut_outs->is_there(f.cut_outs->scene, number, u[lane], v[lane])) pixels &= ~(1u << lane);
  }
  return pixels;
}

enum class Cell { inside, across };

// Fills a cell, the i-th of the window.
template <Cell kind>
inline void fill_cell(const RasterView& view, const Filling& f, const Window& w, int i, int cell,
                      Tile& tile) {
  const SetupTriangle& t = *f.triangle;
  float* const depths = tile.inverse_depth + cell * kCellPixels;
  uint32_t* const numbers = tile.triangle + cell * kCellPixels;
  for (int g = 0; g < kCellRegisters; ++g) {
    const int first = g * kLanes;
    const Float depth = sum_within(t, Float(w.at_corner[i]), f.across[g], f.down[g]);
    const Float old_depth = load(depths + first);
    const Uint old_number = load(numbers + first);
    Mask wins = either(depth > old_depth, both(depth == old_depth, Uint(t.triangle) < old_number));
    if (kind == Cell::across) {
      const Int value = (Int(w.edge[0][i]) + f.edge[0][g]) | (Int(w.edge[1][i]) + f.edge[1][g]) |
                        (Int(w.edge[2][i]) + f.edge[2][g]);
      wins = both(wins, value >= Int(0));
    }
    if (f.cut_outs != nullptr && any(wins)) {
      const int x = tile.x + cell % kTileCellsAcross * kCellSide,
                y = tile.y + cell / kTileCellsAcross * kCellSide;
      wins = mask_of_bits(keep_there(view, f, x, y, first, bits(wins)));
    }
    store(depths + first, select(wins, depth, old_depth));
    store(numbers + first, select(wins, Uint(t.triangle), old_number));
  }
  if (kind == Cell::inside && f.cut_outs == nullptr && w.least[i] > tile.least[cell]) {
    tile.least[cell] = w.least[i];
    tile.least_of_all_is_old = true;
  }
}

// How much an edge function grows within a square of pixels, at most.
inline int64_t greatest_growth(const Edge& e, int side) {
  return (int64_t{vitral::greatest(e.across, 0)} + vitral::greatest(e.down, 0)) * (side - 1);
}

// Whether the triangle lies behind all that the tile has: its plane at the nearest corner of the tile, and
// the least depth that is given to pixels beside the true triangle. The float sums of the cells are off by a
// few 2^-24 of their terms, which the margin of 2^-20 covers.
inline bool is_hidden(const SetupTriangle& t, const Tile& tile) {
  constexpr double far_side = kTileSide - 1, margin = 1.0 / (1 << 20);
  const InverseDepth<double> plane{t.across, t.down, t.at_0};
  const double nearest =
      at_center(plane, tile.x + (t.across > 0 ? far_side : 0.0), tile.y + (t.down > 0 ? far_side : 0.0));
  const double terms =
      vitral::absolute(nearest) + 2 * kTileSide * (vitral::absolute(t.across) + vitral::absolute(t.down));
  return t.least < tile.least_of_all && nearest + terms * margin < static_cast<double>(tile.least_of_all);
}

[[gnu::always_inline]] inline void fill_triangle(const RasterView& view, const SetupTriangle& t, Tile& tile) {
  PixelBox box = centers_within(t.x, t.y);
  box = intersection({box.x0 - tile.x, box.y0 - tile.y, box.x1 - tile.x, box.y1 - tile.y}, tile.window);
  if (vitral::is_empty(box)) return;

  // Most tiles and windows in the box of a large triangle lie outside an edge.
  Edge edge[3];
  for (int k = 0; k < 3; ++k) {
    const int next = k == 2 ? 0 : k + 1;
    edge[k] = make_edge(t.x[k], t.y[k], t.x[next], t.y[next], tile.x, tile.y);
    if (edge[k].value + greatest_growth(edge[k], kTileSide) < 0) return;
  }
  if ((box.x1 - box.x0 > kWindowSide || box.y1 - box.y0 > kWindowSide) && is_hidden(t, tile)) return;

  const Filling f = make_filling(view, t);
  const int x1 = (box.x1 - 1) / kCellSide, y1 = (box.y1 - 1) / kCellSide;  // the last cells
  for (int y = box.y0 / kCellSide; y <= y1; y += kCellSide) {
    for (int x = box.x0 / kCellSide; x <= x1; x += kCellSide) {
      int32_t at_corner[3];
      bool outside = false;
      for (int k = 0; k < 3; ++k) {
        const Edge& e = edge[k];
        const int64_t value =
            e.value + int64_t{e.across} * (x * kCellSide) + int64_t{e.down} * (y * kCellSide);
        outside |= value + greatest_growth(e, kWindowSide) < 0;
        at_corner[k] = cut_off(value);
      }
      if (outside) continue;
      Window w;
      const CellMasks masks = classify(f, at_corner, tile.x + x * kCellSide, tile.y + y * kCellSide, w);
      const uint32_t columns = x1 - x >= 3 ? 0xffffu : 0x1111u * ((2u << (x1 - x)) - 1);
      const uint32_t rows = y1 - y >= 3 ? 0xffffu : (16u << (4 * (y1 - y))) - 1;
      for (uint32_t left = masks.touched & columns & rows; left != 0; left &= left - 1) {
        const int i = __builtin_ctz(left);
        const int cell = (y + i / kCellSide) * kTileCellsAcross + x + i % kCellSide;
        if (w.greatest[i] < tile.least[cell]) continue;
        if (masks.inside >> i & 1u) {
          fill_cell<Cell::inside>(view, f, w, i, cell, tile);
        } else {
          fill_cell<Cell::across>(view, f, w, i, cell, tile);
        }
      }
    }
  }
}

inline const SetupTriangle& setup_triangle(const RasterView& view, SetupReference r) {
  return view.chunks[r >> kPlaceBits][r & ((1u << kPlaceBits) - 1)];
}

// The triangles of a bin lie scattered in memory: each is asked for some turns before its own.
[[gnu::always_inline]] inline void fill_bin(const RasterView& view, uint32_t bin, Tile& tile) {
  constexpr uint64_t ahead = 6;
  const uint64_t first = view.first_reference[bin], end = view.first_reference[bin + 1];
  for (uint64_t i = first; i < first + ahead && i < end; ++i)
    __builtin_prefetch(&setup_triangle(view, view.references[i]));
  for (uint64_t i = first; i < end; ++i) {
    if (i + ahead < end) __builtin_prefetch(&setup_triangle(view, view.references[i + ahead]));
    const SetupTriangle& t = setup_triangle(view, view.references[i]);
    if (tile.least_of_all_is_old) update_least_of_all(tile);
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

// All triangles of the view.
[[gnu::always_inline]] inline void fill_all(const RasterView& view, int tile_x, int tile_y, Tile& tile,
                                            TileVisibility& out) {
  for (int level = kBinLevels - 1; level >= 0; --level)
    fill_bin(view, bin_of(view.grid, level, tile_x, tile_y), tile);
  hand_over(tile, out);
  fill_runs(view, bin_of(view.grid, 0, tile_x, tile_y), out);
}

}  // namespace

void fill_tile(const RasterView& view, int tile_x, int tile_y, TileVisibility& out) {
  Tile tile;
  set_place(view, tile_x, tile_y, tile);
  clear(view, tile);
  mask_unwanted(tile);
  fill_all(view, tile_x, tile_y, tile, out);
}

void fill_over(const RasterView& view, int tile_x, int tile_y, TileVisibility& seen) {
  Tile tile;
  set_place(view, tile_x, tile_y, tile);
  take_over(view, seen, tile);
  mask_unwanted(tile);
  fill_all(view, tile_x, tile_y, tile, seen);
}

}  // namespace VITRAL_ISA
}  // namespace vitral
