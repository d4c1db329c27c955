// Where the samples of a light lie: the same for every instruction set, in their strata, and on the light.
#include "kernels/kernels.h"
#include "math/light.h"
#include "math/strata.h"
#include "render/kernel_choice.h"
#include "support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

namespace vitral::test {
namespace {

Light panel() {
  Light light;
  light.kind = Light::Kind::rectangle;
  light.position = {0.25f, 2, -0.5f};
  light.direction = {0, -1, 0};
  light.side_u = {2, 0, 0};
  light.side_v = {0, 0, 4};
  return light;
}
Light ball(const Vec3& position = {0.5f, 3, 1}, float radius = 0.75f) {
  Light light;
  light.kind = Light::Kind::sphere;
  light.position = position;
  light.radius = radius;
  return light;
}
Light disk(const Vec3& direction = {0.3f, -1, 0.2f}, float diameter = 8) {
  Light light;
  light.kind = Light::Kind::sun;
  light.direction = normalize(direction);
  light.diameter_degrees = diameter;
  return light;
}

// Points on a floor, some of them dead, some beyond a light's reach.
PointPacket points_on_floor() {
  PointPacket p{};
  Random random(5);
  for (int lane = 0; lane < kPacketSize; ++lane) {
    p.px[lane] = random.between(-3, 3), p.pz[lane] = random.between(-3, 3);
    p.py[lane] = random.between(-0.5f, 0.5f);
    const Vec3 n = normalize(Vec3{0, 1, 0} + random.in_box(-0.8f, 0.8f));
    p.nx[lane] = n.x, p.ny[lane] = n.y, p.nz[lane] = n.z;
    p.gy[lane] = 1;
    p.offset[lane] = 1e-3f;
    p.key[lane] = random.bits();
  }
  p.live = 0xffff00ffffffff7eull;
  return p;
}

TEST(Strata, TheCellsOfASetHoldOneSampleEach) {
  Random random(1);
  for (uint32_t n = 1; n <= 1024; n *= 2) {
    for (int round = 0; round < 20; ++round) {
      const uint32_t key = random.bits(), sets = 1 + random.below(5), set = random.below(sets);
      const uint32_t columns = 1u << ((31 - __builtin_clz(n)) / 2), rows = n / columns;
      std::set<uint32_t> seen;
      for (uint32_t k = 0; k < n; ++k) {
        const uint32_t i = sample_in_cell(k, n, key);
        ASSERT_LT(i, n);
        seen.insert(i);
        const Pair<float> p = stratified_pair(set * n + i, sets * n, key);
        const float part = p.u * static_cast<float>(sets) - static_cast<float>(set);
        ASSERT_NEAR(part, (static_cast<float>(k / columns) + 0.5f) / static_cast<float>(rows),
                    0.501f / static_cast<float>(rows));
        ASSERT_EQ(static_cast<uint32_t>(p.v * static_cast<float>(columns)), k % columns);
      }
      ASSERT_EQ(seen.size(), n) << "every sample once";
    }
  }
}

TEST(Strata, ShuffledIsAnOrderThatDependsOnTheKey) {
  std::vector<int> places(5, 0);
  for (const uint32_t count : {1u, 2u, 5u, 16u, 100u}) {
    for (uint32_t key = 0; key < 200; ++key) {
      std::set<uint32_t> seen;
      for (uint32_t i = 0; i < count; ++i) seen.insert(shuffled(i, count, hash32(key)));
      ASSERT_EQ(seen.size(), count);
      ASSERT_LT(*seen.rbegin(), count);
      if (count == 5) ++places[shuffled(2u, count, hash32(key))];
    }
  }
  for (const int n : places) EXPECT_NEAR(n, 40, 30) << "all places come up";
}

class LightRaysOfEveryIsa : public testing::TestWithParam<const Kernels*> {};

TEST_P(LightRaysOfEveryIsa, AreThoseOfTheFormulas) {
  const PointPacket points = points_on_floor();
  size_t facing = 0;
  for (const Light& light : {panel(), ball(), ball({0, 0, 0}, 1.5f), disk()}) {
    const LightShape shape = shape_of(light);
    for (const LightDraw& draw : {LightDraw{0, 1, 1, 7}, LightDraw{0, 1, 16, 8}, LightDraw{2, 5, 3, 9}}) {
      for (uint32_t k = 0; k < draw.samples; ++k) {
        RayPacket rays;
        LightSamples out;
        GetParam()->light_rays(shape, draw, k, points, rays, out);
        ASSERT_EQ(rays.live & ~points.live, 0u);
        for (uint64_t left = points.live; left != 0; left &= left - 1) {
          const int lane = __builtin_ctzll(left);
          const uint32_t key = branch_key(points.key[lane], draw.branch);
          const bool cells = (draw.samples & (draw.samples - 1)) == 0;
          const uint32_t index = shuffled(draw.frame, draw.frames, hash32(key)) * draw.samples +
                                 (cells ? sample_in_cell(k, draw.samples, key) : k);
          const Pair<float> pair = stratified_pair(index, draw.frames * draw.samples, key);
          const Vec3 p{points.px[lane], points.py[lane], points.pz[lane]};
          const LightSample<float> s =
              light.kind == Light::Kind::rectangle ? sample_rectangle(shape, p, pair.u, pair.v)
              : light.kind == Light::Kind::sphere  ? sample_sphere(shape, p, pair.u, pair.v)
                                                   : sample_sun<float>(shape, pair.u, pair.v);
          const float cosine = dot(s.direction, {points.nx[lane], points.ny[lane], points.nz[lane]});
          ASSERT_EQ(rays.live >> lane & 1, cosine > 0 && s.strength > 0 ? 1u : 0u);
          ASSERT_EQ(out.x[lane], s.direction.x);
          ASSERT_EQ(out.irradiance[lane], s.strength * cosine);
          ASSERT_NEAR(length(s.direction), 1, 2e-6f);
          const Ray ray = ray_of(rays, lane);
          ASSERT_EQ(ray.origin.y, points.py[lane] + 1e-3f);
          if (light.kind == Light::Kind::sun) {
            ASSERT_EQ(ray.direction, s.direction);
            ASSERT_EQ(ray.tmax, kInfinity);
          } else {
            ASSERT_EQ(ray.direction, s.target - ray.origin);
            ASSERT_LT(ray.tmax, 1);
            ASSERT_GT(ray.tmax, 0.99f);
          }
          facing += rays.live >> lane & 1;
        }
      }
    }
  }
  EXPECT_GT(facing, 2000u);
}

// All samples of a picture of several per pixel are one set: each of its cells holds one.
TEST_P(LightRaysOfEveryIsa, GoThroughAllStrataOfAPixel) {
  const Light light = panel();
  const LightShape shape = shape_of(light);
  PointPacket points = points_on_floor();
  constexpr uint32_t kFrames = 8, kSamples = 8;
  std::vector<std::set<int>> cells(kPacketSize), rows(kPacketSize);
  std::vector<std::set<float>> first(kPacketSize);
  for (uint32_t frame = 0; frame < kFrames; ++frame) {
    for (uint32_t k = 0; k < kSamples; ++k) {
      RayPacket rays;
      LightSamples out;
      GetParam()->light_rays(shape, {frame, kFrames, kSamples, 1}, k, points, rays, out);
      for (uint64_t left = points.live; left != 0; left &= left - 1) {
        const int lane = __builtin_ctzll(left);
        const Ray ray = ray_of(rays, lane);
        const Vec3 target = ray.origin + ray.direction;
        const float u = (target.x - shape.position.x) / 2, v = (target.z - shape.position.z) / 4;
        ASSERT_TRUE(u > -1e-5f && u < 1.00001f && v > -1e-5f && v < 1.00001f);
        ASSERT_NEAR(target.y, 2, 1e-5f);
        // Rounding may move a sample over a border: those on one are left out.
        const auto cell = [](float x, int n) {
          const float at = x * static_cast<float>(n), whole = std::floor(at);
          return at - whole < 1e-3f || at - whole > 0.999f ? -1 : static_cast<int>(whole);
        };
        const int row = cell(u, 64), x = cell(u, 8), y = cell(v, 8);
        if (row >= 0) {
          EXPECT_TRUE(rows[static_cast<size_t>(lane)].insert(row).second);
        }
        if (x >= 0 && y >= 0) {
          EXPECT_TRUE(cells[static_cast<size_t>(lane)].insert(8 * y + x).second);
        }
        if (k == 0) first[static_cast<size_t>(lane)].insert(std::floor(u * kFrames));
      }
    }
  }
  // The sets come in another order in every pixel.
  std::set<int> orders;
  for (uint64_t left = points.live; left != 0; left &= left - 1) {
    const auto lane = static_cast<size_t>(__builtin_ctzll(left));
    EXPECT_GE(cells[lane].size(), 58u);
    EXPECT_GE(rows[lane].size(), 58u);
    RayPacket rays;
    LightSamples out;
    GetParam()->light_rays(shape, {0, kFrames, kSamples, 1}, 0, points, rays, out);
    const Ray ray = ray_of(rays, static_cast<int>(lane));
    orders.insert(static_cast<int>((ray.origin.x + ray.direction.x - shape.position.x) / 2 * kFrames));
  }
  EXPECT_EQ(orders.size(), kFrames);
}

// The targets lie on the near side of the sphere; from inside, anywhere on it.
TEST_P(LightRaysOfEveryIsa, EndOnTheSphere) {
  const PointPacket points = points_on_floor();
  for (const Light& light : {ball(), ball({100, 300, 20}, 0.1f), ball({0, 0, 0}, 9)}) {
    const bool inside = light.radius == 9;
    int far_side = 0;
    for (uint32_t k = 0; k < 16; ++k) {
      RayPacket rays;
      LightSamples out;
      GetParam()->light_rays(shape_of(light), {0, 1, 16, 1}, k, points, rays, out);
      for (uint64_t left = points.live; left != 0; left &= left - 1) {
        const int lane = __builtin_ctzll(left);
        const Vec3 p{points.px[lane], points.py[lane], points.pz[lane]};
        const Ray ray = ray_of(rays, lane);
        const Vec3 target = ray.origin + ray.direction, way = light.position - p;
        const float size = length(way) * 1e-6f + 1e-5f;
        ASSERT_NEAR(length(target - light.position), light.radius, size + 0.01f * light.radius);
        far_side += dot(target - light.position, way) > size;
      }
    }
    EXPECT_EQ(far_side > 0, inside);
  }
}

INSTANTIATE_TEST_SUITE_P(Trace, LightRaysOfEveryIsa, testing::ValuesIn(available_kernels()),
                         [](const auto& instance) { return std::string(instance.param->isa); });

TEST(LightSample, PointsInTheMiddleOfASphereAreLitFromAllAround) {
  const LightShape shape = shape_of(ball({1, 2, 3}, 0.5f));
  double sum = 0;
  for (uint32_t i = 0; i < 4096; ++i) {
    const Pair<float> pair = stratified_pair(i, 4096, 77u);
    const LightSample<float> s = sample_sphere(shape, Vec3{1, 2, 3}, pair.u, pair.v);
    ASSERT_NEAR(length(s.direction), 1, 1e-5f);
    sum += static_cast<double>(s.strength * greatest(s.direction.z, 0.0f));
  }
  EXPECT_NEAR(sum / 4096, 1 / 0.25, 0.01) << "pi L, L the radiance 1 / (pi r^2)";
}

TEST(LightSample, ASpotFadesSmoothlyBetweenItsCones) {
  Light light;
  light.kind = Light::Kind::spot;
  light.inner_degrees = 20, light.outer_degrees = 50;
  const auto share = [&](double degrees) {
    const double a = degrees * 3.14159265358979323846 / 180;
    return static_cast<double>(
        spot_share(spot_cone(light), Vec3{0, 0, -1},
                   Vec3{static_cast<float>(std::sin(a)), 0, static_cast<float>(std::cos(a))}));
  };
  const double pi = 3.14159265358979323846, inner = std::cos(20 * pi / 180), outer = std::cos(50 * pi / 180);
  for (double degrees = 0; degrees < 180; degrees += 0.7) {
    const double t = std::clamp((std::cos(degrees * pi / 180) - outer) / (inner - outer), 0.0, 1.0);
    ASSERT_NEAR(share(degrees), t * t * (3 - 2 * t), 1e-5) << degrees;
  }
  EXPECT_EQ(share(19.9), 1);
  EXPECT_GT(share(49.9), 0);
  EXPECT_EQ(share(50.1), 0);
  light.inner_degrees = 50;
  EXPECT_EQ(share(49.99), 1) << "an edge without a width";
  EXPECT_EQ(share(50.01), 0);
  const SpotCone cone = spot_cone(light);
  EXPECT_EQ(spot_share(cone, Vec3{0, 0, -1}, Vec3{std::sqrt(1 - cone.outer * cone.outer), 0, cone.outer}), 0)
      << "the outer cone itself is dark";
}

}  // namespace
}  // namespace vitral::test
