// The rasterizer's two layouts: what they hold is what the rendered picture's AOVs hold, on every instruction
// set the same bytes.
#include "render/gbuffer.h"
#include "kernels/octahedral.h"
#include "render/kernel_choice.h"
#include "render/render.h"
#include "support.h"
#include "vitral/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

namespace vitral {
namespace {

constexpr int kWidth = 75, kHeight = 61;

void add_triangle(Scene& scene, const Corners& corners, const Corners& normals, uint32_t material) {
  scene.mesh.triangles.push_back(corners);
  scene.mesh.triangle_normals.push_back(normals);
  scene.mesh.triangle_material.push_back(material);
}

// A ball with normals over a flat floor that ends before the sky begins; three materials.
Scene make_scene() {
  Scene scene;
  scene.materials.resize(3);
  scene.materials[0].diffuse = {0.2f, 0.4f, 0.8f};
  scene.materials[1].diffuse = {1.5f, -1, 0.5f};
  scene.materials[2].diffuse = {0, 1, 0.25f};
  Mesh& mesh = scene.mesh;
  mesh.positions = {{-4, -1, 3}, {4, -1, 3}, {4, -1, -9}, {-4, -1, -9}};
  const Corners flat{kNoIndex, kNoIndex, kNoIndex};
  add_triangle(scene, {0, 1, 2}, flat, 0);
  add_triangle(scene, {0, 2, 3}, flat, 2);
  constexpr uint32_t kRings = 14, kAround = 22;
  for (uint32_t i = 0; i <= kRings; ++i) {
    for (uint32_t j = 0; j < kAround; ++j) {
      const double a = 3.14159265 * i / kRings, b = 6.2831853 * j / kAround;
      const Vec3 n = to_float(Vec3d{std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b)});
      mesh.positions.push_back(n * 1.1f + Vec3{0.2f, 0, -3});
      mesh.normals.push_back(normalize(n));
    }
  }
  for (uint32_t i = 0; i < kRings; ++i) {
    for (uint32_t j = 0; j < kAround; ++j) {
      const uint32_t a = i * kAround + j, b = i * kAround + (j + 1) % kAround;
      const auto corners = [](const Corners& n) { return Corners{n[0] + 4, n[1] + 4, n[2] + 4}; };
      const Corners first{a, b, b + kAround}, second{a, b + kAround, a + kAround};
      if (i > 0) add_triangle(scene, corners(first), first, 1);
      if (i + 1 < kRings) add_triangle(scene, corners(second), second, 1 + j % 2);
    }
  }
  return scene;
}

struct GBufferTest : testing::Test {
  Scene scene = make_scene();
  Camera camera;
  Settings settings;
  ThreadPool pool{2};
  Control control;
  Accelerator accelerator;

  GBufferTest() {
    settings.width = kWidth, settings.height = kHeight;
    settings.effects = {false, false, false, false};
    camera.position = {0.3f, 0.6f, 1.5f};
    camera.view = {-0.05f, -0.2f, -1};
    camera.fov = 55;
    gather_triangles(scene, pool, accelerator);
  }

  GBuffer write(Layout layout, Isa isa = Isa::automatic) {
    settings.isa = isa;
    const FrameContext frame = make_context(scene, accelerator, camera, settings);
    GBuffer out = make_gbuffer(frame, layout);
    if (!out.full.empty()) std::memset(out.full.data(), 0x5a, out.full.size() * sizeof(FullBlock));
    if (!out.min.empty()) std::memset(out.min.data(), 0x5a, out.min.size() * sizeof(MinBlock));
    RasterFrame raster;
    RasterTimes times;
    write_gbuffer(frame, pool, control, raster, out, times);
    return out;
  }

  Frame render_aovs(std::vector<std::string> names) {
    Settings s = settings;
    s.aovs = std::move(names);
    return render_frame(scene, accelerator, camera, s, pool, control);
  }
};

template <class Block>
std::pair<const Block&, size_t> pixel_at(const GBuffer& buffer, const std::vector<Block>& blocks, int x,
                                         int y) {
  return {blocks[block_of(buffer, x, y)], static_cast<size_t>(y % kBlockSide * kBlockSide + x % kBlockSide)};
}

struct GBufferAndAovs : GBufferTest {
  void expect_the_same(uint64_t least_of_floor);
};

void GBufferAndAovs::expect_the_same(uint64_t least_of_floor) {
  for (const Rectangle& crop : {Rectangle{}, Rectangle{21, 9, 37, 44}}) {
    settings.crop = crop;
    const Rectangle part = crop_of(settings);
    const Frame frame = render_aovs({"depth", "position", "normal", "material", "primitive"});
    const GBuffer full = write(Layout::full), min = write(Layout::min);
    uint64_t covered = 0, smooth = 0;
    for (int y = part.y; y < part.y + part.height; ++y) {
      for (int x = part.x; x < part.x + part.width; ++x) {
        const auto [f, i] = pixel_at(full, full.full, x, y);
        const auto [m, j] = pixel_at(min, min.min, x, y);
        const auto aov = [&, x = x, y = y](size_t k) {
          return frame.aovs[k].pixels.pixels[static_cast<size_t>((y - part.y) * part.width + x - part.x)];
        };
        const Vec3 normal{f.nx[i], f.ny[i], f.nz[i]};
        ASSERT_EQ(f.depth[i], aov(0).x) << x << "," << y;
        ASSERT_EQ(m.depth[j], aov(0).x);
        ASSERT_TRUE((Vec3{f.px[i], f.py[i], f.pz[i]} == aov(1)));
        ASSERT_TRUE(normal == aov(2));
        if (f.depth[i] == 0) {
          ASSERT_EQ(f.material[i], kNoMaterial);
          ASSERT_EQ(f.triangle[i], kNoTriangle);
          ASSERT_EQ(m.material[j], kNoMinMaterial);
          ASSERT_EQ(f.albedo[i] + m.normal[j], 0u);
          continue;
        }
        ++covered;
        smooth += f.triangle[i] > 1;
        ASSERT_EQ(static_cast<float>(f.material[i]), aov(3).x);
        ASSERT_EQ(m.material[j], f.material[i]);
        ASSERT_EQ(static_cast<float>(f.triangle[i]), aov(4).x);
        constexpr uint32_t kAlbedo[] = {0xffcc6633u, 0xff8000ffu, 0xff40ff00u};
        ASSERT_EQ(f.albedo[i], kAlbedo[f.material[i]]);
        ASSERT_LT(length(normal_of_octahedral(m.normal[j]) - normal), 7.5e-5f);
      }
    }
    EXPECT_EQ(count_covered(full), covered);
    EXPECT_EQ(count_covered(min), covered);
    EXPECT_LT(covered, static_cast<uint64_t>(part.width * part.height)) << "there is sky";
    EXPECT_GT(smooth, 300u);
    EXPECT_GT(covered - smooth, least_of_floor);
  }
}

TEST_F(GBufferAndAovs, HoldTheSame) {
  expect_the_same(300);
}

// The ball once more, squashed, mirrored and recoloured, and exact shapes, one of them all around.
TEST_F(GBufferAndAovs, HoldTheSameOfObjects) {
  Object ball;
  scene.models.push_back(scene.mesh);
  ball.placement = {{-0.5f, 0, 0}, {0.1f, 0.4f, 0}, {0, 0, 0.5f}, {-0.9f, -0.3f, -0.6f}};
  ball.material = 2;
  Object sphere, box;
  sphere.shape = Shape::sphere, sphere.material = 1;
  sphere.placement = {{0.4f, 0, 0}, {0, 0.3f, 0}, {0, 0, 0.4f}, {1, -0.4f, -1.5f}};
  box.shape = Shape::box, box.material = 0;
  box.placement = {{0.3f, 0.1f, 0}, {0, 0.3f, 0}, {0, 0.1f, 0.3f}, {-0.6f, 0.8f, -2}};
  scene.objects = {ball, sphere, box};
  gather_triangles(scene, pool, accelerator);
  expect_the_same(30);
  const GBuffer full = write(Layout::full);
  size_t on_object[3] = {0, 0, 0};
  for (const FullBlock& block : full.full) {
    for (const uint32_t number : block.triangle) {
      if (number != kNoTriangle && number != 0x5a5a5a5au && is_object(accelerator.placed.view, number))
        ++on_object[object_of(accelerator.placed.view, number)];
    }
  }
  for (const size_t pixels : on_object) EXPECT_GT(pixels, 30u);
  const GBuffer scalar = write(Layout::full, Isa::scalar), min = write(Layout::min),
                min_scalar = write(Layout::min, Isa::scalar);
  EXPECT_EQ(std::memcmp(full.full.data(), scalar.full.data(), full.full.size() * sizeof(FullBlock)), 0);
  EXPECT_EQ(std::memcmp(min.min.data(), min_scalar.min.data(), min.min.size() * sizeof(MinBlock)), 0);
}

// The floor is y = -1: where the rays of the pixels' centres meet it, in double.
TEST_F(GBufferTest, PositionsArePerspectiveCorrect) {
  const GBuffer full = write(Layout::full);
  const Pinhole pinhole = make_pinhole(camera, kWidth, kHeight);
  size_t compared = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto [f, i] = pixel_at(full, full.full, x, y);
      if (f.triangle[i] > 1) continue;
      const Vec3d d = to_double(primary_direction(pinhole, static_cast<float>(x), static_cast<float>(y)));
      const Vec3d eye = to_double(pinhole.origin);
      const double t = (-1 - eye.y) / d.y;
      ASSERT_NEAR(f.depth[i], t, 2e-6 * t);
      ASSERT_NEAR(f.px[i], eye.x + t * d.x, 4e-6 * t);
      ASSERT_NEAR(f.pz[i], eye.z + t * d.z, 4e-6 * t);
      ASSERT_EQ(f.py[i], -1);
      ASSERT_EQ(f.ny[i], 1);
      ++compared;
    }
  }
  EXPECT_GT(compared, 800u);
}

// A block is written from the first byte to the last, or not at all.
TEST_F(GBufferTest, EveryInstructionSetWritesTheSameBytes) {
  const GBuffer full = write(Layout::full, Isa::scalar), min = write(Layout::min, Isa::scalar);
  for (const Kernels* kernels : available_kernels()) {
    const std::string name = kernels->isa;
    const Isa isa = name == "v2"       ? Isa::v2
                    : name == "avx2"   ? Isa::avx2
                    : name == "avx512" ? Isa::avx512
                                       : Isa::scalar;
    const GBuffer other_full = write(Layout::full, isa), other_min = write(Layout::min, isa);
    EXPECT_EQ(std::memcmp(full.full.data(), other_full.full.data(), full.full.size() * sizeof(FullBlock)), 0)
        << name;
    EXPECT_EQ(std::memcmp(min.min.data(), other_min.min.data(), min.min.size() * sizeof(MinBlock)), 0)
        << name;
  }
}

TEST_F(GBufferTest, TheMinimalLayoutHasRoomForSoManyMaterials) {
  scene.materials.resize(kMaxMinMaterials);
  const FrameContext frame = make_context(scene, accelerator, camera, settings);
  EXPECT_NO_THROW(make_gbuffer(frame, Layout::min));
  scene.materials.emplace_back();
  EXPECT_THROW(make_gbuffer(frame, Layout::min), UsageError);
  EXPECT_NO_THROW(make_gbuffer(frame, Layout::full));
}

// Half a step of either code, in the middle of a face: 4 / 65535 and a little.
TEST(Octahedral, NormalsSurviveThePacking) {
  test::Random random(7);
  const auto check = [](const Vec3& n) {
    ASSERT_LT(length(normal_of_octahedral(octahedral_normal(n)) - n), 7.5e-5f)
        << n.x << " " << n.y << " " << n.z;
  };
  for (int i = 0; i < 20000; ++i) check(random.direction());
  for (const float s : {-1.0f, 1.0f}) check({s, 0, 0}), check({0, s, 0}), check({0, 0, s});
}

}  // namespace
}  // namespace vitral
