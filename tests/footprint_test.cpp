// Footprints against the exact hits of neighbouring rays, and lookups where the texture is magnified.
#include "kernels/footprint.h"

#include "math/footprint.h"
#include "render/kernel_choice.h"
#include "render/texture.h"
#include "texture_support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace vitral::test {
namespace {

// Texture coordinates where a ray meets a triangle's plane, in double.
struct Plane {
  Vec3d a, b, c;
  std::array<Vec2, 3> texcoord;
};
Vec2T<double> texcoord_of(const Plane& p, const Vec3d& origin, const Vec3d& d) {
  const Vec3d n = cross(p.b - p.a, p.c - p.a);
  const Vec3d at = origin + d * (dot(n, p.a - origin) / dot(n, d)) - p.a;
  const double u = dot(cross(at, p.c - p.a), n) / dot(n, n), v = dot(cross(p.b - p.a, at), n) / dot(n, n);
  const auto mix = [&](float Vec2::*part) {
    const auto value = [&](size_t k) { return static_cast<double>(p.texcoord[k].*part); };
    return value(0) + u * (value(1) - value(0)) + v * (value(2) - value(0));
  };
  return {mix(&Vec2::x), mix(&Vec2::y)};
}

// Half and full axes of the ellipse of conjugate diameters a and b, by trying 100000 directions.
struct Axes {
  double major, minor;
  Vec2T<double> along;  // the longer one
};
Axes axes_of(const Vec2T<double>& a, const Vec2T<double>& b) {
  Axes out{0, 1e300, {0, 0}};
  for (int i = 0; i < 20000; ++i) {
    const double angle = 3.14159265358979 * i / 20000, s = std::sin(angle), c = std::cos(angle);
    const Vec2T<double> p{a.x * c + b.x * s, a.y * c + b.y * s};
    const double r = std::hypot(p.x, p.y);
    if (r > out.major) out.major = r, out.along = p;
    out.minor = std::min(out.minor, r);
  }
  return out;
}

// A block of pixels that look at one triangle each, all of them seen by all.
struct Block {
  RayPacket rays{};
  HitPacket hits{};
  PointPacket points{};
  TexturedLanes textures{};
  std::vector<KdTriangle> triangles;
  std::vector<Plane> planes;
};
Block make_block(Random& random, const Kernels& kernels, const Pinhole& camera) {
  Block b;
  kernels.primary_rays(camera, 40, 16, b.rays);
  b.rays.live = ~0ull;
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const auto i = static_cast<size_t>(lane);
    const Ray ray = ray_of(b.rays, lane);
    const Vec3 at = ray.origin + ray.direction * random.between(1, 30);
    const Vec3 p = at + random.in_box(-1, 1), q = at + random.in_box(-1, 1);
    const Vec3 r = at * 3 - p - q;  // around the point
    add_triangle(b.triangles, p, q, r);
    Plane plane{to_double(p), to_double(q), to_double(r), {}};
    const uint32_t largest = lane % 2 ? 1024 : 16;  // seen small, seen large
    b.textures.columns[lane] = static_cast<float>(1 + random.below(largest));
    b.textures.rows[lane] = static_cast<float>(1 + random.below(largest));
    for (size_t k = 0; k < 3; ++k) {
      plane.texcoord[k] = {random.between(-2, 2), random.between(-2, 2)};
      b.textures.u[k][lane] = plane.texcoord[k].x, b.textures.v[k][lane] = plane.texcoord[k].y;
    }
    b.planes.push_back(plane);
    const KdTriangle& t = b.triangles[i];
    const Vec3d n = cross(plane.b - plane.a, plane.c - plane.a);
    const double depth = dot(n, plane.a - to_double(ray.origin)) / dot(n, to_double(ray.direction));
    const Vec3d hit = to_double(ray.origin) + to_double(ray.direction) * depth - plane.a;
    const double u = dot(cross(hit, plane.c - plane.a), n) / dot(n, n);
    const double v = dot(cross(plane.b - plane.a, hit), n) / dot(n, n);
    set_hit(b.hits, lane,
            {static_cast<float>(depth), static_cast<float>(u), static_cast<float>(v),
             static_cast<uint32_t>(&t - b.triangles.data())});
  }
  kernels.surface_points(b.triangles.data(), b.rays, b.hits, {0}, b.points);
  return b;
}

// How the texture coordinates of the exact hit change over one pixel, by central differences.
std::array<Vec2T<double>, 2> differences(const Pinhole& c, const Plane& plane, int lane) {
  std::array<Vec2T<double>, 2> out;
  const double h = 1e-3;
  for (size_t axis = 0; axis < 2; ++axis) {
    Vec2T<double> at[2];
    for (int end = 0; end < 2; ++end) {
      const double shift = end ? h : -h;
      const double x = 40 + lane % 8 + 0.5 + (axis == 0 ? shift : 0),
                   y = 16 + lane / 8 + 0.5 + (axis == 1 ? shift : 0);
      const double a = x * static_cast<double>(c.step) - static_cast<double>(c.center_x);
      const double b = static_cast<double>(c.center_y) - y * static_cast<double>(c.step);
      at[end] = texcoord_of(plane, to_double(c.origin),
                            to_double(c.forward) + to_double(c.right) * a + to_double(c.up) * b);
    }
    out[axis] = {(at[1].x - at[0].x) / (2 * h), (at[1].y - at[0].y) / (2 * h)};
  }
  return out;
}

TEST(TextureFootprint, IsTheDerivativeOfTheExactHit) {
  const Pinhole camera = make_pinhole(camera_at({0.3f, 0.2f, 1}, {0.3f, -0.2f, -1}), 128, 96);
  for (const Kernels* kernels : available_kernels()) {
    Random random(91);
    size_t compared = 0, long_ones = 0, magnified = 0;
    for (int round = 0; round < 8; ++round) {
      const Block b = make_block(random, *kernels, camera);
      Footprints f;
      kernels->texture_footprints(b.triangles.data(), b.hits, b.points, {&camera, nullptr}, b.textures, ~0ull,
                                  f);
      for (int lane = 0; lane < kPacketSize; ++lane) {
        const double facing = std::abs(static_cast<double>(b.points.gx[lane] * b.points.vx[lane] +
                                                           b.points.gy[lane] * b.points.vy[lane] +
                                                           b.points.gz[lane] * b.points.vz[lane]));
        const Plane& plane = b.planes[static_cast<size_t>(lane)];
        const double area = length(cross(plane.b - plane.a, plane.c - plane.a));
        if (facing < 0.02 || area < 0.05) continue;  // ill-conditioned
        auto d = differences(camera, plane, lane);
        const double columns = static_cast<double>(b.textures.columns[lane]),
                     rows = static_cast<double>(b.textures.rows[lane]);
        for (Vec2T<double>& v : d) v = {v.x * columns, v.y * rows};
        const Axes axes = axes_of(d[0], d[1]);
        const double width = std::max({axes.minor, axes.major / static_cast<double>(kMaxAnisotropy), 1.0});
        const double row = std::max(axes.major / width - static_cast<double>(kProbeOverlap), 1.0);
        const double got_width = static_cast<double>(f.width[lane]), got = static_cast<double>(f.count[lane]);
        ASSERT_NEAR(got_width, width, 2e-3 * width + 1e-3 * axes.major / 16) << kernels->isa;
        ASSERT_TRUE(got == std::ceil(row * 0.99) || got == std::ceil(row * 1.01)) << kernels->isa;
        ASSERT_LE(got, static_cast<double>(kMaxAnisotropy));
        if (row > 1.5 && axes.major > 2 * axes.minor) {
          // The probes lie along the longer axis and spread as a box of the row's length does.
          const Vec2T<double> step{static_cast<double>(f.step_u[lane]) * columns,
                                   static_cast<double>(f.step_v[lane]) * rows};
          const double along = std::abs(step.x * axes.along.x + step.y * axes.along.y) / axes.major;
          const double variance = along * along * (got * got - 1) / 12;
          ASSERT_NEAR(variance, width * width * (row * row - 1) / 12, 0.03 * variance) << kernels->isa;
          ASSERT_NEAR(std::hypot(step.x, step.y), along, 1e-2 * along);
          ++long_ones;
        }
        if (axes.major < 0.999) {
          ASSERT_EQ(f.width[lane], 1.0f);
          ASSERT_EQ(f.count[lane], 1.0f);
          ++magnified;
        }
        ++compared;
      }
    }
    EXPECT_GT(compared, 400u);
    EXPECT_GT(long_ones, 100u);
    EXPECT_GT(magnified, 20u);
  }
}

// A cone sees of a plane what a pixel of its width would: across, its diameter; along the slope, as much more
// as the plane is turned away.
TEST(TextureFootprint, OfAConeGrowsWithTheSlope) {
  for (const Kernels* kernels : available_kernels()) {
    for (const float cosine : {1.0f, 0.5f, 0.25f, 0.1f}) {
      const float sine = std::sqrt(1 - cosine * cosine);
      Block b;
      add_triangle(b.triangles, {-9, 0, 9}, {9, 0, 9}, {0, 0, -9});
      float diameter[kPacketSize];
      for (int lane = 0; lane < kPacketSize; ++lane) {
        const Vec3 d{0, -cosine, -sine};
        set_ray(b.rays, lane, {d * -2, 0, d, kInfinity});
        set_hit(b.hits, lane, {2, 0.25f, 0.5f, 0});
        diameter[lane] = 0.5f;
        b.textures.u[0][lane] = -9, b.textures.u[1][lane] = 9, b.textures.u[2][lane] = 0;
        b.textures.v[0][lane] = -9, b.textures.v[1][lane] = -9, b.textures.v[2][lane] = 9;
        b.textures.columns[lane] = b.textures.rows[lane] = 32;
      }
      b.rays.live = ~0ull;
      kernels->surface_points(b.triangles.data(), b.rays, b.hits, {0}, b.points);
      Footprints f;
      kernels->texture_footprints(b.triangles.data(), b.hits, b.points, {nullptr, diameter}, b.textures,
                                  ~0ull, f);
      EXPECT_NEAR(f.width[5], 16, 1e-3);
      EXPECT_EQ(f.count[5], std::ceil(std::max(1 / cosine - kProbeOverlap, 1.0f)));
    }
  }
}

TEST(TextureFootprint, IsFiniteWhateverItIsMadeOf) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  const Texture t = checkerboard(37, 20, 3);
  const MipMap map = make_mip_map(t, nullptr);
  for (const float a : {0.0f, 1e-30f, 1.0f, 1e20f, inf, -inf, nan}) {
    for (const float b : {0.0f, -1e-30f, 2.0f, -3e30f, inf, nan}) {
      for (const float center : {0.3f, -7e9f, inf, nan}) {
        const Footprint<float> f = make_footprint<float>({a, b}, {b, a * 0.5f}, 37, 20);
        EXPECT_TRUE(f.width >= 1 && f.count >= 1 && f.count <= kMaxAnisotropy);
        EXPECT_TRUE(std::isfinite(f.step.x) && std::isfinite(f.step.y) && std::isfinite(f.width));
        const Vec3 c = sample_color(map, {center, 0.2f}, f.step, f.width, f.count);
        EXPECT_TRUE(c.x >= 0 && c.x <= 1.0001f) << a << " " << b << " " << center;
      }
    }
  }
}

// The bilinear lookup as it is defined, one rounding after the other.
Vec3 plain_bilinear(const Texture& t, float u, float v) {
  u -= std::floor(u), v -= std::floor(v);
  if (!(u < 1)) u = 0;
  if (!(v < 1)) v = 0;
  const float x = u * static_cast<float>(t.width) - 0.5f, y = (1 - v) * static_cast<float>(t.height) - 0.5f;
  const float fx = x - std::floor(x), fy = y - std::floor(y);
  const float weight[4] = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
  Vec3 sum{0, 0, 0};
  for (int k = 0; k < 4; ++k) {
    const int i = (static_cast<int>(std::floor(x)) + k % 2 + t.width) % t.width;
    const int j = (static_cast<int>(std::floor(y)) + k / 2 + t.height) % t.height;
    const uint8_t* c = &t.texels[static_cast<size_t>(4 * (j * t.width + i))];
    sum += Vec3{kLinearOfSrgb[c[0]], kLinearOfSrgb[c[1]], kLinearOfSrgb[c[2]]} * weight[k];
  }
  return sum;
}

TEST(TextureLookup, MagnifiedIsBilinearInTheFinestLevel) {
  Random random(17);
  for (const auto& [width, height] : {std::pair{1, 1}, {16, 16}, {7, 3}, {1, 5}, {640, 2}}) {
    Texture t{"noise", width, height, {}};
    for (int i = 0; i < 4 * width * height; ++i) t.texels.push_back(static_cast<uint8_t>(random.below(256)));
    const MipMap map = make_mip_map(t, nullptr);
    for (int i = 0; i < 5000; ++i) {
      float u = random.between(-3, 3), v = random.between(-3, 3);
      if (i % 7 == 0) u = std::floor(u);
      if (i % 11 == 0) v = std::nextafter(std::floor(v), -9.0f);
      const Vec3 expected = plain_bilinear(t, u, v);
      ASSERT_EQ(sample_color(map, {u, v}, {0.25f, 0.5f}, 1, 1), expected) << u << " " << v;
    }
  }
}

}  // namespace
}  // namespace vitral::test
