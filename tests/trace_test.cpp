// The ladder of oracles: every triangle tested = one ray through the tree = packets of every
// instruction set, bit for bit, on rays chosen to hurt.
#include "kernels/kernels.h"
#include "render/kernel_choice.h"
#include "support.h"

#include <gtest/gtest.h>

#include <limits>

namespace vitral::test {
namespace {

// Rays of every kind that has ever broken a tracer, aimed at the given triangles.
Ray nasty_ray(Random& random, const std::vector<KdTriangle>& triangles, uint32_t kind) {
  const KdTriangle& t = triangles[random.below(static_cast<uint32_t>(triangles.size()))];
  const Vec3 a = corner_of(t, 0), b = corner_of(t, 1), c = corner_of(t, 2);
  const Vec3 axes[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  Ray r{random.in_box(-3, 3), 0, random.direction(), kInfinity};
  switch (kind % 12) {
    case 0:
      break;  // anything
    case 1:
      r.direction = a - r.origin;
      break;  // through a corner
    case 2:
      r.direction = (a + b) * 0.5f - r.origin;
      break;  // through an edge
    case 3:
      r.direction = (a + b + c) * (1.0f / 3) - r.origin;
      break;  // through the middle
    case 4:
      r.direction = axes[random.below(6)];
      break;  // along an axis
    case 5:
      r.direction = axes[random.below(6)], r.origin = a - r.direction * 4;
      break;  // along an axis, through a corner
    case 6:
      r.origin = a, r.direction = normalize(b - a);
      break;  // from a corner along an edge
    case 7:
      r.origin = a * 2 - b, r.direction = b - a;
      break;  // in the plane, along an edge
    case 8:
      r.origin = (a + b + c) * (1.0f / 3);
      break;  // from inside a triangle
    case 9:
      r.direction = random.direction() * random.between(0.001f, 1000);
      break;  // any length
    case 10:
      r.origin = r.origin * 1000, r.direction = a - r.origin;
      break;  // from far away
    case 11:
      r.direction.x = 0, r.tmax = random.between(0, 3);
      break;  // in an axis plane, bounded
  }
  return r;
}

std::vector<KdTriangle> scene(int which) {
  Random random(static_cast<uint32_t>(which) + 100);
  std::vector<KdTriangle> out;
  switch (which) {
    case 0:
      return soup(random, 300, 0.3f);
    case 1:
      return sphere({0.1f, -0.2f, 0.3f}, 1, 10);
    case 2:  // a city of boxes' faces on a lattice: planes and triangles coincide everywhere
      for (int i = 0; i < 200; ++i) {
        const float x = static_cast<float>(random.below(8)) * 0.25f - 1,
                    y = static_cast<float>(random.below(8)) * 0.25f - 1;
        const float z = static_cast<float>(random.below(8)) * 0.25f - 1;
        const int flat = static_cast<int>(random.below(3));
        const Vec3 u = flat == 0 ? Vec3{0, 0.25f, 0} : Vec3{0.25f, 0, 0},
                   v = flat == 2 ? Vec3{0, 0.25f, 0} : Vec3{0, 0, 0.25f};
        add_triangle(out, {x, y, z}, Vec3{x, y, z} + u, Vec3{x, y, z} + v);
        add_triangle(out, Vec3{x, y, z} + u, Vec3{x, y, z} + u + v, Vec3{x, y, z} + v);
      }
      return out;
    case 3:  // needles, all crossing near the middle
      for (int i = 0; i < 200; ++i) {
        const Vec3 d = random.direction() * 2, e = random.direction() * 1e-6f;
        add_triangle(out, -d, d, d + e);
      }
      return out;
    case 4:  // the same triangle many times, and a flat fan in one plane
      for (int i = 0; i < 40; ++i) add_triangle(out, {-1, -1, 0.5f}, {1, -1, 0.5f}, {0, 1, 0.5f});
      for (int i = 0; i < 40; ++i)
        add_triangle(out, {0, 0, 0}, random.in_box(-1, 1) * Vec3{1, 1, 0},
                     random.in_box(-1, 1) * Vec3{1, 1, 0});
      return out;
    case 5:
      return sphere({1.5e5f, -1234, 2e5f}, 300, 8);
    default:
      return sphere({0, 0, 0}, 1e-5f, 6);
  }
}
constexpr int kScenes = 7;

// Random rays in the scene's own scale: nasty_ray() assumes the cube.
Ray ray_for(Random& random, const Tree& tree, uint32_t kind) {
  const Vec3 center_ = center(tree.tree.bounds);
  const float scale = diagonal(tree.tree.bounds) * 0.5f;
  if (magnitude(tree.tree.bounds) < 4 && scale > 0.1f) return nasty_ray(random, tree.triangles, kind);
  Ray r{center_ + random.direction() * (scale * 2), 0, {}, kInfinity};
  const KdTriangle& t = tree.triangles[random.below(tree.size())];
  r.direction = (kind & 1 ? corner_of(t, 0) : (corner_of(t, 0) + corner_of(t, 1)) * 0.5f) - r.origin;
  if (kind % 3 == 0) r.direction = random.direction();
  if (kind % 5 == 0) r.origin = center_;
  return r;
}

TEST(Trace, WalkEqualsBruteForce) {
  for (int which = 0; which < kScenes; ++which) {
    const Tree tree(scene(which));
    Random random(7);
    int hits = 0;
    for (uint32_t i = 0; i < 6000; ++i) {
      const Ray ray = ray_for(random, tree, i);
      const Hit brute = brute_force_closest(tree.view, tree.size(), ray, GlassRule::blocks);
      const Hit walk = walk_closest(tree.view, ray);
      ASSERT_TRUE(same_bits(brute, walk))
          << "scene " << which << " ray " << i << ": t " << brute.t << " and " << walk.t << ", triangle "
          << brute.triangle << " and " << walk.triangle;
      ASSERT_EQ(walk_any(tree.view, ray, GlassRule::blocks), brute.triangle != kNoTriangle)
          << "scene " << which << " ray " << i;
      hits += brute.triangle != kNoTriangle;
    }
    EXPECT_GT(hits, 600) << "scene " << which;
  }
}

// Where numbers are denormal, errors do not shrink with the scene: the slack must not either. Rays
// start close to the surface, into its middles and corners.
TEST(Trace, WalkEqualsBruteForceAmongDenormals) {
  const Vec3 axes[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (const float scale : {1.6e-40f, 5e-41f, 1e-41f, 3e-42f}) {
    Random random(1);
    std::vector<KdTriangle> ball = sphere({0, 0, 0}, 1, 8);
    for (KdTriangle& t : ball) {
      for (auto& corner : t.corner) {
        for (float& x : corner) x *= scale;
      }
    }
    const Tree tree(std::move(ball));
    int hits = 0;
    for (int i = 0; i < 4000; ++i) {
      const KdTriangle& t = tree.triangles[random.below(tree.size())];
      const Vec3 a = corner_of(t, 0), middle = (a + corner_of(t, 1) + corner_of(t, 2)) * (1.0f / 3);
      const Vec3 d = i % 2 ? axes[random.below(6)] : random.direction();
      const float away = scale * random.unit() * (i % 3 ? 0.05f : 2.0f);
      const Ray ray{(i % 4 < 2 ? middle : a) - d * away, 0, d, kInfinity};
      const Hit brute = brute_force_closest(tree.view, tree.size(), ray, GlassRule::blocks);
      ASSERT_TRUE(same_bits(brute, walk_closest(tree.view, ray))) << scale << " ray " << i;
      hits += brute.triangle != kNoTriangle;
    }
    EXPECT_GT(hits, 3000) << scale;
  }
}

class EveryIsa : public testing::TestWithParam<const Kernels*> {};

TEST_P(EveryIsa, PacketsEqualTheWalk) {
  const Kernels& kernels = *GetParam();
  for (int which = 0; which < kScenes; ++which) {
    const Tree tree(scene(which));
    Random random(11);
    int hits = 0;
    for (uint32_t packet = 0; packet < 120; ++packet) {
      RayPacket rays{};
      rays.tmin = packet % 4 == 0 ? 0.5f : 0.0f;
      for (int lane = 0; lane < kPacketSize; ++lane) {
        // Some packets hold one kind of ray, as real ones do, others a mixture.
        Ray ray = ray_for(random, tree, packet % 2 ? packet : random.bits());
        ray.tmin = rays.tmin;
        set_ray(rays, lane, ray);
      }
      rays.live = packet % 3 == 0 ? ~0ull : (static_cast<uint64_t>(random.bits()) << 32 | random.bits());
      HitPacket found;
      kernels.trace_closest(tree.view, rays, found);
      const uint64_t any = kernels.trace_any(tree.view, rays, GlassRule::blocks);
      for (int lane = 0; lane < kPacketSize; ++lane) {
        const bool live = rays.live >> lane & 1;
        const Hit expected = live ? walk_closest(tree.view, ray_of(rays, lane)) : Hit{};
        ASSERT_TRUE(same_bits(expected, hit_of(found, lane)))
            << kernels.isa << " scene " << which << " packet " << packet << " lane " << lane << ": t "
            << expected.t << " and " << found.t[lane];
        ASSERT_EQ(any >> lane & 1, expected.triangle != kNoTriangle)
            << kernels.isa << " scene " << which << " packet " << packet;
        hits += expected.triangle != kNoTriangle;
      }
    }
    EXPECT_GT(hits, 300) << "scene " << which;
  }
}

// Shadow and ambient rays pass glass; a cut-out texture removes part of a triangle. Both must be the
// same in all traversals.
bool left_half_only(const void*, uint32_t, float u, float) {
  return u < 0.5f;
}

TEST_P(EveryIsa, GlassAndCutOutsAreTheSame) {
  const Kernels& kernels = *GetParam();
  Random random(5);
  std::vector<KdTriangle> list = soup(random, 200, 0.5f);
  for (size_t i = 0; i < list.size(); ++i)
    list[i].flags = i % 3 == 0 ? kGlassTriangle : i % 3 == 1 ? kCutOutTriangle : 0u;
  const Tree tree(std::move(list), {left_half_only, nullptr});
  int blocked = 0, differs = 0;
  for (uint32_t packet = 0; packet < 60; ++packet) {
    RayPacket rays{};
    rays.live = ~0ull;
    for (int lane = 0; lane < kPacketSize; ++lane)
      set_ray(rays, lane, nasty_ray(random, tree.triangles, random.bits()));
    HitPacket found;
    kernels.trace_closest(tree.view, rays, found);
    const uint64_t any = kernels.trace_any(tree.view, rays, GlassRule::passes);
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const Ray ray = ray_of(rays, lane);
      const Hit opaque = brute_force_closest(tree.view, tree.size(), ray, GlassRule::passes);
      const Hit all = brute_force_closest(tree.view, tree.size(), ray, GlassRule::blocks);
      ASSERT_TRUE(same_bits(all, hit_of(found, lane)));
      ASSERT_EQ(any >> lane & 1, opaque.triangle != kNoTriangle);
      ASSERT_EQ(walk_any(tree.view, ray, GlassRule::passes), opaque.triangle != kNoTriangle);
      blocked += opaque.triangle != kNoTriangle;
      differs += opaque.triangle != all.triangle;
    }
  }
  EXPECT_GT(blocked, 500);
  EXPECT_GT(differs, 200);
}

TEST_P(EveryIsa, RaysThatMakeNoSenseHitNothing) {
  const Kernels& kernels = *GetParam();
  const Tree tree(sphere({0, 0, 0}, 1, 8));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Ray bad[] = {
      {{nan, 0, 0}, 0, {1, 0, 0}, kInfinity},
      {{0, 0, 0}, 0, {nan, 0, 1}, kInfinity},
      {{kInfinity, 0, 0}, 0, {1, 0, 0}, kInfinity},
      {{0, 0, 0}, 0, {0, 0, 0}, kInfinity},
      {{0, 0, 0}, 0, {1e-40f, 0, 0}, kInfinity},
      {{0, 0, 0}, 0, {kInfinity, 1, 0}, kInfinity},
      {{0, 0, 0}, 0, {1, 0, 0}, nan},
      {{0, 0, 0}, 0, {1, 0, 0}, 0},
  };
  for (const Ray& ray : bad) {
    RayPacket rays{};
    rays.live = ~0ull;
    for (int lane = 0; lane < kPacketSize; ++lane)
      set_ray(rays, lane, lane % 2 ? ray : Ray{{0, 0, 0}, 0, {0, 1, 0.1f}, kInfinity});
    HitPacket found;
    kernels.trace_closest(tree.view, rays, found);
    const uint64_t any = kernels.trace_any(tree.view, rays, GlassRule::blocks);
    for (int lane = 0; lane < kPacketSize; ++lane) {
      EXPECT_EQ(found.triangle[lane] != kNoTriangle, lane % 2 == 0);
      EXPECT_EQ(any >> lane & 1, lane % 2 == 0);
    }
    EXPECT_EQ(walk_closest(tree.view, ray).triangle, kNoTriangle);
  }
}

TEST_P(EveryIsa, EmptySceneHasNoHits) {
  const Tree tree({});
  RayPacket rays{};
  rays.live = ~0ull;
  Random random(1);
  for (int lane = 0; lane < kPacketSize; ++lane)
    set_ray(rays, lane, {random.in_box(-1, 1), 0, random.direction(), kInfinity});
  HitPacket found;
  GetParam()->trace_closest(tree.view, rays, found);
  for (const uint32_t triangle : found.triangle) EXPECT_EQ(triangle, kNoTriangle);
  EXPECT_EQ(GetParam()->trace_any(tree.view, rays, GlassRule::blocks), 0u);
}

// A million rays from inside a closed mesh: into faces, edges, corners and along the axes.
TEST_P(EveryIsa, ClosedMeshesAreWatertight) {
  struct Case {
    Vec3 center;
    float radius;
    int rings;
  };
  const Case cases[] = {{{0, 0, 0}, 1, 24},
                        {{1000, -2000, 500}, 1, 12},
                        {{1.5e5f, -1234, 2e5f}, 50, 12},
                        {{0, 0, 0}, 1e-6f, 8},
                        {{0, 0, 0}, 1e6f, 8}};
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__OPTIMIZE__)
  const uint32_t packets = 150;
#else
  const uint32_t packets = 3200;  // x 64 x 5 meshes: 1,024,000 rays
#endif
  for (const Case& c : cases) {
    const Tree tree(sphere(c.center, c.radius, c.rings));
    Random random(3);
    uint64_t misses = 0;
    for (uint32_t packet = 0; packet < packets; ++packet) {
      RayPacket rays{};
      rays.live = ~0ull;
      for (int lane = 0; lane < kPacketSize; ++lane) {
        const Vec3 origin = c.center + random.in_box(-0.5f, 0.5f) * c.radius;
        const KdTriangle& t = tree.triangles[random.below(tree.size())];
        const Vec3 a = corner_of(t, 0), b = corner_of(t, 1);
        const float s = random.unit();
        Vec3 d = random.direction();
        switch (packet % 5) {
          case 1:
            d = a - origin;
            break;
          case 2:
            d = (a * s + b * (1 - s)) - origin;
            break;
          case 3:
            d = lane % 2 ? Vec3{0, lane % 4 == 1 ? 1.0f : -1.0f, 0} : Vec3{1, 0, 0};
            break;
          case 4:
            d = normalize(a - origin);
            break;
        }
        set_ray(rays, lane, {packet % 10 == 3 ? c.center : origin, 0, d, kInfinity});
      }
      misses += static_cast<uint64_t>(
          64 - __builtin_popcountll(GetParam()->trace_any(tree.view, rays, GlassRule::blocks)));
      HitPacket found;
      if (packet % 8 == 0) {
        GetParam()->trace_closest(tree.view, rays, found);
        for (const uint32_t triangle : found.triangle) misses += triangle == kNoTriangle;
      }
    }
    EXPECT_EQ(misses, 0u) << "radius " << c.radius;
  }
}

INSTANTIATE_TEST_SUITE_P(Trace, EveryIsa, testing::ValuesIn(available_kernels()),
                         [](const auto& instance) { return std::string(instance.param->isa); });

TEST(KdTree, IsTheSameInWhateverOrderItIsBuilt) {
  Random random(9);
  const std::vector<KdTriangle> triangles = soup(random, 20000, 0.05f);
  std::vector<uint32_t> members(triangles.size());
  for (uint32_t i = 0; i < members.size(); ++i) members[i] = i;
  const KdTree forward =
      build_kdtree(triangles, members, {}, [](size_t n, const std::function<void(size_t)>& body) {
        for (size_t i = 0; i < n; ++i) body(i);
      });
  const KdTree backward =
      build_kdtree(triangles, members, {}, [](size_t n, const std::function<void(size_t)>& body) {
        for (size_t i = n; i-- > 0;) body(i);
      });
  ASSERT_GT(forward.nodes.size(), 1000u);
  ASSERT_EQ(forward.nodes.size(), backward.nodes.size());
  EXPECT_EQ(std::memcmp(forward.nodes.data(), backward.nodes.data(), forward.nodes.size() * sizeof(KdNode)),
            0);
  EXPECT_EQ(forward.references, backward.references);
}

// Depth, number of references and order of children, by walking the whole tree.
struct Shape {
  size_t leaves = 0, references = 0;
  int depth = 0;
};
void measure(const KdTree& tree, uint32_t node, int depth, Shape& shape) {
  const KdNode& n = tree.nodes.at(node);
  shape.depth = std::max(shape.depth, depth);
  if (is_leaf(n)) {
    ++shape.leaves;
    shape.references += count(n);
    ASSERT_LE(first_reference(n) + count(n), tree.references.size());
    return;
  }
  ASSERT_GT(child(n), node);
  ASSERT_EQ(child(n) % 2, 0u);
  measure(tree, child(n), depth + 1, shape);
  measure(tree, child(n) + 1, depth + 1, shape);
}

TEST(KdTree, StaysWithinItsBoundsOnHostileInput) {
  Random random(13);
  std::vector<std::vector<KdTriangle>> hostile(5);
  for (int i = 0; i < 20000; ++i) add_triangle(hostile[0], {0, 0, 0}, {1, 0, 0}, {0, 1, 0});  // all the same
  for (int i = 0; i < 3000; ++i)
    add_triangle(hostile[1], random.in_box(-1, 1), random.in_box(-1, 1),
                 random.in_box(-1, 1));  // all overlap
  for (int i = 0; i < 3000; ++i) {       // all in one plane
    const Vec3 p = random.in_box(-1, 1) * Vec3{1, 0, 1};
    add_triangle(hostile[2], p, p + Vec3{0.1f, 0, 0}, p + Vec3{0, 0, 0.1f});
  }
  for (int i = 0; i < 3000; ++i) {  // all at 1e18 and tiny beside it
    const Vec3 p = random.in_box(-1e18f, 1e18f);
    add_triangle(hostile[3], p, p + Vec3{1e12f, 0, 0}, p + Vec3{0, 1e12f, 0});
  }
  for (int i = 0; i < 3000; ++i) {  // denormal small
    const Vec3 p = random.in_box(-1e-39f, 1e-39f);
    add_triangle(hostile[4], p, p + Vec3{1e-39f, 0, 0}, p + Vec3{0, 1e-39f, 0});
  }
  for (const std::vector<KdTriangle>& list : hostile) {
    const Tree tree(list);
    Shape shape;
    measure(tree.tree, 0, 0, shape);
    EXPECT_LT(shape.depth, kMaxTreeDepth);
    EXPECT_EQ(shape.references, tree.tree.references.size());
    EXPECT_GE(shape.references, list.size());
    EXPECT_LE(shape.references, 4 * list.size());
  }
}

TEST(KdTree, CutsSpaceWhereItPays) {
  const Tree tree(sphere({0, 0, 0}, 1, 60));
  Shape shape;
  measure(tree.tree, 0, 0, shape);
  const double per_leaf = static_cast<double>(shape.references) / static_cast<double>(shape.leaves);
  EXPECT_LT(per_leaf, 8);
  EXPECT_LT(shape.references, 3 * tree.triangles.size());
}

}  // namespace
}  // namespace vitral::test
