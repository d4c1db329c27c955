// Random triangulations are covered exactly once, and by the right triangle, whatever way the triangles go:
// small ones, cells, those of more than 128 pixels and those that leave the guard band share their edges.
//
// VITRAL_MESHES is the number of meshes; without it, and at least, 1000. A long run, of some minutes:
//   VITRAL_MESHES=1000000 out/release/tests --gtest_filter='RasterTriangulation.*'
#include "raster_lattice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace vitral {
namespace {

using namespace raster_test;

struct Triangulation {
  std::vector<Point> points;  // the first three are the corners of the whole
  std::vector<Corners> triangles;

  Outline outline(const Corners& c) const { return {points[c[0]], points[c[1]], points[c[2]]}; }
};

// To a number of 1/256 pixels that a float holds.
int64_t representable(int64_t v) {
  return v < kExactUnits && v > -kExactUnits ? v : v / 65536 * 65536;
}

// A point of a lattice, no farther than 2^bits / 256 pixels from `from`, more or less.
Point point_near(Random& random, const Point& from, int bits) {
  const int64_t grid = int64_t{1} << std::array{0, 4, 7, 8, 8, 8}[random.below(6)];
  const auto coordinate = [&](int64_t v) {
    const int64_t reach = int64_t{1} << bits;
    const int64_t high = random.bits(), low = random.below(256);
    const int64_t step = (high << 8 | low) % (2 * reach) - reach;
    const int64_t on_lattice = (v + step) / grid * grid;
    return representable(random.below(2) == 0 ? on_lattice : on_lattice + (grid > 1 ? 128 : 0));
  };
  const int64_t x = coordinate(from.x), y = coordinate(from.y);
  return {x, y};
}

// From a pixel or two to 2^26 pixels; half of them between.
int random_bits(Random& random) {
  return std::array{9, 10, 12, 12, 13, 13, 14, 15, 17, 20, 23, 27, 34}[random.below(13)];
}

// Cuts the triangle that the point lies in, or the two at whose edge it lies.
void insert(const Point& p, Triangulation& t) {
  const uint32_t number = static_cast<uint32_t>(t.points.size());
  bool used = false;
  for (size_t i = 0, end = t.triangles.size(); i < end; ++i) {
    const Corners c = t.triangles[i];
    int turns[3], zeros = 0, negatives = 0;
    for (size_t k = 0; k < 3; ++k) {
      turns[k] = sign(turn(t.points[c[k]], t.points[c[(k + 1) % 3]], p));
      zeros += turns[k] == 0;
      negatives += turns[k] < 0;
    }
    if (negatives > 0 || zeros > 1) continue;
    used = true;
    bool first = true;
    for (size_t k = 0; k < 3; ++k) {
      if (turns[k] == 0) continue;
      const Corners part{c[k], c[(k + 1) % 3], number};
      if (first) t.triangles[i] = part;
      if (!first) t.triangles.push_back(part);
      first = false;
    }
  }
  if (used) t.points.push_back(p);
}

// A triangle around or near `middle`, cut by points of its plane, some in heaps. The order and the windings
// are random.
Triangulation random_triangulation(Random& random, const Point& middle) {
  Triangulation t;
  for (int attempt = 0; attempt < 20; ++attempt) {
    t.points.clear();
    for (int k = 0; k < 3; ++k) t.points.push_back(point_near(random, middle, random_bits(random)));
    if (is_inside({t.points[0], t.points[1], t.points[2]}, middle)) break;
  }
  if (turn(t.points[0], t.points[1], t.points[2]) < 0) std::swap(t.points[1], t.points[2]);
  if (turn(t.points[0], t.points[1], t.points[2]) == 0) return Triangulation{};
  t.triangles = {{0, 1, 2}};
  const uint32_t cuts = random.below(64);
  Point heap = middle;
  for (uint32_t i = 0; i < cuts; ++i) {
    if (random.below(10) == 0) heap = point_near(random, middle, 12);
    insert(random.below(6) == 0 ? point_near(random, middle, random_bits(random))
                                : point_near(random, heap, between(random, 8, 10)),
           t);
  }
  for (size_t i = t.triangles.size() - 1; i > 0; --i)
    std::swap(t.triangles[i], t.triangles[random.below(static_cast<uint32_t>(i + 1))]);
  for (Corners& c : t.triangles) {
    if (random.below(2) != 0) std::swap(c[1], c[2]);
  }
  return t;
}

struct Box {
  int64_t x0, y0, x1, y1;
};
Box box_of(const Outline& t) {
  const auto [x0, x1] = std::minmax({t[0].x, t[1].x, t[2].x});
  const auto [y0, y1] = std::minmax({t[0].y, t[1].y, t[2].y});
  return {x0 - 2, y0 - 2, x1 + 2, y1 + 2};
}

struct Seen {
  size_t covered = 0, on_an_edge = 0, unsure = 0;
};

// Checks the pixels of the crop; `seen_last` has the triangle of the greatest number at each pixel.
void check(const Triangulation& t, const Rectangle& crop, const Picture& seen_first,
           const std::vector<uint32_t>& seen_last, Seen& seen) {
  std::vector<Outline> outlines;
  std::vector<Box> boxes;
  for (const Corners& c : t.triangles)
    outlines.push_back(t.outline(c)), boxes.push_back(box_of(outlines.back()));
  for (int y = crop.y; y < crop.y + crop.height; ++y) {
    for (int x = crop.x; x < crop.x + crop.width; ++x) {
      const Point p = center_of(x, y);
      const uint32_t got = seen_first.at(x, y);
      ASSERT_EQ(got, seen_last[static_cast<size_t>(y * seen_first.width + x)])
          << "two triangles cover " << x << "," << y;
      uint32_t expected = kNoTriangle;
      bool got_may_be = false, any_unsure = false;
      for (uint32_t i = 0; i < outlines.size(); ++i) {
        const Box& box = boxes[i];
        if (p.x < box.x0 || p.x > box.x1 || p.y < box.y0 || p.y > box.y1) continue;
        const Where w = where(outlines[i], p);
        if (w == Where::inside) expected = i;
        any_unsure |= w == Where::unsure;
        got_may_be |= w == Where::unsure && i == got;
        for (size_t k = 0; k < 3; ++k)
          seen.on_an_edge += w == Where::inside && turn(outlines[i][k], outlines[i][(k + 1) % 3], p) == 0;
      }
      seen.covered += got != kNoTriangle;
      seen.unsure += any_unsure;
      if (!any_unsure || expected != kNoTriangle) {
        ASSERT_EQ(got, expected) << x << "," << y;
      } else if (got == kNoTriangle) {
        ASSERT_NE(where(t.outline({0, 1, 2}), p), Where::inside) << "a crack at " << x << "," << y;
      } else {
        ASSERT_TRUE(got_may_be) << x << "," << y;
      }
    }
  }
}

TEST(RasterTriangulation, EveryPixelIsCoveredExactlyOnce) {
  const char* const asked = std::getenv("VITRAL_MESHES");
  const uint32_t meshes = asked ? static_cast<uint32_t>(std::stoul(asked)) : 1000;
  const std::vector<const Kernels*> kernels = available_kernels();
  const Pinhole camera = pixel_camera();
  RasterFrame frame;
  Paths paths;
  Seen seen;
  size_t triangles = 0, mixed = 0;
  for (uint32_t number = 0; number < meshes; ++number) {
    Random random(number);
    const Kernels& table = *kernels[number % kernels.size()];
    const int size =
        std::array{40, 40, 40, 70, 70, 150, 300, 1100}[random.below(random.below(8) == 0 ? 8 : 7)];
    Rectangle crop{between(random, 0, size - 36), between(random, 0, size - 36), 0, 0};
    crop.width = between(random, 12, 36), crop.height = between(random, 12, 36);
    const Triangulation t =
        random_triangulation(random, center_of(crop.x + crop.width / 2, crop.y + crop.height / 2));
    if (t.triangles.empty()) continue;
    Mesh mesh;
    for (const Point& p : t.points) mesh.positions.push_back(position(p, random));
    mesh.triangles = t.triangles;

    // All depths are equal: the lowest of a pixel's triangles is seen, and in the opposite order the highest.
    const auto see = [&] {
      setup_frame(table.front_end, camera, size, size, crop, mesh, nullptr, in_order, frame);
      return fill_frame(table, camera, size, size, frame);
    };
    const Picture first = see();
    const Paths taken = paths_taken(frame, mesh);
    add(paths, taken);
    mixed += taken.all();
    triangles += t.triangles.size();
    std::reverse(mesh.triangles.begin(), mesh.triangles.end());
    std::vector<uint32_t> last = see().triangle;
    for (uint32_t& i : last) {
      if (i != kNoTriangle) i = static_cast<uint32_t>(mesh.triangles.size()) - 1 - i;
    }
    check(t, crop, first, last, seen);
    if (HasFatalFailure()) FAIL() << "mesh " << number << ", " << table.isa;
  }
  if (asked) {
    std::printf(
        "%u meshes, %zu with all paths; triangles: %zu small, %zu in cells, %zu large, %zu clipped; "
        "pixels: %zu covered, %zu on an edge, %zu near a cut one\n",
        meshes, mixed, paths.small, paths.cells, paths.large, paths.clipped, seen.covered, seen.on_an_edge,
        seen.unsure);
  }
  EXPECT_GT(triangles, 20 * size_t{meshes});
  EXPECT_GT(seen.covered, 200 * size_t{meshes});
  EXPECT_GT(seen.on_an_edge, 4 * size_t{meshes});  // the rule was needed
  EXPECT_GT(seen.unsure, 0u);
  EXPECT_LT(seen.unsure, seen.covered / 50);
  EXPECT_GT(paths.small, size_t{meshes});
  EXPECT_GT(paths.cells, size_t{meshes});
  EXPECT_GT(paths.large, size_t{meshes} / 2);
  EXPECT_GT(paths.clipped, size_t{meshes} / 2);
  EXPECT_GT(mixed, size_t{meshes} / 12);
}

}  // namespace
}  // namespace vitral
