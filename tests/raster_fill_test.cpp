// Which of several triangles a pixel sees, and that nothing else can be seen: not the crop or the
// instruction set. (raster_order_test.cpp: nor the order of the triangles or the threads.)
#include "raster_support.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace vitral {
namespace {

using namespace raster_test;

// The inverse depth of a triangle's plane on the ray through a pixel's centre, in double.
double plane_inverse_depth(const Mesh& mesh, uint32_t triangle, const Pinhole& camera, int x, int y) {
  const Corners& c = mesh.triangles[triangle];
  const Vec3d a = to_double(mesh.positions[c[0]] - camera.origin);
  const Vec3d b = to_double(mesh.positions[c[1]] - camera.origin);
  const Vec3d d = to_double(mesh.positions[c[2]] - camera.origin);
  const Vec3d n = cross(b - a, d - a);
  return dot(n, to_double(primary_direction(camera, static_cast<float>(x), static_cast<float>(y)))) /
         dot(n, a);
}

TEST(RasterFill, TheNearestTriangleWins) {
  constexpr int size = 100;
  Random random(31);
  size_t compared = 0, contested = 0;
  for (int round = 0; round < 6; ++round) {
    const Mesh mesh = soup(random, 40, 1, 60);
    const Pinhole camera = pixel_camera();
    const Kernels& kernels = *available_kernels()[static_cast<size_t>(round) % available_kernels().size()];
    const Picture whole = rasterize(kernels, camera, size, size, mesh);
    std::vector<Picture> alone;
    for (const Corners& c : mesh.triangles) {
      Mesh one;
      one.positions = mesh.positions;
      one.triangles = {c};
      alone.push_back(rasterize(kernels, camera, size, size, one));
    }
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        uint32_t best = kNoTriangle;
        float depth = 0;
        int layers = 0;
        for (uint32_t i = 0; i < alone.size(); ++i) {
          if (alone[i].at(x, y) == kNoTriangle) continue;
          ++layers;
          if (alone[i].depth_at(x, y) > depth) depth = alone[i].depth_at(x, y), best = i;
        }
        ASSERT_EQ(whole.at(x, y), best) << x << "," << y;
        ASSERT_EQ(whole.depth_at(x, y), depth);
        ++compared;
        contested += layers > 1;
      }
    }
  }
  EXPECT_EQ(compared, 60000u);
  EXPECT_GT(contested, 40000u);
}

TEST(RasterFill, DepthIsThatOfTheTruePlane) {
  constexpr int size = 100;
  Random random(32);
  const Mesh mesh = soup(random, 400, 1, 60);
  const Picture p = rasterize(*available_kernels().back(), pixel_camera(), size, size, mesh);
  size_t close = 0, covered = 0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      if (p.at(x, y) == kNoTriangle) continue;
      ++covered;
      const double expected = plane_inverse_depth(mesh, p.at(x, y), pixel_camera(), x, y);
      close += std::abs(static_cast<double>(p.depth_at(x, y)) - expected) <= 1e-6 * expected;
    }
  }
  EXPECT_GT(covered, 9000u);
  EXPECT_GT(static_cast<double>(close),
            0.99 * static_cast<double>(covered));  // but for clamps at slivers' rims
}

// Snapping moves an edge by a third of 1/256 pixel, onto the last pixel centres of a tile that the true
// triangle does not reach: they get its least inverse depth, which is nearer than its plane there.
TEST(RasterFill, PixelsBesideTheTrueTriangleAreNotHiddenByWhatItsPlaneIsBehind) {
  Mesh mesh;
  const float wall = 1.00006f;
  add_triangle(mesh, at_pixel(-10, -10, wall), at_pixel(112, -10, wall), at_pixel(-10, 112, wall));
  add_triangle(mesh, at_pixel(31.5015f, -10, 1), at_pixel(31.5015f, 74, 1), at_pixel(80, 32, 0.2f));
  ASSERT_LT(plane_inverse_depth(mesh, 1, pixel_camera(), 31, 20), 1 - 1e-4);
  ASSERT_GT(1 / static_cast<double>(wall), 1 - 0.8e-4);
  for (const Kernels* kernels : available_kernels()) {
    const Picture p = rasterize(*kernels, pixel_camera(), 64, 64, mesh);
    for (int y = 0; y < 64; ++y) {
      ASSERT_EQ(p.at(30, y), 0u);
      ASSERT_EQ(p.at(31, y), 1u) << kernels->isa << " " << y;
      ASSERT_EQ(p.depth_at(31, y), 1.0f);
    }
  }
}

TEST(RasterFill, InstructionSetsGiveTheSameBytes) {
  Random random(34);
  for (int round = 0; round < 8; ++round) {
    const Mesh mesh = soup(random, 300, round % 2 == 0 ? 1.0f : -20.0f, 40);
    const Picture expected = rasterize(*available_kernels().front(), pixel_camera(), 150, 70, mesh);
    EXPECT_GT(expected.covered(), 5000u);
    for (const Kernels* kernels : available_kernels()) {
      ASSERT_TRUE(rasterize(*kernels, pixel_camera(), 150, 70, mesh) == expected) << kernels->isa;
    }
  }
}

TEST(RasterFill, ACropGivesTheSamePixels) {
  constexpr int width = 140, height = 100;
  Random random(35);
  const Mesh mesh = soup(random, 500, 0.5f, 40);
  const Kernels& kernels = *available_kernels().back();
  const Picture whole = rasterize(kernels, pixel_camera(), width, height, mesh);
  size_t inside = 0;
  for (int round = 0; round < 60; ++round) {
    const int x0 = between(random, 0, width - 1), y0 = between(random, 0, height - 1);
    const Rectangle crop{x0, y0, between(random, 1, width - x0), between(random, 1, height - y0)};
    Options options;
    options.crop = crop;
    const Picture part = rasterize(kernels, pixel_camera(), width, height, mesh, options);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const bool wanted = x >= crop.x && x < crop.x + crop.width && y >= crop.y && y < crop.y + crop.height;
        ASSERT_EQ(part.at(x, y), wanted ? whole.at(x, y) : kNoTriangle) << x << "," << y;
        ASSERT_EQ(part.depth_at(x, y), wanted ? whole.depth_at(x, y) : 0.0f);
        inside += wanted && part.at(x, y) != kNoTriangle;
      }
    }
  }
  EXPECT_GT(inside, 30000u);
}

TEST(RasterFill, WhatLiesBeyondFarOrBeforeNearIsNotSeen) {
  // A wall that runs from depth 1 on the left to depth 100 on the right.
  Mesh mesh;
  add_triangle(mesh, at_pixel(0, -64, 1), at_pixel(64, 32, 100), at_pixel(0, 128, 1));
  const Picture all = rasterize(*available_kernels().front(), pixel_camera(0.5f, 1e6f), 64, 64, mesh);
  const Picture some = rasterize(*available_kernels().front(), pixel_camera(1.5f, 5), 64, 64, mesh);
  size_t before = 0, between_them = 0, beyond = 0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      if (all.at(x, y) == kNoTriangle) continue;
      const float depth = 1 / all.depth_at(x, y);
      if (depth < 1.49f || depth > 5.01f) {
        EXPECT_EQ(some.at(x, y), kNoTriangle) << depth;
        (depth < 2 ? before : beyond) += 1;
      } else if (depth > 1.51f && depth < 4.99f) {
        EXPECT_EQ(some.at(x, y), 0u) << depth;
        EXPECT_EQ(some.depth_at(x, y), all.depth_at(x, y));
        ++between_them;
      }
    }
  }
  EXPECT_GT(before, 500u);
  EXPECT_GT(between_them, 500u);
  EXPECT_GT(beyond, 20u);
}

TEST(RasterFill, SmallTrianglesAreSeenUpToFarPixelByPixel) {
  // A slope from depth 4 to 6 in strips of 2x2 pixels.
  Mesh mesh;
  const auto corner = [](int i, int j) {
    const float y = static_cast<float>(2 * j);
    return at_pixel(static_cast<float>(2 * i), y, 1 / (1.0f / 4 + (1.0f / 6 - 1.0f / 4) * (y / 64)));
  };
  for (int j = 0; j < 32; ++j) {
    for (int i = 0; i < 32; ++i) {
      add_triangle(mesh, corner(i, j), corner(i + 1, j), corner(i + 1, j + 1));
      add_triangle(mesh, corner(i, j), corner(i + 1, j + 1), corner(i, j + 1));
    }
  }
  for (const float far : {4.2f, 5.0f, 5.1f, 5.9f}) {
    const Picture p = rasterize(*available_kernels().back(), pixel_camera(0.5f, far), 64, 64, mesh);
    const Picture all = rasterize(*available_kernels().back(), pixel_camera(0.5f, 1e6f), 64, 64, mesh);
    ASSERT_EQ(all.covered(), 64u * 64);
    for (size_t i = 0; i < p.triangle.size(); ++i)
      ASSERT_EQ(p.triangle[i], all.inverse_depth[i] >= 1 / far ? all.triangle[i] : kNoTriangle) << far;
    EXPECT_GT(p.covered(), 300u);
    EXPECT_LT(p.covered(), 64u * 64);
  }
}

TEST(RasterFill, HostileTrianglesDoNoHarm) {
  constexpr int size = 70;
  Random random(37);
  constexpr float near = 0.125f;
  size_t covered = 0;
  for (int round = 0; round < 120; ++round) {
    Mesh mesh;
    const auto coordinate = [&]() -> float {
      constexpr std::array<float, 12> odd{0,     -0.0f,  1,      -1,     near, -near,
                                          1e18f, -1e18f, 1e-30f, 1e-45f, 64,   1e9f};
      return random.below(3) == 0 ? random.between(-100, 100) : odd[random.below(odd.size())];
    };
    for (int i = 0; i < 200; ++i) {
      Vec3 p[3];
      for (Vec3& v : p) {
        const float x = coordinate(), y = coordinate(), z = coordinate();
        v = {x, y, z};
      }
      if (random.below(6) == 0) p[1] = p[0];
      add_triangle(mesh, p[0], p[1], p[2]);
    }
    const Pinhole camera = pixel_camera(near, random.below(2) == 0 ? 1e6f : 1e30f);
    const Picture expected = rasterize(*available_kernels().front(), camera, size, size, mesh);
    for (size_t i = 0; i < expected.triangle.size(); ++i) {
      if (expected.triangle[i] == kNoTriangle) {
        ASSERT_EQ(expected.inverse_depth[i], 0.0f);
        continue;
      }
      ASSERT_LT(expected.triangle[i], mesh.triangles.size());
      ASSERT_TRUE(expected.inverse_depth[i] > 0 && expected.inverse_depth[i] <= 1 / near);
      ++covered;
    }
    for (const Kernels* kernels : available_kernels()) {
      ASSERT_TRUE(rasterize(*kernels, camera, size, size, mesh) == expected)
          << kernels->isa << " round " << round;
    }
  }
  EXPECT_GT(covered, 100000u);
}

TEST(RasterFill, VerticesThatAreNotFiniteAreLeftOut) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  for (const float bad : {inf, -inf, nan}) {
    Mesh mesh;
    add_triangle(mesh, {bad, bad, bad}, at_pixel(0, 0, 1), at_pixel(64, 0, 1));
    add_triangle(mesh, {0, bad, 1}, {bad, 0, -1}, at_pixel(64, 0, 1));
    add_triangle(mesh, {0, 0, bad}, {1, 0, bad}, {0, 1, bad});
    add_triangle(mesh, at_pixel(0, 0, 5), at_pixel(64, 0, 5), at_pixel(0, 64, 5));
    const Picture p = rasterize(*available_kernels().front(), pixel_camera(), 64, 64, mesh);
    EXPECT_EQ(p.at(10, 10), 3u);
    EXPECT_EQ(p.covered(), 64u * 65 / 2 - 64);
  }
}

TEST(RasterFill, NothingToDrawIsAnEmptyPicture) {
  const Picture p = rasterize(*available_kernels().back(), pixel_camera(), 33, 1, Mesh{});
  EXPECT_EQ(p.triangle.size(), 33u);
  EXPECT_EQ(p.covered(), 0u);
}

TEST(RasterFill, MemoryOfTheBinsIsBounded) {
  // Each of these covers all of the largest frame.
  Mesh mesh;
  for (int i = 0; i < 1000; ++i) {
    const float depth = 1 + static_cast<float>(i);
    add_triangle(mesh, at_pixel(-1, -1, depth), at_pixel(40000, -1, depth), at_pixel(-1, 40000, depth));
  }
  RasterFrame frame;
  setup_frame(available_kernels().back()->front_end, pixel_camera(), kMaxImageSide, kMaxImageSide, {}, mesh,
              nullptr, in_order, frame);
  EXPECT_GE(frame.bins.references.items.size(), 1000u);
  EXPECT_LE(frame.bins.references.items.size(), 1000u * kMaxBinsTouched);
  const Pinhole camera = pixel_camera();
  const RasterView view = make_view(frame, camera, nullptr, nullptr);
  const auto tile = std::make_unique<TileVisibility>();
  available_kernels().back()->fill_tile(view, 511, 511, *tile);
  EXPECT_EQ(tile->triangle[1023], 0u);
}

}  // namespace
}  // namespace vitral
