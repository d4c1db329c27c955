// Which pixels a triangle covers: the fill rule against exact integers, and shared edges drawn once.
#include "raster_support.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>

namespace vitral {
namespace {

using namespace raster_test;

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
// Returns which ways the triangles went, with every instruction set and in all rounds.
Paths expect_covered_once(const Patch& patch, uint32_t seed, size_t least_covered) {
  constexpr int size = 64;
  Paths paths;
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
          EXPECT_EQ(count[static_cast<size_t>(y * size + x)], inside ? 1 : 0)
              << kernels->isa << " at " << x << "," << y;
          if (testing::Test::HasFailure()) return paths;
          covered += inside;
        }
      }
      EXPECT_GE(covered, least_covered);
      RasterFrame frame;
      setup_frame(kernels->front_end, pixel_camera(), size, size, {}, mesh, nullptr, in_order, frame);
      add(paths, paths_taken(frame, mesh));
    }
  }
  return paths;
}

// Rims that run exactly through pixel centres, with the given number of cells a side: small triangles at 24,
// cells at 7, large ones at 1, of which part lies beside the frame.
void expect_rims(bool reversed, uint32_t seed) {
  EXPECT_GT(expect_covered_once({3.5f, 4.5f, 60.5f, 61.0f, 24, 1, 1, reversed}, seed, 57 * 56).small, 4000u);
  EXPECT_GT(expect_covered_once({3.5f, 4.5f, 60.5f, 61.0f, 7, 1, 1, reversed}, seed, 57 * 56).cells, 1000u);
  EXPECT_GT(expect_covered_once({3.5f, 4.5f, 400.5f, 300.5f, 1, 1, 1, reversed}, seed, 60 * 59).large, 10u);
  EXPECT_GT(expect_covered_once({-400.5f, -300.5f, 60.5f, 61.5f, 1, 1, 1, reversed}, seed, 60 * 61).large,
            10u);
}

TEST(RasterFillRule, Basic) {
  expect_rims(false, 11);
}
TEST(RasterFillRule, Reversed) {
  expect_rims(true, 12);
}
TEST(RasterFillRule, ClippedFull) {
  expect_covered_once({-150, -210, 190, 150, 6, 1, 1, false}, 13, 64 * 64);
  const Patch leaves_guard_band{-300000, -400000, 250000, 300000, 5, 1, 1, false};
  EXPECT_GT(expect_covered_once(leaves_guard_band, 14, 64 * 64).clipped, 20u);
}
// At a rim within the frame, which stays where it is although its ends are cut off.
TEST(RasterFillRule, ClippedPartial) {
  expect_covered_once({20.5f, -80, 140, 33.5f, 6, 1, 1, false}, 15, 43 * 33);
  for (const bool reversed : {false, true}) {
    const Patch top_right{20.5f, -200000, 300000, 33.5f, 5, 1, 1, reversed};
    EXPECT_GT(expect_covered_once(top_right, 16, 43 * 33).clipped, 10u);
    const Patch bottom_left{-200000, 20.5f, 33.5f, 300000, 5, 1, 1, reversed};
    EXPECT_GT(expect_covered_once(bottom_left, 19, 33 * 43).clipped, 10u);
  }
}
// (The corners are rounded when they are put at a depth; these rims stay between pixel centres.)
TEST(RasterFillRule, Projected) {
  const Paths paths = expect_covered_once({3.25f, 4.25f, 60.25f, 61.75f, 7, 0.5f, 40, false}, 17, 57 * 57);
  EXPECT_GT(paths.cells, 1000u);
  EXPECT_GT(expect_covered_once({3.25f, 4.25f, 60.25f, 61.75f, 24, 0.5f, 40, true}, 17, 57 * 57).small,
            4000u);
  expect_covered_once({-100, -90, 120, 150, 6, 0.5f, 40, true}, 18, 64 * 64);
}

}  // namespace
}  // namespace vitral
