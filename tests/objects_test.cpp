// Placed meshes and shapes: every object tested = one ray through the tree = packets of every instruction
// set, bit for bit.
#include "kdtree/shapes.h"
#include "kernels/kernels.h"
#include "math/bounds.h"
#include "object_support.h"
#include "render/kernel_choice.h"
#include "vitral/error.h"

#include <gtest/gtest.h>

namespace vitral::test {
namespace {

// A floor of the scene's own, two models, all shapes, under maps of every kind; one material in three is
// glass.
Scene crowd(uint32_t seed, int objects) {
  Random random(seed);
  Scene scene;
  Material opaque, glass;
  glass.optics = Optics::thin;
  add_material(scene, opaque);
  add_material(scene, opaque);
  add_material(scene, glass);
  add_quad(scene, 0, {-4, -3, 4}, {8, 0, 0}, {0, 0, -8});
  const uint32_t soup_model = add_model(scene, 0, soup(random, 200, 0.3f));
  const uint32_t ball = add_model(scene, 2, sphere({0.2f, 0, 0}, 1, 8));
  const Shape shapes[] = {Shape::sphere, Shape::box, Shape::cylinder, Shape::disk, Shape::plane};
  for (uint32_t i = 0; i < static_cast<uint32_t>(objects); ++i) {
    const Affine placement = random_placement(random, i);
    if (i % 3 == 0) {
      scene.objects.push_back(
          shape_at(shapes[i % 57 == 0 ? 4 : random.below(4)], random.below(3), placement));
    } else {
      const uint32_t model = i % 3 == 1 ? soup_model : ball;
      scene.objects.push_back(model_at(model, placement, i % 5 == 0 ? random.below(3) : kNoIndex));
    }
  }
  return scene;
}

Vec3 point_of(Random& random, const Scene& scene) {
  const Object& object = scene.objects[random.below(static_cast<uint32_t>(scene.objects.size()))];
  const Vec3 inside = random.below(2) ? random.direction() : random.in_box(-1, 1);
  return transform_point(object.placement, inside);
}

Ray ray_at(Random& random, const Scene& scene, uint32_t kind) {
  const Vec3 axes[3] = {{1, 0, 0}, {0, -1, 0}, {0, 0, 1}};
  Ray ray{random.in_box(-5, 5), 0, random.direction(), kInfinity};
  const Vec3 target = point_of(random, scene);
  switch (kind % 8) {
    case 0:
      break;
    case 1:
      ray.direction = target - ray.origin;
      break;
    case 2:
      ray.origin = target;
      break;
    case 3:
      ray.origin = random.direction() * 1000;
      ray.direction = normalize(target - ray.origin);
      break;
    case 4:
      ray.direction = axes[random.below(3)];
      ray.origin = target - ray.direction * 3;
      break;
    case 5:
      ray.direction = target - ray.origin, ray.tmax = random.between(0.2f, 1.5f), ray.tmin = 0.1f;
      break;
    case 6:
      ray.direction = (target - ray.origin) * random.between(0.001f, 1000);
      break;
    case 7:
      ray.origin = target, ray.direction = point_of(random, scene) - target;
      break;
  }
  return ray;
}

Hit brute_force(const Built& built, const Ray& ray) {
  const KdView& mesh = built.accelerator.view;
  Hit hit = brute_force_closest(mesh, static_cast<uint32_t>(built.accelerator.triangles.size()), ray,
                                GlassRule::blocks);
  brute_force_objects(built.objects(), ray, hit);
  return hit;
}
Hit one_ray(const Built& built, const Ray& ray) {
  Hit hit = walk_closest(built.accelerator.view, ray);
  walk_objects(built.objects(), ray, Seen::everything, hit);
  return hit;
}

class ObjectsOnEveryIsa : public testing::TestWithParam<const Kernels*> {};

void expect_same_answers(const Built& built, const Kernels& kernels, const RayPacket& rays, int& met) {
  HitPacket hits;
  kernels.trace_closest(built.accelerator.view, rays, hits);
  kernels.closest_objects(built.objects(), rays, hits);
  uint64_t any[2], expected[2] = {0, 0};
  const GlassRule rules[2] = {GlassRule::blocks, GlassRule::passes};
  for (int r = 0; r < 2; ++r) any[r] = kernels.any_objects(built.objects(), rays, rules[r]);
  for (int lane = 0; lane < kPacketSize; ++lane) {
    if (!(rays.live >> lane & 1)) {
      ASSERT_EQ(hits.triangle[lane], kNoTriangle);
      continue;
    }
    const Ray ray = ray_of(rays, lane);
    const Hit all = brute_force(built, ray), one = one_ray(built, ray);
    ASSERT_TRUE(same_bits(one, all)) << lane << " " << one.triangle << " " << all.triangle << " " << one.t
                                     << " " << all.t;
    ASSERT_TRUE(same_bits(hit_of(hits, lane), all))
        << lane << " " << hits.triangle[lane] << " " << all.triangle << " " << hits.t[lane] << " " << all.t;
    met += is_object(built.objects(), all.triangle);
    for (int r = 0; r < 2; ++r) {
      const bool blocked = brute_force_objects_any(built.objects(), ray, rules[r]);
      ASSERT_EQ(walk_objects_any(built.objects(), ray, rules[r]), blocked);
      expected[r] |= uint64_t{blocked} << lane;
    }
  }
  EXPECT_EQ(any[0], expected[0]);
  EXPECT_EQ(any[1], expected[1]);
}

TEST_P(ObjectsOnEveryIsa, TheLadderOfOracles) {
  int met = 0;
  for (uint32_t seed = 1; seed <= 3; ++seed) {
    const Scene scene = crowd(seed, 60);
    const Built built(scene);
    Random random(seed + 10);
    for (uint32_t packet = 0; packet < 12; ++packet) {
      RayPacket rays{};
      float tmin = 0;
      for (int lane = 0; lane < kPacketSize; ++lane) {
        // One kind a packet, or all mixed.
        const uint32_t kind = packet < 8 ? packet : random.below(8);
        const Ray ray = ray_at(random, scene, kind);
        tmin = ray.tmin;
        set_ray(rays, lane, ray);
      }
      rays.tmin = tmin;
      rays.live = packet % 3 == 2 ? 0x0ff3f0f1ffffff0eull : ~0ull;
      expect_same_answers(built, *GetParam(), rays, met);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(met, 800);
}

// Hits of two objects at the very same t: the lower number is the closer one, in whatever order they come.
TEST_P(ObjectsOnEveryIsa, OfEqualHitsTheLowerNumberIsCloser) {
  Scene scene;
  add_material(scene, {});
  const auto ball = sphere({0, 0, 0}, 1, 6);
  add_triangles(scene, 0, ball);
  const uint32_t model = add_model(scene, 0, ball);
  for (int i = 0; i < 3; ++i) scene.objects.push_back(model_at(model, {}));
  for (int i = 0; i < 3; ++i) scene.objects.push_back(shape_at(Shape::sphere, 0, translation({5, 0, 0})));
  const Built built(scene);
  RayPacket rays{};
  Random random(4);
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const Vec3 target = random.in_box(-0.5f, 0.5f) + Vec3{lane < 32 ? 0.0f : 5.0f, 0, 0};
    const Vec3 origin = target + random.direction() * 4;
    set_ray(rays, lane, {origin, 0, target - origin, kInfinity});
  }
  rays.live = ~0ull;
  int met = 0;
  expect_same_answers(built, *GetParam(), rays, met);
  HitPacket hits;
  GetParam()->trace_closest(built.accelerator.view, rays, hits);
  GetParam()->closest_objects(built.objects(), rays, hits);
  const uint32_t own = static_cast<uint32_t>(ball.size());
  int first_sphere = 0;
  for (int lane = 0; lane < 32; ++lane) EXPECT_LT(hits.triangle[lane], own) << "the mesh's own";
  for (int lane = 32; lane < 64; ++lane) first_sphere += hits.triangle[lane] == 4 * own;
  EXPECT_GT(first_sphere, 25);
  // Without what the mesh gave: the first of the objects.
  for (int lane = 0; lane < kPacketSize; ++lane) set_hit(hits, lane, Hit{});
  GetParam()->closest_objects(built.objects(), rays, hits);
  for (int lane = 0; lane < 32; ++lane) EXPECT_LT(hits.triangle[lane], 2 * own);
}

// What an identity places is the mesh itself: its hits have the same bits.
TEST_P(ObjectsOnEveryIsa, AnIdentityChangesNoBit) {
  Random random(5);
  const auto triangles = soup(random, 300, 0.3f);
  Scene direct, placed;
  add_material(direct, {}), add_material(placed, {});
  add_triangles(direct, 0, triangles);
  placed.objects.push_back(model_at(add_model(placed, 0, triangles), {}));
  const Built a(direct), b(placed);
  for (int packet = 0; packet < 20; ++packet) {
    RayPacket rays{};
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const Vec3 origin = random.in_box(-2, 2);
      set_ray(rays, lane, {origin, 0, random.in_box(-1, 1) - origin, kInfinity});
    }
    rays.live = ~0ull;
    HitPacket one, two;
    GetParam()->trace_closest(a.accelerator.view, rays, one);
    GetParam()->trace_closest(b.accelerator.view, rays, two);
    GetParam()->closest_objects(b.objects(), rays, two);
    for (int lane = 0; lane < kPacketSize; ++lane)
      ASSERT_TRUE(same_bits(hit_of(one, lane), hit_of(two, lane))) << lane;
    EXPECT_EQ(GetParam()->any_objects(b.objects(), rays, GlassRule::blocks),
              GetParam()->trace_any(a.accelerator.view, rays, GlassRule::blocks));
  }
}

// Ambient rays are counted one by one: the same number whether what is near is the mesh's or placed.
TEST_P(ObjectsOnEveryIsa, AmbientRaysMeetMeshAndObjectsAlike) {
  Random random(6);
  const auto triangles = soup(random, 300, 0.3f);
  const std::vector<KdTriangle> half(triangles.begin(), triangles.begin() + 150),
      rest(triangles.begin() + 150, triangles.end());
  Scene direct, placed;
  add_material(direct, {}), add_material(placed, {});
  add_triangles(direct, 0, triangles), add_triangles(placed, 0, half);
  placed.objects.push_back(model_at(add_model(placed, 0, rest), {}));
  const Built a(direct), b(placed);
  PointPacket points{};
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const Vec3 p = random.in_box(-1, 1), n = random.direction();
    points.px[lane] = p.x, points.py[lane] = p.y, points.pz[lane] = p.z;
    points.gx[lane] = points.nx[lane] = n.x;
    points.gy[lane] = points.ny[lane] = n.y;
    points.gz[lane] = points.nz[lane] = n.z;
    points.offset[lane] = 1e-5f;
    points.key[lane] = random.bits();
  }
  points.live = 0xfffffff7ffff00ffull;
  const AmbientSettings settings{4, 0.7f};
  FreeRays expected, got;
  const PointPacket* packet = &points;
  GetParam()->ambient_blocks(a.accelerator.view, &packet, 1, settings, &expected);
  GetParam()->ambient_objects(b.accelerator.view, b.objects(), points, settings, got);
  int blocked = 0;
  for (int lane = 0; lane < kPacketSize; ++lane) {
    if (!(points.live >> lane & 1)) continue;
    EXPECT_EQ(got.count[lane], expected.count[lane]) << lane;
    blocked += expected.count[lane] < 16;
  }
  EXPECT_GT(blocked, 30);
}

TEST_P(ObjectsOnEveryIsa, CountingChangesNoAnswer) {
  const Scene scene = crowd(7, 40);
  const Built built(scene);
  Random random(8);
  RayPacket rays{};
  for (int lane = 0; lane < kPacketSize; ++lane) set_ray(rays, lane, ray_at(random, scene, 1));
  rays.live = ~0ull;
  HitPacket hits, counted;
  for (int lane = 0; lane < kPacketSize; ++lane) set_hit(hits, lane, Hit{}), set_hit(counted, lane, Hit{});
  TraversalCounts totals{}, one{};
  LaneWork work{};
  GetParam()->closest_objects(built.objects(), rays, hits);
  GetParam()->count_closest_objects(built.objects(), rays, counted, {&totals, &work});
  double sum = 0;
  for (int lane = 0; lane < kPacketSize; ++lane) {
    EXPECT_TRUE(same_bits(hit_of(hits, lane), hit_of(counted, lane)));
    sum += static_cast<double>(work.work[lane]);
    Hit hit;
    walk_objects(built.objects(), ray_of(rays, lane), Seen::everything, hit, one);
  }
  EXPECT_EQ(sum, static_cast<double>(work_of(totals))) << "all of it is some ray's";
  EXPECT_EQ(totals.rays_traced, 0u) << "the caller's to say";
  EXPECT_GE(work_of(totals), work_of(one)) << "a packet goes where one of its rays goes";
  EXPECT_LT(work_of(totals), 4 * work_of(one));
  TraversalCounts shadow{};
  EXPECT_EQ(GetParam()->count_any_objects(built.objects(), rays, GlassRule::passes, {&shadow, nullptr}),
            GetParam()->any_objects(built.objects(), rays, GlassRule::passes));
  EXPECT_GT(work_of(shadow), 0u);
}

INSTANTIATE_TEST_SUITE_P(All, ObjectsOnEveryIsa, testing::ValuesIn(available_kernels()),
                         [](const auto& p) { return std::string(p.param->isa); });

// Rays that graze the boxes, at the corners of objects that are thin, far from their own origin or squashed,
// from far away: the tree must not lose one that testing all finds.
TEST(Objects, NothingIsLostAtTheEdgesOfTheBoxes) {
  Scene scene;
  add_material(scene, {});
  Scene pane;
  add_quad(pane, 0, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  Scene distant;
  add_quad(distant, 0, {999, -1, 0}, {2, 0, 0}, {0, 2, 0});
  scene.models = {pane.mesh, distant.mesh};
  Random random(12);
  std::vector<Vec3> corners;
  for (uint32_t i = 0; i < 60; ++i) {
    Affine placement = random_placement(random, i);
    if (i % 4 == 0) placement = translation(random.in_box(-3, 3));
    switch (i % 5) {
      case 0:
        scene.objects.push_back(model_at(0, placement));
        break;
      case 1:
        scene.objects.push_back(model_at(1, placement * translation({-1000, 0, 0})));
        break;
      case 2:
        scene.objects.push_back(shape_at(Shape::box, 0, placement));
        break;
      default:
        scene.objects.push_back(shape_at(i % 5 == 3 ? Shape::disk : Shape::sphere, 0, placement));
    }
    const float flat = i % 5 < 2 ? 0.0f : 1.0f;
    for (const float x : {-1.0f, 1.0f}) {
      for (const float y : {-1.0f, 1.0f}) corners.push_back(transform_point(placement, Vec3{x, y, flat}));
      corners.push_back(transform_point(placement, Vec3{x, 0, 0}));
    }
  }
  const Built built(scene);
  int met = 0;
  for (int i = 0; i < 40000; ++i) {
    const Vec3 target = corners[random.below(static_cast<uint32_t>(corners.size()))];
    Vec3 direction = random.direction();
    if (i % 3 == 0) direction = i % 2 ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
    const Vec3 origin = target - direction * (i % 4 == 0 ? 3.0f : 900.0f);
    const Ray ray{origin, 0, target - origin, kInfinity};
    const Hit all = brute_force(built, ray), one = one_ray(built, ray);
    ASSERT_TRUE(same_bits(one, all)) << i << " " << one.triangle << " " << all.triangle;
    met += all.triangle != kNoTriangle && absolute(all.t - 1) < 1e-3f;
  }
  EXPECT_GT(met, 5000);
}

// Only glass is seen: the same as when there were nothing else.
TEST(Objects, GlassAlone) {
  const Scene scene = crowd(9, 60);
  Scene glass = scene;
  glass.mesh = {};
  glass.objects.clear();
  for (const Object& object : scene.objects) {
    const uint32_t own = object.shape == Shape::mesh ? scene.models[object.model].triangle_material[0] : 0;
    if ((object.material != kNoIndex ? object.material : own) == 2) glass.objects.push_back(object);
  }
  ASSERT_LT(glass.objects.size(), scene.objects.size());
  const Built all(scene), only(glass);
  EXPECT_TRUE(all.accelerator.has_glass);
  Random random(10);
  int met = 0;
  for (uint32_t i = 0; i < 2000; ++i) {
    const Ray ray = ray_at(random, scene, i);
    Hit a, b;
    walk_objects(all.objects(), ray, Seen::glass_only, a);
    brute_force_objects(only.objects(), ray, b);
    ASSERT_EQ(a.t, b.t) << i;
    if (a.triangle == kNoTriangle) continue;
    ++met;
    EXPECT_EQ(material_of(scene, all.accelerator.placed, a.triangle), 2u);
  }
  EXPECT_GT(met, 500);
}

TEST(Objects, NumbersGoOnWhereTheMeshEnds) {
  Scene scene;
  add_material(scene, {});
  add_material(scene, {});
  add_quad(scene, 0, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const uint32_t model = add_model(scene, 0, sphere({0, 0, 0}, 1, 4));
  const uint32_t count = static_cast<uint32_t>(scene.models[model].triangles.size());
  scene.objects = {model_at(model, {}), shape_at(Shape::box, 1, {}), model_at(model, {}, 1)};
  const Built built(scene);
  const ObjectsView& view = built.objects();
  EXPECT_EQ(view.first_number, 2u);
  EXPECT_EQ(view.end_number, 2 + 2 * count + 1);
  EXPECT_FALSE(is_object(view, 1));
  EXPECT_TRUE(is_object(view, 2));
  EXPECT_FALSE(is_object(view, kNoTriangle));
  EXPECT_EQ(object_of(view, 2), 0u);
  EXPECT_EQ(object_of(view, 1 + count), 0u);
  EXPECT_EQ(object_of(view, 2 + count), 1u);
  EXPECT_EQ(object_of(view, 3 + count), 2u);
  EXPECT_EQ(object_of(view, view.end_number - 1), 2u);
  const PlacedObjects& placed = built.accelerator.placed;
  EXPECT_EQ(material_of(scene, placed, 1), 0u);
  EXPECT_EQ(material_of(scene, placed, 2), 0u);
  EXPECT_EQ(material_of(scene, placed, 2 + count), 1u);
  EXPECT_EQ(material_of(scene, placed, 3 + count), 1u);
}

TEST(Objects, TooManyTrianglesAreRefused) {
  Scene scene;
  add_material(scene, {});
  const uint32_t model = add_model(scene, 0, sphere({0, 0, 0}, 1, 20));
  scene.models[model].triangles.resize(0x40000000u / 1024);
  scene.models[model].triangle_material.resize(scene.models[model].triangles.size());
  scene.objects.assign(4096, model_at(model, {}));
  Accelerator accelerator;
  ThreadPool pool(1);
  EXPECT_THROW(gather_triangles(scene, pool, accelerator), UsageError);
  scene.objects.resize(4095);
  Accelerator enough;
  gather_triangles(scene, pool, enough);
  EXPECT_EQ(enough.placed.view.end_number, 4095u * (0x40000000u / 1024));
}

// Where they are at a time is a function of it alone, however often they are placed.
TEST(Objects, AreWhereTheirMotionPutsThem) {
  Scene scene;
  add_material(scene, {});
  Object ball = shape_at(Shape::sphere, 0, scaling(0.5f, 0.5f, 0.5f));
  ball.motion = {{0, {0, 0, 0}, {}}, {1, {4, 0, 0}, quaternion({0, 1, 0}, 90)}};
  Object rest = shape_at(Shape::box, 0, translation({0, 10, 0}));
  scene.objects = {ball, rest};
  Built built(scene);
  const auto t_at = [&](float x) {
    Hit hit;
    walk_objects(built.objects(), {{x, 0, 5}, 0, {0, 0, -1}, kInfinity}, Seen::everything, hit);
    return hit.t;
  };
  EXPECT_EQ(t_at(0), 4.5f);
  for (const float time : {0.5f, 1.0f, 0.0f, 0.5f}) {
    place_objects(scene, time, built.accelerator);
    EXPECT_NEAR(t_at(4 * time), 4.5f, 1e-5f);
    EXPECT_EQ(t_at(4 * time + 0.6f), kInfinity);
    Scene there = scene;
    there.objects[0].placement = placement_at(scene.objects[0], time);
    there.objects[0].motion.clear();
    const Built fresh(there);
    const PlacedObject &a = built.objects().objects[0], &b = fresh.objects().objects[0];
    EXPECT_EQ(a.to_world.origin, b.to_world.origin);
    EXPECT_EQ(a.to_world.x, b.to_world.x);
    EXPECT_EQ(a.bounds.min, b.bounds.min);
  }
  const Box all = bounds(scene);
  EXPECT_EQ(all.min.x, -1);
  EXPECT_NEAR(all.max.x, 4.5f, 1e-5f);
}

// The tree leads rays to few of many objects; nothing breaks where all boxes are the same.
TEST(Objects, TheTreeLeadsToFewOfMany) {
  Scene scene;
  add_material(scene, {});
  for (int i = 0; i < 4096; ++i) {
    const Vec3 at{static_cast<float>(i % 16), static_cast<float>(i / 16 % 16), static_cast<float>(i / 256)};
    scene.objects.push_back(shape_at(Shape::sphere, 0, translation(at) * scaling(0.1f, 0.1f, 0.1f)));
  }
  const Built built(scene);
  Random random(11);
  TraversalCounts counts{};
  for (int i = 0; i < 200; ++i) {
    const Vec3 origin{random.between(0, 16), random.between(0, 16), -3};
    Hit hit;
    walk_objects(built.objects(), {origin, 0, {0, 0, 1}, kInfinity}, Seen::everything, hit, counts);
  }
  EXPECT_LT(work_of(counts), 200u * 60);
  EXPECT_TRUE(comes_near(built.objects(), {{-1, -1, -1}, {0, 0, 0}}));
  EXPECT_FALSE(comes_near(built.objects(), {{0.4f, 0.4f, 0.4f}, {0.6f, 0.6f, 0.6f}}));

  Scene same;
  add_material(same, {});
  same.objects.assign(5000, shape_at(Shape::sphere, 0, {}));
  const Built all(same);
  Hit hit;
  walk_objects(all.objects(), {{0, 0, 3}, 0, {0, 0, -1}, kInfinity}, Seen::everything, hit);
  EXPECT_EQ(hit.triangle, 0u);
  EXPECT_EQ(hit.t, 2);
}

}  // namespace
}  // namespace vitral::test
