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

Vec3 position(const Point& p) {
  return at_pixel(static_cast<float>(p.x) / 256.0f, static_cast<float>(p.y) / 256.0f, 1);
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
Triangulation random_triangulation(Random& random, int extent, int grid, int splits) {
  Triangulation t;
  const auto lattice = [&] {
    return Point{int64_t{random.between(-extent, extent)} * grid + 2048,
                 int64_t{random.between(-extent, extent)} * grid + 2048};
  };
  do t.points = {lattice(), lattice(), lattice()};
  while (turn(t.points[0], t.points[1], t.points[2]) == 0);
  t.triangles = {{0, 1, 2}};
  for (int i = 0; i < splits; ++i) {
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

Mesh mesh_of(const Triangulation& t) {
  Mesh mesh;
  for (const Point& p : t.points) mesh.positions.push_back(position(p));
  mesh.triangles = t.triangles;
  return mesh;
}

TEST(RasterCoverage, RandomTriangulationsAreCoveredExactlyOnce) {
  const std::vector<RasterIsa> isas = machine_isas();
  constexpr int side_pixels = 24;
  Random random(1);
  size_t triangles = 0, on_an_edge = 0, covered = 0;
  for (int trial = 0; trial < 8000; ++trial) {
    const int grid = std::array{1, 16, 64, 128, 256}[static_cast<size_t>(random.below(5))];
    const int extent = random.below(8) == 0 ? 12000000 / grid : 4096 / grid;
    const Triangulation t = random_triangulation(random, extent, grid, random.below(24));
    const Mesh mesh = mesh_of(t);
    const RasterIsa& isa = isas[static_cast<size_t>(trial) % isas.size()];
    std::vector<int> count(side_pixels * side_pixels, 0);
    Mesh one;
    one.positions = mesh.positions;
    for (size_t i = 0; i < t.triangles.size(); ++i) {
      one.triangles = {t.triangles[i]};
      const Picture p = rasterize(isa, pixel_camera(), side_pixels, side_pixels, one);
      ++triangles;
      for (int y = 0; y < side_pixels; ++y) {
        for (int x = 0; x < side_pixels; ++x) {
          const bool expected = covers(t.triangle(i), x, y);
          ASSERT_EQ(p.at(x, y) != kNoTriangle, expected)
              << isa.name << " trial " << trial << " at " << x << "," << y;
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

}  // namespace
}  // namespace vitral
