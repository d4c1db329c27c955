// Where the camera rays meet the visible triangles: the tracer's bits, sane numbers at the rims, and
// the same cut-outs as the tracer's.
#include "kdtree/triangle.h"
#include "raster_support.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace vitral {
namespace {

using namespace raster_test;

constexpr int kSize = 128;

Pinhole camera_at(const Vec3& eye, const Vec3& view) {
  return make_camera(eye, normalize(view), kSize, kSize, 0.6f, 0.01f, 1000);
}

Mesh mesh_of(const std::vector<KdTriangle>& triangles) {
  Mesh mesh;
  for (const KdTriangle& t : triangles)
    add_triangle(mesh, test::corner_of(t, 0), test::corner_of(t, 1), test::corner_of(t, 2));
  return mesh;
}

// All pixels' hits by the rasterizer, row by row.
std::vector<Hit> see(const Kernels& kernels, const Pinhole& camera, const Picture& picture,
                     const std::vector<KdTriangle>& triangles) {
  std::vector<Hit> out(picture.triangle.size());
  for (int y = 0; y < kSize; y += kBlockSide) {
    for (int x = 0; x < kSize; x += kBlockSide) {
      uint32_t numbers[kPacketSize];
      for (int i = 0; i < kPacketSize; ++i) numbers[i] = picture.at(x + i % 8, y + i / 8);
      HitPacket hits;
      kernels.intersect_visible(camera, triangles.data(), x, y, numbers, hits);
      for (int i = 0; i < kPacketSize; ++i)
        out[static_cast<size_t>((y + i / 8) * kSize + x + i % 8)] = hit_of(hits, i);
    }
  }
  return out;
}

Ray ray_of_pixel(const Pinhole& c, int x, int y) {
  return {c.origin, c.near, primary_direction(c, static_cast<float>(x), static_cast<float>(y)), c.far};
}

// How far pixel centres are from a triangle's nearest edge on the screen, in pixels.
double edge_distance(const Pinhole& camera, const KdTriangle& t, int x, int y) {
  const Projection p = make_projection(camera, kSize, kSize, {});
  double px[3], py[3];
  for (size_t k = 0; k < 3; ++k) {
    const Vec3d d = to_double(test::corner_of(t, k)) - p.origin;
    const double w = dot(p.row_w, d);
    if (w <= 0) return 1e9;
    px[k] = dot(p.row_x, d) / w - (x + 0.5);
    py[k] = dot(p.row_y, d) / w - (y + 0.5);
  }
  double least = 1e9;
  for (int k = 0; k < 3; ++k) {
    const int n = (k + 1) % 3;
    const double ex = px[n] - px[k], ey = py[n] - py[k];
    const double s = std::clamp(-(px[k] * ex + py[k] * ey) / (ex * ex + ey * ey + 1e-300), 0.0, 1.0);
    least = std::min(least, std::hypot(px[k] + s * ex, py[k] + s * ey));
  }
  return least;
}

// Raster and tracer see the same triangle with the same bits; they may differ only where the pixel's
// centre lies within 1/128 pixel of an edge, or where two surfaces meet.
void compare_with_tracer(const std::vector<KdTriangle>& triangles, const Pinhole& camera, size_t least_same) {
  const test::Tree tree(triangles);
  const Mesh mesh = mesh_of(triangles);
  for (const Kernels* kernels : available_kernels()) {
    const Picture picture = rasterize(*kernels, camera, kSize, kSize, mesh);
    const std::vector<Hit> seen = see(*kernels, camera, picture, triangles);
    size_t same = 0;
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const Hit raster = seen[static_cast<size_t>(y * kSize + x)];
        const Hit traced = walk_closest(tree.view, ray_of_pixel(camera, x, y));
        if (raster.triangle == traced.triangle) {
          ASSERT_TRUE(test::same_bits(raster, traced)) << kernels->isa << " at " << x << "," << y;
          same += raster.triangle != kNoTriangle;
          continue;
        }
        const auto near_edge = [&](uint32_t t) {
          return t != kNoTriangle && edge_distance(camera, triangles[t], x, y) < 1.0 / 128;
        };
        const bool surfaces_meet = raster.triangle != kNoTriangle && traced.triangle != kNoTriangle &&
                                   absolute(raster.t - traced.t) < 1e-5f * traced.t;
        ASSERT_TRUE(near_edge(raster.triangle) || near_edge(traced.triangle) || surfaces_meet)
            << kernels->isa << " at " << x << "," << y << ": " << raster.triangle << " and "
            << traced.triangle;
      }
    }
    EXPECT_GT(same, least_same);
  }
}

TEST(RasterVisible, ASphereIsSeenAsTheTracerSeesIt) {
  compare_with_tracer(test::sphere({0.1f, 0.2f, -3}, 1.4f, 30), camera_at({0, 0, 0}, {0.05f, 0, -1}), 5000);
}
TEST(RasterVisible, ASoupIsSeenAsTheTracerSeesIt) {
  test::Random random(41);
  compare_with_tracer(test::soup(random, 3000, 0.2f), camera_at({0.5f, 0.3f, 2.5f}, {-0.1f, -0.1f, -1}),
                      8000);
}
TEST(RasterVisible, FromWithinASoupToo) {
  test::Random random(42);
  compare_with_tracer(test::soup(random, 1500, 0.6f), camera_at({0.1f, 0, 0.2f}, {1, 0.9f, -0.95f}), 15000);
}

TEST(RasterVisible, BarycentricsArePerspectiveCorrect) {
  test::Random random(43);
  size_t compared = 0;
  for (int round = 0; round < 20; ++round) {
    std::vector<KdTriangle> triangles;
    test::add_triangle(triangles, random.in_box(-3, 3) - Vec3{0, 0, 5}, random.in_box(-3, 3) - Vec3{0, 0, 5},
                       random.in_box(-3, 3) - Vec3{0, 0, 5});
    const Pinhole camera = camera_at({0, 0, 0}, {0.02f, 0.01f, -1});
    const Mesh mesh = mesh_of(triangles);
    const Kernels& kernels = *available_kernels()[static_cast<size_t>(round) % available_kernels().size()];
    const Picture picture = rasterize(kernels, camera, kSize, kSize, mesh);
    const std::vector<Hit> seen = see(kernels, camera, picture, triangles);
    const Vec3d a = to_double(mesh.positions[0]), b = to_double(mesh.positions[1]),
                c = to_double(mesh.positions[2]);
    const Vec3d n = cross(b - a, c - a);
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const Hit& hit = seen[static_cast<size_t>(y * kSize + x)];
        if (hit.triangle == kNoTriangle) continue;
        const Vec3d d = to_double(primary_direction(camera, static_cast<float>(x), static_cast<float>(y)));
        if (std::abs(dot(n, d)) < 0.05 * std::sqrt(dot(n, n)))
          continue;  // seen from the side: ill-conditioned
        const double t = dot(n, a) / dot(n, d);
        const Vec3d p = d * t - a;
        const double u = dot(cross(p, c - a), n) / dot(n, n), v = dot(cross(b - a, p), n) / dot(n, n);
        const double slack = edge_distance(camera, triangles[0], x, y) < 1.0 / 128 ? 1e-2 : 1e-5;
        ASSERT_NEAR(hit.t, t, slack * t);
        ASSERT_NEAR(hit.u, u, slack);
        ASSERT_NEAR(hit.v, v, slack);
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 10000u);
}

// Any triangle at any pixel: what the ray misses is answered with a point of the triangle.
TEST(RasterVisible, RaysThatMissGetAPointOfTheTriangle) {
  test::Random random(44);
  size_t missed = 0, from_the_side = 0;
  for (int round = 0; round < 300; ++round) {
    std::vector<KdTriangle> triangles;
    for (int i = 0; i < 64; ++i) {
      const float scale = std::array{1.0f, 1e-3f, 1e6f, 1e18f, 1e-30f}[random.below(5)];
      const Vec3 a = random.in_box(-1, 1) * scale, b = random.in_box(-1, 1) * scale;
      Vec3 c = random.in_box(-1, 1) * scale;
      if (random.below(4) == 0) c = (a + b) * 0.5f;
      if (random.below(8) == 0) c = a;
      test::add_triangle(triangles, a, b, c);
    }
    const Pinhole camera = camera_at({0, 0, 0}, random.direction() + Vec3{0.01f, 0, 0});
    uint32_t numbers[kPacketSize];
    for (uint32_t& n : numbers) n = random.below(5) == 0 ? kNoTriangle : random.below(64);
    const int x = 8 * between(random, 0, 15), y = 8 * between(random, 0, 15);
    HitPacket expected;
    available_kernels().front()->intersect_visible(camera, triangles.data(), x, y, numbers, expected);
    for (int i = 0; i < kPacketSize; ++i) {
      const Hit hit = hit_of(expected, i);
      ASSERT_EQ(hit.triangle, numbers[i]);
      if (hit.triangle == kNoTriangle) {
        ASSERT_TRUE(test::same_bits(hit, Hit{}));
        continue;
      }
      const Ray ray = ray_of_pixel(camera, x + i % 8, y + i / 8);
      const int z = dominant_axis(ray.direction);
      const Shear<float> shear = make_shear(permute(ray.direction, z));
      Vec3 p[3];
      for (size_t k = 0; k < 3; ++k)
        p[k] = project(permute(test::corner_of(triangles[hit.triangle], k), z), shear);
      const auto exact = surround_origin(p[0], p[1], p[2], shear);
      if (exact.hit && exact.t > 0) {
        ASSERT_TRUE(test::same_bits(hit, {exact.t, exact.u, exact.v, hit.triangle}));
        continue;
      }
      ASSERT_TRUE(hit.u >= 0 && hit.v >= 0 && hit.u + hit.v <= 1) << hit.u << " " << hit.v;
      ASSERT_TRUE(hit.t >= camera.near && hit.t <= camera.far) << hit.t;
      ++missed;
      from_the_side += edge_values(p[0], p[1], p[2]).det == 0;
    }
    for (const Kernels* kernels : available_kernels()) {
      HitPacket hits;
      kernels->intersect_visible(camera, triangles.data(), x, y, numbers, hits);
      for (int i = 0; i < kPacketSize; ++i)
        ASSERT_TRUE(test::same_bits(hit_of(hits, i), hit_of(expected, i))) << kernels->isa;
    }
  }
  EXPECT_GT(missed, 10000u);
  EXPECT_GT(from_the_side, 500u);
}

// A pixel that only the snapped triangle covers.
TEST(RasterVisible, JustOutsideAnEdgeTheNearbyPointIsClose) {
  std::vector<KdTriangle> triangles;
  const Vec3 a = at_pixel(10.501f, 0, 2), b = at_pixel(10.501f, 64, 4), c = at_pixel(60, 32, 3);
  test::add_triangle(triangles, a, b, c);
  const Mesh mesh = mesh_of(triangles);
  const Pinhole camera = pixel_camera();
  for (const Kernels* kernels : available_kernels()) {
    const Picture picture = rasterize(*kernels, camera, kSize, kSize, mesh);
    const std::vector<Hit> seen = see(*kernels, camera, picture, triangles);
    for (int y = 1; y < 63; ++y) {
      const Hit& hit = seen[static_cast<size_t>(y * kSize + 10)];  // its centre is 1/1000 pixel outside
      ASSERT_EQ(hit.triangle, 0u);
      ASSERT_EQ(hit.v, 0.0f);
      const float depth = 1 / (0.5f + (0.25f - 0.5f) * ((static_cast<float>(y) + 0.5f) / 64));
      ASSERT_NEAR(hit.t, depth, 0.001f);
    }
  }
}

// A ray above the horizon of a ground that also runs far behind the camera.
TEST(RasterVisible, PastTheHorizonTheDepthStaysInFront) {
  std::vector<KdTriangle> triangles;
  test::add_triangle(triangles, {-1e8f, -1, -1e8f}, {1e8f, -1, -1e8f}, {0, -1, 3e8f});
  const Pinhole camera = camera_at({0, 0, 0}, {0, 0, -1});
  uint32_t numbers[kPacketSize] = {};
  for (const Kernels* kernels : available_kernels()) {
    HitPacket hits;
    kernels->intersect_visible(camera, triangles.data(), 64, 56, numbers, hits);  // y 56..63: the sky
    for (int i = 0; i < kPacketSize; ++i) {
      ASSERT_TRUE(hits.t[i] == camera.far && hits.u[i] + hits.v[i] <= 1) << hits.t[i];
    }
  }
}

bool checker_is_there(const void*, uint32_t triangle, float u, float v) {
  return ((static_cast<int>(u * 9) + static_cast<int>(v * 9) + static_cast<int>(triangle)) & 1) == 0;
}

TEST(RasterVisible, CutOutsAreTheTracersCutOuts) {
  test::Random random(45);
  std::vector<KdTriangle> triangles = test::soup(random, 60, 1.2f);
  for (size_t i = 0; i < triangles.size(); i += 2) triangles[i].flags = kCutOutTriangle;
  const CutOuts cut_outs{checker_is_there, nullptr};
  const test::Tree tree(triangles, cut_outs);
  const Pinhole camera = camera_at({0.3f, 0.2f, 3}, {-0.05f, -0.05f, -1});
  const Mesh mesh = mesh_of(triangles);
  Options options;
  options.triangles = triangles.data();
  options.cut_outs = &cut_outs;
  const Picture whole = rasterize(*available_kernels().front(), camera, kSize, kSize, mesh);
  for (const Kernels* kernels : available_kernels()) {
    const Picture picture = rasterize(*kernels, camera, kSize, kSize, mesh, options);
    const std::vector<Hit> seen = see(*kernels, camera, picture, triangles);
    size_t same = 0, cut = 0, through = 0, different = 0;
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const Hit& raster = seen[static_cast<size_t>(y * kSize + x)];
        const Hit traced = walk_closest(tree.view, ray_of_pixel(camera, x, y));
        through += picture.at(x, y) != whole.at(x, y);
        if (raster.triangle == kNoTriangle && traced.triangle == kNoTriangle) continue;
        if (raster.triangle != traced.triangle) {
          ++different;
          continue;
        }
        ASSERT_TRUE(test::same_bits(raster, traced));
        ++same;
        if (triangles[raster.triangle].flags & kCutOutTriangle) {
          ASSERT_TRUE(checker_is_there(nullptr, raster.triangle, raster.u, raster.v));
          ++cut;
        }
      }
    }
    EXPECT_GT(same, 8000u) << kernels->isa;
    EXPECT_GT(cut, 2000u);
    EXPECT_GT(through, 2000u);
    EXPECT_LE(different, 20u);  // pixels at an edge
  }
}

TEST(RasterVisible, CutOutsOfAFewPixelsHaveTheirHoles) {
  test::Random random(46);
  std::vector<KdTriangle> triangles;
  for (int i = 0; i < 20000; ++i) {
    Vec3 p[3];
    const float x = random.between(2, 120), y = random.between(2, 120);
    for (Vec3& v : p) {
      const float dx = random.between(0, 3), dy = random.between(0, 3);
      v = at_pixel(x + dx, y + dy, random.between(2, 9));
    }
    test::add_triangle(triangles, p[0], p[1], p[2], i % 4 == 0 ? 0u : kCutOutTriangle);
  }
  const CutOuts cut_outs{checker_is_there, nullptr};
  Options options;
  options.triangles = triangles.data();
  options.cut_outs = &cut_outs;
  const Mesh mesh = mesh_of(triangles);
  for (const Kernels* kernels : available_kernels()) {
    const Picture whole = rasterize(*kernels, pixel_camera(), kSize, kSize, mesh);
    const Picture picture = rasterize(*kernels, pixel_camera(), kSize, kSize, mesh, options);
    size_t cut = 0, solid = 0, through = 0;
    const std::vector<Hit> seen = see(*kernels, pixel_camera(), picture, triangles);
    for (size_t i = 0; i < seen.size(); ++i) {
      through += picture.triangle[i] != whole.triangle[i];
      if (seen[i].triangle == kNoTriangle) continue;
      const bool is_cut_out = triangles[seen[i].triangle].flags != 0;
      ASSERT_TRUE(!is_cut_out || checker_is_there(nullptr, seen[i].triangle, seen[i].u, seen[i].v));
      (is_cut_out ? cut : solid) += 1;
    }
    EXPECT_GT(cut, 2000u) << kernels->isa;
    EXPECT_GT(solid, 1000u);
    EXPECT_GT(through, 2000u);
  }
}

TEST(RasterVisible, WithoutTheRuleCutOutsAreSolid) {
  std::vector<KdTriangle> triangles;
  test::add_triangle(triangles, at_pixel(0, 0, 2), at_pixel(64, 0, 2), at_pixel(0, 64, 2), kCutOutTriangle);
  Options options;
  options.triangles = triangles.data();
  const Picture p =
      rasterize(*available_kernels().back(), pixel_camera(), 64, 64, mesh_of(triangles), options);
  EXPECT_EQ(p.covered(), 64u * 65 / 2 - 64);
}

}  // namespace
}  // namespace vitral
