// What is seen of textures: planes to the horizon against the mean of 256 points a pixel, by the camera, in
// mirrors and through glass; and what is there of cut-outs.
#include "render/texture.h"
#include "texture_support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace vitral::test {
namespace {

constexpr int kSide = 128;

Settings picture(int side = kSide) {
  Settings s;
  s.width = s.height = side;
  s.threads = 2;
  s.effects = kNoEffects;
  return s;
}

// --- planes to the horizon ---------------------------------------------------------------------------

struct Floor {
  Scene scene;
  Texture texture;
  Camera camera;
  float half = 400;
};
Floor make_floor(const Vec3& view, int square) {
  Floor f;
  f.texture = checkerboard(64, 64, square);
  add_textured_floor(f.scene, f.texture, f.half, 1);
  f.camera = camera_at({0.3f, 1.6f, 0.2f}, view, 60);
  f.camera.far = 5000;
  return f;
}

double rms(const std::vector<double>& a, const std::vector<double>& b, int first_row, int end_row) {
  double sum = 0;
  int count = 0;
  for (size_t i = static_cast<size_t>(first_row * kSide); i < static_cast<size_t>(end_row * kSide); ++i) {
    if (std::isnan(a[i]) || std::isnan(b[i])) continue;
    sum += (a[i] - b[i]) * (a[i] - b[i]);
    ++count;
  }
  EXPECT_GT(count, kSide);
  return std::sqrt(sum / count);
}

std::vector<double> reference(const Floor& f, int points) {
  const Pinhole c = make_pinhole(f.camera, kSide, kSide);
  std::vector<double> out;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) out.push_back(floor_reference(c, f.texture, f.half, 1, x, y, points));
  return out;
}

// In bands of rows, from the horizon to where the texture is magnified: within 0.08 of the mean of 256 points
// in a pixel, where one point, which is what the finest level alone gives, is off by up to 0.46.
TEST(TexturedFloor, ConvergesToGreyWithoutMoire) {
  for (const Vec3& view : {Vec3{0.02f, -0.35f, -1}, Vec3{0.5f, -0.35f, -1}}) {
    const Floor f = make_floor(view, 8);
    const std::vector<double> seen = albedo(f.scene, f.camera, picture());
    const std::vector<double> exact = reference(f, 16), level_0 = reference(f, 1);
    for (int row = 24; row + 8 <= 72; row += 8) {
      EXPECT_LT(rms(seen, exact, row, row + 8), 0.08) << "row " << row;
      EXPECT_GT(rms(level_0, exact, row, row + 8), 0.15) << "row " << row;
    }
    EXPECT_LT(rms(seen, exact, 24, kSide), 0.05);
    EXPECT_GT(rms(level_0, exact, 24, kSide), 0.2);
  }
}

// The camera turns by a quarter of a pixel. From the horizon to the nearest row the picture then changes as
// much as the mean of 256 points does, a fifth and 0.01 more at most, where one point flickers between
// black and white; and near paving is the finest level and nothing else.
TEST(TexturedFloor, NeitherShimmersNorBlurs) {
  Floor f = make_floor({0.2f, -0.35f, -1}, 8);
  f.camera.position.y = 0.6f;
  const Pinhole c = make_pinhole(f.camera, kSide, kSide);
  Floor turned = f;
  turned.camera.view = c.forward + c.right * (c.step * 0.25f) + c.up * (c.step * 0.25f);
  const std::vector<double> before = albedo(f.scene, f.camera, picture());
  const std::vector<double> after = albedo(f.scene, turned.camera, picture());
  const std::vector<double> exact = reference(f, 16), exact_after = reference(turned, 16);
  const std::vector<double> point = reference(f, 1), point_after = reference(turned, 1);
  for (int row = 24; row + 8 <= kSide; row += 8) {
    const double change = rms(exact, exact_after, row, row + 8);
    EXPECT_LT(rms(before, after, row, row + 8), 1.2 * change + 0.01) << "row " << row;
    if (row < 48) {
      EXPECT_GT(rms(point, point_after, row, row + 8), 0.6) << "row " << row;
    }
  }
  EXPECT_LT(rms(before, after, 24, 32), 0.02);
  EXPECT_LT(rms(before, point, 88, kSide), 1e-3);
}

// The floor behind the camera, in a mirror that fills the picture down to its foot, against 256 points a
// pixel of the world behind the mirror.
TEST(TexturedFloor, InAMirrorIsSeenByConesAsWellAsByTheCamera) {
  Floor f = make_floor({0, -0.3f, -1}, 8);
  Material mirror;
  mirror.diffuse = {0, 0, 0};
  mirror.specular = {1, 1, 1};
  mirror.optics = Optics::mirror;
  add_quad(f.scene, add_material(f.scene, mirror), {-50, -1, -1}, {100, 0, 0}, {0, 100, 0});
  f.scene.ambient = {1, 1, 1};
  f.scene.background.color = {0, 0, 0};
  Settings s = picture();
  s.effects = only(&Effects::reflection);
  const Frame frame = render_scene(f.scene, f.camera, s);
  std::vector<double> seen;
  for (const Vec3& p : frame.radiance.pixels) seen.push_back(static_cast<double>(p.x));

  // Behind the mirror at z = -1 stands the same camera, looking the other way, left and right exchanged.
  Pinhole c = make_pinhole(f.camera, kSide, kSide);
  c.origin.z = -2 - c.origin.z;
  c.forward.z = -c.forward.z, c.right.z = -c.right.z, c.up.z = -c.up.z;
  const auto mirrored = [&](int points) {
    std::vector<double> out;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) out.push_back(floor_reference(c, f.texture, f.half, 1, x, y, points));
    return out;
  };
  const std::vector<double> exact = mirrored(16), level_0 = mirrored(1);
  EXPECT_LT(rms(seen, exact, 30, 70), 0.06);
  EXPECT_GT(rms(level_0, exact, 30, 70), 0.2);
}

// --- balls -------------------------------------------------------------------------------------------

void add_ball(Scene& scene, const Material& m, const Vec3& center, float radius) {
  const auto triangles = sphere(center, radius, 48);
  Mesh& mesh = scene.mesh;
  mesh.triangle_normals.resize(mesh.triangles.size(), {kNoIndex, kNoIndex, kNoIndex});
  add_triangles(scene, add_material(scene, m), triangles);
  for (const KdTriangle& t : triangles) {
    const uint32_t n = static_cast<uint32_t>(mesh.normals.size());
    for (size_t k = 0; k < 3; ++k) mesh.normals.push_back(normalize(corner_of(t, k) - center));
    mesh.triangle_normals.push_back({n, n + 1, n + 2});
  }
}

// A ball shows a whole floor, in each pixel much of it: against the mean of 8 x 8 pixels of a picture that is
// as many times larger.
double ball_error(const Material& m, double& deviation) {
  Floor f = make_floor({0, -0.1f, -1}, 8);
  add_ball(f.scene, m, {0.3f, 1.2f, -2.5f}, 1);
  f.scene.ambient = {1, 1, 1};
  f.scene.background.color = {0.5f, 0.5f, 0.5f};
  constexpr int kFiner = 8, kSmall = 64;
  Settings s = picture(kSmall);
  s.effects = {false, true, true, false};
  s.aovs = {"material"};
  const Frame frame = render_scene(f.scene, f.camera, s);
  s = picture(kSmall * kFiner);
  s.effects = {false, true, true, false};
  const Frame fine = render_scene(f.scene, f.camera, s);
  double sum = 0, spread = 0;
  int count = 0;
  for (int y = 0; y < kSmall; ++y) {
    for (int x = 0; x < kSmall; ++x) {
      if (frame.aovs[0].pixels.row(y)[x].x < 1) continue;
      double mean = 0;
      for (int j = 0; j < kFiner * kFiner; ++j)
        mean += static_cast<double>(pixel(fine, x * kFiner + j % kFiner, y * kFiner + j / kFiner).x);
      mean /= kFiner * kFiner;
      const double one = static_cast<double>(pixel(fine, x * kFiner + kFiner / 2, y * kFiner + kFiner / 2).x);
      const double got = static_cast<double>(pixel(frame, x, y).x);
      sum += (got - mean) * (got - mean), spread += (one - mean) * (one - mean);
      ++count;
    }
  }
  EXPECT_GT(count, 500);
  deviation = std::sqrt(spread / count);
  return std::sqrt(sum / count);
}

TEST(TexturedFloor, InAMirrorBallIsSeenByConesThatItSpreads) {
  Material m;
  m.diffuse = {0, 0, 0};
  m.specular = {1, 1, 1};
  m.optics = Optics::mirror;
  double deviation = 0;
  EXPECT_LT(ball_error(m, deviation), 0.08);
  EXPECT_GT(deviation, 0.2);
}
TEST(TexturedFloor, ThroughAGlassBallIsSeenByConesThatItFocuses) {
  Material m;
  m.diffuse = {0, 0, 0};
  m.optics = Optics::solid;
  double deviation = 0;
  EXPECT_LT(ball_error(m, deviation), 0.15);
  EXPECT_GT(deviation, 0.2);
}

// --- one picture -------------------------------------------------------------------------------------

TEST(TexturedFloor, IsTheSameRasterizedTracedAndInParts) {
  Floor f = make_floor({0.2f, -0.35f, -1}, 2);
  Material mirror;
  mirror.diffuse = {0.2f, 0.2f, 0.2f};
  mirror.specular = {0.8f, 0.8f, 0.8f};
  mirror.optics = Optics::mirror;
  add_quad(f.scene, add_material(f.scene, mirror), {1, 0, -9}, {6, 0, 5}, {0, 3, 0});
  Settings s = picture();
  s.effects.reflection = true;
  const Frame whole = render_scene(f.scene, f.camera, s);
  Settings other = s;
  other.primary = Primary::trace;
  other.threads = 1;
  other.isa = Isa::scalar;
  EXPECT_TRUE(same_bytes(whole, render_scene(f.scene, f.camera, other)));
  s.crop = {37, 41, 50, 30};
  const Frame part = render_scene(f.scene, f.camera, s);
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 50; ++x) ASSERT_EQ(pixel(part, x, y), pixel(whole, 37 + x, 41 + y));
  }
}

// --- cut-outs ----------------------------------------------------------------------------------------

// What is there of a cut-out is decided in the finest level at every distance: each pixel asks one point, so
// that the share of pixels is that of the picture, within the chance of as many throws: four times
// sqrt(p (1 - p) / n). A mean of alpha, as coarser levels would have it, goes to all or nothing instead.
TEST(CutOut, KeepsItsCoverageAtAnyDistance) {
  Random random(33);
  for (const uint32_t percent : {20u, 70u}) {
    Scene scene;
    Texture leaf = checkerboard(64, 64, 64, 200, 200);
    for (size_t i = 0; i < 64 * 64; ++i) leaf.texels[4 * i + 3] = random.below(100) < percent ? 255 : 0;
    size_t there = 0;
    constexpr int kGrid = 1024;
    for (int i = 0; i < kGrid * kGrid; ++i) {
      const Vec2 at{(static_cast<float>(i % kGrid) + 0.5f) / kGrid,
                    (static_cast<float>(i / kGrid) + 0.5f) / kGrid};
      there += sample_alpha(leaf, at) >= 0.5f;
    }
    const double share = static_cast<double>(there) / (kGrid * kGrid);
    add_textured_floor(scene, leaf, 400, 1);
    scene.materials[0].opacity_map = 0;
    for (const float height : {1.1f, 7.3f, 37.7f, 131.3f}) {
      Camera camera = camera_at({0.21f, height, 0.13f}, {0.031f, -1, 0.017f}, 50, {0, 0, -1});
      Settings s = picture(96);
      const Frame frame = render_scene(scene, camera, s);
      const double n = 96.0 * 96.0, got = static_cast<double>(frame.stats.covered_pixels) / n;
      // Nearby one texel is many pixels, which are one throw.
      const double texels = std::pow(2 * static_cast<double>(height) * std::tan(25 * M_PI / 180) * 64, 2);
      const double bound = 4 * std::sqrt(share * (1 - share) / std::min({n, texels, 64.0 * 64.0}));
      EXPECT_NEAR(got, share, bound) << "from " << height << " m";
      s.primary = Primary::trace;
      EXPECT_TRUE(same_bytes(frame, render_scene(scene, camera, s)));
    }
  }
}

}  // namespace
}  // namespace vitral::test
