// Backgrounds: directions to colours, for the camera, in mirrors and through glass.
#include "render/background.h"
#include "math/pinhole.h"
#include "math/srgb.h"
#include "support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace vitral::test {
namespace {

constexpr double kPi = 3.14159265358979323846;

// 8 x 4 texels, each with a colour of its own.
Scene panorama() {
  Scene scene;
  Texture t{"sky", 8, 4, std::vector<uint8_t>(4 * 8 * 4, 255)};
  for (size_t i = 0; i < 32; ++i) {
    const uint8_t texel[3] = {static_cast<uint8_t>(40 + 5 * i), static_cast<uint8_t>(250 - 7 * i),
                              static_cast<uint8_t>(i % 8 * 30)};
    std::copy(texel, texel + 3, t.texels.begin() + static_cast<std::ptrdiff_t>(4 * i));
  }
  scene.textures.push_back(t);
  scene.background.kind = Background::Kind::panorama;
  scene.background.panorama = 0;
  scene.background.scale = 2;
  return scene;
}

Vec3 texel(const Scene& scene, int column, int row) {
  const uint8_t* t = &scene.textures[0].texels[static_cast<size_t>(4 * (8 * row + column))];
  return Vec3{kLinearOfSrgb[t[0]], kLinearOfSrgb[t[1]], kLinearOfSrgb[t[2]]} * scene.background.scale;
}

// The direction of a point of the picture, u to the right and v down, both in [0, 1].
Vec3 direction(double u, double v) {
  const double azimuth = (u - 0.5) * 2 * kPi, elevation = (0.5 - v) * kPi;
  return {static_cast<float>(std::sin(azimuth) * std::cos(elevation)),
          static_cast<float>(std::sin(elevation)),
          static_cast<float>(-std::cos(azimuth) * std::cos(elevation))};
}

Vec3 seen(const Scene& scene, const Vec3& d) {
  return background_light(scene, make_sky(scene), d);
}

void expect_near(const Vec3& actual, const Vec3& expected, float tolerance = 2e-5f) {
  EXPECT_NEAR(actual.x, expected.x, tolerance);
  EXPECT_NEAR(actual.y, expected.y, tolerance);
  EXPECT_NEAR(actual.z, expected.z, tolerance);
}

TEST(Panorama, EveryTexelLiesInItsDirection) {
  const Scene scene = panorama();
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 8; ++column) {
      const Vec3 d = direction((column + 0.5) / 8, (row + 0.5) / 4);
      expect_near(seen(scene, d), texel(scene, column, row));
      expect_near(seen(scene, d * 7.5f), texel(scene, column, row));
    }
  }
  // The middle is towards -z, a quarter to the right +x.
  expect_near(seen(scene, {0, 0, -1}),
              (texel(scene, 3, 1) + texel(scene, 4, 1) + texel(scene, 3, 2) + texel(scene, 4, 2)) * 0.25f);
  expect_near(seen(scene, {1, 0, 0}),
              (texel(scene, 5, 1) + texel(scene, 6, 1) + texel(scene, 5, 2) + texel(scene, 6, 2)) * 0.25f);
}

TEST(Panorama, HasNoSeam) {
  const Scene scene = panorama();
  const Vec3 middle = (texel(scene, 0, 1) + texel(scene, 7, 1)) * 0.5f;
  const float y = std::sin(static_cast<float>(kPi) / 8), z = std::cos(static_cast<float>(kPi) / 8);
  for (const float x : {0.0f, -0.0f, 1e-30f, -1e-30f, 1e-6f, -1e-6f})
    expect_near(seen(scene, {x, y, z}), middle);
  expect_near(seen(scene, direction(1 - 0.125 / 8, 0.375)),
              texel(scene, 7, 1) * 0.625f + texel(scene, 0, 1) * 0.375f);
  expect_near(seen(scene, direction(0.125 / 8, 0.375)),
              texel(scene, 7, 1) * 0.375f + texel(scene, 0, 1) * 0.625f);
}

TEST(Panorama, AtAPoleAllColumnsMeet) {
  const Scene scene = panorama();
  Vec3 zenith{0, 0, 0}, nadir{0, 0, 0};
  for (int column = 0; column < 8; ++column)
    zenith += texel(scene, column, 0) * 0.125f, nadir += texel(scene, column, 3) * 0.125f;
  expect_near(seen(scene, {0, 1, 0}), zenith);
  expect_near(seen(scene, {0, -1, 0}), nadir);
  for (int i = 0; i < 16; ++i) {
    expect_near(seen(scene, direction(i / 16.0, 1e-5)), zenith, 1e-3f);
    expect_near(seen(scene, direction(i / 16.0, 1 - 1e-5)), nadir, 1e-3f);
  }
  // Half way from the first row's middle to the pole.
  expect_near(seen(scene, direction(0.5 / 8, 1.0 / 16)), (texel(scene, 0, 0) + zenith) * 0.5f);
}

TEST(Panorama, OfOneTexelIsOneColour) {
  Scene scene = panorama();
  scene.textures[0] = {"dot", 1, 1, {10, 200, 90, 255}};
  Random random(1);
  for (int i = 0; i < 100; ++i) expect_near(seen(scene, random.direction()), texel(scene, 0, 0));
}

TEST(Gradient, FollowsTheSineOfTheElevation) {
  Scene scene;
  scene.background.kind = Background::Kind::gradient;
  scene.background.color = {1, 0.5f, 0};
  scene.background.zenith = {0, 0.5f, 2};
  for (const double elevation : {-1.5, -0.3, 0.0, 0.2, 0.9, kPi / 2}) {
    const float t = static_cast<float>(std::max(std::sin(elevation), 0.0));
    expect_near(seen(scene, direction(0.3, 0.5 - elevation / kPi) * 3.0f), {1 - t, 0.5f, 2 * t}, 1e-6f);
  }
}

// Camera rays that meet nothing see what lies in their direction, and a mirror what lies in the mirrored one.
TEST(Background, IsSeenByDirection) {
  Scene scene = panorama();
  Material m;
  m.diffuse = {0, 0, 0};
  m.reflectivity = {1, 1, 1};
  add_quad(scene, add_material(scene, m), {0, -50, -5}, {50, 0, 0}, {0, 100, 0});  // faces +z, on the right
  Settings s;
  s.width = 70, s.height = 50, s.threads = 1;
  s.effects = only(&Effects::reflection);
  const Camera camera = camera_at({0, 0, 0}, {0, 0.1f, -1}, 100);
  const Pinhole pinhole = make_pinhole(camera, s.width, s.height);
  const Frame raster = render_scene(scene, camera, s);
  s.primary = Primary::trace;
  EXPECT_TRUE(same_bytes(raster, render_scene(scene, camera, s)));
  for (int y = 0; y < s.height; ++y) {
    for (int x = 0; x < s.width; ++x) {
      Vec3 d = primary_direction(pinhole, static_cast<float>(x), static_cast<float>(y));
      if (d.x > 0) d.z = -d.z;
      expect_near(pixel(raster, x, y), seen(scene, d), 1e-4f);
    }
  }
  // A crop, whose blocks are not whole, is the same.
  s.crop = {13, 9, 21, 30};
  s.primary = Primary::raster;
  const Frame part = render_scene(scene, camera, s);
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 21; ++x) EXPECT_TRUE(pixel(part, x, y) == pixel(raster, x + 13, y + 9));
  }
}

}  // namespace
}  // namespace vitral::test
