// Objects that move while the shutter is open, against what pencil and paper say of them.
#include "statistics.h"
#include "support.h"

#include <gtest/gtest.h>

#include <cmath>

namespace vitral::test {
namespace {

constexpr double kPi = 3.14159265358979323846;

// One white object before black: a picture of it shows for how long each pixel sees it.
Scene white_object(const Object& object) {
  Scene scene = white_scene();
  scene.objects = {object};
  scene.objects[0].material = 0;
  return scene;
}

Object placed(Shape shape, const Vec3& size, const Vec3& at) {
  Object object;
  object.shape = shape;
  object.placement = {{size.x, 0, 0}, {0, size.y, 0}, {0, 0, size.z}, at};
  return object;
}

Settings tiny(int samples, Primary primary) {
  Settings s;
  s.width = s.height = 16;
  s.samples = samples;
  s.primary = primary;
  s.threads = 1;
  s.effects = kNoEffects;
  return s;
}

// Sixteen pixels see [-1, 1] at depth 1; the shutter is open from 0 to 1.
Camera square_camera() {
  Camera camera = camera_at({0, 0, 0}, {0, 0, -1}, 90);
  camera.shutter_close = 1;
  return camera;
}

// The mean over a pixel of a function of a place on the plane at depth 1.
template <class F>
double mean_over_pixel(int x, int y, const F& at) {
  double sum = 0;
  for (int j = 0; j < 20; ++j) {
    for (int i = 0; i < 20; ++i) sum += at((x + (i + 0.5) / 20) / 8 - 1, 1 - (y + (j + 0.5) / 20) / 8);
  }
  return sum / 400;
}

class Motion : public testing::TestWithParam<Primary> {};
INSTANTIATE_TEST_SUITE_P(, Motion, testing::Values(Primary::raster, Primary::trace),
                         [](const auto& p) { return p.param == Primary::raster ? "raster" : "trace"; });

// A thin plate of half width 1/4 at depth 1 that slides to the right by 1 while the shutter is open.
TEST_P(Motion, ASlidingPlateIsSeenForItsShareOfTheTime) {
  Object plate = placed(Shape::box, {0.25f, 0.25f, 0.0005f}, {-0.5f, 0, -1});
  plate.motion = {{-1, {-1, 0, 0}, {}}, {2, {2, 0, 0}, {}}};  // from -0.5 at 0 to 0.5 at 1
  const Frame frame = render_scene(white_object(plate), square_camera(), tiny(1024, GetParam()));
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      const double expected = mean_over_pixel(x, y, [](double px, double py) {
        if (std::abs(py) > 0.25) return 0.0;
        const double from = std::max(px + 0.5 - 0.25, 0.0), to = std::min(px + 0.5 + 0.25, 1.0);
        return std::max(to - from, 0.0);
      });
      ASSERT_NEAR(pixel(frame, x, y).x, expected, 0.012) << x << " " << y;
    }
  }
}

// A plate that turns about its own origin, in its edge's middle, by a quarter: what lies at the angle a from
// where the edge starts is seen until the edge has passed, or from then on.
TEST_P(Motion, ATurningPlateIsSeenUntilItsEdgeHasPassed) {
  Scene scene = white_scene();
  add_quad(scene, 0, {0, -9, 0}, {9, 0, 0}, {0, 18, 0});  // all that is right of its origin
  scene.models = {scene.mesh};
  scene.mesh = {};
  Object plate;
  plate.placement.origin = {0.25f, 0.125f, -1};
  plate.motion = {{0, {0, 0, 0}, {}}, {1, {0, 0, 0}, quaternion({0, 0, 1}, 90)}};
  scene.objects = {plate};
  // Around the plate's origin place and time matter together: four standard deviations of 4096 samples.
  const Frame frame = render_scene(scene, square_camera(), tiny(4096, GetParam()));
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      const double expected = mean_over_pixel(x, y, [](double px, double py) {
        // Seen while the angle to the plate's normal, which turns from 0 to pi/2, is less than pi/2.
        const double a = std::atan2(py - 0.125, px - 0.25);
        const double from = std::max(a - kPi / 2, 0.0), to = std::min(a + kPi / 2, kPi / 2);
        return std::max(to - from, 0.0) / (kPi / 2);
      });
      ASSERT_NEAR(pixel(frame, x, y).x, expected, 4 * 0.5 / 64) << x << " " << y;
    }
  }
}

// Shadows move with what casts them.
TEST_P(Motion, TheShadowMovesToo) {
  Object plate = placed(Shape::box, {0.25f, 0.0005f, 0.5f}, {-0.5f, 1, 0});
  plate.motion = {{0, {0, 0, 0}, {}}, {1, {1, 0, 0}, {}}};
  Scene scene = white_object(plate);
  add_quad(scene, 0, {-5, 0, 5}, {10, 0, 0}, {0, 0, -10});
  scene.ambient = {0, 0, 0};
  scene.lights = {sun({0, -1, 0})};
  Camera camera = camera_at({0, 0.9f, 0}, {0, -1, 0}, 90, {0, 0, -1});  // under the plate
  camera.shutter_close = 1;
  Settings settings = tiny(1024, GetParam());
  settings.effects = only(&Effects::shadows);
  const Frame frame = render_scene(scene, camera, settings);
  for (int y = 5; y < 11; ++y) {  // well within the plate's depth
    for (int x = 0; x < 16; ++x) {
      const double expected = mean_over_pixel(x, y, [](double px, double) {
        const double at = px * 0.9;
        const double from = std::max(at + 0.25, 0.0), to = std::min(at + 0.75, 1.0);
        return 1 - std::max(to - from, 0.0);
      });
      ASSERT_NEAR(pixel(frame, x, y).x, expected, 0.012) << x << " " << y;
    }
  }
}

// One sample is the middle of the shutter, and what rests gives the picture of a closed shutter.
TEST_P(Motion, OneSampleIsTheMiddleOfTheShutter) {
  Object ball = placed(Shape::sphere, {0.3f, 0.3f, 0.3f}, {-0.5f, 0, -1.5f});
  ball.motion = {{0, {0, 0, 0}, {}}, {1, {1, 0.5f, 0}, {}}};
  const Frame moving = render_scene(white_object(ball), square_camera(), tiny(1, GetParam()));
  ball.motion.clear();
  ball.placement.origin = {0, 0.25f, -1.5f};
  const Frame resting = render_scene(white_object(ball), square_camera(), tiny(1, GetParam()));
  EXPECT_TRUE(same_bytes(moving, resting));
}

// 400 pictures of 4 samples against 64 of 256 (16384 samples), by the other way to primary hits; significance
// one in a thousand for all pixels together.
TEST_P(Motion, HasTheExpectationOfTheReference) {
  Object ball = placed(Shape::sphere, {0.4f, 0.3f, 0.3f}, {-0.4f, -0.1f, -1.5f});
  ball.motion = {{0, {0, 0, 0}, {}}, {1, {0.8f, 0.3f, 0.2f}, quaternion({0, 1, 1}, 70)}};
  Scene scene = white_object(ball);
  add_quad(scene, 0, {-4, -0.6f, 2}, {8, 0, 0}, {0, 0, -12});
  scene.lights = {sun({1, -2, -1}, {0.6f, 0.6f, 0.6f})};
  scene.ambient = {0.3f, 0.3f, 0.3f};
  const auto pictures = [&](Primary primary, int samples, uint32_t count) {
    Settings settings = tiny(samples, primary);
    settings.effects = only(&Effects::shadows);
    PictureSum sum;
    sum.samples = samples;
    for (settings.seed = 1; settings.seed <= count; ++settings.seed)
      sum.add(render_scene(scene, square_camera(), settings).radiance.pixels);
    return sum;
  };
  const Primary other = GetParam() == Primary::raster ? Primary::trace : Primary::raster;
  const PictureSum reference = pictures(other, 256, 64);
  const double critical = critical_z(reference.sum.size());
  EXPECT_LT(greatest_z(pictures(GetParam(), 4, 400), reference), critical);
  // A ball that flies a tenth further must be noticed.
  scene.objects[0].motion[1].translation.x = 0.88f;
  EXPECT_GT(greatest_z(pictures(GetParam(), 4, 400), reference), critical);
}

// What is cut from a checkered block keeps its checks wherever it goes: who goes along sees the same.
TEST_P(Motion, PatternsStayWithWhatMoves) {
  Scene scene;
  Material checkered;
  checkered.pattern.kind = Pattern::Kind::checker;
  checkered.pattern.size = 0.4f;
  add_material(scene, checkered);
  add_triangles(scene, 0, sphere({0.1f, 0.2f, 0.05f}, 0.9f, 12));
  scene.models = {scene.mesh};
  scene.mesh = {};
  scene.ambient = {1, 1, 1};
  const Vec3 away{0.33f, 0.21f, 0.17f};  // no multiple of the checks
  Settings settings = tiny(1, GetParam());
  settings.width = settings.height = 64;
  Object ball = placed(Shape::sphere, {0.9f, 0.9f, 0.9f}, {0.1f, 0.2f, 0.05f}), model;
  ball.material = 0;
  for (const Object& object : {ball, model}) {
    const auto seen_from = [&](const Object& there, const Vec3& eye) {
      scene.objects = {there};
      return render_scene(scene, camera_at(eye, {0, 0, -1}, 50), settings);
    };
    const auto different = [](const Frame& a, const Frame& b) {
      size_t pixels = 0;
      for (size_t i = 0; i < a.radiance.pixels.size(); ++i)
        pixels += std::abs(a.radiance.pixels[i].x - b.radiance.pixels[i].x) > 0.05f ? 1 : 0;
      return pixels;
    };
    const Frame at_rest = seen_from(object, {0, 0, 3});
    Object moved = object;
    moved.motion = {{0, away, {}}};
    const Frame together = seen_from(moved, Vec3{0, 0, 3} + away);
    EXPECT_LT(different(at_rest, together), 40u);  // of 4096: where edges fall on other pixels
    // Where the pattern did not go along, hundreds would differ.
    EXPECT_GT(different(at_rest, seen_from(object, Vec3{0.2f, 0.1f, 3})), 400u);
  }
}

}  // namespace
}  // namespace vitral::test
