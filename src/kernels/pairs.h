// Triangles meet the cells of a tile: which triangle is to be tested with which cells' rays, and the tests.
#pragma once
#include "kernels/cells.h"
#include "kernels/counts.h"
#include "kernels/linear.h"

namespace vitral {
namespace VITRAL_ISA {

// Up to so many cells are not worth another look before their rays are tested.
inline constexpr int kFewCells = 4;

static inline float farthest_ray(const Cells& cells, int cell) {
  Float far = Float(-kInfinity);
  for (int g = 0; g < kCellSize; g += kLanes) {
    const Float high = load(cells.high + cell * kCellSize + g);
    far = greatest(select(mask_of_bits(cells.live[cell] >> g), high, far), far);
  }
  return greatest_lane(far);
}

// Says how deep a hit may be that still matters, after some cells' rays have met something.
static inline void set_far(Cells& cells, uint64_t changed) {
  for (; changed != 0; changed &= changed - 1) {
    const int cell = __builtin_ctzll(changed);
    cells.far[cell] = farthest_ray(cells, cell);
  }
  cells.all_far = -kInfinity;
  for (int group = 0; group < kGroups; ++group) {
    Float most = Float(-kInfinity);
    for (int g = 0; g < kCellsOfGroup; g += kLanes)
      most = greatest(load(cells.far + group * kCellsOfGroup + g), most);
    cells.group_far[group] = greatest_lane(most);
    cells.all_far = vitral::greatest(cells.group_far[group], cells.all_far);
  }
}

template <class AnyCells>
static inline Rectangles cell_bounds(const AnyCells& cells, int at) {
  return {load(cells.x0 + at), load(cells.x1 + at), load(cells.y0 + at), load(cells.y1 + at)};
}

// What has been counted since the mark was done for all rays together.
template <class AnyCells, class Counts>
static inline void share_work(uint64_t mark, const AnyCells& cells, Counts counts) {
  counts.share(mark, cells.packets, [&](int i) { return live_rays(cells, i); });
}

// Triangles and the cells that they are to be tested with.
struct Pair {
  uint32_t number;   // kCells * triangle in the batch + cell
  uint32_t covered;  // rays of the cell that the triangle may surround
};
struct alignas(64) Pairs {
  uint32_t number[kBatch * kCells + kBatch];
  Pair covered[kBatch * kCells];
};

// Of triangle i's edge values over a rectangle: one is nowhere less than `highest`, one nowhere greater than
// `lowest`.
struct Extremes {
  Float highest, lowest;
};
static inline Extremes extremes_of(const Line* edges, int i, const Rectangles& bounds) {
  Extremes out{Float(-kInfinity), Float(kInfinity)};
  for (int k = 0; k < 3; ++k) {
    const Span e = span_of(Float(edges[k].x[i]), Float(edges[k].y[i]), Float(edges[k].c[i]), bounds);
    out = {greatest(e.least, out.highest), least(e.greatest, out.lowest)};
  }
  return out;
}

// The cells from `at` on that may have rays with all edge values of triangle i of one sign: not those where
// one is surely negative and another surely positive.
static inline Mask may_meet(const Cells& cells, int at, const Batch& batch, int i) {
  const Rectangles bounds = cell_bounds(cells, at);
  const Extremes edge = extremes_of(batch.edge, i, bounds);
  const Float doubt = Float(batch.doubt[i]);
  return invert(both(edge.highest > doubt, edge.lowest < -doubt));
}

// Appends the pairs of triangle i of the batch and cells of a group that it can touch.
template <class AnyCells, class AnyBatch>
static inline int add_touched(const AnyCells& cells, int group, const AnyBatch& batch, int i, uint32_t* pairs,
                              int count) {
  const Rectangles triangle{Float(batch.x0[i]), Float(batch.x1[i]), Float(batch.y0[i]), Float(batch.y1[i])};
  const Float nearest = Float(batch.nearest[i]);
  for (int g = 0; g < kCellsOfGroup; g += kLanes) {
    const int at = group * kCellsOfGroup + g;
    Mask m = both(overlap(triangle, cell_bounds(cells, at)), nearest <= load(cells.far + at));
    if (__builtin_popcount(bits(m)) > kFewCells) m = both(m, may_meet(cells, at, batch, i));
    compress(pairs + count, lane_numbers() + Uint(static_cast<uint32_t>(kCells * i + at)), m);
    count += __builtin_popcount(bits(m));
  }
  return count;
}

template <class AnyCells, class AnyBatch>
static inline int find_pairs(const AnyCells& cells, const AnyBatch& batch, uint32_t* pairs) {
  int count = 0;
  for (int group = 0; group < kGroups; ++group) {
    const Rectangle4& r = cells.group[group];
    const Rectangles bounds{Float(r.x0), Float(r.x1), Float(r.y0), Float(r.y1)};
    uint32_t wanted = 0;
    for (int g = 0; g < kBatch; g += kLanes) {
      const Rectangles triangles{load(batch.x0 + g), load(batch.x1 + g), load(batch.y0 + g),
                                 load(batch.y1 + g)};
      const Mask m =
          both(overlap(triangles, bounds), load(batch.nearest + g) <= Float(cells.group_far[group]));
      wanted |= bits(m) << g;
    }
    wanted &= (1u << batch.count) - 1;
    for (; wanted != 0; wanted &= wanted - 1)
      count = add_touched(cells, group, batch, __builtin_ctz(wanted), pairs, count);
  }
  return count;
}

// Tests triangles with the rays that they can touch. First all pairs are found, then those with rays that the
// triangle may surround, then these are tested: three loops without a choice that a processor could get
// wrong.
template <class Counts>
static void meet(const KdView& tree, const View& view, const uint32_t* ids, int count, Cells& cells,
                 Counts counts) {
  Batch batch;
  fetch(tree, view, ids, count, batch);
  const uint64_t mark = counts.mark();
  counts.group_test(count);
  share_work(mark, cells, counts);
  Pairs pairs;
  const int touched = find_pairs(cells, batch, pairs.number);
  int found = 0;
  for (int p = 0; p < touched; ++p) {
    const uint32_t number = pairs.number[p];
    const int cell = static_cast<int>(number % kCells);
    counts.of(cell / kCellsOfPacket).test(packet_lanes(cells.live[cell], cell % kCellsOfPacket));
    const uint32_t covered = covered_lanes(cells, cell, batch, static_cast<int>(number / kCells));
    pairs.covered[found] = {number, covered};
    found += covered != 0;
  }
  uint64_t changed = 0;
  for (int p = 0; p < found; ++p) {
    const Pair& pair = pairs.covered[p];
    const int i = static_cast<int>(pair.number / kCells), cell = static_cast<int>(pair.number % kCells);
    if (meet_cell(tree, view, batch, i, cell, pair.covered, cells)) changed |= 1ull << cell;
  }
  if (changed != 0) set_far(cells, changed);
}

}  // namespace VITRAL_ISA
}  // namespace vitral
