// The samples of a pixel: filters, lens and shutter, against what pencil and paper say of them.
#include "render/samples.h"
#include "statistics.h"
#include "support.h"

#include <gtest/gtest.h>

#include <cmath>

namespace vitral::test {
namespace {

double mitchell(double x) {  // Mitchell and Netravali 1988, eq. 8, B = C = 1/3
  x = std::abs(x);
  if (x < 1) return (7 * x * x * x - 12 * x * x + 16 / 3.0) / 6;
  if (x < 2) return (-7 / 3.0 * x * x * x + 12 * x * x - 20 * x + 32 / 3.0) / 6;
  return 0;
}
double filter_at(Filter filter, double x) {
  switch (filter) {
    case Filter::box:
      return std::abs(x) <= 0.5 ? 1 : 0;
    case Filter::tent:
      return std::max(1 - std::abs(x), 0.0);
    case Filter::mitchell:
      return mitchell(x);
  }
  return 0;
}

// The weight that samples bring to each eighth of a pixel is the filter's integral there.
TEST(Filter, SamplesAreSpreadAsItWeighs) {
  for (const Filter filter : {Filter::box, Filter::tent, Filter::mitchell}) {
    Settings settings;
    settings.samples = 65536;
    settings.filter = filter;
    std::vector<double> across(40), down(40);
    double sum = 0;
    for (const PixelSample& s : pixel_samples(settings, Camera{})) {
      across.at(static_cast<size_t>((s.x + 2.5f) * 8)) += s.weight;
      down.at(static_cast<size_t>((s.y + 2.5f) * 8)) += s.weight;
      sum += s.weight;
    }
    EXPECT_NEAR(sum, 1, 1e-9);
    for (size_t i = 0; i < across.size(); ++i) {
      double expected = 0;
      const int steps = 1000;
      for (int k = 0; k < steps; ++k)
        expected += filter_at(filter, (static_cast<double>(i) + (k + 0.5) / steps) / 8 - 2.5) / (8 * steps);
      EXPECT_NEAR(across[i], expected, 5e-4) << static_cast<int>(filter) << " " << i;
      EXPECT_NEAR(down[i], expected, 5e-4) << static_cast<int>(filter) << " " << i;
    }
  }
}

TEST(Filter, FewSamplesStillMakeAMean) {
  for (int samples = 1; samples <= 40; ++samples) {
    for (uint32_t seed = 1; seed < 50; ++seed) {
      Settings settings;
      settings.samples = samples, settings.seed = seed, settings.filter = Filter::mitchell;
      double sum = 0, greatest = 0;
      for (const PixelSample& s : pixel_samples(settings, Camera{}))
        sum += s.weight, greatest = std::max(greatest, std::abs(s.weight));
      ASSERT_NEAR(sum, 1, 1e-12);
      ASSERT_LT(greatest, 2.001 / samples);
    }
  }
}

// --- pictures ---------------------------------------------------------------------------------------

// A wall at depth d from the origin, seen along -z, of which everything right of x = edge is there.
Scene half_wall(float depth, float edge) {
  Scene scene = white_scene();
  add_quad(scene, 0, {edge, -50, -depth}, {100, 0, 0}, {0, 100, 0});
  return scene;
}

Settings tiny(int samples, int side = 16) {
  Settings s;
  s.width = s.height = side;
  s.samples = samples;
  s.threads = 1;
  s.effects = kNoEffects;
  return s;
}

PictureSum over_seeds(const Scene& scene, const Camera& camera, Settings settings, uint32_t seeds) {
  PictureSum sum;
  sum.samples = settings.samples;
  for (uint32_t seed = 1; seed <= seeds; ++seed) {
    settings.seed = seed;
    sum.add(render_scene(scene, camera, settings).radiance.pixels);
  }
  return sum;
}

// An upright edge through pixels at 1/4 of their width: the box sees 3/4, the tent the area of its part.
TEST(Antialiasing, AnEdgeIsTheFiltersIntegral) {
  const Camera camera = camera_at({0, 0, 0}, {0, 0, -1}, 90);  // a pixel is 1/8 wide at depth 1
  for (const Filter filter : {Filter::box, Filter::tent, Filter::mitchell}) {
    Settings settings = tiny(1024);
    settings.filter = filter;
    const Frame frame = render_scene(half_wall(1, 0.25f / 8), camera, settings);
    for (int x = 4; x < 12; ++x) {
      // The pixel's centre is (x - 7.5) pixels from the axis, the edge 0.25.
      double expected = 0;
      const int steps = 4000;
      for (int k = 0; k < steps; ++k) {
        const double at = -2 + 4 * (k + 0.5) / steps;
        if (x - 7.5 + at > 0.25) expected += filter_at(filter, at) * 4 / steps;
      }
      for (int y = 4; y < 12; ++y)
        EXPECT_NEAR(pixel(frame, x, y).x, expected, 4e-3) << static_cast<int>(filter) << " at " << x;
    }
  }
}

// A slanted edge: 16 samples are as good as their strata say, far better than 16 random ones (sigma 0.125).
TEST(Antialiasing, StrataReduceTheNoiseOfASlantedEdge) {
  Scene scene = white_scene();
  add_quad(scene, 0, {-15.35f, -50, -1}, {100, 0, 0}, {30, 100, 0});
  const Camera camera = camera_at({0, 0, 0}, {0, 0, -1}, 90);
  const std::vector<Vec3> reference = render_scene(scene, camera, tiny(16384)).radiance.pixels;
  const PictureSum sum = over_seeds(scene, camera, tiny(16), 64);
  double worst = 0;
  int partly = 0;
  for (size_t i = 0; i < reference.size(); ++i) {
    worst = std::max(worst, std::sqrt(sum.variance(3 * i) * 64));
    partly += reference[i].x > 0.1f && reference[i].x < 0.9f ? 1 : 0;
  }
  EXPECT_GT(partly, 10);
  EXPECT_GT(worst, 0.01);
  EXPECT_LT(worst, 0.07);
  EXPECT_LT(greatest_z(sum, reference), critical_z(3 * reference.size()));
}

TEST(Antialiasing, OneSampleIsThePixelsCentre) {
  const Scene scene = half_wall(1, 0.1f);
  Camera camera = camera_at({0, 0, 0}, {0, 0, -1}, 90);
  const Frame pinhole = render_scene(scene, camera, tiny(1));
  camera.aperture = 0.5f, camera.focus = 3;
  for (const Primary primary : {Primary::raster, Primary::trace}) {
    Settings settings = tiny(1);
    settings.filter = Filter::mitchell;
    settings.primary = primary;
    EXPECT_TRUE(same_bytes(pinhole, render_scene(scene, camera, settings)));
  }
}

TEST(Antialiasing, CropsHaveThePixelsOfTheWhole) {
  Scene scene = half_wall(3, -0.4f);
  add_triangles(scene, 0, sphere({0.2f, 0.1f, -2}, 0.5f, 8));
  scene.lights = {sun({1, -1, -1})};
  Camera camera = camera_at({0, 0, 0}, {0, 0, -1}, 60);
  camera.aperture = 0.2f, camera.focus = 2, camera.shutter_close = 1;
  camera.motion = {{0, {0, 0, 0}, {0, 0, -1}, {0, 1, 0}}, {1, {0.1f, 0, 0}, {0.1f, 0, -1}, {0.2f, 1, 0}}};
  for (const Primary primary : {Primary::raster, Primary::trace}) {
    Settings settings = tiny(5, 48);
    settings.effects = {true, true, true, true};
    settings.filter = Filter::mitchell;
    settings.primary = primary;
    const Frame whole = render_scene(scene, camera, settings);
    settings.crop = {13, 7, 21, 30};
    settings.threads = 2;
    const Frame part = render_scene(scene, camera, settings);
    for (int y = 0; y < 30; ++y) {
      for (int x = 0; x < 21; ++x) ASSERT_EQ(pixel(part, x, y), pixel(whole, x + 13, y + 7)) << x << " " << y;
    }
  }
}

// The share of a disk of radius r around 0 that lies at x > edge.
double beyond(double edge, double r) {
  const double e = std::min(std::max(edge / r, -1.0), 1.0);
  return (std::acos(e) - e * std::sqrt(1 - e * e)) / 3.14159265358979323846;
}

// A wall behind the plane in focus: its edge is a blurred disk's edge, of the radius aperture / 2 times
// |1 - depth / focus| on the wall. The pixels are small against that.
TEST(DepthOfField, AnEdgeOutOfFocusIsADisksSegment) {
  Camera camera = camera_at({0, 0, 0}, {0, 0, -1}, 20);
  camera.aperture = 0.5f, camera.focus = 2;
  const float depth = 5;
  const Scene scene = half_wall(depth, 0);
  const double radius = 0.25 * (5 / 2.0 - 1);
  for (const Primary primary : {Primary::raster, Primary::trace}) {
    Settings settings = tiny(4096);
    settings.primary = primary;
    const Frame frame = render_scene(scene, camera, settings);
    int between = 0;
    for (int x = 0; x < 16; ++x) {
      const double width =
          2 * std::tan(10 * 3.14159265358979323846 / 180) * 5 / 16;  // of a pixel on the wall
      // The mean over the pixel.
      double expected = 0;
      for (int k = 0; k < 100; ++k) expected += beyond(-(x - 8 + (k + 0.5) / 100) * width, radius) / 100;
      for (int y = 0; y < 16; ++y) ASSERT_NEAR(pixel(frame, x, y).x, expected, 0.01) << x << " " << y;
      between += expected > 0.05 && expected < 0.95 ? 1 : 0;
    }
    EXPECT_GE(between, 3);
  }
}

TEST(DepthOfField, WhatIsInFocusStaysSharp) {
  Camera camera = camera_at({0, 0, 0}, {0, 0, -1}, 40);
  const Scene scene = half_wall(2, 0.031f);
  Settings settings = tiny(64);
  const Frame sharp = render_scene(scene, camera, settings);
  camera.aperture = 1, camera.focus = 2;
  for (const Primary primary : {Primary::raster, Primary::trace}) {
    settings.primary = primary;
    const Frame frame = render_scene(scene, camera, settings);
    for (size_t i = 0; i < sharp.radiance.pixels.size(); ++i)
      EXPECT_NEAR(frame.radiance.pixels[i].x, sharp.radiance.pixels[i].x, 1.5 / 64);
  }
}

// A scene with all that is random at once.
Scene busy() {
  Scene scene = white_scene();
  Material red;
  red.diffuse = {0.8f, 0.2f, 0.1f};
  add_material(scene, red);
  add_quad(scene, 0, {-4, -0.6f, 2}, {8, 0, 0}, {0, 0, -12});
  add_triangles(scene, 1, sphere({0.5f, 0, -3}, 0.6f, 10));
  add_triangles(scene, 1, sphere({-0.4f, -0.2f, -1.6f}, 0.3f, 10));
  scene.lights = {sun({1, -2, -1}, {0.7f, 0.7f, 0.7f})};
  scene.ambient = {0.4f, 0.4f, 0.4f};
  scene.background.color = {0.3f, 0.5f, 0.9f};
  return scene;
}

// Both ways to primary hits have one expectation: 600 pictures of 4 samples from each, against 64 of 256 from
// tracing (16384 samples) and against each other. Significance one in a thousand for all pixels together.
TEST(DepthOfField, RasterAndTraceHaveTheSameExpectation) {
  const Scene scene = busy();
  Camera camera = camera_at({0, 0.1f, 0.5f}, {0, -0.05f, -1}, 50);
  camera.aperture = 0.3f, camera.focus = 3.5f, camera.shutter_close = 1;
  camera.motion = {{0, camera.position, camera.view, camera.up},
                   {1, {0.15f, 0.1f, 0.4f}, {0.05f, -0.05f, -1}, {0.1f, 1, 0}}};
  Settings settings = tiny(4, 12);
  settings.effects = {true, false, false, true};
  settings.ao_samples = 1, settings.ao_distance = 1;
  const auto pictures = [&](Primary primary, int samples, uint32_t seeds) {
    Settings s = settings;
    s.primary = primary, s.samples = samples;
    return over_seeds(scene, camera, s, seeds);
  };
  const PictureSum reference = pictures(Primary::trace, 256, 64);
  const PictureSum rastered = pictures(Primary::raster, 4, 600), traced = pictures(Primary::trace, 4, 600);
  const double critical = critical_z(reference.sum.size());
  EXPECT_LT(greatest_z(rastered, reference), critical);
  EXPECT_LT(greatest_z(traced, reference), critical);
  EXPECT_LT(greatest_z(rastered, traced), critical);
  // With a lens wider by a third the test must fail.
  camera.aperture = 0.4f;
  EXPECT_GT(greatest_z(pictures(Primary::trace, 256, 64), rastered), critical);
}

// A camera that slides along a wall: an edge becomes a ramp, as long as the way on the wall.
TEST(MotionBlur, ASlidingCameraMakesARamp) {
  Camera camera = camera_at({0, 0, 0}, {0, 0, -1}, 90);
  camera.shutter_open = 1, camera.shutter_close = 2;
  camera.motion = {{0, {-0.75f, 0, 0}, {0, 0, -1}, {0, 1, 0}}, {3, {0.75f, 0, 0}, {0, 0, -1}, {0, 1, 0}}};
  const Frame frame = render_scene(half_wall(1, 0), camera, tiny(1024));
  // While the shutter is open the camera is at -0.25 to 0.25, and sees the edge that far on the other side.
  for (int x = 0; x < 16; ++x) {
    double expected = 0;
    for (int k = 0; k < 100; ++k)
      expected += std::min(std::max(0.5 + (x - 8 + (k + 0.5) / 100) / 8 / 0.5, 0.0), 1.0) / 100;
    for (int y = 0; y < 16; ++y) ASSERT_NEAR(pixel(frame, x, y).x, expected, 0.01) << x;
  }
}

TEST(MotionBlur, TheCameraTurnsAtConstantSpeed) {
  Camera camera = camera_at({1, 2, 3}, {0, 0, -1}, 90);
  camera.motion = {{0, {1, 2, 3}, {0, 0, -1}, {0, 1, 0}}, {2, {5, 2, 3}, {3, 0, 0}, {0, 2, 0}}};
  for (const float time : {0.25f, 0.5f, 1.0f, 1.75f}) {
    const Camera now = camera_at(camera, time);
    const double angle = static_cast<double>(time) / 2 * 1.5707963267948966;
    EXPECT_NEAR(now.view.x, std::sin(angle), 1e-6);
    EXPECT_NEAR(now.view.z, -std::cos(angle), 1e-6);
    EXPECT_NEAR(now.view.y, 0, 1e-6);
    EXPECT_NEAR(now.up.y, 1, 1e-6);
    EXPECT_NEAR(now.position.x, 1 + 2 * time, 1e-6);
  }
  EXPECT_EQ(camera_at(camera, 2).view, (Vec3{3, 0, 0}));  // a key is as it was given
  EXPECT_NEAR(camera_at(camera, 9).position.x, 5, 1e-6);  // and the camera rests outside of them
  EXPECT_NEAR(camera_at(camera, -9).position.x, 1, 1e-6);
}

TEST(Samples, AuxiliaryPicturesAreMeansOrTheFirstSamples) {
  Settings settings = tiny(64);
  settings.aovs = {"albedo", "primitive", "depth"};
  const Scene scene = half_wall(1, 0.25f / 8);
  const Frame frame = render_scene(scene, camera_at({0, 0, 0}, {0, 0, -1}, 90), settings);
  EXPECT_EQ(frame.stats.covered_pixels % 16, 0u);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      // White, and nothing else: the albedo's mean is the coverage, as the picture is.
      EXPECT_NEAR(frame.aovs[0].pixels.row(y)[x].x, pixel(frame, x, y).x, 1e-6);
      const float number = frame.aovs[1].pixels.row(y)[x].x;
      EXPECT_TRUE(number == -1 || number == 0 || number == 1);
      const float depth = frame.aovs[2].pixels.row(y)[x].x;
      EXPECT_TRUE(depth == 0 || std::abs(depth - 1) < 1e-5f);
    }
  }
}

}  // namespace
}  // namespace vitral::test
