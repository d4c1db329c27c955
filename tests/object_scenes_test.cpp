// Pictures of objects: closed forms, and what must be the same however it is written down.
#include "object_support.h"
#include "render/frame.h"
#include "render/render.h"
#include "render/surface.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace vitral::test {
namespace {

Settings traced(int width = 48, int height = 48) {
  Settings s;
  s.width = width, s.height = height;
  s.threads = 2;
  s.effects = kNoEffects;
  s.primary = Primary::trace;
  return s;
}

Material matte(const Vec3& color) {
  Material m;
  m.diffuse = color;
  return m;
}
Material glass_of(float index) {
  Material m;
  m.diffuse = {0, 0, 0};
  m.optics = Optics::solid;
  m.index = index;
  m.opacity = 0;
  return m;
}

// A texture of vertical stripes, `bright` where they are odd.
Texture stripes(int count, int texels_each) {
  Texture t;
  t.width = count * texels_each, t.height = 4;
  for (int y = 0; y < t.height; ++y) {
    for (int x = 0; x < t.width; ++x) {
      const uint8_t value = x / texels_each % 2 ? 255 : 0;
      t.texels.insert(t.texels.end(), {value, value, value, 255});
    }
  }
  return t;
}

// A mesh with smooth normals, like `triangles` around a middle.
void add_smooth(Mesh& mesh, uint32_t material, const std::vector<KdTriangle>& triangles, const Vec3& middle) {
  for (const KdTriangle& t : triangles) {
    const uint32_t p = static_cast<uint32_t>(mesh.positions.size());
    for (size_t k = 0; k < 3; ++k) {
      mesh.positions.push_back(corner_of(t, k));
      mesh.normals.push_back(normalize(corner_of(t, k) - middle));
    }
    mesh.triangles.push_back({p, p + 1, p + 2});
    mesh.triangle_normals.push_back({p, p + 1, p + 2});
    mesh.triangle_material.push_back(material);
  }
}

double mean_difference(const Frame& a, const Frame& b) {
  double sum = 0;
  for (size_t i = 0; i < a.radiance.pixels.size(); ++i) {
    const Vec3 d = a.radiance.pixels[i] - b.radiance.pixels[i];
    sum += std::abs(static_cast<double>(d.x)) + std::abs(static_cast<double>(d.y)) +
           std::abs(static_cast<double>(d.z));
  }
  return sum / static_cast<double>(3 * a.radiance.pixels.size());
}

const Vec3& aov(const Frame& frame, size_t which, int x, int y) {
  return frame.aovs[which].pixels.row(y)[x];
}

// Mirrors, glass, smooth normals, textures, shadows, ambient occlusion: what an identity places is the mesh.
TEST(ObjectScenes, AnIdentityChangesNoByte) {
  Scene direct;
  Material textured = matte({1, 1, 1});
  textured.diffuse_map = 0;
  Material mirror = matte({0.1f, 0.1f, 0.1f});
  mirror.optics = Optics::mirror, mirror.specular = {0.9f, 0.9f, 0.9f};
  const uint32_t t = add_material(direct, textured), g = add_material(direct, glass_of(1.5f)),
                 m = add_material(direct, mirror);
  direct.textures = {stripes(8, 8)};
  direct.lights = {sun({-1, -2, -1})};
  add_quad(direct, t, {-4, -1, 4}, {8, 0, 0}, {0, 0, -8});
  add_quad(direct, m, {-4, -1, -4}, {8, 0, 0}, {0, 5, 0});
  direct.mesh.triangle_normals.assign(4, {kNoIndex, kNoIndex, kNoIndex});
  add_smooth(direct.mesh, g, sphere({-1, 0, 0}, 0.9f, 12), {-1, 0, 0});
  add_smooth(direct.mesh, t, sphere({1, 0, 0}, 0.9f, 12), {1, 0, 0});
  direct.mesh.triangle_texcoords.resize(direct.mesh.triangles.size(), {0, 1, 2});
  Scene placed = direct;
  placed.models = {std::exchange(placed.mesh, {})};
  placed.objects = {model_at(0, {})};
  Settings settings = traced();
  settings.effects = {};
  settings.ao_samples = 4;
  settings.aovs = {"primitive", "depth", "material", "shadow"};
  const Camera camera = test::camera_at({0, 1, 6}, {0, -0.15f, -1}, 50);
  const Frame a = render_scene(direct, camera, settings), b = render_scene(placed, camera, settings);
  EXPECT_TRUE(same_bytes(a, b));
  for (size_t i = 0; i < a.aovs.size(); ++i)
    EXPECT_EQ(a.aovs[i].pixels.pixels, b.aovs[i].pixels.pixels) << a.aovs[i].name;
}

// The same body written as a mirrored one: left and right change places, inside and outside do not.
TEST(ObjectScenes, MirroredGlassIsStillGlassFromOutside) {
  Scene scene;
  const uint32_t g = add_material(scene, glass_of(1.5f));
  Material textured = matte({1, 1, 1});
  textured.diffuse_map = 0;
  const uint32_t t = add_material(scene, textured);
  scene.textures = {stripes(8, 16)};
  Mesh ball;
  add_smooth(ball, g, sphere({0, 0, 0}, 1, 24), {0, 0, 0});
  scene.models = {ball};
  scene.objects = {model_at(0, {}), shape_at(Shape::plane, t, translation({0, -1.2f, 0}))};
  Scene mirrored = scene;
  mirrored.objects[0].placement = scaling(-1, 1, 1);
  Settings settings = traced();
  settings.effects.reflection = settings.effects.refraction = true;
  const Camera camera = test::camera_at({0, 0.5f, 5}, {0, -0.1f, -1}, 40);
  const Frame a = render_scene(scene, camera, settings), b = render_scene(mirrored, camera, settings);
  EXPECT_LT(mean_difference(a, b), 0.01);
  // A body turned inside out is another thing altogether.
  Scene inside_out = scene;
  for (Corners& c : inside_out.models[0].triangles) std::swap(c[1], c[2]);
  for (Corners& c : inside_out.models[0].triangle_normals) std::swap(c[1], c[2]);
  EXPECT_GT(mean_difference(a, render_scene(inside_out, camera, settings)), 0.04);

  // The same for shapes: their tangents must keep the normal outside.
  scene.objects[0] = shape_at(Shape::sphere, g, {});
  mirrored.objects[0] = shape_at(Shape::sphere, g, scaling(-1, 1, 1));
  EXPECT_LT(mean_difference(render_scene(scene, camera, settings), render_scene(mirrored, camera, settings)),
            1e-4);
}

// Closed form: a ray that meets a ball of index n under the angle i leaves it turned by 2 (i - r), in the
// same plane. What it then meets is a striped wall.
TEST(ObjectScenes, AGlassBallShowsWhatSnellSays) {
  Scene scene;
  const float index = 1.5f;
  const uint32_t g = add_material(scene, glass_of(index));
  Material textured = matte({1, 1, 1});
  textured.diffuse_map = 0;
  const uint32_t t = add_material(scene, textured);
  constexpr int kStripes = 16;
  scene.textures = {stripes(kStripes, 64)};
  scene.ambient = {1, 1, 1};
  // A wall 10 wide, its texture once across.
  scene.objects = {shape_at(Shape::sphere, g, {}),
                   shape_at(Shape::box, t, translation({0, 0, -5}) * scaling(5, 5, 0.5f))};
  Settings settings = traced(96, 96);
  settings.effects.refraction = true;
  const Camera camera = test::camera_at({0, 0, 6}, {0, 0, -1}, 18);
  const Frame frame = render_scene(scene, camera, settings);
  const double step = 2 * std::tan(9 * 3.14159265358979 / 180) / 96, eye = 6, wall = -4.5;
  int checked = 0;
  for (int y = 0; y < 96; ++y) {
    for (int x = 0; x < 96; ++x) {
      // In the plane of ray and middle: (a, z), the ray from (0, eye) along (tan, -1).
      const double px = (x + 0.5 - 48) * step, py = (48 - y - 0.5) * step, tangent = std::hypot(px, py);
      const double angle = std::atan(tangent), b = eye * std::sin(angle);
      if (b > 0.95) continue;
      const double i = std::asin(b), r = std::asin(b / static_cast<double>(index));
      // Where it leaves the ball, as an angle from +z: entered at i - angle, and on by pi - 2 r.
      const double at = (i - angle) + (3.14159265358979 - 2 * r);
      const double turned = angle - 2 * (i - r);  // direction (sin, -cos)
      const double leave_a = std::sin(at), leave_z = std::cos(at);
      const double hit = leave_a + std::tan(turned) * (leave_z - wall);
      const double across = tangent > 0 ? hit * px / tangent : 0;
      if (std::abs(across) > 4.9) continue;
      const double stripe = (across + 5) / 10 * kStripes, part = stripe - std::floor(stripe);
      if (part < 0.12 || part > 0.88) continue;
      const bool bright = static_cast<int>(stripe) % 2 == 1;
      const float seen = pixel(frame, x, y).x;
      EXPECT_EQ(seen > 0.45f, bright) << x << " " << y << " " << seen << " " << stripe;
      ++checked;
    }
  }
  EXPECT_GT(checked, 2000);
}

// A ball of many triangles tends to the exact one.
TEST(ObjectScenes, MeshesTendToTheShape) {
  Settings settings = traced();
  settings.effects.reflection = settings.effects.refraction = settings.effects.shadows = true;
  const Camera camera = test::camera_at({0, 1.5f, 5}, {0, -0.3f, -1}, 40);
  const auto make = [&](int rings) {
    Scene scene;
    const uint32_t g = add_material(scene, glass_of(1.5f)),
                   w = add_material(scene, matte({0.8f, 0.5f, 0.3f}));
    scene.lights = {sun({-1, -2, -1})};
    scene.objects = {shape_at(Shape::plane, w, translation({0, -1, 0}))};
    for (const uint32_t material : {g, w}) {
      const Vec3 middle{material == g ? -1.1f : 1.1f, 0, 0};
      if (rings == 0)
        scene.objects.push_back(shape_at(Shape::sphere, material, translation(middle)));
      else
        add_smooth(scene.mesh, material, sphere(middle, 1, rings), middle);
    }
    return render_scene(scene, camera, settings);
  };
  const Frame exact = make(0);
  const double coarse = mean_difference(make(12), exact), fine = mean_difference(make(96), exact);
  EXPECT_LT(fine, coarse / 4);
  EXPECT_LT(fine, 0.006);
}

// A ball over a plane, the sun straight above: the shadow is its disk, however the ball is written down.
TEST(ObjectScenes, TheShadowOfABallIsADisk) {
  Scene scene;
  add_material(scene, matte({1, 1, 1}));
  scene.lights = {sun({0, -1, 0})};
  scene.objects = {shape_at(Shape::plane, 0, {}),
                   shape_at(Shape::sphere, 0, translation({0.3f, 5, 0}) * scaling(0.8f, 0.1f, 0.8f))};
  Settings settings = traced();
  settings.effects.shadows = true;
  settings.aovs = {"shadow", "position"};
  const Frame frame = render_scene(scene, test::camera_at({0, 3, 0}, {0, -1, 0}, 60, {0, 0, -1}), settings);
  int dark = 0;
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 48; ++x) {
      const Vec3 p = aov(frame, 1, x, y);
      const double r = std::hypot(static_cast<double>(p.x) - 0.3, static_cast<double>(p.z));
      if (std::abs(r - 0.8) < 1e-4) continue;
      EXPECT_EQ(aov(frame, 0, x, y).x, r < 0.8 ? 0 : 1) << x << " " << y;
      dark += r < 0.8;
    }
  }
  EXPECT_GT(dark, 200);
}

// A light with a size sees objects, too: below a disk that hides all of it nothing arrives, beside it all.
TEST(ObjectScenes, LightsWithASizeSeeObjects) {
  Scene scene;
  add_material(scene, matte({1, 1, 1}));
  Light lamp;
  lamp.kind = Light::Kind::sphere, lamp.position = {0, 4, 0}, lamp.radius = 0.5f, lamp.samples = 64;
  scene.lights = {lamp};
  scene.objects = {shape_at(Shape::plane, 0, {}), shape_at(Shape::disk, 0, translation({0, 2, 0}))};
  Settings settings = traced();
  settings.effects.shadows = true;
  settings.aovs = {"shadow", "position"};
  const Frame frame =
      render_scene(scene, test::camera_at({0, 1.9f, 0}, {0, -1, 0}, 140, {0, 0, -1}), settings);
  int dark = 0, half = 0, lit = 0;
  for (size_t i = 0; i < frame.aovs[0].pixels.pixels.size(); ++i) {
    const Vec3 p = frame.aovs[1].pixels.pixels[i];
    const double r = std::hypot(static_cast<double>(p.x), static_cast<double>(p.z));
    const float shadow = frame.aovs[0].pixels.pixels[i].x;
    // The cones that touch lamp and disk: from an edge of the lamp over the disk's to the floor.
    dark += r<1.3, lit += r> 2.75;
    if (r < 1.3 || r > 2.75) {
      EXPECT_EQ(shadow, r < 1.3 ? 0 : 1) << r;
    }
    half += shadow > 0 && shadow < 1;
  }
  EXPECT_GT(dark, 50);
  EXPECT_GT(lit, 200);
  EXPECT_GT(half, 50);
}

// Under a ceiling at height h, rays of length d are blocked where their cosine is above h / d: 1 - (h / d)^2
// of a cosine-weighted hemisphere.
TEST(ObjectScenes, AmbientRaysUnderACeiling) {
  Scene scene;
  add_material(scene, matte({1, 1, 1}));
  scene.objects = {shape_at(Shape::plane, 0, {}), shape_at(Shape::plane, 0, translation({0, 2, 0}))};
  Settings settings = traced(16, 16);
  settings.effects.ambient_occlusion = true;
  settings.ao_samples = 1024;
  settings.aovs = {"ao"};
  const Camera camera = test::camera_at({0, 1, 0}, {0, -1, 0}, 60, {0, 0, -1});
  for (const float distance : {1.0f, 4.0f}) {
    settings.ao_distance = distance;
    const double expected = std::min(1.0, std::pow(2 / static_cast<double>(distance), 2));
    const Frame frame = render_scene(scene, camera, settings);
    for (const Vec3& ao : frame.aovs[0].pixels.pixels) EXPECT_NEAR(static_cast<double>(ao.x), expected, 0.01);
  }
}

// No convex body shadows itself where it faces the light, nor does it occlude its own hemisphere, whatever
// its size, however it is stretched and from wherever it is seen.
struct Acne {
  Shape shape;
  float scale;
  float away;  // of the camera, in scales
};
class NoShapeShadowsItself : public testing::TestWithParam<Acne> {};

TEST_P(NoShapeShadowsItself, AnywhereItFacesTheLight) {
  const auto [shape, scale, away] = GetParam();
  for (const bool stretched : {false, true}) {
    Scene scene;
    add_material(scene, matte({1, 1, 1}));
    Affine placement = scaling(scale, scale, scale);
    if (stretched)
      placement = translation(Vec3{3, -2, 1} * scale) * rotation({1, 2, 3}, 50) *
                  scaling(scale, 0.05f * scale, -0.6f * scale) * rotation({3, 1, 2}, 77);
    scene.objects = {shape_at(shape, 0, placement)};
    scene.lights = {sun({-1, -0.7f, -0.4f})};
    Settings settings = traced(64, 64);
    settings.effects.shadows = settings.effects.ambient_occlusion = true;
    settings.ao_samples = 4;
    settings.ao_distance = 3 * scale;
    settings.aovs = {"shadow", "ao", "normal"};
    const Vec3 middle = placement.origin, from = middle + normalize(Vec3{0.5f, 1, 0.8f}) * (scale * away);
    Camera camera = test::camera_at(from, middle - from, std::min(100.0f, 200.0f / away));
    camera.near = 0.01f * scale, camera.far = 1e6f * scale;
    const Frame frame = render_scene(scene, camera, settings);
    EXPECT_GT(frame.stats.covered_pixels, 40u);
    int dark = 0, occluded = 0;
    for (size_t i = 0; i < frame.aovs[0].pixels.pixels.size(); ++i) {
      const Vec3 normal = frame.aovs[2].pixels.pixels[i];
      if (dot(normal, normal) == 0) continue;
      dark += frame.aovs[0].pixels.pixels[i].x != 1 && dot(normal, scene.lights[0].direction) < 0;
      occluded += frame.aovs[1].pixels.pixels[i].x != 1;
    }
    EXPECT_EQ(dark, 0) << (stretched ? "stretched" : "plain");
    EXPECT_EQ(occluded, 0) << (stretched ? "stretched" : "plain");
  }
}

std::vector<Acne> acne_cases() {
  std::vector<Acne> cases;
  for (const Shape shape : {Shape::sphere, Shape::plane, Shape::box, Shape::cylinder, Shape::disk}) {
    for (const float scale : {1e-3f, 1.0f, 1e4f}) {
      for (const float away : {1.7f, 500.0f}) cases.push_back({shape, scale, away});
    }
  }
  return cases;
}
INSTANTIATE_TEST_SUITE_P(All, NoShapeShadowsItself, testing::ValuesIn(acne_cases()));

// A model far from its own origin, placed near the world's, keeps the rounding that it has there.
TEST(ObjectScenes, DistantModelsDoNotShadowThemselves) {
  Scene scene;
  add_material(scene, matte({1, 1, 1}));
  const float far = 3000;
  add_model(scene, 0, sphere({far, far, far}, 1, 8));
  scene.objects = {model_at(0, rotation({1, 2, 0}, 30) * translation({-far, -far, -far}))};
  scene.lights = {sun({-1, -0.7f, -0.4f})};
  Settings settings = traced(64, 64);
  settings.effects.shadows = true;
  settings.aovs = {"shadow", "geometric-normal"};
  const Vec3 from{2, 4, 3};
  const Frame frame = render_scene(scene, test::camera_at(from, -from, 30), settings);
  EXPECT_GT(frame.stats.covered_pixels, 500u);
  int dark = 0;
  for (size_t i = 0; i < frame.aovs[0].pixels.pixels.size(); ++i) {
    const float cosine = dot(frame.aovs[1].pixels.pixels[i], scene.lights[0].direction);
    dark += frame.aovs[0].pixels.pixels[i].x != 1 && cosine < -0.05f;
  }
  EXPECT_EQ(dark, 0);
}

// A small ball far away has normals as good as a large one.
TEST(ObjectScenes, NormalsOfASmallDistantBall) {
  Scene scene;
  add_material(scene, matte({1, 1, 1}));
  const Vec3 middle{0, 500, 0};
  scene.objects = {shape_at(Shape::sphere, 0, translation(middle) * scaling(0.05f, 0.05f, 0.05f))};
  Settings settings = traced();
  settings.aovs = {"normal", "geometric-normal"};
  const Frame frame =
      render_scene(scene, test::camera_at(middle + Vec3{0, 0, 0.25f}, {0, 0, -1}, 25), settings);
  int seen = 0;
  for (size_t i = 0; i < frame.aovs[0].pixels.pixels.size(); ++i) {
    const Vec3 n = frame.aovs[0].pixels.pixels[i];
    if (dot(n, n) == 0) continue;
    EXPECT_LT(length(n - frame.aovs[1].pixels.pixels[i]), 1e-5f);
    ++seen;
  }
  EXPECT_GT(seen, 300);
}

// Shading that is right: normals of an ellipsoid are its gradient's, texture coordinates land where they
// must.
TEST(ObjectScenes, NormalsOfAnEllipsoid) {
  Scene scene;
  add_material(scene, matte({1, 1, 1}));
  const Vec3 axes{1.5f, 0.5f, 0.8f};
  scene.objects = {shape_at(Shape::sphere, 0, scaling(axes.x, axes.y, axes.z))};
  Settings settings = traced();
  settings.aovs = {"normal", "position", "geometric-normal", "depth"};
  const Vec3 eye{1, 2, 3};
  const Frame frame = render_scene(scene, test::camera_at(eye, -eye, 45), settings);
  int seen = 0;
  for (int i = 0; i < 48 * 48; ++i) {
    const Vec3 n = frame.aovs[0].pixels.pixels[static_cast<size_t>(i)],
               p = frame.aovs[1].pixels.pixels[static_cast<size_t>(i)];
    if (dot(n, n) == 0) continue;
    const Vec3 q{p.x / axes.x, p.y / axes.y, p.z / axes.z};
    EXPECT_NEAR(length(q), 1, 1e-6);
    const Vec3 expected = normalize(Vec3{q.x / axes.x, q.y / axes.y, q.z / axes.z});
    EXPECT_LT(length(n - expected), 1e-6);
    EXPECT_LT(length(frame.aovs[2].pixels.pixels[static_cast<size_t>(i)] - expected), 2e-6);
    ++seen;
  }
  EXPECT_GT(seen, 300);
}

// A picture as far as the eye can tell: the plane repeats its texture with every unit.
TEST(ObjectScenes, ThePlanesTextureRepeats) {
  Scene scene;
  Material textured = matte({1, 1, 1});
  textured.diffuse_map = 0;
  add_material(scene, textured);
  scene.textures = {stripes(2, 64)};
  scene.ambient = {1, 1, 1};
  scene.objects = {shape_at(Shape::plane, 0, scaling(2, 2, 2))};
  Settings settings = traced();
  settings.aovs = {"position"};
  const Frame frame =
      render_scene(scene, test::camera_at({0.3f, 6, 0}, {0, -1, 0}, 60, {0, 0, -1}), settings);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 48; ++x) {
      const double u = static_cast<double>(aov(frame, 0, x, y).x), part = u - std::floor(u);
      if (part < 0.15 || part > 0.85) continue;
      EXPECT_EQ(pixel(frame, x, y).x > 0.5f, static_cast<int>(std::floor(u)) % 2 != 0) << u;
    }
  }
}

// Light through two coloured panes, one of the mesh and one placed, is tinted by both; by a placed ball of
// solid glass twice; what an instance's own material says holds over its model's.
TEST(ObjectScenes, PlacedGlassTintsShadows) {
  Scene scene;
  Material red = glass_of(1), blue = glass_of(1);
  red.optics = blue.optics = Optics::thin;
  red.transmission = {0.8f, 0.4f, 0.5f}, blue.transmission = {0.5f, 0.9f, 0.6f};
  const uint32_t floor = add_material(scene, matte({1, 1, 1})), r = add_material(scene, red),
                 b = add_material(scene, blue);
  add_quad(scene, r, {-5, 1, 5}, {10, 0, 0}, {0, 0, -10});
  Scene pane;
  add_quad(pane, floor, {-5, 0, 5}, {10, 0, 0}, {0, 0, -10});
  scene.models = {pane.mesh};
  scene.lights = {sun({0, -1, 0})};
  scene.ambient = {0, 0, 0};
  scene.objects = {shape_at(Shape::plane, floor, {}), model_at(0, translation({0, 2, 0}), b)};
  Settings settings = traced(8, 8);
  settings.effects.shadows = true;
  const Camera camera = test::camera_at({0, 0.5f, 0}, {0, -1, 0}, 60, {0, 0, -1});
  const auto seen = [&] { return pixel(render_scene(scene, camera, settings), 4, 4); };
  Vec3 tint = red.transmission * blue.transmission;
  EXPECT_NEAR(seen().x, tint.x, 1e-6);
  EXPECT_NEAR(seen().y, tint.y, 1e-6);
  EXPECT_NEAR(seen().z, tint.z, 1e-6);
  scene.objects[1] = shape_at(Shape::sphere, b, translation({0, 3, 0}));
  tint = red.transmission * blue.transmission * blue.transmission;
  EXPECT_NEAR(seen().x, tint.x, 1e-6);
  EXPECT_NEAR(seen().y, tint.y, 1e-6);
  scene.objects[1] = model_at(0, translation({0, 2, 0}));
  EXPECT_EQ(seen(), (Vec3{0, 0, 0})) << "its own material is opaque";
}

// Light through placed, mirrored and exact glass that absorbs: the way inside, by Beer and Lambert.
TEST(ObjectScenes, PlacedGlassAbsorbs) {
  Scene scene;
  Material glass = glass_of(1);
  glass.absorption = {0.5f, 1, 2};
  const uint32_t floor = add_material(scene, matte({1, 1, 1})), g = add_material(scene, glass);
  Mesh ball;
  add_smooth(ball, g, sphere({0, 0, 0}, 1, 64), {0, 0, 0});
  scene.models = {ball};
  scene.lights = {sun({0, -1, 0})};
  scene.ambient = {0, 0, 0};
  Settings settings = traced(8, 8);
  settings.effects.shadows = true;
  const Camera camera = test::camera_at({0, 0.5f, 0}, {0, -1, 0}, 1, {0, 0, -1});
  for (const Affine& placement :
       {scaling(0.5f, 0.5f, 0.5f), scaling(-0.5f, 0.5f, 0.5f), scaling(3, 0.5f, 3)}) {
    for (const bool mesh : {false, true}) {
      const Affine up = translation({0, 3, 0}) * placement;
      scene.objects = {shape_at(Shape::plane, floor, {}),
                       mesh ? model_at(0, up) : shape_at(Shape::sphere, g, up)};
      const Vec3 seen = pixel(render_scene(scene, camera, settings), 4, 4);
      EXPECT_NEAR(seen.x, std::exp(-0.5f), 1e-3f) << mesh;
      EXPECT_NEAR(seen.y, std::exp(-1.0f), 1e-3f) << mesh;
      EXPECT_NEAR(seen.z, std::exp(-2.0f), 1e-3f) << mesh;
    }
  }
}

// Holes: a shape's texture cuts both its sides; an instance with a material of its own asks its texture.
TEST(ObjectScenes, CutOutsOfObjects) {
  Scene scene;
  Texture grate = stripes(8, 16);
  for (size_t i = 0; i < grate.texels.size(); i += 4) grate.texels[i + 3] = grate.texels[i];
  Material cut = matte({1, 1, 1});
  cut.opacity_map = 0;
  const uint32_t full = add_material(scene, matte({1, 1, 1})), c = add_material(scene, cut);
  scene.textures = {grate};
  Scene pane;
  add_quad(pane, full, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  scene.models = {pane.mesh};
  Settings settings = traced();
  settings.aovs = {"depth"};
  const Camera camera = test::camera_at({0, 0, 8}, {0, 0, -1}, 12);
  const auto depth_at = [&](float x) {
    const Frame frame = render_scene(scene, camera, settings);
    const double across = static_cast<double>(x) / (2 * 8 * std::tan(6 * 3.14159265358979 / 180)) + 0.5;
    return aov(frame, 0, static_cast<int>(across * 48), 24).x;
  };
  scene.objects = {model_at(0, {}, c)};
  EXPECT_EQ(depth_at(-0.62f), 8) << "u = 0.19: there";
  EXPECT_EQ(depth_at(-0.38f), 0) << "u = 0.31: a hole";
  scene.objects = {model_at(0, {})};
  EXPECT_EQ(depth_at(-0.38f), 8) << "without a hole";
  scene.objects = {shape_at(Shape::box, c, {})};
  EXPECT_EQ(depth_at(-0.62f), 7) << "the front";
  EXPECT_EQ(depth_at(-0.38f), 9) << "through a hole on the back, whose texture runs the other way";
}

// A mirror shows the exact reflection; rays that start on a shape meet others and the mesh.
TEST(ObjectScenes, AMirrorBallReflects) {
  Scene scene;
  Material mirror = matte({0, 0, 0});
  mirror.optics = Optics::mirror, mirror.specular = {1, 1, 1};
  const uint32_t m = add_material(scene, mirror), w = add_material(scene, matte({1, 1, 1}));
  scene.ambient = {1, 1, 1};
  scene.background.color = {0, 0, 0};
  scene.objects = {shape_at(Shape::sphere, m, {}),
                   shape_at(Shape::sphere, w, translation({3, 0, 3}) * scaling(0.5f, 0.5f, 0.5f))};
  Settings settings = traced(96, 96);
  settings.effects.reflection = true;
  settings.aovs = {"position", "normal"};
  const Camera camera = test::camera_at({0, 0, 8}, {0, 0, -1}, 16);
  const Frame frame = render_scene(scene, camera, settings);
  int seen = 0, unclear = 0;
  for (int y = 0; y < 96; ++y) {
    for (int x = 0; x < 96; ++x) {
      const Vec3 n = aov(frame, 1, x, y);
      if (dot(n, n) == 0) continue;
      const Vec3d p = to_double(aov(frame, 0, x, y)), normal = normalize(p);
      const Vec3d in = normalize(p - Vec3d{0, 0, 8}), out = in - normal * (2 * dot(in, normal));
      const Vec3d way = Vec3d{3, 0, 3} - p;
      const double along = dot(way, out), apart = std::sqrt(std::max(0.0, dot(way, way) - along * along));
      if (std::abs(apart - 0.5) < 0.01) {
        ++unclear;
        continue;
      }
      const bool meets = along > 0 && apart < 0.5;
      EXPECT_EQ(pixel(frame, x, y).x > 0.5f, meets) << x << " " << y;
      seen += meets;
    }
  }
  EXPECT_GT(seen, 20);
  EXPECT_LT(unclear, 100);
}

// What stands in for a hit bends and runs its texture as the surface does, at any size and seen from inside,
// too.
TEST(ObjectScenes, HitsBendAsTheSurfaceDoes) {
  Scene scene;
  const uint32_t w = add_material(scene, matte({1, 1, 1}));
  Mesh ball;
  add_smooth(ball, w, sphere({0, 0, 0}, 1, 64), {0, 0, 0});
  scene.models = {ball};
  Settings settings = traced();
  for (const float radius : {0.01f, 2.0f, -2.0f, 300.0f}) {
    const float size = std::abs(radius);
    const Affine placement = translation({size * 5, 0, 0}) * scaling(radius, size, size);
    scene.objects = {shape_at(Shape::sphere, w, placement), model_at(0, placement)};
    for (const bool mesh : {false, true}) {
      Scene one = scene;
      one.objects = {scene.objects[mesh ? 1 : 0]};
      const Built built(one);
      const FrameContext frame =
          make_context(one, built.accelerator, test::camera_at({0, 0, 1}, {0, 0, -1}), settings);
      Random random(1);
      RayPacket rays{};
      for (int lane = 0; lane < kPacketSize; ++lane) {
        const Vec3 target = placement.origin + random.in_box(-0.5f, 0.5f) * size;
        const Vec3 from = lane % 2 ? placement.origin + random.in_box(-0.1f, 0.1f) * size
                                   : placement.origin + random.direction() * (3 * size);
        set_ray(rays, lane, {from, 0, target - from, kInfinity});
      }
      rays.live = ~0ull;
      HitPacket hits;
      for (int lane = 0; lane < kPacketSize; ++lane) set_hit(hits, lane, Hit{});
      frame.kernels.closest_objects(built.objects(), rays, hits);
      SurfacePacket s;
      float diameters[kPacketSize] = {};
      make_surfaces(frame, rays, hits, s, diameters);
      ASSERT_EQ(s.points.live, ~0ull);
      for (int lane = 0; lane < kPacketSize; ++lane) {
        const float expected = (lane % 2 ? -1 : 1) / size;
        EXPECT_NEAR(s.turning[lane], expected, (mesh ? 0.02f : 1e-4f) / size) << lane << " " << mesh;
        EXPECT_EQ((s.back >> lane & 1) != 0, lane % 2 != 0) << lane << " " << mesh << " " << radius;
        EXPECT_EQ(s.triangle[lane], hits.triangle[lane]);
        const Vec3 n = get(s.points.nx, s.points.ny, s.points.nz, lane),
                   p = get(s.points.px, s.points.py, s.points.pz, lane);
        const Vec3 outward = normalize(p - placement.origin);
        EXPECT_GT(dot(n, outward) * (lane % 2 ? -1.0f : 1.0f), 0.999f);
      }
    }
  }
}

// Counts add up with objects, too; and without objects nothing is different.
TEST(ObjectScenes, CountsAddUp) {
  Scene scene;
  const uint32_t w = add_material(scene, matte({1, 1, 1})), g = add_material(scene, glass_of(1.4f));
  add_quad(scene, w, {-4, -1, 4}, {8, 0, 0}, {0, 0, -8});
  const uint32_t model = add_model(scene, w, sphere({0, 0, 0}, 1, 8));
  scene.objects = {model_at(model, translation({-1, 0, 0})),
                   shape_at(Shape::sphere, g, translation({1, 0, 0})),
                   shape_at(Shape::plane, w, translation({0, -2, 0}))};
  scene.lights = {sun({-1, -2, -1})};
  Settings settings = traced();
  settings.effects = {};
  const Camera camera = test::camera_at({0, 1, 6}, {0, -0.15f, -1}, 50);
  const Frame plain = render_scene(scene, camera, settings);
  settings.aovs = {"cost"};
  const Frame counted = render_scene(scene, camera, settings);
  EXPECT_TRUE(same_bytes(plain, counted));
  double sum = 0;
  for (const Vec3& c : counted.aovs[0].pixels.pixels) sum += static_cast<double>(c.x);
  const TraversalCounts& all = counted.stats.traversal;
  EXPECT_NEAR(sum, static_cast<double>(work_of(all)), 1e-4 * sum);
  for (const PassStats& pass : counted.stats.passes) {
    EXPECT_LE(pass.traversal.rays_traced, pass.rays) << pass.name;
    EXPECT_EQ(pass.traversal.rays_traced + pass.traversal.rays_culled, pass.rays) << pass.name;
  }
}

}  // namespace
}  // namespace vitral::test
