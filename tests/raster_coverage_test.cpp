// Which pixels a triangle covers: the fill rule against exact integers, and shared edges drawn once.
#include "raster_support.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>

namespace vitral {
namespace {

using namespace raster_test;

// Points in 1/256 pixel.
struct Point {
  int64_t x, y;
};
__extension__ typedef __int128 Wide;

int sign(Wide v) {
  return v > 0 ? 1 : v < 0 ? -1 : 0;
}

Wide turn(const Point& a, const Point& b, const Point& c) {
  return static_cast<Wide>(b.x - a.x) * (c.y - a.y) - static_cast<Wide>(b.y - a.y) * (c.x - a.x);
}

// On which side of the line a-b the point is when it is moved a little to the right and much less
// down. No point is on a line then, and this move puts a point on a left or a top edge inside.
int side(const Point& a, const Point& b, const Point& p) {
  if (const int s = sign(turn(a, b, p))) return s;
  if (const int s = sign(-static_cast<Wide>(b.y - a.y))) return s;
  return sign(static_cast<Wide>(b.x - a.x));
}

bool covers(const std::array<Point, 3>& t, int x, int y) {
  const Point p{256 * x + 128, 256 * y + 128};
  if (turn(t[0], t[1], t[2]) == 0) return false;
  const int s = side(t[0], t[1], p);
  return s == side(t[1], t[2], p) && s == side(t[2], t[0], p);
}

// A place that is snapped to the point: up to half of 1/256 pixel before it, or less than that behind.
Vec3 position(const Point& p, Random& random) {
  const bool exact = p.x * p.x > 1 << 30 || p.y * p.y > 1 << 30;  // no bits left for fractions
  const float dx = exact ? 0.0f : static_cast<float>(between(random, -4, 3)) / 8;
  const float dy = exact ? 0.0f : static_cast<float>(between(random, -4, 3)) / 8;
  return at_pixel((static_cast<float>(p.x) + dx) / 256.0f, (static_cast<float>(p.y) + dy) / 256.0f, 1);
}

struct Triangulation {
  std::vector<Point> points;
  std::vector<Corners> triangles;
  std::array<Point, 3> outline() const { return {points[0], points[1], points[2]}; }
  std::array<Point, 3> triangle(size_t i) const {
    return {points[triangles[i][0]], points[triangles[i][1]], points[triangles[i][2]]};
  }
};

// Splits one triangle again and again by random lattice points inside it; the windings are random.
Triangulation random_triangulation(Random& random, int extent, int grid, uint32_t splits) {
  Triangulation t;
  const auto lattice = [&] {
    return Point{int64_t{between(random, -extent, extent)} * grid + 2048,
                 int64_t{between(random, -extent, extent)} * grid + 2048};
  };
  do t.points = {lattice(), lattice(), lattice()};
  while (turn(t.points[0], t.points[1], t.points[2]) == 0);
  t.triangles = {{0, 1, 2}};
  for (uint32_t i = 0; i < splits; ++i) {
    const Point p = lattice();
    for (size_t k = 0; k < t.triangles.size(); ++k) {
      const Corners c = t.triangles[k];
      const int s[3] = {sign(turn(t.points[c[0]], t.points[c[1]], p)),
                        sign(turn(t.points[c[1]], t.points[c[2]], p)),
                        sign(turn(t.points[c[2]], t.points[c[0]], p))};
      if (s[0] == 0 || s[0] != s[1] || s[1] != s[2]) continue;
      const uint32_t n = static_cast<uint32_t>(t.points.size());
      t.points.push_back(p);
      t.triangles[k] = {c[0], c[1], n};
      t.triangles.push_back({c[1], c[2], n});
      t.triangles.push_back({c[2], c[0], n});
      break;
    }
  }
  for (Corners& c : t.triangles) {
    if (random.below(2) != 0) std::swap(c[1], c[2]);
  }
  return t;
}

Mesh mesh_of(const Triangulation& t, Random& random) {
  Mesh mesh;
  for (const Point& p : t.points) mesh.positions.push_back(position(p, random));
  mesh.triangles = t.triangles;
  return mesh;
}

TEST(RasterCoverage, RandomTriangulationsAreCoveredExactlyOnce) {
  const std::vector<const Kernels*> kernels = available_kernels();
  constexpr int side_pixels = 24;
  Random random(1);
  size_t triangles = 0, on_an_edge = 0, covered = 0;
  for (int trial = 0; trial < 6000; ++trial) {
    const int grid = std::array{1, 16, 64, 128, 256}[random.below(5)];
    const int extent = random.below(8) == 0 ? 12000000 / grid : 4096 / grid;
    const Triangulation t = random_triangulation(random, extent, grid, random.below(24));
    const Mesh mesh = mesh_of(t, random);
    const Kernels& table = *kernels[static_cast<size_t>(trial) % kernels.size()];
    std::vector<int> count(side_pixels * side_pixels, 0);
    Mesh one;
    one.positions = mesh.positions;
    for (size_t i = 0; i < t.triangles.size(); ++i) {
      one.triangles = {t.triangles[i]};
      const Picture p = rasterize(table, pixel_camera(), side_pixels, side_pixels, one);
      ++triangles;
      for (int y = 0; y < side_pixels; ++y) {
        for (int x = 0; x < side_pixels; ++x) {
          const bool expected = covers(t.triangle(i), x, y);
          ASSERT_EQ(p.at(x, y) != kNoTriangle, expected)
              << table.isa << " trial " << trial << " at " << x << "," << y;
          count[static_cast<size_t>(y * side_pixels + x)] += expected;
          const Point center{256 * x + 128, 256 * y + 128};
          for (size_t k = 0; k < 3; ++k)
            on_an_edge += turn(t.triangle(i)[k], t.triangle(i)[(k + 1) % 3], center) == 0;
        }
      }
    }
    for (int y = 0; y < side_pixels; ++y) {
      for (int x = 0; x < side_pixels; ++x) {
        const bool expected = covers(t.outline(), x, y);
        ASSERT_EQ(count[static_cast<size_t>(y * side_pixels + x)], expected ? 1 : 0) << "trial " << trial;
        covered += expected;
      }
    }
  }
  EXPECT_GT(triangles, 10000u);
  EXPECT_GT(covered, 100000u);
  EXPECT_GT(on_an_edge, 20000u);  // the rule was needed
}

// --- the fill-rule cases of the Vulkan conformance tests -------------------------------------------

// A patch of cells x cells quads over [x0, x1] x [y0, y1] pixels, inner corners moved at random.
struct Patch {
  float x0, y0, x1, y1;
  int cells;
  float near_depth, far_depth;  // corners lie between
  bool reversed;
};

Mesh make_patch(const Patch& patch, Random& random) {
  Mesh mesh;
  const int n = patch.cells;
  const float cell_x = (patch.x1 - patch.x0) / static_cast<float>(n),
              cell_y = (patch.y1 - patch.y0) / static_cast<float>(n);
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const bool on_rim_x = i == 0 || i == n, on_rim_y = j == 0 || j == n;
      const float shift_x = random.between(-0.3f, 0.3f), shift_y = random.between(-0.3f, 0.3f);
      const float x =
          i == n ? patch.x1 : patch.x0 + cell_x * (static_cast<float>(i) + (on_rim_x ? 0.0f : shift_x));
      const float y =
          j == n ? patch.y1 : patch.y0 + cell_y * (static_cast<float>(j) + (on_rim_y ? 0.0f : shift_y));
      mesh.positions.push_back(at_pixel(x, y, random.between(patch.near_depth, patch.far_depth)));
    }
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const uint32_t a = static_cast<uint32_t>(j * (n + 1) + i), b = a + 1,
                     c = a + static_cast<uint32_t>(n) + 1, d = c + 1;
      const bool falling = random.below(2) != 0;
      mesh.triangles.push_back(falling ? Corners{a, b, d} : Corners{a, b, c});
      mesh.triangles.push_back(falling ? Corners{a, d, c} : Corners{b, d, c});
    }
  }
  if (patch.reversed) {
    for (Corners& c : mesh.triangles) std::swap(c[1], c[2]);
  }
  return mesh;
}

// Every pixel whose centre the patch surrounds is covered by exactly one triangle, the others by none.
void expect_covered_once(const Patch& patch, uint32_t seed, size_t least_covered) {
  constexpr int size = 64;
  Random random(seed);
  for (int round = 0; round < 6; ++round) {
    const Mesh mesh = make_patch(patch, random);
    for (const Kernels* kernels : available_kernels()) {
      const std::vector<int> count = count_coverage(*kernels, pixel_camera(), size, size, mesh);
      size_t covered = 0;
      for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
          const float cx = static_cast<float>(x) + 0.5f, cy = static_cast<float>(y) + 0.5f;
          const bool inside = cx >= patch.x0 && cx < patch.x1 && cy >= patch.y0 && cy < patch.y1;
          ASSERT_EQ(count[static_cast<size_t>(y * size + x)], inside ? 1 : 0)
              << kernels->isa << " at " << x << "," << y;
          covered += inside;
        }
      }
      ASSERT_GE(covered, least_covered);
    }
  }
}

TEST(RasterFillRule, Basic) {
  expect_covered_once({3.5f, 4.5f, 60.5f, 61.0f, 7, 1, 1, false}, 11, 57 * 56);
}
TEST(RasterFillRule, Reversed) {
  expect_covered_once({3.5f, 4.5f, 60.5f, 61.0f, 7, 1, 1, true}, 12, 57 * 56);
}
TEST(RasterFillRule, ClippedFull) {
  expect_covered_once({-150, -210, 190, 150, 6, 1, 1, false}, 13, 64 * 64);
  expect_covered_once({-300000, -400000, 250000, 300000, 5, 1, 1, false}, 14,
                      64 * 64);  // leaves the guard band
}
TEST(RasterFillRule, ClippedPartial) {
  expect_covered_once({20.5f, -80, 140, 33.5f, 6, 1, 1, false}, 15, 43 * 33);
  expect_covered_once({20.5f, -200000, 300000, 33.5f, 5, 1, 1, true}, 16, 43 * 33);
}
// (The corners are rounded when they are put at a depth; these rims stay between pixel centres.)
TEST(RasterFillRule, Projected) {
  expect_covered_once({3.25f, 4.25f, 60.25f, 61.75f, 7, 0.5f, 40, false}, 17, 57 * 57);
  expect_covered_once({-100, -90, 120, 150, 6, 0.5f, 40, true}, 18, 64 * 64);
}

}  // namespace
}  // namespace vitral
