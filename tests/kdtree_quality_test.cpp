// The tree that is built: no part of a triangle is lost, and its planes are about as good as there are.
#include "kdtree/build.h"
#include "kdtree/cut.h"
#include "kdtree_support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace vitral::test {
namespace {

// The part of a polygon on one side of a plane (Sutherland and Hodgman 1974).
using Polygon = std::vector<std::array<double, 3>>;
Polygon clip(const Polygon& polygon, size_t axis, double position, bool keep_below) {
  Polygon out;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const auto &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double da = keep_below ? position - a[axis] : a[axis] - position,
                 db = keep_below ? position - b[axis] : b[axis] - position;
    if (da >= 0) out.push_back(a);
    if ((da > 0 && db < 0) || (da < 0 && db > 0)) {
      std::array<double, 3> c;
      for (size_t k = 0; k < 3; ++k) c[k] = a[k] + (b[k] - a[k]) * (da / (da - db));
      c[axis] = position;
      out.push_back(c);
    }
  }
  return out;
}
Polygon clip(Polygon polygon, const Box& cell, double inwards) {
  for (int axis = 0; axis < 3 && !polygon.empty(); ++axis) {
    const size_t a = static_cast<size_t>(axis);
    polygon = clip(polygon, a, static_cast<double>(component(cell.min, axis)) + inwards, false);
    polygon = clip(polygon, a, static_cast<double>(component(cell.max, axis)) - inwards, true);
  }
  return polygon;
}
Polygon polygon_of(const KdTriangle& t) {
  Polygon p;
  for (const auto& c : t.corner)
    p.push_back({static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2])});
  return p;
}

// The bounds of a part are those of the exact one, rounded outwards and no further than need be.
TEST(KdTreeQuality, CutsTightly) {
  Random random(27);
  int straddling = 0;
  for (int i = 0; i < 3000; ++i) {
    Triangles list;
    add_triangle(list, random.in_box(-1, 1), random.in_box(-1, 1), random.in_box(-1, 1));
    Box box;
    for (size_t k = 0; k < 3; ++k) extend(box, corner_of(list[0], k));
    const Reference whole{{box.min.x, box.min.y, box.min.z}, 7, {box.max.x, box.max.y, box.max.z}, 0};
    const Plane plane{0, random.between(-1, 1), i % 3, PlanarSide::below, 1, 1};
    if (!(component(box.min, plane.axis) < plane.position && component(box.max, plane.axis) > plane.position))
      continue;
    ++straddling;
    Reference parts[2];
    cut(list[0], whole, plane, parts[0], parts[1]);
    for (const bool below : {true, false}) {
      const Reference& part = parts[below ? 0 : 1];
      EXPECT_EQ(part.triangle, 7u);
      const Polygon exact = clip(polygon_of(list[0]), static_cast<size_t>(plane.axis),
                                 static_cast<double>(plane.position), below);
      for (size_t axis = 0; axis < 3; ++axis) {
        double lo = 1e30, hi = -1e30;
        for (const auto& p : exact) lo = std::min(lo, p[axis]), hi = std::max(hi, p[axis]);
        EXPECT_LE(static_cast<double>(part.min[axis]), lo + 1e-12);
        EXPECT_GE(static_cast<double>(part.max[axis]), hi - 1e-12);
        EXPECT_NEAR(static_cast<double>(part.min[axis]), lo, 0x1p-18);
        EXPECT_NEAR(static_cast<double>(part.max[axis]), hi, 0x1p-18);
      }
    }
  }
  EXPECT_GT(straddling, 1000);
}

bool contains(const Box& cell, double grown, const std::array<double, 3>& p) {
  for (int axis = 0; axis < 3; ++axis) {
    const double x = p[static_cast<size_t>(axis)];
    if (x < static_cast<double>(component(cell.min, axis)) - grown) return false;
    if (x > static_cast<double>(component(cell.max, axis)) + grown) return false;
  }
  return true;
}

// Whatever of a triangle lies in a cell, further than the error from its faces, is in the cell's leaf;
// and any point of a triangle is in a leaf that it touches.
TEST(KdTreeQuality, LosesNoPartOfATriangle) {
  Random random(22);
  const Triangles scenes[] = {soup(random, 300, 0.5f),
                              city(random, 200),
                              needles(random, 150),
                              sphere({1.5e5f, -1234, 2e5f}, 300, 8),
                              scaled(soup(random, 200, 0.5f), 1e17f, {3e17f, 0, -1e17f}),
                              scaled(soup(random, 200, 0.5f), 1e-40f, {0, 0, 0})};
  size_t parts = 0;
  for (const Triangles& scene : scenes) {
    const KdTree tree = build_kdtree(scene, all_of(scene), {}, one_by_one);
    const double error = static_cast<double>(magnitude(tree.bounds)) * 0x1p-20 + 0x1p-147;
    std::vector<std::array<double, 3>> points;
    std::vector<bool> found(4 * scene.size());
    for (const KdTriangle& t : scene) {
      for (int i = 0; i < 4; ++i) {
        const double u = static_cast<double>(random.unit()), v = (1 - u) * static_cast<double>(random.unit());
        const Polygon p = polygon_of(t);
        auto& x = points.emplace_back();
        for (size_t k = 0; k < 3; ++k)
          x[k] = i == 0 ? p[0][k] : p[0][k] * (1 - u - v) + p[1][k] * u + p[2][k] * v;
      }
    }
    size_t lost = 0;
    for_each_leaf(tree, 0, tree.bounds, 0, [&](const KdNode& leaf, const Box& cell, int) {
      const auto first = tree.references.begin() + first_reference(leaf), last = first + count(leaf);
      EXPECT_TRUE(std::is_sorted(first, last));
      for (uint32_t i = 0; i < scene.size(); ++i) {
        const bool here = std::binary_search(first, last, i);
        for (size_t k = 4 * i; here && k < 4 * i + 4; ++k) {
          if (contains(cell, error, points[k])) found[k] = true;
        }
        if (clip(polygon_of(scene[i]), cell, error).empty()) continue;
        ++parts;
        lost += !here;
      }
    });
    EXPECT_EQ(lost, 0u);
    EXPECT_EQ(std::count(found.begin(), found.end(), false), 0);
  }
  EXPECT_GT(parts, 2000u);
}

double surface(const Box& b) {
  const double x = static_cast<double>(b.max.x) - static_cast<double>(b.min.x),
               y = static_cast<double>(b.max.y) - static_cast<double>(b.min.y),
               z = static_cast<double>(b.max.z) - static_cast<double>(b.min.z);
  return x * y + (x + y) * z;
}

double cost_of(const KdTree& tree, const SahCosts& costs) {
  double sum = 0;
  size_t leaves = 0;
  for_each_leaf(tree, 0, tree.bounds, 0, [&](const KdNode& leaf, const Box& cell, int) {
    sum += static_cast<double>(costs.intersection) * count(leaf) * surface(cell);
    ++leaves;
  });
  const auto inner = [&](const auto& self, uint32_t node, const Box& cell) -> double {
    const KdNode& n = tree.nodes[node];
    if (is_leaf(n)) return 0;
    Box below = cell, above = cell;
    (axis(n) == 0 ? below.max.x : axis(n) == 1 ? below.max.y : below.max.z) = split(n);
    (axis(n) == 0 ? above.min.x : axis(n) == 1 ? above.min.y : above.min.z) = split(n);
    return static_cast<double>(costs.traversal) * surface(cell) + self(self, child(n), below) +
           self(self, child(n) + 1, above);
  };
  sum += inner(inner, 0, tree.bounds);
  EXPECT_GT(leaves, 50u);
  return sum / surface(tree.bounds);
}

// The same recursion with nothing saved: every end of every part, clipped to its cell in full, is
// tried as a plane and counted against every part. The expected cost of a ray that enters the cell.
double exhaustive_cost(const std::vector<Polygon>& parts, const Box& cell, int depth, const SahCosts& costs) {
  const double n = static_cast<double>(parts.size()), as_leaf = static_cast<double>(costs.intersection) * n;
  double best = as_leaf, best_at = 0;
  size_t best_axis = 3;
  bool planar_below = true;
  std::vector<std::array<double, 2>> ends(parts.size());
  for (size_t axis = 0; axis < 3 && parts.size() > 1 && depth < 30; ++axis) {
    for (size_t i = 0; i < parts.size(); ++i) {
      ends[i] = {1e30, -1e30};
      for (const auto& p : parts[i]) ends[i] = {std::min(ends[i][0], p[axis]), std::max(ends[i][1], p[axis])};
    }
    for (size_t i = 0; i < 2 * parts.size(); ++i) {
      const double at = ends[i / 2][i % 2];
      Box below_cell = cell, above_cell = cell;
      float& top = axis == 0 ? below_cell.max.x : axis == 1 ? below_cell.max.y : below_cell.max.z;
      float& bottom = axis == 0 ? above_cell.min.x : axis == 1 ? above_cell.min.y : above_cell.min.z;
      if (!(at > static_cast<double>(bottom) && at < static_cast<double>(top))) continue;
      top = bottom = static_cast<float>(at);
      double below = 0, above = 0, planar = 0;
      for (const auto& e : ends) {
        below += e[0] < at;
        above += e[1] > at;
        planar += e[0] == at && e[1] == at;
      }
      for (const bool side : {true, false}) {
        const double b = below + (side ? planar : 0), a = above + (side ? 0 : planar);
        const double work = (surface(below_cell) * b + surface(above_cell) * a) / surface(cell);
        const double cost =
            (static_cast<double>(costs.traversal) + static_cast<double>(costs.intersection) * work) *
            (a == 0 || b == 0 ? static_cast<double>(costs.empty_bonus) : 1.0);
        if (cost < best) best = cost, best_axis = axis, best_at = at, planar_below = side;
      }
    }
  }
  if (best_axis == 3) return as_leaf;
  Box cells[2] = {cell, cell};
  (best_axis == 0   ? cells[0].max.x
   : best_axis == 1 ? cells[0].max.y
                    : cells[0].max.z) = static_cast<float>(best_at);
  (best_axis == 0   ? cells[1].min.x
   : best_axis == 1 ? cells[1].min.y
                    : cells[1].min.z) = static_cast<float>(best_at);
  double cost = static_cast<double>(costs.traversal);
  for (const bool is_below : {true, false}) {
    std::vector<Polygon> inside;
    for (const Polygon& part : parts) {
      double lo = 1e30, hi = -1e30;
      for (const auto& p : part) lo = std::min(lo, p[best_axis]), hi = std::max(hi, p[best_axis]);
      const bool planar = lo == best_at && hi == best_at;
      if (planar ? planar_below == is_below : is_below ? lo < best_at : hi > best_at)
        inside.push_back(clip(part, best_axis, best_at, is_below));
    }
    const Box& c = cells[is_below ? 0 : 1];
    cost += surface(c) / surface(cell) * exhaustive_cost(inside, c, depth + 1, costs);
  }
  return cost;
}

TEST(KdTreeQuality, IsAboutAsGoodAsTryingEveryPlane) {
  Random random(24);
  const Triangles scenes[] = {soup(random, 500, 0.2f), sphere({0.1f, -0.2f, 0.3f}, 1, 11), city(random, 250)};
  const BuildSettings settings;
  for (const Triangles& scene : scenes) {
    const KdTree tree = build_kdtree(scene, all_of(scene), settings, one_by_one);
    std::vector<Polygon> parts;
    for (const KdTriangle& t : scene) parts.push_back(polygon_of(t));
    const double reference = exhaustive_cost(parts, tree.bounds, 0, settings.costs);
    const double cost = cost_of(tree, settings.costs);
    EXPECT_LT(cost, 1.05 * reference);
    EXPECT_GT(cost, 0.7 * reference);
  }
}

}  // namespace
}  // namespace vitral::test
