// Rasterized and traced, objects are the same: placed meshes in every pixel whose centre lies farther than
// 1/128 pixel from a projected edge, exact shapes in every pixel; and wherever the hit has the same number,
// all that is known of the surface has the same bytes.
#include "math/pinhole.h"
#include "raster/setup.h"
#include "support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace vitral {
namespace {

constexpr int kWidth = 250, kHeight = 190;
constexpr double kNearEdge = 1.0 / 128;

using Triangle = std::array<Vec3d, 3>;

Affine moved(const Vec3& by) {
  return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, by};
}
Affine scaled(const Vec3& by) {
  return {{by.x, 0, 0}, {0, by.y, 0}, {0, 0, by.z}, {0, 0, 0}};
}
Affine random_turn(test::Random& random) {
  return rotation(random.direction(), random.between(0, 360));
}

// Moves the scene's mesh to its models.
uint32_t make_model(Scene& scene, Scene& from) {
  scene.models.push_back(std::move(from.mesh));
  from.mesh = {};
  return static_cast<uint32_t>(scene.models.size() - 1);
}

void place(Scene& scene, uint32_t model, const Affine& placement, uint32_t material = kNoIndex) {
  Object object;
  object.model = model, object.material = material, object.placement = placement;
  scene.objects.push_back(object);
}
void place(Scene& scene, Shape shape, const Affine& placement, uint32_t material) {
  Object object;
  object.shape = shape, object.material = material, object.placement = placement;
  scene.objects.push_back(object);
}

struct Materials {
  uint32_t plain, checked, holes;
};
Materials add_materials(Scene& scene) {
  Materials all{};
  Material m;
  m.diffuse = {0.8f, 0.7f, 0.5f};
  all.plain = test::add_material(scene, m);
  Texture checks{"checks", 4, 4, std::vector<uint8_t>(64, 255)};
  for (size_t i = 0; i < 16; ++i) {
    if ((i % 4 + i / 4) % 2 == 0) checks.texels[4 * i] = checks.texels[4 * i + 3] = 40;
  }
  scene.textures.push_back(checks);
  m.diffuse_map = 0;
  all.checked = test::add_material(scene, m);
  m.opacity_map = 0;
  all.holes = test::add_material(scene, m);
  return all;
}

// A ground of the scene's own, and models that are placed all over it: coarse and fine balls, some cut out,
// loose triangles, squashed, turned, mirrored, partly sunk into each other and behind the camera.
Scene instances(uint32_t seed, int count) {
  Scene scene;
  const Materials materials = add_materials(scene);
  Scene workshop;
  test::add_triangles(workshop, materials.plain, test::sphere({0, 0, 0}, 1, 6));
  const uint32_t coarse = make_model(scene, workshop);
  test::add_triangles(workshop, materials.plain, test::sphere({0.3f, 0, 0}, 1, 40));
  const uint32_t fine = make_model(scene, workshop);
  test::Random random(seed);
  for (const KdTriangle& t : test::soup(random, 40, 1)) {
    const Vec3 a = test::corner_of(t, 0);
    test::add_quad(workshop, random.below(2) != 0 ? materials.checked : materials.holes, a,
                   test::corner_of(t, 1) - a, test::corner_of(t, 2) - a);
  }
  const uint32_t loose = make_model(scene, workshop);
  test::add_quad(scene, materials.checked, {-90, -1, -90}, {0, 0, 180}, {180, 0, 0});
  for (int i = 0; i < count; ++i) {
    const Vec3 size{random.between(0.1f, 0.7f), random.between(0.1f, 0.7f), random.between(-0.7f, 0.7f)};
    const Vec3 at{random.between(-5, 5), random.between(-1, 1.5f), random.between(-9, 4)};
    place(scene, std::array{coarse, fine, loose}[random.below(3)],
          moved(at) * (random_turn(random) * scaled(size)),
          random.below(4) == 0 ? materials.checked : kNoIndex);
  }
  scene.lights = {test::sun({0.5f, -1, -0.4f})};
  return scene;
}

// Every kind of shape, many times, among a few triangles and instances.
Scene shapes(uint32_t seed, int count) {
  Scene scene = instances(seed, 6);
  test::Random random(seed + 1);
  constexpr Shape kinds[] = {Shape::sphere, Shape::box, Shape::cylinder, Shape::disk};
  for (int i = 0; i < count; ++i) {
    const Vec3 size{random.between(0.1f, 0.6f), random.between(0.1f, 0.6f), random.between(-0.6f, -0.1f)};
    const Vec3 at{random.between(-4, 4), random.between(-1, 1.5f), random.between(-8, 3)};
    place(scene, kinds[random.below(4)], moved(at) * (random_turn(random) * scaled(size)), random.below(3));
  }
  place(scene, Shape::plane, moved({0, -0.95f, 0}) * rotation({0.2f, 0, 1}, 4), 1);
  place(scene, Shape::plane, moved({0, 0, -30}) * rotation({1, 0, 0}, 80), 2);
  return scene;
}

// All triangles by their numbers, where they stand in the world; shapes have none.
std::vector<Triangle> world_triangles(const Scene& scene) {
  std::vector<Triangle> out;
  const auto add = [&](const Mesh& mesh, const Affine& placement) {
    const PreciseAffine to_world = to_double(placement);
    for (const Corners& c : mesh.triangles) {
      Triangle t;
      for (size_t k = 0; k < 3; ++k) t[k] = transform_point(to_world, to_double(mesh.positions[c[k]]));
      out.push_back(t);
    }
  };
  add(scene.mesh, Affine{});
  for (const Object& o : scene.objects) {
    if (o.shape == Shape::mesh) {
      add(scene.models[o.model], o.placement);
    } else {
      out.push_back({});
    }
  }
  return out;
}
bool is_nothing(const Triangle& t) {
  return t[0] == t[1] && t[1] == t[2];
}

// (X, Y, W) of the corners.
Triangle project_corners(const Projection& projection, const Triangle& t) {
  Triangle out;
  for (size_t k = 0; k < 3; ++k) {
    const Vec3d d = t[k] - projection.origin;
    out[k] = {dot(projection.row_x, d), dot(projection.row_y, d), dot(projection.row_w, d)};
  }
  return out;
}

double distance(double x0, double y0, double x1, double y1, double x, double y) {
  const double ex = x1 - x0, ey = y1 - y0, px = x - x0, py = y - y0;
  const double squared = ex * ex + ey * ey;
  const double s = squared > 0 ? std::clamp((px * ex + py * ey) / squared, 0.0, 1.0) : 0.0;
  return std::hypot(px - s * ex, py - s * ey);
}

// The pixels whose centres lie near an edge of a triangle that is not wholly behind what is seen there.
std::vector<bool> near_edges(const std::vector<Triangle>& triangles, const Projection& projection,
                             const Image<Vec3>& depth) {
  std::vector<bool> near(size_t{kWidth} * kHeight, false);
  for (const Triangle& t : triangles) {
    if (is_nothing(t)) continue;
    const Triangle corner = project_corners(projection, t);
    const double least = std::min({corner[0].z, corner[1].z, corner[2].z});
    for (size_t k = 0; k < 3; ++k) {
      Vec3d a = corner[k], b = corner[(k + 1) % 3];
      if (a.z < projection.near && b.z < projection.near) continue;
      const Vec3d cut = a + (b - a) * ((projection.near - a.z) / (b.z - a.z));
      if (a.z < projection.near) a = cut;
      if (b.z < projection.near) b = cut;
      const double x0 = a.x / a.z, y0 = a.y / a.z, x1 = b.x / b.z, y1 = b.y / b.z;
      const auto first = [](double p, double q) { return std::max(0.0, std::floor(std::min(p, q) - 1)); };
      const auto last = [](double p, double q, int size) { return std::min(size - 1.0, std::max(p, q) + 1); };
      for (double y = first(y0, y1); y <= last(y0, y1, kHeight); ++y) {
        for (double x = first(x0, x1); x <= last(x0, x1, kWidth); ++x) {
          const size_t i = static_cast<size_t>(y) * kWidth + static_cast<size_t>(x);
          const double seen = static_cast<double>(depth.pixels[i].x);
          if (seen > 0 && least > seen * 1.00001) continue;
          if (distance(x0, y0, x1, y1, x + 0.5, y + 0.5) <= kNearEdge) near[i] = true;
        }
      }
    }
  }
  return near;
}

// Inverse depth over the screen.
struct Plane {
  double across, down, at_0;
};
Plane plane_of(const Projection& projection, const Triangle& t) {
  const Triangle v = project_corners(projection, t);
  const Vec3d n = cross(v[1] - v[0], v[2] - v[0]);
  const double det = dot(v[0], n);
  return {n.x / det, n.y / det, n.z / det};
}

// Whether the line in which two planes are equally deep passes within 1/128 pixel: an edge of what is seen.
bool planes_meet(const Plane& p, const Plane& q, double x, double y) {
  const double change = std::hypot(p.across - q.across, p.down - q.down);
  const double apart = (p.at_0 - q.at_0) + (p.across - q.across) * x + (p.down - q.down) * y;
  return std::abs(apart) <= change * kNearEdge;
}

// Two triangles, or a triangle and the near plane.
bool is_at_an_edge(const Projection& projection, const Triangle& a, const Triangle& b, double x, double y) {
  const Plane near{0, 0, 1 / projection.near};
  const bool has_a = !is_nothing(a), has_b = !is_nothing(b);
  return (has_a && has_b && planes_meet(plane_of(projection, a), plane_of(projection, b), x, y)) ||
         (has_a && planes_meet(plane_of(projection, a), near, x, y)) ||
         (has_b && planes_meet(plane_of(projection, b), near, x, y));
}

struct Agreement {
  size_t on_objects = 0, on_shapes = 0, different = 0, at_meeting_planes = 0;
};

Frame see(const Scene& scene, const Camera& camera, Primary primary, Isa isa) {
  Settings settings;
  settings.width = kWidth, settings.height = kHeight;
  settings.threads = 1;
  settings.effects = test::kNoEffects;
  settings.isa = isa;
  settings.primary = primary;
  settings.aovs = {"primitive", "depth", "position", "normal", "geometric-normal", "albedo", "material"};
  return test::render_scene(scene, camera, settings);
}

Agreement compare(const Scene& scene, const Camera& camera, Isa isa) {
  const Frame raster = see(scene, camera, Primary::raster, isa);
  const Frame traced = see(scene, camera, Primary::trace, isa);
  const std::vector<Triangle> triangles = world_triangles(scene);
  const Projection projection = make_projection(make_pinhole(camera, kWidth, kHeight), kWidth, kHeight, {});
  const std::vector<bool> near = near_edges(triangles, projection, traced.aovs[1].pixels);
  Agreement sum;
  for (size_t i = 0; i < near.size(); ++i) {
    const float a = raster.aovs[0].pixels.pixels[i].x, b = traced.aovs[0].pixels.pixels[i].x;
    const auto of = [&](float number) {
      return number < 0 ? Triangle{} : triangles[static_cast<size_t>(number)];
    };
    if (a == b) {
      if (a >= static_cast<float>(scene.mesh.triangles.size()))
        ++(is_nothing(of(a)) ? sum.on_shapes : sum.on_objects);
      bool same = std::memcmp(&raster.pixels.pixels[i], &traced.pixels.pixels[i], sizeof(Rgb8)) == 0;
      for (size_t aov = 0; aov < raster.aovs.size(); ++aov) {
        same &= std::memcmp(&raster.aovs[aov].pixels.pixels[i], &traced.aovs[aov].pixels.pixels[i],
                            sizeof(Vec3)) == 0;
      }
      EXPECT_TRUE(same) << "number " << a << " at " << i % kWidth << "," << i / kWidth;
      continue;
    }
    ++sum.different;
    if (near[i]) continue;
    const double x = static_cast<double>(i % kWidth) + 0.5, y = static_cast<double>(i / kWidth) + 0.5;
    const bool meet = is_at_an_edge(projection, of(a), of(b), x, y);
    sum.at_meeting_planes += meet;
    EXPECT_TRUE(meet) << "numbers " << a << " and " << b << " at " << x << "," << y;
  }
  return sum;
}

std::vector<Camera> cameras() {
  return {test::camera_at({0.2f, 0.3f, 5}, {0, -0.1f, -1}),
          test::camera_at({2, 1.5f, 3}, {-0.5f, -0.4f, -1}, 40),
          test::camera_at({0.3f, 0.2f, -1}, {0.1f, 0.1f, -1}, 110, {0.3f, 1, 0}),
          test::camera_at({-2, 6, 40}, {0.05f, -0.15f, -1}, 12)};
}

TEST(ObjectRay, PlacedMeshesFartherThanA128thPixelFromEdges) {
  const Scene scene = instances(1, 60);
  Agreement all;
  for (const Camera& camera : cameras()) {
    const Agreement a = compare(scene, camera, Isa::automatic);
    EXPECT_GT(a.on_objects, 3000u);
    all.on_objects += a.on_objects, all.different += a.different;
    all.at_meeting_planes += a.at_meeting_planes;
  }
  EXPECT_GT(all.on_objects, 40000u);
  EXPECT_LT(all.different, 150u);
  EXPECT_LT(all.at_meeting_planes, 30u);
}

TEST(ObjectRay, ExactShapesInEveryPixel) {
  const Scene scene = shapes(3, 60);
  Agreement all;
  for (const Camera& camera : cameras()) {
    for (const Isa isa : {Isa::automatic, Isa::scalar}) {
      const Agreement a = compare(scene, camera, isa);
      EXPECT_GT(a.on_shapes, 10000u);
      all.on_shapes += a.on_shapes, all.different += a.different;
    }
  }
  EXPECT_GT(all.on_shapes, 150000u);
  EXPECT_LT(all.different, 100u);
}

// A camera inside each of the shapes sees its inner side wherever nothing is nearer.
TEST(ObjectRay, FromInsideAShape) {
  for (const Shape shape : {Shape::sphere, Shape::box, Shape::cylinder}) {
    Scene scene;
    add_materials(scene);
    test::Random random(5);
    place(scene, shape, moved({0.2f, 0, 0.1f}) * (random_turn(random) * scaled({3, 2, -4})), 1);
    place(scene, Shape::sphere, moved({0, 0, -1}) * scaled({0.3f, 0.3f, 0.3f}), 0);
    const Camera camera = test::camera_at({0, 0, 0}, {0, 0, -1}, 80);
    const Agreement a = compare(scene, camera, Isa::automatic);
    EXPECT_EQ(a.on_shapes, size_t{kWidth} * kHeight);
    EXPECT_EQ(a.different, 0u);
  }
}

// Long, thin and far shapes, seen through a very narrow lens: what their bounds leave out no ray meets.
TEST(ObjectRay, ShapesThatAreThinFarAndSeenNarrowly) {
  test::Random random(9);
  size_t on_shapes = 0;
  for (int round = 0; round < 12; ++round) {
    Scene scene;
    add_materials(scene);
    const float far = std::array{3.0f, 300.0f, 900.0f}[static_cast<size_t>(round % 3)];
    for (int i = 0; i < 40; ++i) {
      const Vec3 size{random.between(0.001f, 0.02f), random.between(0.001f, 0.4f),
                      random.between(0.01f, 0.4f)};
      const Vec3 at{random.between(-1, 1), random.between(-1, 1), -far + random.between(-1, 1)};
      constexpr Shape kinds[] = {Shape::sphere, Shape::box, Shape::cylinder, Shape::disk};
      place(scene, kinds[random.below(4)], moved(at) * (random_turn(random) * scaled(size)), 0);
    }
    const Camera camera = test::camera_at({0, 0, 0}, {0, 0, -1}, 100 / far);
    const Agreement a = compare(scene, camera, Isa::automatic);
    EXPECT_EQ(a.different, 0u);
    on_shapes += a.on_shapes;
  }
  EXPECT_GT(on_shapes, 20000u);
}

// Objects at the near plane, across it, and beside the guard band.
TEST(ObjectRay, AcrossTheNearPlane) {
  Scene scene = shapes(21, 30);
  place(scene, 1, scaled({40, 30, 35}));
  place(scene, 0, moved({0, -3, 5}) * scaled({3, 2, 60}));
  Camera camera = test::camera_at({0.3f, 0.2f, 5}, {0.1f, -0.1f, -1}, 90);
  for (const float near : {0.01f, 0.5f, 3.0f, 9.0f}) {
    camera.near = near;
    const Agreement a = compare(scene, camera, Isa::automatic);
    EXPECT_GT(a.on_objects, 10000u);
    EXPECT_LT(a.different, 60u);
  }
}

TEST(ObjectRay, CropsThreadsAndInstructionSetsCannotBeSeen) {
  const Scene scene = shapes(31, 30);
  const Camera camera = cameras()[0];
  Settings settings;
  settings.width = kWidth, settings.height = kHeight;
  settings.ao_samples = 4;
  settings.threads = 1;
  const Frame whole = test::render_scene(scene, camera, settings);
  settings.isa = Isa::scalar;
  settings.threads = 3;
  EXPECT_TRUE(test::same_bytes(whole, test::render_scene(scene, camera, settings)));
  settings.crop = {61, 43, 77, 85};
  const Frame part = test::render_scene(scene, camera, settings);
  for (int y = 0; y < 85; ++y) {
    ASSERT_EQ(std::memcmp(part.radiance.row(y), whole.radiance.row(y + 43) + 61, 77 * sizeof(Vec3)), 0) << y;
  }
}

}  // namespace
}  // namespace vitral
