// Rasterized and traced primary hits agree: the same triangle in every pixel whose centre lies farther than
// 1/128 pixel from a projected edge, and there, as wherever the triangle is the same, the same bytes.
#include "io/project.h"
#include "raster_support.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace vitral {
namespace {

using namespace raster_test;

constexpr int kWidth = 330, kHeight = 250;
constexpr double kNearEdge = 1.0 / 128;

// A ground that runs behind the camera and leaves the guard band, a wall, balls from coarse to so fine that
// some hundred triangles share a pixel, all partly sunk into each other, and loose triangles among them.
Scene mixed_scene() {
  Scene scene;
  Material m;
  m.diffuse = {0.8f, 0.7f, 0.5f};
  const uint32_t plain = test::add_material(scene, m);
  Texture checks{"checks", 2, 2, std::vector<uint8_t>(16, 255)};
  checks.texels[0] = checks.texels[13] = 40;
  scene.textures.push_back(checks);
  m.diffuse_map = 0;
  const uint32_t checked = test::add_material(scene, m);
  test::add_quad(scene, checked, {-90, -1, -90}, {0, 0, 180}, {180, 0, 0});
  test::add_quad(scene, checked, {-4, -2, -6}, {9, 0, 1}, {0.5f, 5, -0.4f});
  test::add_triangles(scene, plain, test::sphere({-1.2f, -0.3f, -1}, 1, 6));
  test::add_triangles(scene, plain, test::sphere({0.4f, -0.2f, -1.5f}, 1, 40));
  test::add_triangles(scene, plain, test::sphere({1.5f, -0.8f, 0.2f}, 0.3f, 30));
  test::add_triangles(scene, plain, test::sphere({0.3f, 0.9f, -0.8f}, 0.15f, 90));
  test::Random random(71);
  std::vector<KdTriangle> loose = test::soup(random, 300, 0.15f);
  for (const KdTriangle& t : test::soup(random, 6, 2)) loose.push_back(t);
  test::add_triangles(scene, plain, loose);
  scene.lights = {test::sun({0.5f, -1, -0.4f})};
  return scene;
}

// The scene's triangles as they are on the screen, in double.
struct ScreenEdge {
  double x0, y0, x1, y1;  // pixels
};
struct ScreenTriangle {
  std::vector<ScreenEdge> edges;  // as far as they lie before the camera
  double least_depth;
};

std::vector<ScreenTriangle> project_edges(const Mesh& mesh, const Pinhole& camera) {
  const Projection projection = make_projection(camera, kWidth, kHeight, {});
  std::vector<ScreenTriangle> out;
  for (const Corners& c : mesh.triangles) {
    ScreenTriangle t{{}, 1e30};
    Vec3d corner[3];
    for (size_t k = 0; k < 3; ++k) {
      const Vec3d d = to_double(mesh.positions[c[k]]) - projection.origin;
      corner[k] = {dot(projection.row_x, d), dot(projection.row_y, d), dot(projection.row_w, d)};
    }
    for (size_t k = 0; k < 3; ++k) {
      Vec3d a = corner[k], b = corner[(k + 1) % 3];
      t.least_depth = std::min(t.least_depth, a.z);
      if (a.z < projection.near && b.z < projection.near) continue;
      const Vec3d cut = a + (b - a) * ((projection.near - a.z) / (b.z - a.z));
      if (a.z < projection.near) a = cut;
      if (b.z < projection.near) b = cut;
      t.edges.push_back({a.x / a.z, a.y / a.z, b.x / b.z, b.y / b.z});
    }
    out.push_back(t);
  }
  return out;
}

double distance(const ScreenEdge& e, double x, double y) {
  const double ex = e.x1 - e.x0, ey = e.y1 - e.y0, px = x - e.x0, py = y - e.y0;
  const double squared = ex * ex + ey * ey;
  const double s = squared > 0 ? std::clamp((px * ex + py * ey) / squared, 0.0, 1.0) : 0.0;
  return std::hypot(px - s * ex, py - s * ey);
}

// The pixels whose centres lie near an edge of a triangle that is not wholly behind what is seen there.
std::vector<bool> near_edges(const std::vector<ScreenTriangle>& triangles, const Image<Vec3>& depth) {
  std::vector<bool> near(static_cast<size_t>(kWidth * kHeight), false);
  for (const ScreenTriangle& t : triangles) {
    for (const ScreenEdge& e : t.edges) {
      const auto first = [](double a, double b) { return std::max(0.0, std::floor(std::min(a, b) - 1)); };
      const auto last = [](double a, double b, int size) { return std::min(size - 1.0, std::max(a, b) + 1); };
      for (double y = first(e.y0, e.y1); y <= last(e.y0, e.y1, kHeight); ++y) {
        for (double x = first(e.x0, e.x1); x <= last(e.x0, e.x1, kWidth); ++x) {
          const size_t i = static_cast<size_t>(y) * kWidth + static_cast<size_t>(x);
          const double seen = static_cast<double>(depth.pixels[i].x);
          if (seen > 0 && t.least_depth > seen * 1.00001) continue;
          if (distance(e, x + 0.5, y + 0.5) <= kNearEdge) near[i] = true;
        }
      }
    }
  }
  return near;
}

// The inverse depth of a triangle's plane, and how it changes over the screen, in double.
struct Plane {
  double across, down, at_0;
  Plane(const Mesh& mesh, uint32_t triangle, const Pinhole& camera) {
    const Projection projection = make_projection(camera, kWidth, kHeight, {});
    Vec3d v[3];
    for (size_t k = 0; k < 3; ++k) {
      const Vec3d d = to_double(mesh.positions[mesh.triangles[triangle][k]]) - projection.origin;
      v[k] = {dot(projection.row_x, d), dot(projection.row_y, d), dot(projection.row_w, d)};
    }
    const Vec3d n = cross(v[1] - v[0], v[2] - v[0]);
    const double det = dot(v[0], n);
    across = n.x / det, down = n.y / det, at_0 = n.z / det;
  }
  double at(double x, double y) const { return at_0 + across * x + down * y; }
};

// Whether the line in which two triangles' planes meet passes within 1/128 pixel: an edge of what is seen.
bool planes_meet(const Mesh& mesh, const Pinhole& camera, uint32_t a, uint32_t b, int x, int y) {
  const Plane p(mesh, a, camera), q(mesh, b, camera);
  const double change = std::hypot(p.across - q.across, p.down - q.down);
  return std::abs(p.at(x + 0.5, y + 0.5) - q.at(x + 0.5, y + 0.5)) <= change * kNearEdge;
}

struct Agreement {
  size_t compared = 0, same_near_edges = 0, different = 0, at_meeting_planes = 0;
};

Settings without_effects() {
  Settings settings;
  settings.effects = test::kNoEffects;
  return settings;
}

Agreement compare(const Scene& scene, const Camera& camera, Settings settings) {
  settings.width = kWidth, settings.height = kHeight;
  settings.threads = 1;
  settings.aovs = {"primitive", "depth", "normal", "albedo"};
  settings.primary = Primary::raster;
  const Frame raster = test::render_scene(scene, camera, settings);
  settings.primary = Primary::trace;
  const Frame traced = test::render_scene(scene, camera, settings);

  const Pinhole pinhole = make_pinhole(camera, kWidth, kHeight);
  const std::vector<bool> near = near_edges(project_edges(scene.mesh, pinhole), traced.aovs[1].pixels);
  Agreement sum;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const size_t i = static_cast<size_t>(y * kWidth + x);
      const float a = raster.aovs[0].pixels.pixels[i].x, b = traced.aovs[0].pixels.pixels[i].x;
      if (a == b) {
        (near[i] ? sum.same_near_edges : sum.compared) += 1;
        bool same = std::memcmp(&raster.pixels.pixels[i], &traced.pixels.pixels[i], sizeof(Rgb8)) == 0 &&
                    std::memcmp(&raster.radiance.pixels[i], &traced.radiance.pixels[i], sizeof(Vec3)) == 0;
        for (size_t aov = 0; aov < raster.aovs.size(); ++aov) {
          same &= std::memcmp(&raster.aovs[aov].pixels.pixels[i], &traced.aovs[aov].pixels.pixels[i],
                              sizeof(Vec3)) == 0;
        }
        EXPECT_TRUE(same) << "triangle " << a << " at " << x << "," << y;
        continue;
      }
      ++sum.different;
      if (near[i]) continue;
      const bool meet =
          a >= 0 && b >= 0 &&
          planes_meet(scene.mesh, pinhole, static_cast<uint32_t>(a), static_cast<uint32_t>(b), x, y);
      sum.at_meeting_planes += meet;
      EXPECT_TRUE(meet) << "triangles " << a << " and " << b << " at " << x << "," << y;
    }
  }
  return sum;
}

TEST(RasterRay, TheSameTriangleFartherThanA128thPixelFromEdges) {
  const Scene scene = mixed_scene();
  size_t compared = 0, different = 0, large = 0;
  for (const Camera& camera : {test::camera_at({0.2f, 0.3f, 2.5f}, {0, -0.15f, -1}),
                               test::camera_at({2, 1.5f, 3}, {-0.5f, -0.4f, -1}, 40),
                               test::camera_at({0.3f, 0.2f, 0.6f}, {0.1f, 0.2f, -1}, 100, {0.3f, 1, 0}),
                               test::camera_at({-2, 4, 30}, {0.05f, -0.13f, -1}, 20)}) {
    RasterFrame frame;
    setup_frame(available_kernels().back()->front_end, make_pinhole(camera, kWidth, kHeight), kWidth, kHeight,
                {}, scene.mesh, nullptr, in_order, frame);
    const Paths paths = paths_taken(frame, scene.mesh);
    EXPECT_TRUE(paths.small > 0 && paths.cells > 0 && paths.clipped > 0) << camera.fov;
    large += paths.large;
    const Agreement a = compare(scene, camera, without_effects());
    compared += a.compared, different += a.different;
    EXPECT_LT(a.at_meeting_planes, 10u);
  }
  EXPECT_GT(compared, 320000u);
  EXPECT_LT(different, 200u);
  EXPECT_GT(large, 2u);
}

// With every effect that a scene asks for, what is seen by way of the camera's hit has the same bits, too.
TEST(RasterRay, TheSamePictureOfTheSmallScenes) {
  size_t compared = 0, different = 0;
  for (const char* name : {"ambient_occlusion", "cutout", "glass_solid", "highlight", "near_clip",
                           "point_light", "polished", "shadow", "terminator", "texture"}) {
    SCOPED_TRACE(name);
    Warnings warnings;
    const Project project = load_project(std::string("scenes/") + name + ".xml", warnings);
    const Pipeline& pipeline = project.pipelines[project.default_pipeline];
    ASSERT_EQ(project.scene.cameras.front().name, pipeline.camera);
    const Agreement a = compare(project.scene, project.scene.cameras.front(), pipeline.settings);
    compared += a.compared, different += a.different;
    EXPECT_EQ(a.at_meeting_planes, 0u);
  }
  EXPECT_GT(compared, 300000u);
  EXPECT_LT(different, 100u);
}

TEST(RasterRay, TheSamePictureOfLooseTriangles) {
  Scene scene;
  Material m;
  const uint32_t plain = test::add_material(scene, m);
  m.optics = Optics::mirror, m.specular = {0.5f, 0.5f, 0.5f};
  const uint32_t mirror = test::add_material(scene, m);
  test::Random random(72);
  test::add_triangles(scene, plain, test::soup(random, 600, 0.3f));
  test::add_triangles(scene, mirror, test::soup(random, 40, 0.6f));
  scene.lights = {test::sun({0.3f, -1, -0.6f})};
  Settings settings;
  settings.ao_samples = 4;
  const Agreement a = compare(scene, test::camera_at({0.1f, 0.2f, 3}, {0, 0, -1}, 45), settings);
  EXPECT_GT(a.compared, 50000u);
  EXPECT_LT(a.different, 100u);
  EXPECT_LT(a.at_meeting_planes, 30u);
}

}  // namespace
}  // namespace vitral
