// Secondary rays start off their surfaces by a bound on rounding: never do they meet the triangle they start
// from, and what stands next to it still casts its shadow.
#include "kernels/ray_offset.h"

#include "kernels/kernels.h"
#include "kernels/shading.h"
#include "math/sampling.h"
#include "render/kernel_choice.h"
#include "support.h"
#include "vitral/affine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace vitral::test {
namespace {

Vec3 front_of(const KdTriangle& t) {
  return facet_normal(corner_of(t, 0), corner_of(t, 1), corner_of(t, 2));
}
float offset_of(const KdTriangle& t) {
  return ray_offset(corner_of(t, 0), corner_of(t, 1), corner_of(t, 2), front_of(t));
}

// Any shape, from equilateral to slivers a 4000th as high as long, 1e-6 to 1e6 across, up to 1e5 away from
// the origin; but its corners are distinct and not on one line after rounding.
KdTriangle any_triangle(Random& random) {
  for (;;) {
    const float size = std::pow(10.0f, random.between(-6, 6));
    const float away = random.below(2) ? 0 : std::pow(10.0f, random.between(-6, 5));
    const Vec3 at = random.direction() * away, along = random.direction() * size;
    const float thin = std::exp2(-random.between(0, random.below(2) ? 1.0f : 12.0f));
    Vec3 a = at, b = at + along, c = at + along * random.unit() + random.direction() * (size * thin);
    if (random.below(4) == 0) a.y = b.y = c.y = at.y;  // level, as floors are
    const Vec3d ab = to_double(b) - to_double(a), ac = to_double(c) - to_double(a);
    const Vec3d n = cross(ab, ac);
    if (!(dot(n, n) > 1e-8 * dot(ab, ab) * dot(ac, ac))) continue;
    std::vector<KdTriangle> out;
    add_triangle(out, a, b, c);
    return out.front();
  }
}

Vec3 any_point(Random& random, const KdTriangle& t) {
  float u = random.unit(), v = random.unit();
  if (u + v > 1) u = 1 - u, v = 1 - v;
  const uint32_t where = random.below(8);
  if (where == 0) u = 0;
  if (where == 1) v = 0;
  if (where == 2) v = 1 - u;
  if (where == 3) u = v = 0;
  const Vec3 a = corner_of(t, 0);
  return (a + (corner_of(t, 1) - a) * u) + (corner_of(t, 2) - a) * v;
}

// Over the plane by the kernels' own test; half of them graze it.
Vec3 any_rising(Random& random, const Vec3& normal) {
  for (;;) {
    Vec3 d = random.direction();
    if (random.below(2)) d = d - normal * dot(d, normal) + normal * std::exp2(-random.between(4, 24));
    d = normalize(d);
    if (random.below(4) == 0) d = d * std::exp2(random.between(-20, 20));
    if (dot(d, normal) > 0) return d;
  }
}

bool meets(const KdTriangle& t, const Vec3& origin, const Vec3& d) {
  KdView view{};
  view.triangles = &t;
  return brute_force_closest(view, 1, {origin, 0, d, kInfinity}, GlassRule::blocks).triangle != kNoTriangle;
}

struct Reintersections {
  size_t points = 0, hits = 0;
};
Reintersections reintersect(uint32_t seed, int triangles, float part_of_offset) {
  Random random(seed);
  Reintersections sum;
  for (int i = 0; i < triangles; ++i) {
    const KdTriangle t = any_triangle(random);
    const Vec3 front = front_of(t);
    const float offset = offset_of(t) * part_of_offset;
    for (int k = 0; k < 8; ++k) {
      const Vec3 n = random.below(2) ? front : -front, p = any_point(random, t);
      ++sum.points;
      sum.hits += meets(t, p + n * offset, any_rising(random, n));
    }
  }
  return sum;
}

TEST(RayOffset, NoRayMeetsTheTriangleItStartsFrom) {
  const Reintersections whole = reintersect(1, 130000, 1);
  EXPECT_GT(whole.points, 1000000u);
  EXPECT_EQ(whole.hits, 0u);
}

// Half of it is not enough for all of them, a quarter for one in 200: there is little to take away.
TEST(RayOffset, IsNoMoreThanTwiceWhatIsNeeded) {
  EXPECT_GT(reintersect(2, 40000, 0.5f).hits, 0u);
  EXPECT_GT(reintersect(2, 40000, 0.25f).hits, 1000u);
  EXPECT_GT(reintersect(2, 40000, 0).hits, 80000u);
}

// By the size of a triangle and of its coordinates; 2^-18 of the latter, which would do as well, is many
// times as much where triangles are fine.
TEST(RayOffset, IsAFewUnitsInTheLastPlace) {
  Random random(3);
  for (int i = 0; i < 100000; ++i) {
    const KdTriangle t = any_triangle(random);
    const Vec3 a = corner_of(t, 0), b = corner_of(t, 1), c = corner_of(t, 2);
    const float m = std::max({largest_component(a), largest_component(b), largest_component(c)});
    const float side = std::max({length(b - a), length(c - b), length(a - c)});
    ASSERT_LE(offset_of(t), (5.2f * m + 37 * side) * kUnitRoundoff * 1.002f);
    if (side < 0.01f * m) {
      ASSERT_LT(offset_of(t), m * (1.0f / 262144) / 11);
    }
  }
}

// A floor at height 0 has nothing to round in that direction, wherever its corners are.
TEST(RayOffset, FloorsAtHeight0AreMeasuredByTheirSizeAlone) {
  std::vector<KdTriangle> floor;
  add_triangle(floor, {90000, 0, -70000}, {90001, 0, -70000}, {90000, 0, -69999});
  EXPECT_LT(offset_of(floor[0]), 16 * kUnitRoundoff * 1.1f);
}

// What lies two offsets above a surface blocks its rays; the mean gap to where they start is measured in
// units of 2^-18 of the largest coordinate.
TEST(RayOffset, WhatStandsNextToTheSurfaceCastsItsShadow) {
  Random random(5);
  size_t blocked = 0, count = 0;
  double gap = 0;
  for (; count < 20000; ++count) {
    const Vec3 at = random.direction() * 100.0f;
    std::vector<KdTriangle> ground, sheet;
    add_triangle(ground, at, at + random.direction(), at + random.direction());
    const Vec3 n = front_of(ground[0]), p = any_point(random, ground[0]);
    const float offset = offset_of(ground[0]);
    Vec3 x, y;
    tangent_frame(n, x, y);
    const Vec3 above = p + n * (2 * offset);
    add_triangle(sheet, above - x - y, above + x * 3.0f - y, above + y * 3.0f - x);
    blocked += meets(sheet[0], p + n * offset, n);
    gap += static_cast<double>(offset * 262144 / largest_component(at));
  }
  // The sheet's own corners are rounded, too: at times below the origin.
  EXPECT_GT(blocked, count * 9 / 10);
  EXPECT_LT(gap / static_cast<double>(count), 0.12);
}

// Triangles that share an edge. Points on it are taken for points of the other one up to rounding: none may
// be kept from light that reaches both, whether the fold bulges (angle < 0) or is a hollow of up to 20
// degrees.
TEST(RayOffset, NeighboursThatDoNotHideTheLightAreNotMet) {
  for (const double angle : {-60.0, -20.0, -1.0, -1e-3, 0.0, 1e-3, 1.0, 20.0}) {
    Random random(4);
    size_t hits = 0, without = 0, points = 0;
    for (int i = 0; i < 20000; ++i) {
      const float size = std::pow(10.0f, random.between(-3, 3)), k = std::pow(10.0f, random.between(-2, 2));
      const Vec3 at =
          random.direction() * (random.below(2) ? 0 : size * std::pow(10.0f, random.between(0, 3)));
      const Vec3 along = random.direction();
      Vec3 out, up;
      tangent_frame(along, out, up);
      const float s = static_cast<float>(std::sin(angle / 57.29578)),
                  c = static_cast<float>(std::cos(angle / 57.29578));
      std::vector<KdTriangle> pair;
      const Vec3 a = at, b = at + along * size;
      add_triangle(pair, a, b, at + along * (size * random.unit()) + out * (size * random.between(0.3f, 1)));
      add_triangle(pair, b, a, at + along * (size * random.unit()) + (up * s - out * c) * (size * k));
      const Vec3 n = front_of(pair[0]), other = front_of(pair[1]), d = any_rising(random, n);
      if (!(dot(other, normalize(d)) > 1e-5f)) continue;
      const Vec3 p = a + (b - a) * random.unit();
      ++points;
      hits += meets(pair[1], p + n * offset_of(pair[0]), d);
      without += meets(pair[1], p, d);
    }
    EXPECT_GT(points, 8000u) << angle;
    EXPECT_GT(without, 1000u) << angle;
    EXPECT_EQ(hits, 0u) << angle;
  }
}

// The corners of a model's triangle, taken to the world, and a ray from there, taken back: the plane
// that it is tested with is the model's.
TEST(RayOffset, HoldsForPlacedTrianglesWithTheErrorOfTheirPlacement) {
  Random random(6);
  size_t hits = 0, without = 0, count = 0;
  for (; count < 100000; ++count) {
    const KdTriangle model = any_triangle(random);
    const float size = largest_component(corner_of(model, 1) - corner_of(model, 0));
    if (!(largest_component(corner_of(model, 0)) < 100 * size)) continue;
    Affine map = rotation(random.direction(), random.between(0, 360));
    map.x = map.x * random.between(0.1f, 4), map.y = map.y * random.between(0.1f, 4);
    map.z = map.z + map.x * random.between(-1, 1);
    map.origin = random.direction() * (size * std::pow(10.0f, random.between(-1, 3)));
    // A model that stands far from its own origin and is brought back near the world's has its errors there.
    if (count % 2 == 0) map.origin = -transform_vector(map, corner_of(model, 0));
    const PreciseAffine there = to_double(map), back = precise_inverse(map);
    const Vec3 own[3] = {corner_of(model, 0), corner_of(model, 1), corner_of(model, 2)};
    const auto to_world = [&](const Vec3& v) { return to_float(transform_point(there, to_double(v))); };
    std::vector<KdTriangle> proxy;
    add_triangle(proxy, to_world(own[0]), to_world(own[1]), to_world(own[2]));
    const KdTriangle& t = proxy.front();
    const Vec3 n = front_of(t), p = any_point(random, t), d = any_rising(random, n);
    const Vec3 m =
        greatest(absolute(corner_of(t, 0)), greatest(absolute(corner_of(t, 1)), absolute(corner_of(t, 2))));
    const Vec3 size_there = greatest(absolute(own[0]), greatest(absolute(own[1]), absolute(own[2])));
    const Vec3 apart = greatest(own[0], greatest(own[1], own[2])) - least(own[0], least(own[1], own[2]));
    const float more = dot(absolute(n), placement_error(map, size_there, apart, m));
    const auto meets_model = [&](float offset) {
      return meets(model, to_float(transform_point(back, to_double(p + n * offset))),
                   to_float(transform_vector(back, to_double(d))));
    };
    hits += meets_model(offset_of(t) + more);
    without += meets_model(offset_of(t));
  }
  EXPECT_EQ(hits, 0u);
  EXPECT_GT(without, 10u) << "it is needed";
}

class RayOffsetOfEveryIsa : public testing::TestWithParam<const Kernels*> {};

TEST_P(RayOffsetOfEveryIsa, SurfacesHaveIt) {
  Random random(7);
  std::vector<KdTriangle> triangles;
  for (int i = 0; i < 40; ++i) triangles.push_back(any_triangle(random));
  for (const uint32_t different : {1u, 5u, 40u}) {  // one triangle a block, a table of them, or each gathered
    RayPacket rays{};
    HitPacket hits{};
    rays.live = ~0ull;
    for (int lane = 0; lane < kPacketSize; ++lane) {
      set_ray(rays, lane, {{0, 0, 0}, 0, random.direction(), kInfinity});
      hits.triangle[lane] = random.below(different);
      hits.u[lane] = hits.v[lane] = 0.25f, hits.t[lane] = 1;
    }
    PointPacket points;
    GetParam()->surface_points(triangles.data(), rays, hits, {0}, points);
    for (int lane = 0; lane < kPacketSize; ++lane)
      ASSERT_EQ(points.offset[lane], offset_of(triangles[hits.triangle[lane]])) << different;
  }
}

INSTANTIATE_TEST_SUITE_P(, RayOffsetOfEveryIsa, testing::ValuesIn(available_kernels()),
                         [](const auto& each) { return std::string(each.param->isa); });

}  // namespace
}  // namespace vitral::test
