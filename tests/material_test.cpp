// Closed forms of what materials do to light: reflectivity, deep mirrors, absorption, emission.
#include "math/absorption.h"
#include "math/fresnel.h"
#include "support.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

namespace vitral::test {
namespace {

Settings small(const Effects& effects, int side = 16) {
  Settings s;
  s.width = s.height = side;
  s.threads = 1;
  s.effects = effects;
  s.min_importance = 0;
  return s;
}

constexpr Effects kRays{false, true, true, false};

Material matte(const Vec3& color) {
  Material m;
  m.diffuse = color;
  return m;
}

Material glass(Optics optics, float index = 1.5f) {
  Material m = matte({0, 0, 0});
  m.optics = optics;
  m.index = index;
  return m;
}

// Sides of length 2 * half around the y axis, facing up or down.
void add_floor(Scene& scene, uint32_t material, float half, float y = 0) {
  add_quad(scene, material, {-half, y, -half}, {0, 0, 2 * half}, {2 * half, 0, 0});
}
void add_ceiling(Scene& scene, uint32_t material, float half, float y) {
  add_quad(scene, material, {-half, y, -half}, {2 * half, 0, 0}, {0, 0, 2 * half});
}

const Camera kWide = camera_at({0, 4, 0}, {0, -1, 0}, 60, {0, 0, -1});
const Camera kNarrow = camera_at({0, 4, 0}, {0, -1, 0}, 1, {0, 0, -1});

const PassStats& pass_of(const Frame& frame, const std::string& name) {
  for (const PassStats& p : frame.stats.passes) {
    if (p.name == name) return p;
  }
  throw std::runtime_error("no pass " + name);
}

TEST(Reflectivity, ComesOnTopOfADiffuseSurfaceAtEveryAngle) {
  Scene scene;
  Material m = matte({0.5f, 0.25f, 0.125f});
  m.reflectivity = {0.2f, 0.4f, 0.6f};
  add_floor(scene, add_material(scene, m), 50);
  add_floor(scene, add_material(scene, matte({0.5f, 0.5f, 0.5f})), 50, 6);
  scene.ambient = {1, 1, 1};
  for (const Vec3& c : render_scene(scene, kWide, small(only(&Effects::reflection))).radiance.pixels) {
    ASSERT_NEAR(c.x, 0.5f + 0.2f * 0.5f, 1e-6);
    ASSERT_NEAR(c.y, 0.25f + 0.4f * 0.5f, 1e-6);
    ASSERT_NEAR(c.z, 0.125f + 0.6f * 0.5f, 1e-6);
  }
  for (const Vec3& c : render_scene(scene, kWide, small(kNoEffects)).radiance.pixels) ASSERT_EQ(c.x, 0.5f);
}

// The optics share what is not mirrored: a white world seen in any glass stays as white as it is.
TEST(Reflectivity, OfGlassLeavesTheRestToIt) {
  for (const Optics optics : {Optics::thin, Optics::dissolve, Optics::mirror, Optics::polished}) {
    Scene scene;
    add_floor(scene, add_material(scene, matte({1, 1, 1})), 50);
    Material m = glass(optics);
    m.reflectivity = {0.3f, 0, 1};
    m.transmission = {0.9f, 0.9f, 0.9f};
    m.specular = {0.5f, 0.5f, 0.5f};
    m.opacity = 0.25f;
    add_floor(scene, add_material(scene, m), 50, 1);
    scene.ambient = {0.5f, 0.5f, 0.5f};
    scene.background.color = {0.2f, 0.2f, 0.2f};
    const float f = fresnel_exact(1, 1 / 1.5f);
    const float by_optics = optics == Optics::thin       ? (1 - f) * 0.9f * 0.5f + f * 0.2f
                            : optics == Optics::dissolve ? 0.75f * 0.5f
                            : optics == Optics::mirror   ? 0.5f * 0.2f
                                                         : 0.5f * f * 0.2f;
    for (const Vec3& c : render_scene(scene, kNarrow, small(kRays)).radiance.pixels) {
      ASSERT_NEAR(c.x, 0.7f * by_optics + 0.3f * 0.2f, 1e-4) << static_cast<int>(optics);
      ASSERT_NEAR(c.y, by_optics, 1e-4) << static_cast<int>(optics);
      ASSERT_NEAR(c.z, 0.2f, 1e-4) << static_cast<int>(optics);
    }
  }
}

// A camera between two mirrors of reflectivity r that send out `own` light by themselves.
Frame hall_of_mirrors(float r, float own, const Settings& settings) {
  Scene scene;
  Material m = matte({0, 0, 0});
  m.reflectivity = {r, r, r};
  m.emission = {own, own, own};
  const uint32_t mirror = add_material(scene, m);
  add_floor(scene, mirror, 1e5f);
  add_ceiling(scene, mirror, 1e5f, 5);
  return render_scene(scene, kNarrow, settings);
}

TEST(Mirrors, AHundredReflectionsAreAGeometricSeries) {
  Settings s = small(only(&Effects::reflection));
  for (const int depth : {1, 10, 99, 100}) {
    s.max_depth = depth;
    const Frame frame = hall_of_mirrors(0.98f, 0.01f, s);
    const double expected = 0.01 * (1 - std::pow(0.98, depth + 1)) / (1 - 0.98);
    for (const Vec3& c : frame.radiance.pixels) ASSERT_NEAR(c.x, expected, 2e-5 * expected) << depth;
    EXPECT_EQ(pass_of(frame, "reflection").rays, 256u * static_cast<uint64_t>(depth));
    EXPECT_EQ(pass_of(frame, "reflection").rays_saved, 0u) << "the depth limit saves for another reason";
  }
}

TEST(Mirrors, RaysSavedByTheirImportanceAreCounted) {
  Settings s = small(only(&Effects::reflection));
  s.max_depth = 100;
  for (const auto& [importance, followed] :
       {std::pair{0.5f, 6u}, std::pair{0.25f, 13u}, std::pair{1.0f, 0u}}) {
    s.min_importance = importance;  // 0.9^6 > 0.5 > 0.9^7 and 0.9^13 > 0.25 > 0.9^14
    const Frame frame = hall_of_mirrors(0.9f, 0.01f, s);
    EXPECT_EQ(pass_of(frame, "reflection").rays, 256u * followed);
    EXPECT_EQ(pass_of(frame, "reflection").rays_saved, 256u);
    EXPECT_EQ(pass_of(frame, "refraction").rays_saved, 0u);
    const double expected = 0.01 * (1 - std::pow(0.9, followed + 1)) / (1 - 0.9);
    for (const Vec3& c : frame.radiance.pixels) ASSERT_NEAR(c.x, expected, 2e-5 * expected);
  }
}

// What weighs nothing at all is no ray that could be saved.
TEST(Mirrors, BlackReflectionsAreNotCounted) {
  Scene scene;
  Material m = glass(Optics::mirror);
  add_floor(scene, add_material(scene, m), 50);
  const Frame frame = render_scene(scene, kNarrow, small(kRays));
  EXPECT_EQ(pass_of(frame, "reflection").rays + pass_of(frame, "reflection").rays_saved, 0u);
}

const Vec3 kAbsorption{0.5f, 1.25f, 0};
Vec3 left_after(double length) {
  return {static_cast<float>(std::exp(-0.5 * length)), static_cast<float>(std::exp(-1.25 * length)), 1};
}
void expect_near(const Vec3& actual, const Vec3& expected, float tolerance) {
  EXPECT_NEAR(actual.x, expected.x, tolerance);
  EXPECT_NEAR(actual.y, expected.y, tolerance);
  EXPECT_NEAR(actual.z, expected.z, tolerance);
}

TEST(Absorption, TransmittanceIsTheExponential) {
  for (const float a : {0.0f, 0.01f, 1.0f, 7.5f, 1e6f}) {
    for (const float length : {0.0f, 0.3f, 2.0f, 50.0f}) {
      const double expected = std::exp(-static_cast<double>(a) * static_cast<double>(length));
      EXPECT_NEAR(static_cast<double>(transmittance(a, length)), expected, 1e-7 * expected + 1e-40);
    }
  }
  EXPECT_EQ(transmittance(0.0f, kInfinity), 1);
  EXPECT_EQ(transmittance(1e-6f, kInfinity), 0);
}

// A slab of glass, 1 m thick, over a floor that sends out 1.
Scene slab() {
  Scene scene;
  Material m = glass(Optics::solid);
  m.absorption = kAbsorption;
  const uint32_t solid = add_material(scene, m);
  add_floor(scene, solid, 500, 2);
  add_ceiling(scene, solid, 500, 1);
  Material bright = matte({0, 0, 0});
  bright.emission = {1, 1, 1};
  add_floor(scene, add_material(scene, bright), 500);
  scene.background.color = {0, 0, 0};
  scene.ambient = {0, 0, 0};
  return scene;
}

TEST(Absorption, OfASlabAtAnyAngle) {
  const Scene scene = slab();
  for (const double angle : {0.0, 0.4, 0.9, 1.2}) {
    const double inside = std::asin(std::sin(angle) / 1.5);
    const Vec3 view{static_cast<float>(std::sin(angle)), static_cast<float>(-std::cos(angle)), 0};
    const Frame frame = render_scene(scene, camera_at({0, 4, 0}, view, 0.01f, {0, 0, -1}),
                                     small({false, false, true, false}));
    const float cos_i = static_cast<float>(std::cos(angle)), cos_t = static_cast<float>(std::cos(inside));
    const float through = (1 - fresnel_exact(cos_i, 1 / 1.5f)) * (1 - fresnel_exact(cos_t, 1.5f));
    expect_near(pixel(frame, 8, 8), left_after(1 / std::cos(inside)) * through, 1e-3f);
  }
}

TEST(Absorption, OfACameraInTheGlass) {
  const Camera camera = camera_at({0, 1.75f, 0}, {0, -1, 0}, 0.01f, {0, 0, -1});
  const Frame frame = render_scene(slab(), camera, small({false, false, true, false}));
  expect_near(pixel(frame, 8, 8), left_after(0.75) * (1 - fresnel_exact(1, 1.5f)), 1e-4f);
  // What the glass itself shows loses as much: here its own emission.
  Scene shining = slab();
  shining.materials[0].emission = {1, 1, 1};
  const Frame own = render_scene(shining, camera, small(kNoEffects));
  expect_near(pixel(own, 8, 8), left_after(0.75), 1e-4f);
}

// Something within the glass is seen through as much of it as lies before it.
TEST(Absorption, UpToWhatIsEnclosed) {
  Scene scene = slab();
  Material insect = matte({0, 0, 0});
  insect.emission = {1, 1, 1};
  add_floor(scene, add_material(scene, insect), 100, 1.25f);
  const Frame frame = render_scene(scene, kNarrow, small({false, false, true, false}));
  expect_near(pixel(frame, 8, 8), left_after(0.75) * (1 - fresnel_exact(1, 1 / 1.5f)), 1e-3f);
}

// A right-angled prism turns light by total reflection: whatever its height, it runs 1 m through the glass.
TEST(Absorption, OfAPrismWithTotalReflection) {
  Scene scene;
  Material m = glass(Optics::solid);
  m.absorption = kAbsorption;
  const uint32_t solid = add_material(scene, m);
  add_quad(scene, solid, {0, 0, -5}, {0, 0, 10}, {0, 1, 0});   // entered here, facing -x
  add_quad(scene, solid, {0, 1, -5}, {0, 0, 10}, {1, -1, 0});  // reflected, facing +x +y
  add_quad(scene, solid, {0, 0, -5}, {1, 0, 0}, {0, 0, 10});   // left, facing down
  Material bright = matte({0, 0, 0});
  bright.emission = {1, 1, 1};
  add_floor(scene, add_material(scene, bright), 100, -2);
  scene.background.color = {0, 0, 0};
  for (const float height : {0.2f, 0.5f, 0.8f}) {
    const Frame frame =
        render_scene(scene, camera_at({-1, height, 0}, {1, 0, 0}, 0.01f), small({false, false, true, false}));
    const float f = fresnel_exact(1, 1.5f);
    expect_near(pixel(frame, 8, 8), left_after(1) * ((1 - f) * (1 - f)), 1e-3f);
  }
  // And 0.9 m to something 0.1 m above the lowest face, within the glass.
  add_floor(scene, 1, 100, 0.1f);
  const Frame frame =
      render_scene(scene, camera_at({-1, 0.5f, 0}, {1, 0, 0}, 0.01f), small({false, false, true, false}));
  expect_near(pixel(frame, 8, 8), left_after(0.9) * (1 - fresnel_exact(1, 1.5f)), 1e-3f);
}

// A floor that only the light through some glass reaches.
Vec3 lit_through(Scene& scene, const Light& light) {
  add_floor(scene, add_material(scene, matte({1, 1, 1})), 100, -1);
  scene.ambient = {0, 0, 0};
  scene.lights = {light};
  const Camera below = camera_at({0, -0.5f, 0}, {0, -1, 0}, 0.01f, {0, 0, -1});
  return pixel(render_scene(scene, below, small(only(&Effects::shadows))), 8, 8);
}

TEST(Absorption, ColoursShadowsAlongTheWayThroughTheGlass) {
  const Vec3 down = normalize(Vec3{0.6f, -0.8f, 0});
  Scene open;
  open.materials.push_back(slab().materials[0]);
  add_floor(open, 0, 500, 2);
  add_ceiling(open, 0, 500, 1);
  expect_near(lit_through(open, sun(down)), left_after(1 / 0.8) * 0.8f, 1e-4f);
}

TEST(Absorption, EverySheetAndSolidOnTheWayColoursTheShadow) {
  Scene scene;
  Material m = glass(Optics::solid);
  m.absorption = kAbsorption;
  m.transmission = {1, 0.9f, 0.5f};  // at either surface
  const uint32_t solid = add_material(scene, m);
  add_floor(scene, solid, 500, 2);
  add_ceiling(scene, solid, 500, 1);
  Material red = glass(Optics::thin), veil = glass(Optics::dissolve), coated = glass(Optics::thin);
  red.transmission = {0.9f, 0.2f, 0.1f};
  veil.opacity = 0.25f;
  coated.reflectivity = {0, 0.5f, 0};
  add_floor(scene, add_material(scene, red), 500, 3);
  add_floor(scene, add_material(scene, veil), 500, 1.5f);  // within the solid, which goes on behind it
  add_floor(scene, add_material(scene, coated), 500, 0.5f);
  const Vec3 expected = left_after(1) * Vec3{0.9f * 0.75f, 0.81f * 0.2f * 0.75f * 0.5f, 0.25f * 0.1f * 0.75f};
  expect_near(lit_through(scene, sun({0, -1, 0})), expected, 1e-4f);
}

// What lies within the glass is lit through as much of it as lies above.
TEST(Absorption, ColoursTheLightOnWhatIsEnclosed) {
  Scene scene;
  Material m = glass(Optics::solid);
  m.absorption = kAbsorption;
  const uint32_t solid = add_material(scene, m);
  add_floor(scene, solid, 500, 0);
  add_ceiling(scene, solid, 500, -3);
  expect_near(lit_through(scene, sun({0, -1, 0})), left_after(1), 5e-4f);
}

// Lights in the midst of the glass and above it, whose shadow rays are of any length.
TEST(Absorption, IsThatOfTheWayToALightThatIsNear) {
  for (const auto& [height, inside] : {std::pair{2.5f, 1.5}, std::pair{4.0f, 2.0}}) {
    Scene scene;
    Material m = glass(Optics::solid);
    m.absorption = kAbsorption;
    const uint32_t solid = add_material(scene, m);
    add_floor(scene, solid, 500, 3);
    add_ceiling(scene, solid, 500, 1);
    Light lamp;
    lamp.kind = Light::Kind::point;
    lamp.position = {0, height, 0};
    lamp.color = Vec3{1, 1, 1} * ((height + 1) * (height + 1));  // 1 on the floor
    expect_near(lit_through(scene, lamp), left_after(inside), 1e-4f);
  }
}

TEST(Emission, IsSeenWhateverTheLight) {
  for (const Compositing compositing : {Compositing::physical, Compositing::report}) {
    Scene scene;
    Material m = matte({0.5f, 0.5f, 0.5f});
    m.emission = {3, 0.25f, 0};
    add_floor(scene, add_material(scene, m), 20);
    add_floor(scene, add_material(scene, matte({0, 0, 0})), 20, 5);  // keeps the sun off, behind the camera
    scene.ambient = {0, 0, 0};
    scene.lights = {sun({0, -1, 0})};
    Settings s = small({true, false, false, true});
    s.compositing = compositing;
    s.ao_distance = 100;
    for (const Vec3& c : render_scene(scene, kWide, s).radiance.pixels) {
      ASSERT_NEAR(c.x, compositing == Compositing::report ? c.y + 2.75f : 3, 1e-5);
      ASSERT_GE(c.y, 0.25f);
    }
  }
}

TEST(Emission, IsSeenInMirrorsAndThroughGlass) {
  Scene scene;
  Material lamp = matte({0, 0, 0});
  lamp.emission = {2, 1, 0.5f};
  add_ceiling(scene, add_material(scene, lamp), 50, 6);
  Material mirror = glass(Optics::mirror);
  mirror.specular = {0.5f, 0.5f, 0.5f};
  add_floor(scene, add_material(scene, mirror), 50);
  Material pane = glass(Optics::thin);
  pane.transmission = {0.5f, 1, 1};
  add_floor(scene, add_material(scene, pane), 50, 2);
  Settings s = small({false, false, true, false});
  s.effects.reflection = true;
  s.max_depth = 3;  // through the pane, mirrored, through the pane
  s.min_importance = 0.2f;
  const float f = fresnel_exact(1, 1 / 1.5f);
  const Vec3 c = pixel(render_scene(scene, kNarrow, s), 8, 8);
  EXPECT_NEAR(c.x, (1 - f) * (1 - f) * 0.5f * 0.25f * 2, 1e-3);
  EXPECT_NEAR(c.y, (1 - f) * (1 - f) * 0.5f, 1e-3);
}

}  // namespace
}  // namespace vitral::test
