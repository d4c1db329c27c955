// Spots, rectangles, spheres and suns in whole renders. Expectations are closed forms; where random samples
// are compared with them it is by a z-test of every pixel, at a significance of one in a thousand for all.
#include "render/kernel_choice.h"
#include "statistics.h"
#include "support.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace vitral::test {
namespace {

constexpr double kPi = 3.14159265358979323846;

Settings picture(int width, int height) {
  Settings s;
  s.width = width, s.height = height;
  s.threads = 1;
  s.effects = only(&Effects::shadows);
  return s;
}

Material matte(float grey) {
  Material m;
  m.diffuse = {grey, grey, grey};
  return m;
}

void add_floor(Scene& scene, uint32_t material, float half, float y = 0) {
  add_quad(scene, material, {-half, y, -half}, {0, 0, 2 * half}, {2 * half, 0, 0});
}

// A white floor without ambient light.
Scene floor_under(const Light& light) {
  Scene scene;
  add_floor(scene, add_material(scene, matte(1)), 20);
  scene.ambient = {0, 0, 0};
  scene.lights = {light};
  return scene;
}

Light with_size(Light::Kind kind, const Vec3& position, int samples) {
  Light light;
  light.kind = kind;
  light.position = position;
  light.samples = samples;
  return light;
}
Light panel(const Vec3& position, float width, float height, int samples) {
  Light light = with_size(Light::Kind::rectangle, position, samples);
  light.side_u = {width, 0, 0}, light.side_v = {0, 0, height};
  return light;
}
Light ball(const Vec3& position, float radius, int samples) {
  Light light = with_size(Light::Kind::sphere, position, samples);
  light.radius = radius;
  return light;
}
Light disk(const Vec3& direction, float diameter, int samples) {
  Light light = with_size(Light::Kind::sun, {0, 0, 0}, samples);
  light.direction = normalize(direction);
  light.diameter_degrees = diameter;
  return light;
}

const Camera kFromAbove = camera_at({0, 2, 0}, {0, -1, 0}, 60, {0, 0, -1});

// Pictures of many seeds, from 1 + `first` on.
PictureSum pictures(const Scene& scene, Settings s, int count, uint32_t first = 0,
                    const Camera& camera = kFromAbove) {
  PictureSum sum;
  for (int i = 0; i < count; ++i) {
    s.seed = 1 + first + static_cast<uint32_t>(i);
    sum.add(render_scene(scene, camera, s).radiance.pixels);
  }
  return sum;
}

std::vector<Vec3> positions(const Scene& scene, Settings s, const Camera& camera = kFromAbove) {
  s.aovs = {"position"};
  return render_scene(scene, camera, s).aovs[0].pixels.pixels;
}

// The expected picture from what a point of the floor receives.
template <class Irradiance>
std::vector<Vec3> expected(const std::vector<Vec3>& points, Irradiance irradiance) {
  std::vector<Vec3> out;
  for (const Vec3& p : points) {
    const auto e = static_cast<float>(irradiance(static_cast<double>(p.x), static_cast<double>(p.z)));
    out.push_back({e, e, e});
  }
  return out;
}

// The form factor from a small patch to a parallel rectangle [0, x] x [0, y] at distance 1 above it, signed.
double corner_form_factor(double x, double y) {
  const double a = std::sqrt(1 + x * x), b = std::sqrt(1 + y * y);
  return (x / a * std::atan(y / a) + y / b * std::atan(x / b)) / (2 * kPi);
}

TEST(RectangleLight, HasTheFormFactorOfAParallelRectangle) {
  const float width = 1.5f, height = 0.8f, distance = 1.2f;
  Light light = panel({0.3f, distance, -0.2f}, width, height, 16);
  light.color = {2, 2, 2};
  const Scene scene = floor_under(light);
  const Settings s = picture(12, 8);
  const double radiance = 2 / static_cast<double>(width * height), d = static_cast<double>(distance);
  const std::vector<Vec3> closed = expected(positions(scene, s), [&](double x, double z) {
    const double x0 = (0.3 - static_cast<double>(width) / 2 - x) / d,
                 x1 = (0.3 + static_cast<double>(width) / 2 - x) / d,
                 z0 = (-0.2 - static_cast<double>(height) / 2 - z) / d,
                 z1 = (-0.2 + static_cast<double>(height) / 2 - z) / d;
    return kPi * radiance *
           (corner_form_factor(x1, z1) - corner_form_factor(x0, z1) - corner_form_factor(x1, z0) +
            corner_form_factor(x0, z0));
  });
  const PictureSum sum = pictures(scene, s, 1000);
  EXPECT_LT(greatest_z(sum, closed), critical_z(closed.size()));
  EXPECT_NEAR(sum.mean(3 * (4 * 12 + 6)) / static_cast<double>(closed[4 * 12 + 6].x), 1, 0.02);
}

// Light goes to one side only, and none comes from below the horizon: not a ray is traced there.
TEST(RectangleLight, ShinesToOneSide) {
  Scene scene = floor_under(panel({0, 1, 0}, 1, 1, 4));
  const Settings s = picture(16, 16);
  Frame frame = render_scene(scene, kFromAbove, s);
  EXPECT_EQ(frame.stats.passes[1].name, "shadows");
  EXPECT_EQ(frame.stats.passes[1].rays, 16u * 16 * 4);
  EXPECT_GT(pixel(frame, 8, 8).x, 0.1f);
  scene.lights[0].direction = {0, 1, 0};
  frame = render_scene(scene, kFromAbove, s);
  EXPECT_EQ(frame.stats.passes[1].rays, 0u);
  for (const Vec3& c : frame.radiance.pixels) ASSERT_EQ(c.x, 0);
  scene.lights[0] = panel({0, -1, 0}, 1, 1, 4);
  EXPECT_EQ(render_scene(scene, kFromAbove, s).stats.passes[1].rays, 0u);
}

// Far away, and small, every light with a size is the point light of its colour, straight on; its highlight
// too.
TEST(LightsWithASize, AreFromAfarThePointLightOfTheirColour) {
  Scene scene;
  Material shiny = matte(0.7f);
  shiny.specular = {0.5f, 0.25f, 1};
  shiny.shininess = 8;
  add_floor(scene, add_material(scene, shiny), 20);
  Light point = with_size(Light::Kind::point, {300, 300, -40}, 1);
  point.color = {160000, 80000, 40000};
  Light sun = disk(-point.position, 0.01f, 3), directional = sun;
  directional.kind = Light::Kind::directional;
  Light rectangle = panel(point.position, 0.1f, 0.1f, 3), sphere = ball(point.position, 0.1f, 3);
  rectangle.color = sphere.color = point.color;
  rectangle.direction = normalize(-point.position);
  for (const auto& [one, other] :
       {std::pair{point, rectangle}, std::pair{point, sphere}, std::pair{directional, sun}}) {
    scene.lights = {one};
    const Frame expect = render_scene(scene, kFromAbove, picture(24, 24));
    scene.lights = {other};
    const Frame frame = render_scene(scene, kFromAbove, picture(24, 24));
    float brightest = 0;
    for (size_t i = 0; i < frame.radiance.pixels.size(); ++i) {
      const Vec3 &a = expect.radiance.pixels[i], &b = frame.radiance.pixels[i];
      ASSERT_NEAR(b.x / a.x, 1, 3e-3f);
      ASSERT_NEAR(b.z / a.z, 1, 3e-3f);
      brightest = greatest(brightest, a.z / a.x);
    }
    EXPECT_GT(brightest, one.kind == Light::Kind::directional ? 1.2f : 0.3f) << "there is a highlight";
  }
}

// E = pi L (r/d)^2 cos, and L = color / (pi r^2): a sphere that is seen whole lights like a point.
TEST(SphereLight, SeenWholeLightsLikeAPointInItsMiddle) {
  const Scene scene = floor_under(ball({0.4f, 1, -0.3f}, 0.6f, 4));
  const Settings s = picture(12, 8);
  const std::vector<Vec3> closed = expected(positions(scene, s), [](double x, double z) {
    const double d2 = (x - 0.4) * (x - 0.4) + (z + 0.3) * (z + 0.3) + 1;
    return 1 / (d2 * std::sqrt(d2));
  });
  EXPECT_LT(greatest_z(pictures(scene, s, 1000), closed), critical_z(closed.size()));
}

// The half of a sphere that stands above the horizon.
TEST(SphereLight, HalfAboveTheHorizonLightsByHalf) {
  const Scene scene = floor_under(ball({0, 0, -4}, 1, 16));
  const Settings s = picture(6, 6);
  // Over the part above the floor of the cone around the horizon with sin(a) = r/d: the integral of the
  // cosine is half a disk's first moment, (2/3) sin^3(a) in the projection, plus the part it bulges by.
  const std::vector<Vec3> closed = expected(positions(scene, s), [](double x, double z) {
    const double d = std::hypot(x, z + 4), a = std::asin(1 / d);
    // Directions at height y above the horizon within the cone: their width in azimuth is 2 acos(cos a / cos
    // e).
    double sum = 0;
    constexpr int kSteps = 4000;
    for (int i = 0; i < kSteps; ++i) {
      const double e = a * (i + 0.5) / kSteps;
      sum += 2 * std::acos(std::min(std::cos(a) / std::cos(e), 1.0)) * std::cos(e) * std::sin(e);
    }
    return sum * a / kSteps / kPi;
  });
  EXPECT_LT(greatest_z(pictures(scene, s, 1000), closed), critical_z(closed.size()));
}

// Of the sun's disk, straight above, a half-plane at height 1 leaves a part that grows with x: the share of
// the disk's projection to the floor beyond an ellipse, nearly a straight line: a segment of the circle.
TEST(Sun, ThePenumbraOfAnEdgeIsASegmentOfTheDisk) {
  const float diameter = 20;
  Scene scene = floor_under(disk({0, -1, 0}, diameter, 16));
  add_quad(scene, 0, {-50, 1, -50}, {0, 0, 100}, {50, 0, 0});  // x < 0
  const Settings s = picture(24, 6);
  const Camera camera = camera_at({0, 0.5f, 0}, {0, -1, 0}, 40, {0, 0, -1});
  const double a = static_cast<double>(diameter) / 2 * kPi / 180, r = std::sin(a);
  const std::vector<Vec3> closed = expected(positions(scene, s, camera), [&](double x, double) {
    double sum = 0;
    constexpr int kSteps = 2000;
    for (int i = 0; i < kSteps; ++i) {
      const double z = r * (2 * (i + 0.5) / kSteps - 1), half = std::sqrt(r * r - z * z);
      const double edge = x * std::sqrt((1 - z * z) / (1 + x * x));  // where dx / dy = x
      sum += half + std::clamp(edge, -half, half);
    }
    return sum * 2 * r / kSteps / (kPi * r * r);
  });
  int dark = 0, lit = 0, half = 0;
  for (const Vec3& c : closed) ++(c.x < 1e-3f ? dark : c.x > 0.999f ? lit : half);
  EXPECT_GT(std::min(dark, std::min(lit, half)), 12);
  EXPECT_LT(greatest_z(pictures(scene, s, 500, 0, camera), closed), critical_z(closed.size()));
  // The circle's segment by itself is right to the second order of the disk's size.
  const std::vector<Vec3> points = positions(scene, s, camera);
  for (size_t i = 0; i < points.size(); ++i) {
    const double t = std::clamp(static_cast<double>(points[i].x) / std::tan(a), -1.0, 1.0);
    EXPECT_NEAR(static_cast<double>(closed[i].x), (std::asin(t) + t * std::sqrt(1 - t * t)) / kPi + 0.5,
                5e-3);
  }
}

TEST(Spot, LightsItsConeAndAsksNothingOutside) {
  Light light = with_size(Light::Kind::spot, {0.2f, 1.5f, 0.1f}, 1);
  light.direction = normalize(Vec3{0.1f, -1, -0.2f});
  light.inner_degrees = 15, light.outer_degrees = 30;
  light.color = {3, 2, 1};
  const Scene scene = floor_under(light);
  Settings s = picture(48, 48);
  const std::vector<Vec3> points = positions(scene, s);
  const Frame frame = render_scene(scene, kFromAbove, s);
  uint64_t inside = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const Vec3 way = light.position - points[i];
    const double d2 = static_cast<double>(dot(way, way)), d = std::sqrt(d2);
    const double cosine = -static_cast<double>(dot(way, light.direction)) / d;
    const double inner = std::cos(15 * kPi / 180), outer = std::cos(30 * kPi / 180);
    const double t = std::clamp((cosine - outer) / (inner - outer), 0.0, 1.0);
    ASSERT_NEAR(frame.radiance.pixels[i].x, 3 * t * t * (3 - 2 * t) * 1.5 / (d2 * d), 1e-5);
    ASSERT_NEAR(frame.radiance.pixels[i].z, t * t * (3 - 2 * t) * 1.5 / (d2 * d), 1e-5);
    ASSERT_GT(std::abs(cosine - outer), 1e-6) << "no pixel is on the edge";
    inside += cosine > outer;
  }
  EXPECT_GT(inside, 300u);
  EXPECT_LT(inside, 2000u);
  EXPECT_EQ(frame.stats.passes[1].rays, inside);
}

TEST(Spot, CastsThePointLightsShadow) {
  Light light = with_size(Light::Kind::spot, {0, 3, 0}, 1);
  light.inner_degrees = 89, light.outer_degrees = 90;
  Scene scene = floor_under(light);
  add_quad(scene, 0, {-0.3f, 1, -0.3f}, {0, 0, 0.6f}, {0.6f, 0, 0});
  const Settings s = picture(40, 40);
  const Frame spot = render_scene(scene, camera_at({0, 0.9f, 0}, {0, -1, 0}, 90, {0, 0, -1}), s);
  scene.lights[0].kind = Light::Kind::point;
  const Frame point = render_scene(scene, camera_at({0, 0.9f, 0}, {0, -1, 0}, 90, {0, 0, -1}), s);
  EXPECT_TRUE(same_bytes(spot, point));
}

// A penumbra, a highlight and a pane of glass under each light with a size.
Scene still_life(const Light& light) {
  Scene scene = floor_under(light);
  Material shiny = matte(0.4f), glass = matte(0);
  shiny.specular = {0.6f, 0.6f, 0.6f};
  shiny.shininess = 10;
  glass.optics = Optics::thin;
  glass.transmission = {0.9f, 0.5f, 0.2f};
  scene.materials[0] = shiny;
  add_quad(scene, 0, {-0.6f, 0.7f, -0.4f}, {0, 0, 0.8f}, {0.6f, 0, 0});
  add_quad(scene, add_material(scene, glass), {0.1f, 0.8f, -0.5f}, {0, 0, 1}, {0.6f, 0, 0});
  return scene;
}

std::vector<Light> lights_with_a_size(int samples) {
  return {panel({0.2f, 1.6f, 0}, 1, 0.6f, samples), ball({-0.3f, 1.7f, 0.2f}, 0.5f, samples),
          disk({0.2f, -1, 0.1f}, 25, samples)};
}

// Every number of samples has the expectation of 16384: 256 pictures with 64 samples of each light.
TEST(LightsWithASize, HaveOneMeanForAnyNumberOfSamples) {
  const Camera camera = camera_at({0, 0.6f, 0}, {0, -1, 0}, 80, {0, 0, -1});
  for (const Light& light : lights_with_a_size(64)) {
    Scene scene = still_life(light);
    const Settings s = picture(8, 6);
    const PictureSum reference = pictures(scene, s, 256, 100000, camera);
    for (const auto& [samples, seeds] : {std::pair{1, 600}, std::pair{2, 500}, std::pair{4, 400},
                                         std::pair{7, 300}, std::pair{16, 250}, std::pair{256, 100}}) {
      scene.lights[0].samples = samples;
      EXPECT_LT(greatest_z(pictures(scene, s, seeds, 0, camera), reference), critical_z(3 * 48))
          << samples << " samples of kind " << static_cast<int>(light.kind);
    }
  }
}

// The strata: N samples vary far less than N random ones would, which have 1/N of the variance of one.
TEST(LightsWithASize, AreStratified) {
  const auto variance = [](const Scene& scene, int samples, const Camera& camera) {
    Settings s = picture(16, 12);
    s.light_samples = samples;
    const PictureSum sum = pictures(scene, s, 40, 0, camera);
    double all = 0;
    for (size_t i = 0; i < sum.sum.size(); i += 3) all += sum.variance(i);
    return all;
  };
  const Camera camera = camera_at({0, 0.6f, 0}, {0, -1, 0}, 80, {0, 0, -1});
  for (const Light& light : lights_with_a_size(1)) {
    const Scene open = floor_under(light), blocked = still_life(light);
    const double smooth = variance(open, 1, camera), edge = variance(blocked, 1, camera);
    EXPECT_LT(variance(open, 16, camera), smooth / 16 * 0.15) << static_cast<int>(light.kind);
    EXPECT_LT(variance(open, 256, camera), smooth / 256 * 0.02) << static_cast<int>(light.kind);
    EXPECT_LT(variance(blocked, 16, camera), edge / 16 * 0.5) << static_cast<int>(light.kind);
    EXPECT_LT(variance(blocked, 256, camera), edge / 256 * 0.3) << static_cast<int>(light.kind);
  }
}

// The samples of a light in all samples of a pixel are one set: 4 times 4 of them vary as 16 do, not as four
// independent sets of 4, and have the same mean. The camera sees next to nothing, so that pixels are points.
TEST(LightsWithASize, AreStratifiedOverTheSamplesOfAPixel) {
  const Camera camera = camera_at({0, 0.6f, 0}, {0, -1, 0}, 0.01f, {0, 0, -1});
  for (const Light& light : lights_with_a_size(1)) {
    const Scene scene = floor_under(light);
    const auto sum_of = [&](int frames, int samples) {
      Settings s = picture(8, 8);
      s.samples = frames, s.light_samples = samples;
      return pictures(scene, s, 250, 0, camera);
    };
    const auto variance = [](const PictureSum& sum) {
      double all = 0;
      for (size_t i = 0; i < sum.sum.size(); i += 3) all += sum.variance(i);
      return all;
    };
    const PictureSum four = sum_of(1, 4), sixteen = sum_of(1, 16), together = sum_of(4, 4),
                     frames = sum_of(16, 1);
    const std::string what = "kind " + std::to_string(static_cast<int>(light.kind));
    EXPECT_LT(variance(sixteen), variance(four) / 4 * 0.5) << what;
    EXPECT_LT(variance(together), 1.5 * variance(sixteen)) << what;
    EXPECT_LT(variance(frames), 1.5 * variance(sixteen)) << what;
    EXPECT_LT(greatest_z(together, sixteen), critical_z(64)) << what;
    EXPECT_LT(greatest_z(frames, sixteen), critical_z(64)) << what;
  }
}

TEST(LightsWithASize, SendEachPointAsManyRaysAsAsked) {
  for (const Light& light : lights_with_a_size(5)) {
    Scene scene = floor_under(light);
    Settings s = picture(20, 20);
    EXPECT_EQ(render_scene(scene, kFromAbove, s).stats.passes[1].rays, 400u * 5);
    s.light_samples = 2;
    EXPECT_EQ(render_scene(scene, kFromAbove, s).stats.passes[1].rays, 400u * 2);
    scene.lights = {light, with_size(Light::Kind::point, {0, 3, 0}, 9), light};
    EXPECT_EQ(render_scene(scene, kFromAbove, s).stats.passes[1].rays, 400u * 5);
    s.effects.shadows = false;
    EXPECT_EQ(render_scene(scene, kFromAbove, s).stats.passes[1].rays, 0u);
  }
}

// What shows the light may stand where it is, and what is behind it casts no shadow.
TEST(LightsWithASize, EndTheirShadowRays) {
  Scene scene = floor_under(panel({0, 1, 0}, 0.8f, 0.8f, 16));
  const Camera camera = camera_at({1.2f, 0.5f, 0}, {-1, -0.5f, 0}, 60);
  const Settings s = picture(16, 16);
  const Frame open = render_scene(scene, camera, s);
  add_quad(scene, 0, {-0.4f, 1, -0.4f}, {0, 0, 0.8f}, {0.8f, 0, 0});
  add_floor(scene, 0, 20, 1.5f);
  const Frame shown = render_scene(scene, camera, s);
  for (int y = 8; y < 16; ++y)
    for (int x = 0; x < 16; ++x) ASSERT_EQ(pixel(open, x, y), pixel(shown, x, y));

  scene = floor_under(ball({0, 1, 0}, 0.4f, 16));
  const Frame without = render_scene(scene, camera, s);
  add_triangles(scene, 0, sphere({0, 1, 0}, 0.4f, 12));
  const Frame with = render_scene(scene, camera, s);
  for (int y = 10; y < 16; ++y)
    for (int x = 0; x < 16; ++x) ASSERT_EQ(pixel(without, x, y), pixel(with, x, y));
}

TEST(LightsWithASize, AreTintedByGlass) {
  const Camera camera = camera_at({0, 0.4f, 0}, {0, -1, 0}, 60, {0, 0, -1});
  const Settings s = picture(20, 20);
  Settings unshadowed = s;
  unshadowed.effects = only(&Effects::ambient_occlusion);  // there are trees
  for (const Light& light : lights_with_a_size(4)) {
    Scene scene = floor_under(light);
    const Frame open = render_scene(scene, camera, s);
    Material glass = matte(0);
    glass.optics = Optics::thin;
    glass.transmission = {0.9f, 0.5f, 0.25f};
    add_floor(scene, add_material(scene, glass), 20, 0.5f);
    const Frame tinted = render_scene(scene, camera, s), plain = render_scene(scene, camera, unshadowed);
    scene.mesh.triangle_material[2] = scene.mesh.triangle_material[3] = 0;
    const Frame dark = render_scene(scene, camera, s);
    for (int y = 0; y < 20; ++y) {
      for (int x = 0; x < 20; ++x) {
        ASSERT_GT(pixel(open, x, y).x, 0.05f);
        ASSERT_NEAR(pixel(tinted, x, y).x, 0.9f * pixel(open, x, y).x, 1e-5f);
        ASSERT_NEAR(pixel(tinted, x, y).z, 0.25f * pixel(open, x, y).z, 1e-5f);
        ASSERT_EQ(pixel(dark, x, y).x, 0);
        ASSERT_EQ(pixel(plain, x, y), pixel(open, x, y)) << "without shadows nothing keeps the light";
      }
    }
  }
}

// The report darkens the finished colour by one half where light is blocked: by the mean of that over the
// samples, which is also what the picture of the shadows tells.
TEST(LightsWithASize, DarkenTheReportsColourByTheirMean) {
  Scene scene = floor_under(disk({0, -1, 0}, 20, 16));
  add_quad(scene, 0, {-50, 1, -50}, {0, 0, 100}, {50, 0, 0});
  const Camera camera = camera_at({0, 0.5f, 0}, {0, -1, 0}, 40, {0, 0, -1});
  Settings s = picture(24, 6);
  s.aovs = {"shadow"};
  s.compositing = Compositing::report;
  const Frame report = render_scene(scene, camera, s);
  s.effects = kNoEffects;
  const Frame open = render_scene(scene, camera, s);
  int part = 0;
  for (size_t i = 0; i < report.radiance.pixels.size(); ++i) {
    const float visible = report.aovs[0].pixels.pixels[i].x;
    ASSERT_NEAR(report.radiance.pixels[i].x, open.radiance.pixels[i].x * (0.5f + 0.5f * visible), 1e-5f);
    ASSERT_EQ(open.aovs[0].pixels.pixels[i].x, 1);
    part += visible > 0 && visible < 1;
  }
  EXPECT_GT(part, 20);
  EXPECT_EQ(report.aovs[0].pixels.row(3)[0].x, 0);
  EXPECT_EQ(report.aovs[0].pixels.row(3)[23].x, 1);
}

// Every kind at once, with mirrors and glass.
Scene all_lights() {
  Scene scene = still_life(panel({0.2f, 1.6f, 0}, 1, 0.6f, 5));
  Material mirror = matte(0.1f);
  mirror.optics = Optics::mirror;
  mirror.specular = {0.8f, 0.8f, 0.8f};
  mirror.shininess = 40;
  add_triangles(scene, add_material(scene, mirror), sphere({0.4f, 0.3f, 0.9f}, 0.3f, 8));
  scene.lights.push_back(ball({-1, 1.2f, 0.8f}, 0.3f, 4));
  scene.lights.push_back(disk({0.4f, -1, -0.3f}, 9, 8));
  Light spot = with_size(Light::Kind::spot, {1, 2, 1}, 1);
  spot.direction = normalize(Vec3{-0.4f, -1, -0.5f});
  spot.inner_degrees = 10, spot.outer_degrees = 35;
  scene.lights.push_back(spot);
  scene.lights.push_back(with_size(Light::Kind::point, {-1, 2, -1}, 1));
  return scene;
}

TEST(LightsWithASize, GiveOneSetOfBytes) {
  const Scene scene = all_lights();
  const Camera camera = camera_at({0, 1.5f, 3}, {0, -0.45f, -1}, 50);
  for (const Primary primary : {Primary::raster, Primary::trace}) {
    Settings s = picture(70, 50);
    s.effects = {true, true, true, true};
    s.ao_samples = 4;
    s.isa = Isa::scalar;
    s.primary = primary;
    const Frame whole = render_scene(scene, camera, s);
    for (const Kernels* kernels : available_kernels()) {
      for (const int threads : {1, 5}) {
        s.threads = threads;
        const std::string name = kernels->isa;
        s.isa = name == "scalar" ? Isa::scalar
                : name == "v2"   ? Isa::v2
                : name == "avx2" ? Isa::avx2
                                 : Isa::avx512;
        const Frame frame = render_scene(scene, camera, s);
        EXPECT_TRUE(same_bytes(whole, frame)) << name << " " << threads;
        EXPECT_EQ(frame.stats.passes[1].rays, whole.stats.passes[1].rays);
      }
    }
    s.crop = {13, 9, 41, 30};
    const Frame part = render_scene(scene, camera, s);
    for (int y = 0; y < 30; ++y)
      for (int x = 0; x < 41; ++x) ASSERT_EQ(pixel(part, x, y), pixel(whole, 13 + x, 9 + y));
  }
}

TEST(LightsWithASize, CountTheirWork) {
  const Camera camera = camera_at({0, 1.5f, 3}, {0, -0.45f, -1}, 50);
  Settings s = picture(45, 40);
  s.effects = {true, true, true, false};
  const Frame plain = render_scene(all_lights(), camera, s);
  s.aovs = {"cost"};
  const Frame counted = render_scene(all_lights(), camera, s);
  EXPECT_TRUE(same_bytes(plain, counted));
  double sum = 0;
  for (const Vec3& v : counted.aovs[0].pixels.pixels) sum += static_cast<double>(v.x);
  EXPECT_NEAR(sum / static_cast<double>(work_of(counted.stats.traversal)), 1, 1e-5);
  const PassStats& shadows = counted.stats.passes[1];
  EXPECT_EQ(shadows.rays, plain.stats.passes[1].rays);
  EXPECT_EQ(shadows.traversal.rays_traced + shadows.traversal.rays_culled, shadows.rays);
  EXPECT_LE(shadows.traversal.rays_traced, shadows.rays);
  EXPECT_GT(shadows.traversal.rays_traced, 10000u);
}

TEST(LightsWithASize, OutOfRangeAreAUsageError) {
  const auto refused = [](Light light) {
    try {
      render_scene(floor_under(light), kFromAbove, picture(4, 4));
    } catch (const std::runtime_error&) {
      return true;
    }
    return false;
  };
  EXPECT_FALSE(refused(ball({0, 1, 0}, 0.5f, 1)));
  EXPECT_TRUE(refused(ball({0, 1, 0}, 0.5f, 0)));
  EXPECT_TRUE(refused(ball({0, 1, 0}, 0.5f, kMostLightSamples + 1)));
  EXPECT_TRUE(refused(ball({0, 1, 0}, 0, 1)));
  EXPECT_TRUE(refused(disk({0, -1, 0}, 0, 1)));
  EXPECT_TRUE(refused(disk({0, -1, 0}, 181, 1)));
}

}  // namespace
}  // namespace vitral::test
