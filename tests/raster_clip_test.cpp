// Clipping opens no crack and draws no shared edge twice.
#include "raster/clip.h"

#include "raster_support.h"

#include <gtest/gtest.h>

#include <array>

namespace vitral {
namespace {

using namespace raster_test;

// An orthonormal view in a random direction.
Pinhole random_camera(Random& random, int size, float half_height, float near, float far) {
  Vec3 view;
  do view = random.direction();
  while (absolute(view.y) > 0.95f);
  return make_camera({0, 0, 0}, view, size, size, half_height, near, far);
}

// The 12 triangles of a box around the origin, or finer, every side cut into n x n quads.
Mesh box_around_origin(int n, float half) {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (int end = 0; end < 2; ++end) {
      const auto corner = [&](int i, int j) {
        const float a = half * (2 * static_cast<float>(i) / static_cast<float>(n) - 1);
        const float b = half * (2 * static_cast<float>(j) / static_cast<float>(n) - 1);
        const float c = end == 0 ? -half : half;
        return axis == 0 ? Vec3{c, a, b} : axis == 1 ? Vec3{a, c, b} : Vec3{a, b, c};
      };
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
          add_triangle(mesh, corner(i, j), corner(i + 1, j), corner(i + 1, j + 1));
          add_triangle(mesh, corner(i, j), corner(i + 1, j + 1), corner(i, j + 1));
        }
      }
    }
  }
  return mesh;
}

TEST(RasterClip, ABoxAroundTheCameraCoversEveryPixelOnce) {
  constexpr int size = 40;
  Random random(21);
  size_t pixels = 0, clipped = 0;
  for (int round = 0; round < 60; ++round) {
    const int n = 1 + round % 3;
    const float half = round % 2 == 0 ? 1.0f : 3000.0f;
    const float near = std::array{0.2f, 1e-3f, 1e-6f, 1e-9f}[random.below(4)] * half;
    const Pinhole camera = random_camera(random, size, random.between(0.2f, 3.0f), near, 1e9f);
    const Mesh mesh = box_around_origin(n, half);
    const Kernels& kernels =
        *available_kernels()[random.below(static_cast<uint32_t>(available_kernels().size()))];
    for (const int count : count_coverage(kernels, camera, size, size, mesh)) {
      ASSERT_EQ(count, 1) << "round " << round;
      ++pixels;
    }
    const Projection projection = make_projection(camera, size, size, {});
    std::vector<ScreenVertex> vertices(mesh.positions.size());
    available_kernels().back()->front_end.project_vertices(projection, mesh.positions.data(),
                                                           mesh.positions.size(), vertices.data());
    for (const Corners& c : mesh.triangles) {
      const uint32_t any = vertices[c[0]].outside | vertices[c[1]].outside | vertices[c[2]].outside;
      const uint32_t all = vertices[c[0]].outside & vertices[c[1]].outside & vertices[c[2]].outside;
      clipped += any != 0 && all == 0;
    }
  }
  EXPECT_EQ(pixels, 60u * size * size);
  EXPECT_GT(clipped, 500u);
}

// How many triangles cover one pixel.
size_t count_alone(const Kernels& kernels, const Pinhole& camera, int size, const Mesh& mesh, int x, int y) {
  size_t count = 0;
  Mesh one;
  one.positions = mesh.positions;
  Options options;
  options.crop = {x, y, 1, 1};
  for (const Corners& c : mesh.triangles) {
    one.triangles = {c};
    count += rasterize(kernels, camera, size, size, one, options).at(x, y) != kNoTriangle;
  }
  return count;
}

// From close to a wall, an edge or a corner of a finely cut box: triangles that the near plane or the guard
// band cuts, huge ones, cells and small ones share their edges and corners in one picture. Where the wall is
// seen along itself, snapping may fold it, so that a triangle turns over and its pixels are covered by it and
// by one more on either side: once more than an even number of times.
TEST(RasterClip, FromCloseToItsWallsABoxOfManyTrianglesCoversEveryPixelOnce) {
  constexpr int size = 48;
  Random random(24);
  Paths paths;
  size_t mixed = 0, folded = 0;
  for (int round = 0; round < 60; ++round) {
    const Mesh mesh = box_around_origin(std::array{4, 15, 30}[static_cast<size_t>(round) % 3], 1.0f);
    const float gap = std::array{0.1f, 0.01f, 0.001f}[random.below(3)];
    Pinhole camera = random_camera(random, size, random.between(0.4f, 3.0f), gap * 1e-4f, 1e9f);
    float* const eye[3] = {&camera.origin.x, &camera.origin.y, &camera.origin.z};
    for (float* const axis : eye) *axis = random.between(-0.9f, 0.9f);
    for (uint32_t i = 0, n = 1 + random.below(3); i < n; ++i)
      *eye[i] = (1 - gap) * (random.below(2) ? 1.0f : -1.0f);
    const Kernels& kernels = *available_kernels()[static_cast<size_t>(round) % available_kernels().size()];
    const std::vector<int> count = count_coverage(kernels, camera, size, size, mesh);
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const int c = count[static_cast<size_t>(y * size + x)];
        ASSERT_GE(c, 1) << "round " << round << ": a crack at " << x << "," << y;
        if (c == 1) continue;
        ASSERT_LT(++folded, 10u);
        ASSERT_EQ(count_alone(kernels, camera, size, mesh, x, y) % 2, 1u) << round << " at " << x << "," << y;
      }
    }
    RasterFrame frame;
    setup_frame(kernels.front_end, camera, size, size, {}, mesh, nullptr, in_order, frame);
    const Paths taken = paths_taken(frame, mesh);
    add(paths, taken);
    mixed += taken.all();
  }
  EXPECT_GT(paths.small, 1000u);
  EXPECT_GT(paths.cells, 1000u);
  EXPECT_GT(paths.large, 30u);
  EXPECT_GT(paths.clipped, 100u);
  EXPECT_GT(mixed, 10u);
}

// A hill seen from within the reach of the near plane, which cuts it across the picture.
TEST(RasterClip, TheNearPlaneCutsAGroundWithoutCracks) {
  constexpr int size = 64;
  Random random(22);
  size_t once = 0, none = 0;
  for (int round = 0; round < 40; ++round) {
    // The plane y = -1 as a jittered grid.
    constexpr int n = 10;
    Mesh mesh;
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        const float x = static_cast<float>(i) + random.between(-0.3f, 0.3f) - n / 2,
                    z = static_cast<float>(j) + random.between(-0.3f, 0.3f) - n / 2;
        mesh.positions.push_back({x * 1.5f, -1, z * 1.5f});
      }
    }
    for (uint32_t j = 0; j < n; ++j) {
      for (uint32_t i = 0; i < n; ++i) {
        const uint32_t a = j * (n + 1) + i, c = a + n + 1;
        mesh.triangles.push_back({a, a + 1, c + 1});
        mesh.triangles.push_back({a, c + 1, c});
      }
    }
    const float near = random.between(1.05f, 1.6f);
    const float turn = random.between(-1.0f, 1.0f);
    const Vec3 view = normalize(Vec3{turn, random.between(-1.2f, -0.6f), -1});
    const Pinhole camera = make_camera({0, 0, 0}, view, size, size, 0.6f, near, 1000);
    const Kernels& kernels = *available_kernels()[static_cast<size_t>(round) % available_kernels().size()];
    const std::vector<int> count = count_coverage(kernels, camera, size, size, mesh);
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const Vec3 d = primary_direction(camera, static_cast<float>(x), static_cast<float>(y));
        const float t = d.y < 0 ? -1 / d.y : 1e9f;
        const Vec3 p = d * t;
        if (!(p.x > -6 && p.x < 6 && p.z > -6 && p.z < 6)) continue;
        const int c = count[static_cast<size_t>(y * size + x)];
        ASSERT_LE(c, 1) << "round " << round << " at " << x << "," << y;
        if (t > near * 1.001f) {
          ASSERT_EQ(c, 1) << "round " << round << " at " << x << "," << y;
          ++once;
        } else if (t < near * 0.999f) {
          ASSERT_EQ(c, 0) << "round " << round << " at " << x << "," << y;
          ++none;
        }
      }
    }
  }
  EXPECT_GT(once, 20000u);
  EXPECT_GT(none, 5000u);
}

TEST(RasterClip, BothTrianglesAtAnEdgeComputeTheSamePointOnIt) {
  Random random(23);
  size_t compared = 0;
  for (int round = 0; round < 5000; ++round) {
    const auto vertex = [&] {
      const double scale = std::array{1.0, 1e3, 1e9, 1e18}[random.below(4)];
      const double x = random.between(-1, 1), y = random.between(-1, 1), w = random.between(-1, 1);
      return ClipVertex{x * scale, y * scale, w};
    };
    const ClipVertex a = vertex(), b = vertex(), c = vertex(), d = vertex();
    const ClipVertex one[3] = {a, b, c}, other[3] = {b, a, d};
    const ClipPolygon p = clip_triangle(one, 0.01), q = clip_triangle(other, 0.01);
    ASSERT_LE(p.corners, kMaxClippedCorners);
    // Points of the near plane on the edge a-b: those with W = near that both polygons have.
    const bool crosses = (a.z >= 0.01) != (b.z >= 0.01);
    if (!crosses || p.corners < 3 || q.corners < 3) continue;
    const ClipVertex &in = a.z >= 0.01 ? a : b, &out = a.z >= 0.01 ? b : a;
    const double s = (in.z - 0.01) / ((in.z - 0.01) - (out.z - 0.01));
    const ClipVertex expected{in.x + (out.x - in.x) * s, in.y + (out.y - in.y) * s, 0.01};
    if (outside_planes<uint32_t>(expected, 0.01) != 0) continue;
    const auto has = [&](const ClipPolygon& polygon) {
      for (int i = 0; i < polygon.corners; ++i) {
        const ClipVertex& v = polygon.corner[i];
        if (v.x == expected.x && v.y == expected.y && v.z == expected.z) return true;
      }
      return false;
    };
    ASSERT_TRUE(has(p) && has(q)) << "round " << round;
    ++compared;
  }
  EXPECT_GT(compared, 500u);
}

}  // namespace
}  // namespace vitral
