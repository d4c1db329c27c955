#include "kdtree/sah.h"

#include <algorithm>
#include <limits>

namespace vitral {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();

// The cell's surface areas as functions of where the plane is, all halved.
struct CellArea {
  float ends, around, lower, upper;
  float inverse;  // 1 / area of the whole cell; 0 when that has none
};
CellArea cell_area(const Box& cell, int axis) {
  const Vec3 e = extent(cell);
  const float u = component(e, (axis + 1) % 3), v = component(e, (axis + 2) % 3), w = component(e, axis);
  const float whole = u * v + (u + v) * w;
  return {u * v, u + v, component(cell.min, axis), component(cell.max, axis), whole > 0 ? 1 / whole : 0.0f};
}

// The cost of four planes, with that many references on their sides; +inf for those that do not lie
// strictly inside the cell.
Float4 cost_of(const CellArea& area, const Float4& position, const Int4& below, const Int4& above,
               const SahCosts& costs) {
  const Float4 area_below = area.ends + area.around * (position - area.lower);
  const Float4 area_above = area.ends + area.around * (area.upper - position);
  const Float4 work = (area_below * to_float(below) + area_above * to_float(above)) * area.inverse;
  const Int4 cuts_off = (below == 0) | (above == 0);
  const Float4 bonus = select(cuts_off, splat(costs.empty_bonus), splat(1.0f));
  const Int4 inside = (position > area.lower) & (position < area.upper);
  return select(inside, bonus * (costs.traversal + costs.intersection * work), splat(kInfinite));
}

// The best plane of an axis in each lane.
struct Best4 {
  Float4 cost = splat(kInfinite), position = splat(kInfinite);
  Int4 planar_above = Int4{0, 0, 0, 0};
};
void consider(const Float4& cost, const Float4& position, const Int4& planar_above, Best4& best) {
  const Int4 better = (cost < best.cost) | ((cost == best.cost) & (position < best.position));
  best.cost = select(better, cost, best.cost);
  best.position = select(better, position, best.position);
  best.planar_above = (better & planar_above) | (~better & best.planar_above);
}

void take_best(const Best4& best, int axis, Plane& plane) {
  Plane here{kInfinite, kInfinite, axis, PlanarSide::below};
  for (int k = 0; k < 4; ++k) {
    const float cost = best.cost[k], position = best.position[k];
    if (cost < here.cost || (cost == here.cost && position < here.position))
      here = {cost, position, axis, best.planar_above[k] ? PlanarSide::above : PlanarSide::below};
  }
  if (here.cost < plane.cost) plane = here;
}

// The ends of boxes along one axis, padded with +inf to whole registers, and the positions of those
// boxes that are flat there.
struct alignas(16) Ends {
  float start[kExactAtMost], end[kExactAtMost], flat[kExactAtMost];
  size_t count = 0, flats = 0;
};

// Counts four candidates against all boxes. Boxes that start before a candidate are below it, boxes
// that end after it above, boxes that do neither lie in it.
void consider_ends(const Ends& ends, const float* candidates, const CellArea& area, const SahCosts& costs,
                   Best4& best) {
  const Float4 position = load4(candidates);
  Int4 below{0, 0, 0, 0}, above{0, 0, 0, 0};
  for (size_t i = 0; i < ends.count; ++i) {
    below -= splat(ends.start[i]) < position;
    above -= splat(ends.end[i]) > position;
  }
  if (ends.flats == 0) {
    consider(cost_of(area, position, below, above, costs), position, Int4{0, 0, 0, 0}, best);
    return;
  }
  Int4 planar{0, 0, 0, 0};
  for (size_t i = 0; i < ends.flats; ++i) planar -= splat(ends.flat[i]) == position;
  const Float4 cost_below = cost_of(area, position, below + planar, above, costs);
  const Float4 cost_above = cost_of(area, position, below, above + planar, costs);
  const Int4 planar_above = cost_above < cost_below;
  consider(select(planar_above, cost_above, cost_below), position, planar_above, best);
}

}  // namespace

Box4 bounds_of(std::span<const Reference> references) {
  Box4 b;
  for (const Reference& r : references) extend(b, lower(r), upper(r));
  return b;
}

Plane best_plane_exact(std::span<const Reference> references, const Box& cell, const SahCosts& costs) {
  Plane best{kInfinite, 0, 0, PlanarSide::below};
  Ends ends;
  ends.count = references.size();
  for (int axis = 0; axis < 3; ++axis) {
    const CellArea area = cell_area(cell, axis);
    if (area.inverse == 0) continue;
    ends.flats = 0;
    size_t padded = 0;
    for (const Reference& r : references) {
      const float start = r.min[axis], end = r.max[axis];
      ends.start[padded] = start;
      ends.end[padded++] = end;
      ends.flat[ends.flats] = start;
      ends.flats += start == end;
    }
    for (; padded % 4 != 0; ++padded) ends.start[padded] = ends.end[padded] = kInfinite;
    Best4 here;
    for (size_t i = 0; i < padded; i += 4) {
      consider_ends(ends, ends.start + i, area, costs, here);
      consider_ends(ends, ends.end + i, area, costs, here);
    }
    take_best(here, axis, best);
  }
  return best;
}

BinLayout make_bins(const Box4& tight, size_t references) {
  BinLayout layout{tight.min, splat(0), to_box(tight), references > 1024 ? 64 : references > 128 ? 32 : 16};
  layout.lower[3] = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float width = tight.max[axis] - tight.min[axis];
    const float scale = width > 0 ? static_cast<float>(layout.bins) / width : 0.0f;
    layout.scale[axis] = scale < 1e30f ? scale : 0.0f;
  }
  return layout;
}

void clear(const BinLayout& layout, BinCounts& counts) {
  for (size_t axis = 0; axis < 3; ++axis) {
    std::fill_n(counts.starts[axis], layout.bins, 0u);
    std::fill_n(counts.ends[axis], layout.bins, 0u);
  }
}

void count_bins(std::span<const Reference> references, const BinLayout& layout, BinCounts& counts) {
  const Float4 last = splat(static_cast<float>(layout.bins - 1)), zero = splat(0.0f);
  const Int4 three{-1, -1, -1, 0};
  for (const Reference& r : references) {
    const Float4 lo = (keep(three, lower(r)) - layout.lower) * layout.scale;
    const Float4 hi = (keep(three, upper(r)) - layout.lower) * layout.scale;
    const Int4 s = truncate(least(greatest(lo, zero), last)), e = truncate(least(greatest(hi, zero), last));
    ++counts.starts[0][s[0]], ++counts.starts[1][s[1]], ++counts.starts[2][s[2]];
    ++counts.ends[0][e[0]], ++counts.ends[1][e[1]], ++counts.ends[2][e[2]];
  }
}

void add_counts(const BinLayout& layout, const BinCounts& more, BinCounts& counts) {
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < layout.bins; ++i) {
      counts.starts[axis][i] += more.starts[axis][i];
      counts.ends[axis][i] += more.ends[axis][i];
    }
  }
}

// Plane i stands between bins i-1 and i; planes 0 and `bins` cut off the empty space outside.
Plane best_plane_binned(const BinLayout& layout, const BinCounts& counts, size_t references, const Box& cell,
                        const SahCosts& costs) {
  Plane best{kInfinite, 0, 0, PlanarSide::below};
  alignas(16) int32_t below[kMaxBins + 4], above[kMaxBins + 4];
  for (int axis = 0; axis < 3; ++axis) {
    const CellArea area = cell_area(cell, axis);
    if (layout.scale[axis] == 0 || area.inverse == 0) continue;
    int32_t started = 0, left = static_cast<int32_t>(references);
    for (int i = 0; i < layout.bins; ++i) {
      below[i] = started;
      above[i] = left;
      started += static_cast<int32_t>(counts.starts[axis][i]);
      left -= static_cast<int32_t>(counts.ends[axis][i]);
    }
    Best4 here;
    const float step = 1 / layout.scale[axis];
    for (int i = 0; i < layout.bins; i += 4) {
      Int4 b, a;
      std::memcpy(&b, below + i, sizeof b);
      std::memcpy(&a, above + i, sizeof a);
      const Float4 position = layout.lower[axis] + to_float(i + Int4{0, 1, 2, 3}) * step;
      consider(cost_of(area, position, b, a, costs), position, Int4{0, 0, 0, 0}, here);
    }
    const int32_t all = static_cast<int32_t>(references);
    const Float4 end = splat(component(layout.tight.max, axis));
    consider(cost_of(area, end, Int4{all, all, all, all}, Int4{0, 0, 0, 0}, costs), end, Int4{0, 0, 0, 0},
             here);
    take_best(here, axis, best);
  }
  return best;
}

}  // namespace vitral
