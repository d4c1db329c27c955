// Closed forms of light: what a person could work out with pencil and paper.
#include "math/fresnel.h"
#include "support.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

namespace vitral::test {
namespace {

Settings small(int width = 64, int height = 64) {
  Settings s;
  s.width = width;
  s.height = height;
  s.threads = 1;
  s.effects = kNoEffects;
  return s;
}

Material matte(const Vec3& color) {
  Material m;
  m.diffuse = color;
  return m;
}

// A floor of side 2 * half around the origin, facing up.
void add_floor(Scene& scene, uint32_t material, float half, float y = 0) {
  add_quad(scene, material, {-half, y, -half}, {0, 0, 2 * half}, {2 * half, 0, 0});
}

const Camera kFromAbove = camera_at({0, 4, 0}, {0, -1, 0}, 60, {0, 0, -1});

const Vec3& aov(const Frame& frame, size_t which, int x, int y) {
  return frame.aovs[which].pixels.row(y)[x];
}

// The pixels of the first auxiliary picture, from above.
std::vector<Vec3> first_aov(const Scene& scene, const Settings& settings) {
  return render_scene(scene, kFromAbove, settings).aovs.at(0).pixels.pixels;
}

TEST(Light, LambertsCosine) {
  Scene scene;
  add_floor(scene, add_material(scene, matte({0.5f, 0.25f, 1})), 10);
  scene.ambient = {0.1f, 0.2f, 0.3f};
  scene.lights = {sun({1, -1, 0}, {0.8f, 0.6f, 0.4f})};
  const Frame frame = render_scene(scene, kFromAbove, small());
  const float cosine = std::sqrt(0.5f);
  for (const Vec3& c : frame.radiance.pixels) {
    ASSERT_NEAR(c.x, 0.5f * (0.1f + cosine * 0.8f), 1e-6);
    ASSERT_NEAR(c.y, 0.25f * (0.2f + cosine * 0.6f), 1e-6);
    ASSERT_NEAR(c.z, 1.0f * (0.3f + cosine * 0.4f), 1e-6);
  }
}

TEST(Light, FromBehindOnlyTheAmbientPartRemains) {
  Scene scene;
  add_floor(scene, add_material(scene, matte({0.5f, 0.5f, 0.5f})), 10);
  scene.ambient = {0.5f, 0.5f, 0.5f};
  scene.lights = {sun({0, 1, 0})};
  Settings s = small();
  s.effects = only(&Effects::shadows);
  for (const Vec3& c : render_scene(scene, kFromAbove, s).radiance.pixels) ASSERT_NEAR(c.x, 0.25f, 1e-6);
}

TEST(Light, PointLightFallsOffWithTheSquare) {
  Scene scene;
  add_floor(scene, add_material(scene, matte({1, 1, 1})), 10);
  scene.ambient = {0, 0, 0};
  Light lamp;
  lamp.kind = Light::Kind::point;
  lamp.position = {0, 2, 0};
  scene.lights = {lamp};
  Settings s = small();
  s.effects = only(&Effects::shadows);
  s.aovs = {"position"};
  const Frame frame = render_scene(scene, kFromAbove, s);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const Vec3 p = aov(frame, 0, x, y);
      const double d2 = static_cast<double>(p.x) * static_cast<double>(p.x) +
                        static_cast<double>(p.z) * static_cast<double>(p.z) + 4;
      ASSERT_NEAR(pixel(frame, x, y).x, 2 / (d2 * std::sqrt(d2)), 1e-5);
    }
  }
}

TEST(Light, BlinnHighlight) {
  Scene scene;
  Material m = matte({0, 0, 0});
  m.specular = {1, 0.5f, 0.25f};
  m.shininess = 20;
  add_floor(scene, add_material(scene, m), 10);
  scene.ambient = {0, 0, 0};
  scene.lights = {sun({0, -1, 0})};
  Settings s = small();
  s.aovs = {"position"};
  const Frame frame = render_scene(scene, kFromAbove, s);
  for (int y = 0; y < 64; y += 7) {
    for (int x = 0; x < 64; x += 7) {
      const Vec3 p = aov(frame, 0, x, y);
      const Vec3 h = normalize(Vec3{0, 1, 0} + normalize(Vec3{0, 4, 0} - p));
      const double expected = std::pow(static_cast<double>(h.y), 20.0);
      ASSERT_NEAR(pixel(frame, x, y).x, expected, 1e-5);
      ASSERT_NEAR(pixel(frame, x, y).z, expected / 4, 1e-5);
    }
  }
}

// The shadow of a square under a slanted sun, pixel by pixel: centres at least 1e-4 from its outline.
TEST(Shadow, OfASquareIsExact) {
  Scene scene;
  const uint32_t white = add_material(scene, matte({1, 1, 1}));
  add_floor(scene, white, 20);
  add_quad(scene, white, {-0.5f, 1, -0.5f}, {0, 0, 1}, {1, 0, 0});  // hides x, z in [-0.5, 0.5] at height 1
  scene.ambient = {0.25f, 0.25f, 0.25f};
  scene.lights = {sun({1, -1, 0.5f})};  // the shadow lies 1 to the right and 0.5 down
  Settings s = small(128, 128);
  s.effects = only(&Effects::shadows);
  s.aovs = {"position", "shadow"};
  const Frame frame = render_scene(scene, kFromAbove, s);
  int dark = 0, lit = 0;
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 128; ++x) {
      const Vec3 p = aov(frame, 0, x, y);
      if (p.y > 0.5f) continue;
      const float dx = std::abs(p.x - 1), dz = std::abs(p.z - 0.5f);
      if (std::abs(dx - 0.5f) < 1e-4f || std::abs(dz - 0.5f) < 1e-4f) continue;
      const bool inside = dx < 0.5f && dz < 0.5f;
      ASSERT_EQ(aov(frame, 1, x, y).x, inside ? 0.0f : 1.0f) << p.x << " " << p.z;
      ASSERT_NEAR(pixel(frame, x, y).x, inside ? 0.25f : 0.25f + 1 / 1.5f, 1e-5);
      ++(inside ? dark : lit);
    }
  }
  EXPECT_GT(dark, 200);
  EXPECT_GT(lit, 5000);
}

TEST(Shadow, EndsAtAPointLight) {
  Scene scene;
  const uint32_t white = add_material(scene, matte({1, 1, 1}));
  add_floor(scene, white, 10);
  add_floor(scene, white, 10, 3);  // a ceiling behind the light must not shade the floor
  Light lamp;
  lamp.kind = Light::Kind::point;
  lamp.position = {0, 2, 0};
  scene.lights = {lamp};
  Settings s = small();
  s.effects = only(&Effects::shadows);
  s.aovs = {"shadow"};
  const Frame frame = render_scene(scene, camera_at({0, 1.5f, 0}, {0, -1, 0}, 60, {0, 0, -1}), s);
  for (const Vec3& v : frame.aovs[0].pixels.pixels) ASSERT_EQ(v.x, 1);
}

TEST(Shadow, EverySheetOfGlassTints) {
  Scene scene;
  add_floor(scene, add_material(scene, matte({1, 1, 1})), 20);
  Material glass = matte({0, 0, 0});
  glass.optics = Optics::thin;
  glass.transmission = {0.5f, 1, 0.25f};
  const uint32_t sheet = add_material(scene, glass);
  add_floor(scene, sheet, 20, 6);
  add_floor(scene, sheet, 20, 7);  // above the camera: only the sun passes them
  scene.ambient = {0, 0, 0};
  scene.lights = {sun({0.3f, -1, 0.2f})};
  Settings s = small();
  s.effects = only(&Effects::shadows);
  const float lambert = 1 / std::sqrt(1.13f);
  for (const Vec3& c : render_scene(scene, kFromAbove, s).radiance.pixels) {
    ASSERT_NEAR(c.x, 0.25f * lambert, 1e-5);
    ASSERT_NEAR(c.y, lambert, 1e-5);
    ASSERT_NEAR(c.z, 0.0625f * lambert, 1e-5);
  }
}

TEST(Compositing, ReportDarkensTheFinishedColour) {
  Scene scene;
  const uint32_t white = add_material(scene, matte({1, 1, 1}));
  add_floor(scene, white, 20);
  add_quad(scene, white, {-50, 8, -50}, {0, 0, 100}, {100, 0, 0});  // a roof over everything
  scene.ambient = {0.2f, 0.2f, 0.2f};
  scene.lights = {sun({0, -1, 0}, {0.6f, 0.6f, 0.6f})};
  Settings s = small();
  s.effects = only(&Effects::shadows);
  s.compositing = Compositing::report;
  for (const Vec3& c : render_scene(scene, kFromAbove, s).radiance.pixels)
    ASSERT_NEAR(c.x, 0.5f * 0.8f, 1e-6);
  s.compositing = Compositing::physical;
  for (const Vec3& c : render_scene(scene, kFromAbove, s).radiance.pixels) ASSERT_NEAR(c.x, 0.2f, 1e-6);
}

TEST(Ambient, AnOpenPlaneSeesTheWholeSky) {
  Scene scene;
  add_floor(scene, add_material(scene, matte({1, 1, 1})), 10);
  Settings s = small();
  s.effects = only(&Effects::ambient_occlusion);
  s.ao_distance = 100;
  s.aovs = {"ao"};
  const Frame frame = render_scene(scene, kFromAbove, s);
  for (const Vec3& v : frame.aovs[0].pixels.pixels) ASSERT_EQ(v.x, 1);
}

// At the foot of an endless wall half of the cosine-weighted sky is hidden; at the inner corner of
// two walls three quarters. Higher up the exponent applies to the same share.
TEST(Ambient, HalfAtTheFootOfAWall) {
  Scene scene;
  const uint32_t white = add_material(scene, matte({1, 1, 1}));
  add_floor(scene, white, 1000);
  add_quad(scene, white, {0, 0, -1000}, {0, 0, 2000}, {0, 1000, 0});  // the wall x = 0
  Settings s = small(32, 32);
  s.effects = only(&Effects::ambient_occlusion);
  s.ao_distance = 1e6f;
  s.ao_samples = 1024;
  s.aovs = {"ao"};
  const Camera close = camera_at({0.05f, 0.2f, 0}, {0, -1, 0}, 10, {0, 0, -1});
  Frame frame = render_scene(scene, close, s);
  double mean = 0;
  for (const Vec3& v : frame.aovs[0].pixels.pixels) mean += static_cast<double>(v.x) / 1024;
  EXPECT_NEAR(mean, 0.5, 0.003);

  s.ao_exponent = 2;
  const Frame squared = render_scene(scene, close, s);
  for (int i = 0; i < 1024; ++i) {
    const size_t k = static_cast<size_t>(i);
    const float v = frame.aovs[0].pixels.pixels[k].x;
    ASSERT_NEAR(squared.aovs[0].pixels.pixels[k].x, v * v, 1e-6);
  }

  add_quad(scene, white, {-1000, 0, 0.1f}, {0, 1000, 0}, {2000, 0, 0});  // the wall z = 0.1, facing -z
  s.ao_exponent = 1;
  frame = render_scene(scene, camera_at({0.05f, 0.2f, 0.05f}, {0, -1, 0}, 10, {0, 0, -1}), s);
  mean = 0;
  for (const Vec3& v : frame.aovs[0].pixels.pixels) mean += static_cast<double>(v.x) / 1024;
  EXPECT_NEAR(mean, 0.25, 0.003);
}

TEST(Ambient, EndsAtItsDistanceAndPassesGlass) {
  Scene scene;
  add_floor(scene, add_material(scene, matte({1, 1, 1})), 100);
  add_floor(scene, add_material(scene, matte({1, 1, 1})), 100, 5);
  Settings s = small();
  s.effects = only(&Effects::ambient_occlusion);
  s.aovs = {"ao"};
  s.ao_distance = 4.9f;
  for (const Vec3& v : first_aov(scene, s)) ASSERT_EQ(v.x, 1);
  s.ao_distance = 1000;
  double mean = 0;  // what shows between floor and ceiling at the horizon: (5/100)^2
  for (const Vec3& v : first_aov(scene, s)) mean += static_cast<double>(v.x) / 4096;
  EXPECT_NEAR(mean, 0.0025, 0.0015);
  scene.materials[1].optics = Optics::solid;
  for (const Vec3& v : first_aov(scene, s)) ASSERT_EQ(v.x, 1);
}

// A mirror floor under a uniformly bright ceiling: Ks times what the ceiling sends.
TEST(Reflection, OfAMirror) {
  Scene scene;
  Material mirror = matte({0, 0, 0});
  mirror.optics = Optics::mirror;
  mirror.specular = {0.9f, 0.5f, 0.1f};
  add_floor(scene, add_material(scene, mirror), 50);
  add_floor(scene, add_material(scene, matte({0.5f, 0.5f, 0.5f})), 50, 6);
  scene.ambient = {1, 1, 1};
  Settings s = small();
  s.effects = only(&Effects::reflection);
  s.aovs = {"reflection"};
  const Frame frame = render_scene(scene, kFromAbove, s);
  for (int i = 0; i < 64 * 64; ++i) {
    const Vec3 c = frame.radiance.pixels[static_cast<size_t>(i)];
    ASSERT_NEAR(c.x, 0.45f, 1e-6);
    ASSERT_NEAR(c.z, 0.05f, 1e-6);
    ASSERT_TRUE(frame.aovs[0].pixels.pixels[static_cast<size_t>(i)] == c);
  }
  s.effects = kNoEffects;
  for (const Vec3& c : render_scene(scene, kFromAbove, s).radiance.pixels) ASSERT_EQ(c.x, 0);
}

// Two facing mirrors: n bounces are n, and a path ends when its weight is not worth it.
TEST(Reflection, DepthAndImportanceLimits) {
  Scene scene;
  Material mirror = matte({0.01f, 0.01f, 0.01f});
  mirror.optics = Optics::mirror;
  mirror.specular = {0.5f, 0.5f, 0.5f};
  const uint32_t m = add_material(scene, mirror);
  add_floor(scene, m, 1000);
  add_floor(scene, m, 1000, 5);
  scene.ambient = {1, 1, 1};
  Settings s = small(16, 16);
  s.effects = only(&Effects::reflection);
  s.min_importance = 0;
  const Camera narrow = camera_at({0, 4, 0}, {0, -1, 0}, 1, {0, 0, -1});
  for (int depth = 0; depth <= 6; ++depth) {
    s.max_depth = depth;
    float expected = 0, weight = 0.01f;
    for (int i = 0; i <= depth; ++i, weight *= 0.5f) expected += weight;
    for (const Vec3& c : render_scene(scene, narrow, s).radiance.pixels)
      ASSERT_NEAR(c.x, expected, 1e-7) << depth;
  }
  s.max_depth = 100;
  s.min_importance = 0.2f;  // weights 1/2 and 1/4 are followed, 1/8 is not
  const Frame frame = render_scene(scene, narrow, s);
  for (const PassStats& p : frame.stats.passes) {
    if (p.name == "reflection") {
      EXPECT_EQ(p.rays, 2u * 16 * 16);
    }
  }
  for (const Vec3& c : frame.radiance.pixels) ASSERT_NEAR(c.x, 0.01f * 1.75f, 1e-7);
}

// One pane over a bright floor, seen straight on: (1-F) Tf of the floor and F of the background.
TEST(Refraction, OfAThinPane) {
  for (const Fresnel model : {Fresnel::exact, Fresnel::schlick, Fresnel::report}) {
    Scene scene;
    add_floor(scene, add_material(scene, matte({1, 1, 1})), 50);
    Material pane = matte({0, 0, 0});
    pane.optics = Optics::thin;
    pane.transmission = {0.9f, 0.8f, 0.7f};
    add_floor(scene, add_material(scene, pane), 50, 1);
    scene.ambient = {0.5f, 0.5f, 0.5f};
    scene.background.color = {0.2f, 0.4f, 0.8f};
    Settings s = small(16, 16);
    s.effects = {false, true, true, false};
    s.fresnel = model;
    s.min_importance = 0;
    const Frame frame = render_scene(scene, camera_at({0, 4, 0}, {0, -1, 0}, 1, {0, 0, -1}), s);
    const float f = fresnel(model, 1, 1 / 1.5f);
    for (const Vec3& c : frame.radiance.pixels) {
      ASSERT_NEAR(c.x, (1 - f) * 0.9f * 0.5f + f * 0.2f, 1e-4);
      ASSERT_NEAR(c.z, (1 - f) * 0.7f * 0.5f + f * 0.8f, 1e-4);
    }
  }
}

// Straight on through a slab of solid glass nothing bends, but each face takes its Fresnel part:
// entering and leaving must use the two sides' ratio. Seen at a slant, the slab shifts the ray by
// d sin(i - t) / cos(t).
TEST(Refraction, OfASolidSlab) {
  Scene scene;
  Material glass = matte({0, 0, 0});
  glass.optics = Optics::solid;
  glass.index = 1.5f;
  const uint32_t slab = add_material(scene, glass);
  add_floor(scene, slab, 50, 2);
  add_quad(scene, slab, {-50, 1, -50}, {100, 0, 0}, {0, 0, 100});  // the lower face looks down
  const uint32_t black = add_material(scene, matte({0, 0, 0})), white = add_material(scene, matte({1, 1, 1}));
  add_quad(scene, black, {-50, 0, -50}, {0, 0, 100}, {50, 0, 0});  // x < 0 black, x > 0 white
  add_quad(scene, white, {0, 0, -50}, {0, 0, 100}, {50, 0, 0});
  scene.ambient = {1, 1, 1};
  scene.background.color = {0, 0, 0};
  Settings s = small(64, 16);
  s.effects = {false, false, true, false};
  s.min_importance = 0;
  const double angle = 0.9, inside = std::asin(std::sin(angle) / 1.5);
  const Vec3 view{static_cast<float>(std::sin(angle)), static_cast<float>(-std::cos(angle)), 0};
  // Aimed so that the ray through the middle of the picture, shifted, lands on x = 0.
  const double x0 = -(3 * std::tan(angle) + std::tan(inside));
  const Frame frame = render_scene(scene, camera_at({static_cast<float>(x0), 4, 0}, view, 1, {0, 0, -1}), s);
  const float cos_i = static_cast<float>(std::cos(angle)), cos_t = static_cast<float>(std::cos(inside));
  const float through = (1 - fresnel_exact(cos_i, 1 / 1.5f)) * (1 - fresnel_exact(cos_t, 1.5f));
  // The edge between black and white must be in the middle of the picture.
  int bright = 0;
  for (int x = 0; x < 64; ++x) {
    for (int y = 0; y < 16; ++y) {
      if (pixel(frame, x, y).x > 0.5f) {
        ++bright;
        ASSERT_NEAR(pixel(frame, x, y).x, through, 0.01);
      } else {
        ASSERT_LT(pixel(frame, x, y).x, 0.01f);
      }
    }
  }
  EXPECT_NEAR(bright, 64 * 16 / 2, 64);
}

// From inside glass, beyond the critical angle, the surface is a perfect mirror.
TEST(Refraction, TotalInternalReflection) {
  Scene scene;
  Material glass = matte({0, 0, 0});
  glass.optics = Optics::solid;
  add_quad(scene, add_material(scene, glass), {-50, 0, -50}, {0, 0, 100}, {100, 0, 0});  // glass below y = 0
  const uint32_t white = add_material(scene, matte({1, 1, 1}));
  add_quad(scene, white, {30, -60, -60}, {0, 0, 120}, {0, 60, 0});  // seen by the mirrored ray, at x = 30
  scene.ambient = {0.7f, 0.7f, 0.7f};
  scene.background.color = {0, 0, 0};
  Settings s = small(16, 16);
  s.effects = {false, false, true, false};
  const float over = std::asin(1 / 1.5f) + 0.05f;
  const Camera up = camera_at({0, -5, 0}, {std::sin(over), std::cos(over), 0}, 2, {0, 0, 1});
  for (const Vec3& c : render_scene(scene, up, s).radiance.pixels) ASSERT_NEAR(c.x, 0.7f, 1e-5);
  const float under = std::asin(1 / 1.5f) - 0.15f;
  const Camera through = camera_at({0, -5, 0}, {std::sin(under), std::cos(under), 0}, 2, {0, 0, 1});
  for (const Vec3& c : render_scene(scene, through, s).radiance.pixels) ASSERT_NEAR(c.x, 0, 1e-5);
}

TEST(Refraction, DissolveShowsWhatLiesStraightBehind) {
  Scene scene;
  add_floor(scene, add_material(scene, matte({1, 0, 0})), 50);
  Material veil = matte({0, 1, 0});
  veil.optics = Optics::dissolve;
  veil.opacity = 0.25f;
  add_floor(scene, add_material(scene, veil), 50, 1);
  scene.ambient = {1, 1, 1};
  Settings s = small(16, 16);
  s.effects = only(&Effects::refraction);
  for (const Vec3& c : render_scene(scene, kFromAbove, s).radiance.pixels) {
    ASSERT_NEAR(c.x, 0.75f, 1e-6);
    ASSERT_NEAR(c.y, 0.25f, 1e-6);
  }
}

// What a mirror shows is lit, shadowed and occluded like what the camera sees directly.
TEST(Reflection, HitsGetTheFullTreatment) {
  Scene scene;
  const uint32_t white = add_material(scene, matte({1, 1, 1}));
  add_floor(scene, white, 20);
  add_quad(scene, white, {-1, 1, -1}, {0, 0, 2}, {2, 0, 0});  // casts a shadow around the origin
  Material mirror = matte({0, 0, 0});
  mirror.optics = Optics::mirror;
  mirror.specular = {1, 1, 1};
  scene.lights = {sun({0, -1, 0}, {0.5f, 0.5f, 0.5f})};
  scene.ambient = {0.5f, 0.5f, 0.5f};
  Settings s = small(32, 32);
  s.effects = {true, true, true, true};
  s.ao_distance = 3;
  // Directly from below the occluder's height, and by a mirror that looks at the same place.
  const Frame direct = render_scene(scene, camera_at({-3, 0.5f, 0}, {1, -0.15f, 0}, 5), s);
  add_quad(scene, add_material(scene, mirror), {-3, -10, -10}, {0, 20, 0}, {0, 0, 20});  // the plane x = -3
  const Frame mirrored = render_scene(scene, camera_at({-2.9f, 0.515f, 0}, {-1, -0.15f, 0}, 5), s);
  EXPECT_LT(pixel(direct, 16, 16).x, 0.45f);  // in the shadow and partly occluded
  EXPECT_NEAR(pixel(mirrored, 16, 16).x, pixel(direct, 16, 16).x, 0.12f);
}

// A speck far away, or a camera far away, must not move the origins of rays elsewhere.
TEST(Shadow, DistantTrianglesAndCamerasChangeNothing) {
  Scene scene;
  const uint32_t white = add_material(scene, matte({1, 1, 1}));
  add_floor(scene, white, 2);
  add_quad(scene, white, {-0.5f, 0.001f, -0.5f}, {0, 0, 1}, {1, 0, 0});  // a millimetre above the floor
  add_quad(scene, white, {0.7f, 0, -1}, {0, 0, 2}, {0, 1, 0});
  scene.lights = {sun({1, -1, 0.5f})};
  Settings s = small();
  s.effects = {true, false, false, true};
  s.ao_distance = 0.5f;
  const Frame expected = render_scene(scene, kFromAbove, s);
  for (const float far : {1e4f, 1e6f, 1e9f}) {
    Scene crowded = scene;
    add_quad(crowded, white, {far, -far, far}, {1, 0, 0}, {0, 0, 1});
    EXPECT_TRUE(same_bytes(expected, render_scene(crowded, kFromAbove, s))) << far;
  }
  s.aovs = {"ao"};
  double mean[2] = {0, 0};
  for (const int i : {0, 1}) {
    Camera c = camera_at({0, i == 0 ? 10.0f : 10000.0f, 0}, {0, -1, 0}, i == 0 ? 20.0f : 0.02f, {0, 0, -1});
    c.near = c.position.y * 0.5f, c.far = c.position.y * 2;
    const Frame frame = render_scene(scene, c, s);
    for (const Vec3& v : frame.aovs[0].pixels.pixels) mean[i] += static_cast<double>(v.x) / 4096;
  }
  EXPECT_LT(mean[0], 0.98);
  EXPECT_NEAR(mean[0], mean[1], 0.02);
}

TEST(NotFinite, PixelsAreRedAndCounted) {
  Scene scene;
  add_floor(scene, add_material(scene, matte({1, 1, 1})), 1);
  scene.ambient = {std::numeric_limits<float>::infinity(), 0, 0};
  const Frame frame = render_scene(scene, kFromAbove, small());
  EXPECT_EQ(frame.stats.not_finite_pixels, frame.stats.covered_pixels);
  EXPECT_GT(frame.stats.covered_pixels, 100u);
  const Rgb8 middle = frame.pixels.row(32)[32];
  EXPECT_EQ(middle.r, 255);
  EXPECT_EQ(middle.g, 0);
  EXPECT_TRUE((pixel(frame, 32, 32) == Vec3{1, 0, 0}));
}

TEST(Background, ShowsWhereNothingIs) {
  Scene scene;
  scene.background.color = {0.25f, 0.5f, 1};
  Settings s = small();
  s.effects = {true, true, true, true};
  const Frame frame = render_scene(scene, kFromAbove, s);
  EXPECT_EQ(frame.stats.covered_pixels, 0u);
  for (const Vec3& c : frame.radiance.pixels) ASSERT_TRUE((c == Vec3{0.25f, 0.5f, 1}));
}

}  // namespace
}  // namespace vitral::test
