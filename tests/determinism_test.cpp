// One picture, one set of bytes: for every instruction set, any number of threads, crop or whole.
#include "render/kernel_choice.h"
#include "support.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace vitral::test {
namespace {

constexpr std::array<Isa, 4> kIsas = {Isa::scalar, Isa::v2, Isa::avx2, Isa::avx512};

std::vector<Isa> isas_here() {
  std::vector<Isa> found;
  for (const Kernels* k : available_kernels()) {
    for (const Isa isa : kIsas) {
      const char* const names[] = {"auto", "scalar", "v2", "avx2", "avx512"};
      if (std::string(names[static_cast<size_t>(isa)]) == k->isa) found.push_back(isa);
    }
  }
  return found;
}

// A room with everything in it: glass and mirror balls, a tinted pane, a cut-out, texture, two lights.
Scene room() {
  Scene scene;
  Material m;
  m.name = "floor";
  m.diffuse = {0.9f, 0.8f, 0.7f};
  Texture checks{"checks", 4, 4, std::vector<uint8_t>(64)};
  for (size_t i = 0; i < 16; ++i) {
    const uint8_t c = (i + i / 4) % 2 ? 230 : 40;
    const uint8_t texel[4] = {c, 200, static_cast<uint8_t>(255 - c), static_cast<uint8_t>(i % 3 ? 255 : 0)};
    std::copy(texel, texel + 4, checks.texels.begin() + static_cast<std::ptrdiff_t>(4 * i));
  }
  scene.textures.push_back(checks);
  m.diffuse_map = 0;
  add_quad(scene, add_material(scene, m), {-5, -1, -5}, {0, 0, 10}, {10, 0, 0});
  m.opacity_map = 0;
  add_quad(scene, add_material(scene, m), {-3, -1, -3}, {6, 0, 0}, {0, 3, 0.5f});

  Material glass;
  glass.optics = Optics::solid;
  glass.diffuse = {0, 0, 0};
  glass.transmission = {0.9f, 1, 0.95f};
  add_triangles(scene, add_material(scene, glass), sphere({-1, 0, 0}, 0.9f, 10));
  Material mirror;
  mirror.optics = Optics::mirror;
  mirror.specular = {0.9f, 0.9f, 0.8f};
  mirror.shininess = 30;
  add_triangles(scene, add_material(scene, mirror), sphere({1, 0, -0.5f}, 0.9f, 10));
  Material pane;
  pane.optics = Optics::thin;
  pane.transmission = {0.5f, 0.9f, 0.6f};
  add_quad(scene, add_material(scene, pane), {-2, -1, 1}, {2.5f, 0, 0}, {0, 2, -0.3f});

  scene.lights = {sun({0.5f, -1, -0.4f}, {0.7f, 0.7f, 0.6f})};
  Light lamp;
  lamp.kind = Light::Kind::point;
  lamp.position = {0, 3, 2};
  lamp.color = {4, 3, 2};
  scene.lights.push_back(lamp);
  scene.ambient = {0.3f, 0.3f, 0.35f};
  return scene;
}

const Camera kCamera = camera_at({0.3f, 1, 4}, {-0.05f, -0.25f, -1}, 55);

Settings settings(Primary primary) {
  Settings s;
  s.width = 90;
  s.height = 70;
  s.threads = 1;
  s.isa = Isa::scalar;
  s.primary = primary;
  s.ao_distance = 1;
  return s;
}

// The room with all that is sampled, placed, moved and patterned as well.
Scene crowded_room() {
  Scene scene = room();
  Material marble;
  marble.pattern.kind = Pattern::Kind::marble, marble.pattern.size = 0.3f;
  marble.reflectivity = {0.2f, 0.15f, 0.1f};
  Material checker;
  checker.pattern.kind = Pattern::Kind::checker, checker.pattern.size = 0.25f;
  checker.emission = {0.05f, 0, 0.1f};
  Material brick;
  brick.pattern.kind = Pattern::Kind::brick, brick.pattern.size = 0.4f;
  Material amber;
  amber.optics = Optics::solid, amber.absorption = {0.3f, 1, 3};
  const Material materials[] = {marble, checker, brick, amber};
  uint32_t number[4];
  for (size_t i = 0; i < 4; ++i) number[i] = add_material(scene, materials[i]);

  Scene ball;
  add_triangles(ball, 0, sphere({0, 0, 0}, 0.3f, 8));
  scene.models = {ball.mesh};
  const auto add = [&](Shape shape, uint32_t material, const Vec3& size, const Vec3& at) -> Object& {
    Object o;
    o.shape = shape, o.material = material;
    o.placement = {{size.x, 0, 0}, {0, size.y, 0}, {0, 0, size.z}, at};
    scene.objects.push_back(o);
    return scene.objects.back();
  };
  add(Shape::plane, number[2], {1, 1, 1}, {0, -1.1f, 0});
  add(Shape::sphere, number[3], {0.4f, 0.5f, 0.4f}, {0, 0.2f, 1.5f});
  add(Shape::box, number[1], {0.3f, 0.2f, 0.3f}, {1.8f, -0.8f, 1}).motion = {
      {0, {0, 0, 0}, {}}, {1, {0.1f, 0.5f, 0}, quaternion({1, 1, 0}, 50)}};
  add(Shape::cylinder, number[0], {0.2f, 0.6f, 0.2f}, {-1.8f, -0.3f, 1.2f});
  add(Shape::disk, number[0], {0.5f, 0.5f, 0.5f}, {0, 1.5f, -1});
  for (int i = 0; i < 9; ++i)
    add(Shape::mesh, i % 2 ? kNoIndex : number[static_cast<size_t>(i) % 4], {i % 3 ? 1.0f : -0.7f, 1, 1},
        {static_cast<float>(i % 3) - 1, 1.2f, static_cast<float>(i / 3) - 1.5f});

  Light lamp;
  lamp.kind = Light::Kind::rectangle, lamp.position = {0, 2.5f, 1}, lamp.color = {2, 2, 2};
  lamp.samples = 3;
  scene.lights.push_back(lamp);
  lamp.kind = Light::Kind::sphere, lamp.position = {2, 1.5f, 2}, lamp.radius = 0.3f;
  scene.lights.push_back(lamp);
  lamp.kind = Light::Kind::spot, lamp.position = {-2, 2, 3},
  lamp.direction = normalize(Vec3{0.5f, -0.6f, -1});
  scene.lights.push_back(lamp);
  lamp.kind = Light::Kind::sun, lamp.diameter_degrees = 5, lamp.color = {0.3f, 0.3f, 0.2f};
  scene.lights.push_back(lamp);
  scene.background.kind = Background::Kind::gradient;
  scene.background.zenith = {0.1f, 0.2f, 0.6f};
  return scene;
}

Camera moving_camera() {
  Camera camera = kCamera;
  camera.aperture = 0.1f, camera.focus = 4, camera.shutter_close = 1;
  camera.motion = {{0, camera.position, camera.view, camera.up},
                   {1, camera.position + Vec3{0.05f, 0, 0}, camera.view, {0.03f, 1, 0}}};
  return camera;
}

Settings sampled(Primary primary) {
  Settings s = settings(primary);
  s.width = 70, s.height = 50;
  s.samples = 3, s.filter = Filter::mitchell, s.terminator = Terminator::smooth;
  s.ao_samples = 4, s.max_depth = 8;
  return s;
}

class Determinism : public testing::TestWithParam<Primary> {};

TEST_P(Determinism, IsasAndThreadsWithAllThatThereIs) {
  const Scene scene = crowded_room();
  Settings s = sampled(GetParam());
  const Frame expected = render_scene(scene, moving_camera(), s);
  EXPECT_EQ(expected.stats.not_finite_pixels, 0u);
  for (const Isa isa : isas_here()) {
    for (const int threads : {1, 5}) {
      s.isa = isa;
      s.threads = threads;
      const Frame frame = render_scene(scene, moving_camera(), s);
      ASSERT_TRUE(same_bytes(expected, frame)) << frame.stats.isa << " with " << threads << " threads";
    }
  }
  s.crop = {21, 9, 33, 37};
  const Frame part = render_scene(scene, moving_camera(), s);
  for (int y = 0; y < s.crop.height; ++y) {
    ASSERT_EQ(std::memcmp(part.radiance.row(y), expected.radiance.row(s.crop.y + y) + s.crop.x,
                          static_cast<size_t>(s.crop.width) * sizeof(Vec3)),
              0)
        << "row " << y;
  }
}

TEST_P(Determinism, IsasAndThreads) {
  const Scene scene = room();
  Settings s = settings(GetParam());
  const Frame expected = render_scene(scene, kCamera, s);
  EXPECT_GT(expected.stats.covered_pixels, 4000u);
  for (const Isa isa : isas_here()) {
    for (const int threads : {1, 2, 3, 8, 17}) {
      s.isa = isa;
      s.threads = threads;
      const Frame frame = render_scene(scene, kCamera, s);
      ASSERT_TRUE(same_bytes(expected, frame)) << frame.stats.isa << " with " << threads << " threads";
      for (size_t p = 0; p < frame.stats.passes.size(); ++p) {
        EXPECT_EQ(frame.stats.passes[p].rays, expected.stats.passes[p].rays) << frame.stats.passes[p].name;
      }
    }
  }
}

TEST_P(Determinism, CropEqualsTheWholeFramesPart) {
  const Scene scene = room();
  Settings s = settings(GetParam());
  const Frame whole = render_scene(scene, kCamera, s);
  for (const Rectangle& crop : {Rectangle{0, 0, 1, 1}, Rectangle{33, 17, 40, 30}, Rectangle{5, 40, 85, 30},
                                Rectangle{31, 31, 2, 2}}) {
    s.crop = crop;
    const Frame part = render_scene(scene, kCamera, s);
    ASSERT_EQ(part.radiance.width, crop.width);
    ASSERT_EQ(part.radiance.height, crop.height);
    for (int y = 0; y < crop.height; ++y) {
      ASSERT_EQ(std::memcmp(part.radiance.row(y), whole.radiance.row(crop.y + y) + crop.x,
                            static_cast<size_t>(crop.width) * sizeof(Vec3)),
                0)
          << crop.x << "," << crop.y << " row " << y;
    }
  }
}

TEST_P(Determinism, SeedChangesOnlyTheSampling) {
  const Scene scene = room();
  Settings s = settings(GetParam());
  const Frame one = render_scene(scene, kCamera, s);
  s.seed = 2;
  EXPECT_FALSE(same_bytes(one, render_scene(scene, kCamera, s)));
  s.effects.ambient_occlusion = false;
  const Frame two = render_scene(scene, kCamera, s);
  s.seed = 3;
  EXPECT_TRUE(same_bytes(two, render_scene(scene, kCamera, s)));
}

INSTANTIATE_TEST_SUITE_P(Frames, Determinism, testing::Values(Primary::raster, Primary::trace),
                         [](const auto& i) {
                           return i.param == Primary::raster ? std::string("raster") : std::string("trace");
                         });

TEST(Settings, OutOfRangeIsAUsageError) {
  const Scene scene;
  const auto refused = [&](auto change) {
    Settings s;
    s.width = s.height = 8;
    Camera camera;
    change(s, camera);
    try {
      render_scene(scene, camera, s);
    } catch (const std::runtime_error&) {
      return true;
    }
    return false;
  };
  EXPECT_FALSE(refused([](Settings&, Camera&) {}));
  EXPECT_TRUE(refused([](Settings& s, Camera&) { s.width = 0; }));
  EXPECT_TRUE(refused([](Settings& s, Camera&) { s.height = kMaxImageSide + 1; }));
  EXPECT_TRUE(refused([](Settings& s, Camera&) { s.crop = {4, 4, 5, 1}; }));
  EXPECT_TRUE(refused([](Settings& s, Camera&) { s.ao_samples = 15; }));
  EXPECT_TRUE(refused([](Settings& s, Camera&) { s.max_depth = -1; }));
  EXPECT_TRUE(refused([](Settings& s, Camera&) { s.aovs = {"colour"}; }));
  EXPECT_TRUE(refused([](Settings&, Camera& c) { c.view = {0, 0, 0}; }));
  EXPECT_TRUE(refused([](Settings&, Camera& c) { c.up = c.view; }));
  EXPECT_TRUE(refused([](Settings&, Camera& c) { c.fov = 180; }));
  EXPECT_TRUE(refused([](Settings&, Camera& c) { c.near = 0; }));
}

TEST(Control, StopEndsTheRender) {
  const Scene scene = room();
  Control control;
  control.stop = true;
  EXPECT_THROW(render(scene, kCamera, settings(Primary::raster), control), std::runtime_error);
}

}  // namespace
}  // namespace vitral::test
