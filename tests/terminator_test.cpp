// The shadow that a smooth body of coarse facets casts on itself.
#include "kernels/shading.h"
#include "support.h"

#include <gtest/gtest.h>

#include <cmath>

namespace vitral::test {
namespace {

// A sphere of 2 * 16 * 7 triangles with the normals of the true one.
void add_smooth_sphere(Scene& scene, const Vec3& center, float radius) {
  Mesh& m = scene.mesh;
  const size_t first = m.triangles.size();
  add_triangles(scene, 0, sphere(center, radius, 8));
  m.triangle_normals.resize(first, Corners{kNoIndex, kNoIndex, kNoIndex});
  for (size_t i = first; i < m.triangles.size(); ++i) {
    const uint32_t n = static_cast<uint32_t>(m.normals.size());
    for (const uint32_t corner : m.triangles[i]) m.normals.push_back(normalize(m.positions[corner] - center));
    m.triangle_normals.push_back({n, n + 1, n + 2});
  }
}

Settings shadows_only(Terminator terminator) {
  Settings s;
  s.width = 240, s.height = 180;
  s.threads = 1;
  s.effects = only(&Effects::shadows);
  s.terminator = terminator;
  s.aovs = {"position", "shadow", "primitive"};
  return s;
}

// A sphere on a ground, with a post beside it, under a low sun.
const Vec3 kCenter{0.2f, 1, -0.3f};
Scene sphere_on_ground() {
  Scene scene;
  add_material(scene, {});
  add_quad(scene, 0, {-20, 0, 20}, {40, 0, 0}, {0, 0, -40});
  add_quad(scene, 0, {-1.6f, 0, 0.4f}, {0.3f, 0, 0}, {0, 0.7f, 0});
  scene.mesh.triangle_normals.resize(scene.mesh.triangles.size(), Corners{kNoIndex, kNoIndex, kNoIndex});
  add_smooth_sphere(scene, kCenter, 1);
  scene.lights = {sun({0.8f, -0.4f, -0.2f})};
  scene.ambient = {0, 0, 0};
  return scene;
}

// Pixels that see the sphere where the true one is turned to the sun by more than a cosine of 0.05, and those
// of them that are in shadow nevertheless; pixels of the ground in shadow.
struct Seen {
  size_t lit_side = 0, dark = 0, on_ground = 0;
};
Seen count(const Scene& scene, const Frame& frame) {
  Seen sum;
  for (size_t i = 0; i < frame.aovs[0].pixels.pixels.size(); ++i) {
    const bool dark = frame.aovs[1].pixels.pixels[i].x == 0;
    const float primitive = frame.aovs[2].pixels.pixels[i].x;
    if (primitive < 0) continue;
    if (primitive < 4) {
      sum.on_ground += dark;
      continue;
    }
    const Vec3 n = normalize(frame.aovs[0].pixels.pixels[i] - kCenter);
    if (dot(n, -scene.lights[0].direction) <= 0.05f) continue;
    ++sum.lit_side;
    sum.dark += dark;
  }
  return sum;
}

TEST(Terminator, FacetsOfASmoothSphereDoNotShowAtTheEdgeOfItsNight) {
  const Scene scene = sphere_on_ground();
  const Camera camera = camera_at({0.3f, 1.8f, 4.2f}, {0, -0.22f, -1}, 45);
  const Frame facet = render_scene(scene, camera, shadows_only(Terminator::facet));
  const Frame smooth = render_scene(scene, camera, shadows_only(Terminator::smooth));
  const Seen before = count(scene, facet), after = count(scene, smooth);
  EXPECT_GT(before.lit_side, 4000u);
  EXPECT_GT(before.dark, 100u) << "there is something to soften";
  EXPECT_EQ(after.dark, 0u);

  // Flat surfaces, the ground with the shadows of sphere and post, are the same to the bit.
  EXPECT_GT(before.on_ground, 500u);
  for (size_t i = 0; i < facet.radiance.pixels.size(); ++i) {
    if (facet.aovs[2].pixels.pixels[i].x >= 4) continue;
    ASSERT_EQ(facet.radiance.pixels[i], smooth.radiance.pixels[i]) << i;
  }
}

// As the true sphere's Lambert shading, but for the part that the polygons' outline takes away.
TEST(Terminator, TheSphereIsShadedAsTheTrueOne) {
  const Scene scene = sphere_on_ground();
  const Camera camera = camera_at({0.3f, 1.8f, 4.2f}, {0, -0.22f, -1}, 45);
  double error[2] = {};
  for (const Terminator t : {Terminator::facet, Terminator::smooth}) {
    const Frame frame = render_scene(scene, camera, shadows_only(t));
    double sum = 0, pixels = 0;
    for (size_t i = 0; i < frame.radiance.pixels.size(); ++i) {
      if (frame.aovs[2].pixels.pixels[i].x < 4) continue;
      const Vec3 n = normalize(frame.aovs[0].pixels.pixels[i] - kCenter);
      const float exact = 0.8f * std::max(dot(n, -scene.lights[0].direction), 0.0f);
      sum += std::abs(static_cast<double>(frame.radiance.pixels[i].x - exact));
      ++pixels;
    }
    error[t == Terminator::smooth] = sum / pixels;
  }
  EXPECT_LT(error[1], 0.004);
  EXPECT_GT(error[0], 2 * error[1]);
}

// Inside a sphere every plane that touches it at a corner lies behind the facets: nothing is lifted, and
// what the post casts on the bowl begins where it stands.
TEST(Terminator, HollowsAreNotLifted) {
  Scene scene;
  add_material(scene, {});
  add_smooth_sphere(scene, {0, 0, 0}, 2);
  const size_t bowl = scene.mesh.triangles.size();
  add_quad(scene, 0, {-0.2f, -2, 0}, {0.4f, 0, 0}, {0, 1, 0});
  scene.mesh.triangle_normals.resize(scene.mesh.triangles.size(), Corners{kNoIndex, kNoIndex, kNoIndex});
  Light lamp;
  lamp.kind = Light::Kind::point, lamp.position = {0.3f, 0.8f, 1};
  scene.lights = {lamp};
  const Camera camera = camera_at({0, 0.5f, 1.2f}, {0, -0.8f, -1}, 80);
  const Frame facet = render_scene(scene, camera, shadows_only(Terminator::facet));
  const Frame smooth = render_scene(scene, camera, shadows_only(Terminator::smooth));
  size_t dark = 0;
  for (size_t i = 0; i < facet.radiance.pixels.size(); ++i) {
    ASSERT_EQ(facet.aovs[1].pixels.pixels[i], smooth.aovs[1].pixels.pixels[i]) << i;
    dark +=
        facet.aovs[1].pixels.pixels[i].x == 0 && facet.aovs[2].pixels.pixels[i].x < static_cast<float>(bowl);
  }
  EXPECT_GT(dark, 40u);
}

// Closed form: over the middle of an edge of a unit sphere's facet the lift is the mean of the two corners'.
TEST(Terminator, TheLiftIsTheWeightedMeanOfTheTangentPlanes) {
  const double half = 0.3;  // angle from the edge's middle to its ends
  const float s = static_cast<float>(std::sin(half)), c = static_cast<float>(std::cos(half));
  Facet<float, bool> f;
  set_corners<float, bool>({-s, c, 0}, {s, c, 0}, {0, c, -1}, {0, 5, 0}, 0, f);
  f.smooth = true;
  f.corner_normal[0] = {-s, c, 0}, f.corner_normal[1] = {s, c, 0}, f.corner_normal[2] = {0, 1, 0};
  const Vec3 p{0, c, 0};
  for (const float side : {1.0f, -1.0f}) {
    const Vec3 geometric{0, side, 0};
    const auto sum =
        sum_normals(f.corner_normal[0], f.corner_normal[1], f.corner_normal[2], 0.5f, 0.0f, true);
    const Vec3 lifted = lifted_position(f, p, 0.5f, 0.0f, sum, geometric);
    // Each corner's plane is sin^2 above p, along a normal that leans by the same angle to either side.
    EXPECT_NEAR(lifted.y, side > 0 ? c + s * s * c : c, 1e-6);
    EXPECT_NEAR(lifted.x, 0, 1e-6);
  }
}

}  // namespace
}  // namespace vitral::test
