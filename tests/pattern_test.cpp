// Patterns: what a pixel sees of them is their mean over it.
#include "render/pattern.h"
#include "math/noise.h"
#include "support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace vitral::test {
namespace {

Pattern pattern(Pattern::Kind kind) {
  Pattern p;
  p.kind = kind;
  p.first = {1, 0.5f, 0};
  p.second = {0, 0.5f, 0.25f};
  p.size = 0.5f;
  p.height = 0.2f;
  p.mortar = 0.04f;
  p.turbulence = 1;
  return p;
}

constexpr Vec3 kUp{0, 1, 0};

PatternPlace point(const Vec3& position, const Vec3& outward = kUp) {
  return {position, outward, {0, 0, 0}, {0, 0, 0}};
}

// The mean over a grid of points of the place's parallelogram.
Vec3 mean_of_points(const Pattern& p, const PatternPlace& place, int n) {
  Vec3d sum{0, 0, 0};
  for (int i = 0; i < n * n; ++i) {
    const float a = (static_cast<float>(i % n) + 0.5f) / static_cast<float>(n) - 0.5f;
    const float b = (static_cast<float>(i / n) + 0.5f) / static_cast<float>(n) - 0.5f;
    sum += to_double(
        pattern_color(p, point(place.position + place.first * a + place.second * b, place.outward)));
  }
  return to_float(sum * (1.0 / (n * n)));
}

void expect_near(const Vec3& actual, const Vec3& expected, float tolerance) {
  EXPECT_NEAR(actual.x, expected.x, tolerance);
  EXPECT_NEAR(actual.y, expected.y, tolerance);
  EXPECT_NEAR(actual.z, expected.z, tolerance);
}

TEST(Checker, CubesTakeTurns) {
  const Pattern p = pattern(Pattern::Kind::checker);
  for (int i = -3; i < 3; ++i) {
    for (int j = -3; j < 3; ++j) {
      for (int k = -3; k < 3; ++k) {
        const Vec3 middle{0.5f * (static_cast<float>(i) + 0.5f), 0.5f * (static_cast<float>(j) + 0.5f),
                          0.5f * (static_cast<float>(k) + 0.5f)};
        EXPECT_TRUE(pattern_color(p, point(middle)) == ((i + j + k) % 2 == 0 ? p.first : p.second));
      }
    }
  }
}

// A floor between two layers of cubes shows the one below it, however its height is rounded.
TEST(Checker, AFloorBetweenLayersIsNotNoise) {
  const Pattern p = pattern(Pattern::Kind::checker);
  for (const float y : {-1e-6f, 0.0f, 1e-6f}) {
    EXPECT_TRUE(pattern_color(p, point({0.1f, y, 0.1f})) == p.second);
    EXPECT_TRUE(pattern_color(p, point({0.1f, y, 0.1f}, {0, -1, 0})) == p.first);
  }
}

TEST(Checker, IsTheMeanOverABoxAlongTheAxes) {
  const Pattern p = pattern(Pattern::Kind::checker);
  Random random(7);
  for (int i = 0; i < 60; ++i) {
    PatternPlace place = point(random.in_box(-5, 5));
    place.first = {random.between(0.01f, 1.5f), 0, 0}, place.second = {0, 0, random.between(-1.5f, 1.5f)};
    expect_near(pattern_color(p, place), mean_of_points(p, place, 400), 0.006f);
  }
}

TEST(Brick, CoursesBricksAndJoints) {
  const Pattern p = pattern(Pattern::Kind::brick);
  const auto at = [&](float along, float up) { return pattern_color(p, point({along, up, 7}, {0, 0, 1})); };
  EXPECT_TRUE(at(0.25f, 0.1f) == p.first);    // the middle of a brick of the first course
  EXPECT_TRUE(at(0.015f, 0.1f) == p.second);  // the joint beside it, 0.04 wide around 0
  EXPECT_TRUE(at(-0.015f, 0.1f) == p.second);
  EXPECT_TRUE(at(0.025f, 0.1f) == p.first);
  EXPECT_TRUE(at(0.25f, 0.015f) == p.second);  // the joint between two courses
  EXPECT_TRUE(at(0.25f, -0.015f) == p.second);
  EXPECT_TRUE(at(0.25f, 0.3f) == p.second);  // the next course is moved by half a brick
  EXPECT_TRUE(at(0.5f, 0.3f) == p.first);
  EXPECT_TRUE(at(0.5f, 0.5f) == p.second);
}

// Every wall has upright courses; across it nothing changes.
TEST(Brick, FollowsTheWall) {
  const Pattern p = pattern(Pattern::Kind::brick);
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const float along = random.between(-3, 3), up = random.between(-3, 3), across = random.between(-3, 3);
    const Vec3 expected = pattern_color(p, point({along, up, 0}, {0, 0, 1}));
    EXPECT_TRUE(pattern_color(p, point({along, up, across}, {0.1f, 0, -0.9f})) == expected);
    EXPECT_TRUE(pattern_color(p, point({across, up, along}, {-0.9f, 0.2f, 0.1f})) == expected);
    EXPECT_TRUE(pattern_color(p, point({along, across, up}, {0.3f, 0.8f, 0.1f})) == expected);
  }
}

TEST(Brick, IsTheMeanOverABoxWithinACourse) {
  const Pattern p = pattern(Pattern::Kind::brick);
  Random random(8);
  for (int i = 0; i < 60; ++i) {
    const float course = static_cast<float>(random.below(9)) - 4;
    PatternPlace place = point({random.between(-3, 3), 0.2f * (course + 0.5f), 0}, {0, 0, 1});
    place.first = {random.between(0.01f, 1.5f), 0, 0}, place.second = {0, random.between(0.01f, 0.2f), 0};
    expect_near(pattern_color(p, place), mean_of_points(p, place, 400), 0.006f);
  }
  PatternPlace far = point({0.3f, 0.4f, 0}, {0, 0, 1});
  far.first = {100, 0, 0}, far.second = {0, 100, 0};
  const float bricks = (1 - 0.04f / 0.2f) * (1 - 0.04f / 0.5f);
  expect_near(pattern_color(p, far), p.first * bricks + p.second * (1 - bricks), 2e-3f);
}

TEST(Noise, IsContinuousBoundedAndZeroAtTheLattice) {
  Random random(5);
  double sum = 0, magnitude = 0;
  constexpr int kCount = 100000;
  for (int i = 0; i < kCount; ++i) {
    const Vec3 p = random.in_box(-300, 300);
    const float n = gradient_noise(p);
    sum += static_cast<double>(n), magnitude += static_cast<double>(std::abs(n));
    ASSERT_LE(std::abs(n), 1);
    ASSERT_NEAR(gradient_noise(p + Vec3{1e-3f, 1e-3f, -1e-3f}), n, 0.02f);
    ASSERT_EQ(gradient_noise({std::floor(p.x), std::floor(p.y), std::floor(p.z)}), 0);
  }
  EXPECT_NEAR(sum / kCount, 0, 0.005);
  EXPECT_NEAR(magnitude / kCount, 0.22, 0.002);  // what marble takes for octaves that are too fine
  EXPECT_EQ(gradient_noise({1e30f, -1e30f, std::numeric_limits<float>::infinity()}), 0);
}

TEST(Marble, FadesToItsMean) {
  const Pattern p = pattern(Pattern::Kind::marble);
  PatternPlace place = point({3, 1, 4});
  place.first = {100, 0, 0}, place.second = {0, 0, 100};
  const Vec3 far = pattern_color(p, place);
  expect_near(far, p.first * (93.0f / 128) + p.second * (35.0f / 128), 1e-5f);
  expect_near(mean_of_points(p, place, 223), far, 0.02f);
  // Half as wide a pixel sees nearly the mean of its parts.
  Random random(9);
  for (int i = 0; i < 40; ++i) {
    PatternPlace near = point(random.in_box(-5, 5));
    near.first = {0.02f, 0, 0}, near.second = {0, 0, 0.02f};
    expect_near(pattern_color(p, near), mean_of_points(p, near, 40), 0.12f);
  }
}

// Without turbulence the veins are cos^8, and their mean over a span has a closed form that ours is near to
// where it matters.
TEST(Marble, VeinsFadeWaveByWave) {
  Pattern p = pattern(Pattern::Kind::marble);
  p.turbulence = 0;
  for (const float wide : {0.05f, 0.1f, 0.2f}) {
    for (int i = 0; i < 20; ++i) {
      PatternPlace place = point({0.025f * static_cast<float>(i), 3, 2});
      place.first = {wide, 0, 0};
      expect_near(pattern_color(p, place), mean_of_points(p, place, 40), 0.05f);
    }
  }
}

// The solid is the same from both sides of the surface that cuts it.
TEST(Patterns, FromBehindTheSurfaceLooksTheSame) {
  Scene scene;
  Material m;
  m.pattern = pattern(Pattern::Kind::checker);
  add_quad(scene, add_material(scene, m), {-2, 0, -2}, {0, 0, 4}, {4, 0, 0});
  scene.ambient = {1, 1, 1};
  Settings s;
  s.width = s.height = 9, s.threads = 1;
  s.effects = kNoEffects;
  const Frame above = render_scene(scene, camera_at({0.1f, 4, 0.1f}, {0, -1, 0}, 30, {0, 0, -1}), s);
  const Frame below = render_scene(scene, camera_at({0.1f, -4, 0.1f}, {0, 1, 0}, 30, {0, 0, -1}), s);
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 9; ++x) EXPECT_NEAR(pixel(above, x, y).x, pixel(below, 8 - x, y).x, 0.01f);
  }
}

// Seen from its edge a surface shows its mean, and nothing that is not finite.
TEST(Patterns, AreFiniteWhateverIsSeen) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  for (const Pattern::Kind kind : {Pattern::Kind::checker, Pattern::Kind::brick, Pattern::Kind::marble}) {
    for (const float bad : {inf, -inf, nan, 1e38f}) {
      const PatternPlace place{{1e9f, 2, -1e-30f}, kUp, {bad, 0, 1}, {bad, bad, bad}};
      const Vec3 c = pattern_color(pattern(kind), place);
      EXPECT_TRUE(c.x >= 0 && c.x <= 1 && c.y >= 0 && c.y <= 1 && c.z >= 0 && c.z <= 1);
    }
  }
}

// A floor to the horizon: each pixel near the mean of 16x16 finer ones, for the camera and in a mirror alike.
TEST(Patterns, OnAFloorNeitherShimmerNorBlur) {
  for (const Pattern::Kind kind : {Pattern::Kind::checker, Pattern::Kind::brick, Pattern::Kind::marble}) {
    Scene scene;
    Material m;
    m.pattern = pattern(kind);
    m.pattern.second = {0, 0, 0};
    add_quad(scene, add_material(scene, m), {-200, 0, -200}, {0, 0, 400}, {400, 0, 0});
    scene.ambient = {1, 1, 1};
    scene.background.color = {0, 0, 0};
    for (const bool mirrored : {false, true}) {
      Settings s;
      s.width = 48, s.height = 32, s.threads = 1;
      s.effects = only(&Effects::reflection);
      Camera camera = camera_at({0.2f, 1, 0.1f}, {0.1f, -0.4f, -1}, 50);
      if (mirrored) {
        Material mirror;
        mirror.optics = Optics::mirror;
        mirror.diffuse = {0, 0, 0}, mirror.specular = {1, 1, 1};
        add_quad(scene, add_material(scene, mirror), {-50, -50, 0.5f}, {0, 100, 0}, {100, 0, 0});
        camera.view.z = 1;
      }
      const Frame one = render_scene(scene, camera, s);
      s.width *= 16, s.height *= 16;
      const Frame many = render_scene(scene, camera, s);
      double sum = 0;
      for (int y = 0; y < 32; ++y) {
        for (int x = 0; x < 48; ++x) {
          double mean = 0;
          for (int i = 0; i < 256; ++i)
            mean += static_cast<double>(pixel(many, 16 * x + i % 16, 16 * y + i / 16).x) / 256;
          sum += std::abs(static_cast<double>(pixel(one, x, y).x) - mean);
        }
      }
      // Marble is filtered by a model of its noise.
      EXPECT_LT(sum / (48 * 32), kind == Pattern::Kind::marble ? 0.065 : 0.03)
          << static_cast<int>(kind) << (mirrored ? " mirrored" : "");
    }
  }
}

}  // namespace
}  // namespace vitral::test
