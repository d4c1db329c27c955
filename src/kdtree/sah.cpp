#include "kdtree/sah.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace vitral {
namespace {

constexpr int kBins = 64;

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

// Takes the plane into account when it lies strictly inside the cell.
void consider(const CellArea& area, int axis, float position, size_t below, size_t above, size_t planar,
              const SahCosts& costs, Plane& best) {
  if (!(position > area.lower && position < area.upper) || area.inverse == 0) return;
  const float area_below = area.ends + area.around * (position - area.lower);
  const float area_above = area.ends + area.around * (area.upper - position);
  for (const PlanarSide side : {PlanarSide::below, PlanarSide::above}) {
    const size_t b = below + (side == PlanarSide::below ? planar : 0);
    const size_t a = above + (side == PlanarSide::above ? planar : 0);
    const float work =
        (area_below * static_cast<float>(b) + area_above * static_cast<float>(a)) * area.inverse;
    const float bonus = a == 0 || b == 0 ? costs.empty_bonus : 1.0f;
    const float cost = bonus * (costs.traversal + costs.intersection * work);
    if (cost < best.cost) best = {cost, position, axis, side};
    if (planar == 0) break;
  }
}

}  // namespace

Plane best_plane_exact(std::span<const Reference> references, const Box& cell, const SahCosts& costs) {
  Plane best{std::numeric_limits<float>::infinity(), 0, 0, PlanarSide::below};
  const size_t n = references.size();
  std::vector<float> starts(n), ends(n), flats;
  for (int axis = 0; axis < 3; ++axis) {
    flats.clear();
    starts.clear();
    ends.clear();
    for (const Reference& r : references) {
      const float lo = component(r.box.min, axis), hi = component(r.box.max, axis);
      if (lo == hi) {
        flats.push_back(lo);
      } else {
        starts.push_back(lo);
        ends.push_back(hi);
      }
    }
    // Only values are sorted, equal ones cannot be told apart.
    std::sort(starts.begin(), starts.end());
    std::sort(ends.begin(), ends.end());
    std::sort(flats.begin(), flats.end());

    // Sweep: at each candidate, boxes that started before it are below, boxes that have not ended are above.
    const CellArea area = cell_area(cell, axis);
    size_t s = 0, e = 0, f = 0;
    while (s < starts.size() || e < ends.size() || f < flats.size()) {
      float at = std::numeric_limits<float>::infinity();
      if (s < starts.size()) at = std::min(at, starts[s]);
      if (e < ends.size()) at = std::min(at, ends[e]);
      if (f < flats.size()) at = std::min(at, flats[f]);
      const size_t flats_before = f, starts_before = s;
      while (e < ends.size() && ends[e] == at) ++e;
      while (f < flats.size() && flats[f] == at) ++f;
      while (s < starts.size() && starts[s] == at) ++s;
      const size_t above = (ends.size() - e) + (flats.size() - f);
      consider(area, axis, at, starts_before + flats_before, above, f - flats_before, costs, best);
    }
  }
  return best;
}

Plane best_plane_binned(std::span<const Reference> references, const Box& cell, const SahCosts& costs) {
  Plane best{std::numeric_limits<float>::infinity(), 0, 0, PlanarSide::below};
  Box tight;
  for (const Reference& r : references) extend(tight, r.box);

  // Counts of boxes that start and that end in each bin.
  std::array<std::array<uint32_t, kBins>, 3> starts{}, ends{};
  float lower[3], scale[3];
  for (int axis = 0; axis < 3; ++axis) {
    const float width = component(tight.max, axis) - component(tight.min, axis);
    lower[axis] = component(tight.min, axis);
    scale[axis] = width > 0 ? static_cast<float>(kBins) / width : 0.0f;
    if (!(scale[axis] < 1e30f)) scale[axis] = 0;
  }
  for (const Reference& r : references) {
    for (size_t axis = 0; axis < 3; ++axis) {
      const int a = static_cast<int>(axis);
      const float lo = (component(r.box.min, a) - lower[axis]) * scale[axis];
      const float hi = (component(r.box.max, a) - lower[axis]) * scale[axis];
      ++starts[axis][static_cast<size_t>(std::clamp(static_cast<int>(lo), 0, kBins - 1))];
      ++ends[axis][static_cast<size_t>(std::clamp(static_cast<int>(hi), 0, kBins - 1))];
    }
  }

  // Plane i stands between bins i-1 and i; planes 0 and kBins cut off the empty space outside.
  for (int axis = 0; axis < 3; ++axis) {
    const size_t a = static_cast<size_t>(axis);
    if (scale[axis] == 0) continue;
    const CellArea area = cell_area(cell, axis);
    size_t below = 0, above = references.size();
    for (int i = 0; i <= kBins; ++i) {
      const float position =
          i == kBins ? component(tight.max, axis) : lower[axis] + static_cast<float>(i) / scale[axis];
      consider(area, axis, position, below, above, 0, costs, best);
      if (i < kBins) {
        below += starts[a][static_cast<size_t>(i)];
        above -= ends[a][static_cast<size_t>(i)];
      }
    }
  }
  return best;
}

}  // namespace vitral
