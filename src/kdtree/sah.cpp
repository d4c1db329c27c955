#include "kdtree/sah.h"

#include <algorithm>
#include <limits>

namespace vitral {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();
constexpr Plane kNoPlane{kInfinite, 0, 0, PlanarSide::below, 0, 0};

// What a plane across one axis of the cell costs. Surface areas are halved.
struct CellCosts {
  float lower, upper;     // of the cell, along the axis
  float ends, around;     // area of an end, and of all sides per length
  float traversal, work;  // intersection cost / area of the whole cell
  float bonus;            // what is taken off for empty space
};

// The cost of four planes with so many references on their sides; +inf for those that do not lie
// strictly inside the cell.
Float4 cost_of(const CellCosts& c, const Float4& position, const Float4& below, const Float4& above) {
  const Float4 height = position - c.lower, rest = c.upper - position;
  const Float4 work = (c.ends + c.around * height) * below + (c.ends + c.around * rest) * above;
  const Int4 cuts_off = least(below, above) == 0.0f, outside = least(height, rest) <= 0.0f;
  const Float4 cost = (c.traversal + work * c.work) * (1.0f - keep(cuts_off, splat(c.bonus)));
  return greatest(cost, keep(outside, splat(kInfinite)));
}

// The best plane so far in each lane; its code is 2 * (axis * Candidates::kMost + number), + 1 with what
// lies in it above.
struct Best4 {
  Float4 cost = splat(kInfinite);
  Int4 code{0, 0, 0, 0};
};
void consider(const Float4& cost, const Int4& code, Best4& best) {
  const Int4 better = cost < best.cost;
  best.cost = least(cost, best.cost);
  best.code = (better & code) | (~better & best.code);
}

// All candidates of an axis.
void consider_axis(const Candidates::Axis& planes, int axis, const CellCosts& c, Best4& best) {
  Int4 code = 2 * (axis * static_cast<int>(Candidates::kMost) + Int4{0, 1, 2, 3});
  for (size_t i = 0; i < planes.count; i += 4, code += 8) {
    const Float4 position = load4(planes.position + i), below = load4(planes.below + i),
                 above = load4(planes.above + i);
    if (!planes.has_planar) {
      consider(cost_of(c, position, below, above), code, best);
      continue;
    }
    const Float4 planar = load4(planes.planar + i);
    const Float4 cost_below = cost_of(c, position, below + planar, above);
    const Float4 cost_above = cost_of(c, position, below, above + planar);
    consider(least(cost_above, cost_below), code - (cost_above < cost_below), best);
  }
}

// The plane of the least cost and, among those, of the least code.
Plane decode(const Best4& best, const Candidates& candidates) {
  const float cost = least(least(best.cost[0], best.cost[1]), least(best.cost[2], best.cost[3]));
  if (!(cost < kInfinite)) return kNoPlane;
  const Int4 codes = (best.cost == cost) & (best.code + 1);  // 0 where the cost is not the least
  uint32_t code = std::numeric_limits<uint32_t>::max();
  for (int k = 0; k < 4; ++k) code = std::min(code, static_cast<uint32_t>(codes[k]) - 1);
  const int axis = static_cast<int>(code / (2 * Candidates::kMost));
  const size_t i = code / 2 % Candidates::kMost;
  const Candidates::Axis& planes = candidates.axis[axis];
  Plane plane{cost,
              planes.position[i],
              axis,
              PlanarSide::below,
              static_cast<uint32_t>(planes.below[i]),
              static_cast<uint32_t>(planes.above[i])};
  if (planes.has_planar ? code % 2 != 0 : plane.below == 0) plane.planar = PlanarSide::above;
  if (planes.has_planar)
    (plane.planar == PlanarSide::above ? plane.above : plane.below) +=
        static_cast<uint32_t>(planes.planar[i]);
  return plane;
}

// The positions of an axis are the places where boxes start, then those where boxes end.
struct Ends {
  size_t starts, ends;
  uint32_t below, above;  // boxes that start before all of these, and that end after all of them
};

// Counts 4 * groups of candidates, from number k on. Boxes that start before a candidate are below it,
// boxes that end after it above.
template <size_t groups>
void count_sides(Candidates::Axis& planes, const Ends& e, size_t k) {
  Float4 position[groups];
  Int4 below[groups], above[groups];
  for (size_t g = 0; g < groups; ++g) {
    position[g] = load4(planes.position + k + 4 * g);
    below[g] = Int4{0, 0, 0, 0} + static_cast<int32_t>(e.below);
    above[g] = Int4{0, 0, 0, 0} + static_cast<int32_t>(e.above);
  }
  for (size_t i = 0; i < e.starts; ++i) {
    const Float4 start = splat(planes.position[i]);
    for (size_t g = 0; g < groups; ++g) below[g] -= start < position[g];
  }
  for (size_t i = e.starts; i < e.starts + e.ends; ++i) {
    const Float4 end = splat(planes.position[i]);
    for (size_t g = 0; g < groups; ++g) above[g] -= end > position[g];
  }
  for (size_t g = 0; g < groups; ++g) {
    store4(planes.below + k + 4 * g, to_float(below[g]));
    store4(planes.above + k + 4 * g, to_float(above[g]));
  }
}

// Counts all candidates; `flat` are the positions of the boxes that have no extent along the axis.
void count_all(const Ends& e, std::span<const float> flat, Candidates::Axis& planes) {
  for (planes.count = e.starts + e.ends; planes.count % 4 != 0; ++planes.count)
    planes.position[planes.count] = kInfinite;
  size_t k = 0;
  for (; k + 8 <= planes.count; k += 8) count_sides<2>(planes, e, k);
  if (k < planes.count) count_sides<1>(planes, e, k);
  planes.has_planar = !flat.empty();
  for (k = 0; planes.has_planar && k < planes.count; k += 4) {
    const Float4 position = load4(planes.position + k);
    Int4 planar{0, 0, 0, 0};
    for (const float x : flat) planar -= splat(x) == position;
    store4(planes.planar + k, to_float(planar));
  }
}

}  // namespace

Box4 bounds_of(std::span<const Reference> references) {
  Box4 b;
  for (const Reference& r : references) extend(b, lower(r), upper(r));
  return b;
}

Plane best_plane(const Candidates& candidates, const Box& cell, const SahCosts& costs) {
  const float lower[3] = {cell.min.x, cell.min.y, cell.min.z},
              upper[3] = {cell.max.x, cell.max.y, cell.max.z};
  const Vec3 e = extent(cell);
  const float side[3] = {e.x, e.y, e.z}, area = e.x * e.y + (e.x + e.y) * e.z;
  const float work = costs.intersection / area;
  if (!(work < kInfinite)) return kNoPlane;
  Best4 best;
  for (int axis = 0; axis < 3; ++axis) {
    const float u = side[(axis + 1) % 3], v = side[(axis + 2) % 3];
    consider_axis(candidates.axis[axis], axis,
                  {lower[axis], upper[axis], u * v, u + v, costs.traversal, work, 1 - costs.empty_bonus},
                  best);
  }
  return decode(best, candidates);
}

void find_exact_candidates(std::span<const Reference> references, Candidates& candidates) {
  const size_t n = references.size();
  Int4 flat{0, 0, 0, 0};
  for (size_t i = 0; i < n; ++i) {
    const Float4 start = lower(references[i]), end = upper(references[i]);
    flat |= start == end;
    for (int axis = 0; axis < 3; ++axis) {
      candidates.axis[axis].position[i] = start[axis];
      candidates.axis[axis].position[n + i] = end[axis];
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    Candidates::Axis& planes = candidates.axis[axis];
    float flats[kExactAtMost];
    size_t f = 0;
    for (size_t i = 0; flat[axis] != 0 && i < n; ++i) {
      flats[f] = planes.position[i];
      f += planes.position[i] == planes.position[n + i];
    }
    count_all({n, n, 0, 0}, {flats, f}, planes);
  }
}

bool find_candidates_near(std::span<const Reference> references, int axis, float from, float to,
                          Candidates& candidates) {
  Candidates::Axis& planes = candidates.axis[axis];
  float ends[kExactAtMost], flats[kExactAtMost];
  Ends e{0, 0, 0, 0};
  size_t f = 0;
  for (const Reference& r : references) {
    if (e.starts == kExactAtMost || e.ends == kExactAtMost) return false;
    const float start = r.min[axis], end = r.max[axis];
    e.below += start <= from;
    e.above += end >= to;
    planes.position[e.starts] = start;
    e.starts += (start > from) & (start < to);
    flats[f] = ends[e.ends] = end;
    const bool ends_inside = (end > from) & (end < to);
    e.ends += ends_inside;
    f += ends_inside & (start == end);
  }
  if (f == kExactAtMost) return false;
  std::copy_n(ends, e.ends, planes.position + e.starts);
  for (Candidates::Axis& other : candidates.axis) other.count = 0;
  count_all(e, {flats, f}, planes);
  return true;
}

BinLayout make_bins(const Box4& tight, size_t references) {
  const size_t bins = references > 1024 ? 64 : references > 128 ? 32 : 16;
  BinLayout layout{tight.min, splat(0), tight.max, bins};
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
  for (size_t axis = 0; axis < 3; ++axis) {
    for (size_t i = 0; i < layout.bins; ++i) {
      counts.starts[axis][i] += more.starts[axis][i];
      counts.ends[axis][i] += more.ends[axis][i];
    }
  }
}

// Plane i stands between bins i-1 and i; planes 0 and `bins` cut off the empty space outside.
void find_binned_candidates(const BinLayout& layout, const BinCounts& counts, size_t references,
                            Candidates& candidates) {
  for (int axis = 0; axis < 3; ++axis) {
    Candidates::Axis& planes = candidates.axis[axis];
    planes.count = 0;
    planes.has_planar = false;
    if (layout.scale[axis] == 0) continue;
    uint32_t below = 0, above = static_cast<uint32_t>(references);
    const float step = 1 / layout.scale[axis];
    for (size_t i = 0; i < layout.bins; ++i) {
      planes.position[i] = layout.lower[axis] + static_cast<float>(i) * step;
      planes.below[i] = static_cast<float>(below);
      planes.above[i] = static_cast<float>(above);
      below += counts.starts[axis][i];
      above -= counts.ends[axis][i];
    }
    for (size_t i = layout.bins; i < layout.bins + 4; ++i) {
      planes.position[i] = layout.upper[axis];
      planes.below[i] = static_cast<float>(references);
      planes.above[i] = 0;
    }
    planes.count = layout.bins + 4;
  }
}

}  // namespace vitral
