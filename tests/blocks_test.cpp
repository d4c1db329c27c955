// Shadows and ambient occlusion of the blocks of a tile are found together, and most rays are decided
// without being traced. None of that may be seen: ray for ray the answers are those of the walk through
// the tree, and of testing every triangle.
#include "kernels/kernels.h"
#include "kernels/ray_offset.h"
#include "render/kernel_choice.h"
#include "support.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace vitral::test {
namespace {

bool left_half_only(const void*, uint32_t, float u, float v) {
  return u < v;
}

// A bumpy floor of shared corners under a roof with a hole, walls, posts, slivers, glass and cut-outs: some
// triangles cover whole tiles, others are smaller than a block.
std::vector<KdTriangle> courtyard(Random& random, const Vec3& at, float scale) {
  std::vector<KdTriangle> out;
  constexpr int kSide = 16;
  std::vector<Vec3> floor;
  for (int i = 0; i <= kSide; ++i) {
    for (int j = 0; j <= kSide; ++j)
      floor.push_back(at + Vec3{static_cast<float>(i) * 0.5f, random.between(0, i < 8 ? 0.15f : 0.0f),
                                static_cast<float>(j) * 0.5f} *
                               scale);
  }
  for (size_t i = 0; i < kSide; ++i) {
    for (size_t j = 0; j < kSide; ++j) {
      const Vec3 &a = floor[i * (kSide + 1) + j], &b = floor[i * (kSide + 1) + j + 1],
                 &c = floor[(i + 1) * (kSide + 1) + j], &d = floor[(i + 1) * (kSide + 1) + j + 1];
      add_triangle(out, a, b, d), add_triangle(out, a, d, c);
    }
  }
  const auto quad = [&](const Vec3& a, const Vec3& u, const Vec3& v, uint32_t flags = 0) {
    const Vec3 p = at + a * scale;
    add_triangle(out, p, p + u * scale, p + (u + v) * scale, flags);
    add_triangle(out, p, p + (u + v) * scale, p + v * scale, flags);
  };
  quad({0, 4, 0}, {4, 0, 0}, {0, 0, 8});
  quad({4, 4, 0}, {4, 0, 0}, {0, 0, 3});
  quad({0, 0, 0}, {0, 4, 0}, {0, 0, 8});
  quad({8, 0, 0}, {0, 4, 0}, {0, 0, 8}, kGlassTriangle);
  for (int i = 0; i < 24; ++i) {
    const Vec3 foot{random.between(0, 8), 0, random.between(0, 8)};
    const uint32_t flags = i % 4 == 0 ? kCutOutTriangle : i % 4 == 1 ? kGlassTriangle : 0u;
    quad(foot, {0, random.between(0.1f, 2), 0}, {random.between(-0.4f, 0.4f), 0, random.between(-0.4f, 0.4f)},
         flags);
    quad(foot + Vec3{0, 1, 0}, {random.between(-3, 3), 0, 1e-4f}, {0, 1e-4f, 1e-3f});
  }
  return out;
}

PointPacket point_on(Random& random, const std::vector<KdTriangle>& triangles,
                     const std::vector<uint32_t>& chosen, float bend) {
  PointPacket p;
  p.live = random.below(4) ? ~0ull : (static_cast<uint64_t>(random.bits()) << 32 | random.bits());
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const KdTriangle& t = triangles[chosen[random.below(static_cast<uint32_t>(chosen.size()))]];
    const Vec3 a = corner_of(t, 0), b = corner_of(t, 1), c = corner_of(t, 2);
    float u = random.unit(), v = random.unit();
    if (random.below(8) == 0) u = 0;
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Vec3 x = (a + (b - a) * u) + (c - a) * v;
    Vec3 g = to_float(normalize(cross(to_double(b) - to_double(a), to_double(c) - to_double(a))));
    if (random.below(16) == 0) g = -g;
    const Vec3 n = bend > 0 ? normalize(g + random.in_box(-bend, bend)) : g;
    p.px[lane] = x.x, p.py[lane] = x.y, p.pz[lane] = x.z;
    p.gx[lane] = g.x, p.gy[lane] = g.y, p.gz[lane] = g.z;
    p.nx[lane] = n.x, p.ny[lane] = n.y, p.nz[lane] = n.z;
    p.offset[lane] = ray_offset(a, b, c, g);
    if (random.below(8) == 0) p.offset[lane] = 0;
    p.key[lane] = random.bits();
  }
  return p;
}

// Points from which the light is seen exactly past an edge of some triangle, or through a corner, as far as
// that can be said in float.
PointPacket point_behind_edges(Random& random, const std::vector<KdTriangle>& triangles, const Vec3& to_light,
                               float scale) {
  PointPacket p;
  p.live = ~0ull;
  const uint32_t first = random.below(static_cast<uint32_t>(triangles.size()));
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const KdTriangle& t = triangles[(first + random.below(3)) % triangles.size()];
    const size_t k = random.below(3);
    const Vec3 a = corner_of(t, k), b = corner_of(t, (k + 1) % 3);
    const Vec3 edge = a + (b - a) * (random.below(3) ? random.unit() : 0.0f);
    const Vec3 x = edge - to_light * (random.between(0.01f, 1) * scale);
    p.px[lane] = x.x, p.py[lane] = x.y, p.pz[lane] = x.z;
    p.gx[lane] = p.nx[lane] = to_light.x, p.gy[lane] = p.ny[lane] = to_light.y;
    p.gz[lane] = p.nz[lane] = to_light.z;
    p.offset[lane] = 0;
  }
  return p;
}

// Sixteen packets of points around a triangle, on those whose first corner lies within `reach` of its own.
std::vector<PointPacket> neighbours(Random& random, const std::vector<KdTriangle>& triangles, float reach,
                                    float bend) {
  const uint32_t middle = random.below(static_cast<uint32_t>(triangles.size()));
  std::vector<uint32_t> chosen;
  for (uint32_t i = 0; i < triangles.size(); ++i) {
    if (largest_component(corner_of(triangles[i], 0) - corner_of(triangles[middle], 0)) <= reach)
      chosen.push_back(i);
  }
  std::vector<PointPacket> out;
  for (int i = 0; i < 16; ++i) out.push_back(point_on(random, triangles, chosen, bend));
  return out;
}

std::vector<const PointPacket*> pointers(const std::vector<PointPacket>& packets, size_t count) {
  std::vector<const PointPacket*> out;
  for (size_t i = 0; i < count; ++i) out.push_back(&packets[i]);
  return out;
}

struct Place {
  Vec3 at;
  float scale;
};
constexpr Place kPlaces[] = {
    {{0, 0, 0}, 1}, {{-3e3f, 50, 1e4f}, 1}, {{0, 0, 0}, 1e-5f}, {{0, 0, 0}, 1e5f}, {{0, 0, 0}, 1e-30f}};

class BlocksOfEveryIsa : public testing::TestWithParam<const Kernels*> {};

TEST_P(BlocksOfEveryIsa, ShadowsEqualTheWalkRayForRay) {
  const Kernels& kernels = *GetParam();
  uint64_t lit = 0, blocked = 0, dark_blocks = 0, lit_blocks = 0;
  for (const Place& place : kPlaces) {
    Random random(5);
    const Tree tree(courtyard(random, place.at, place.scale), {left_half_only, nullptr});
    for (int group = 0; group < 60; ++group) {
      const float reaches[] = {0, 0.4f, 1, 20};
      std::vector<PointPacket> packets =
          neighbours(random, tree.triangles, reaches[group % 4] * place.scale, group % 3 ? 0.0f : 0.3f);
      const Vec3 directions[] = {
          random.direction(), {0, -1, 0}, {1e-7f, -1, 0}, {0.5f, -0.5f, 0}, {-1, -1e-3f, 0.2f}};
      Light light = sun(group % 5 ? Vec3{0.3f, -1, 0.2f} : directions[group / 5 % 5]);
      if (group % 7 == 0) light = sun(directions[group / 7 % 5]);
      if (group % 2) {
        for (PointPacket& p : packets)
          p = point_behind_edges(random, tree.triangles, -light.direction, place.scale);
      }
      const GlassRule glass = group % 4 < 2 ? GlassRule::passes : GlassRule::blocks;
      const size_t count = group % 6 == 5 ? 1 + random.below(16) : 16;
      const auto points = pointers(packets, count);
      ShadowAnswer answers[16];
      kernels.trace_shadows(tree.view, light, glass, points.data(), static_cast<int>(count), answers);
      for (size_t i = 0; i < count; ++i) {
        RayPacket rays;
        kernels.shadow_rays(light, packets[i], rays);
        ASSERT_EQ(answers[i].facing, rays.live);
        const uint64_t expected = kernels.trace_any(tree.view, rays, glass);
        ASSERT_EQ(answers[i].blocked, expected)
            << kernels.isa << " group " << group << " packet " << i << " scale " << place.scale;
        const int lane = static_cast<int>(random.below(kPacketSize));
        if (rays.live >> lane & 1) {
          const bool met =
              brute_force_closest(tree.view, tree.size(), ray_of(rays, lane), glass).triangle != kNoTriangle;
          ASSERT_EQ((answers[i].blocked >> lane & 1) != 0, met);
        }
        lit += static_cast<uint64_t>(__builtin_popcountll(rays.live & ~expected));
        blocked += static_cast<uint64_t>(__builtin_popcountll(expected));
        if (rays.live != 0) ++(expected == rays.live ? dark_blocks : lit_blocks);
      }
    }
  }
  EXPECT_GT(lit, 20000u);
  EXPECT_GT(blocked, 20000u);
  EXPECT_GT(dark_blocks, 100u);
  EXPECT_GT(lit_blocks, 100u);
}

void expect_equal_rays(const std::vector<PointPacket>& packets, const std::vector<FreeRays>& found,
                       const std::vector<FreeRays>& expected) {
  for (size_t i = 0; i < found.size(); ++i) {
    for (int lane = 0; lane < kPacketSize; ++lane) {
      if (!(packets[i].live >> lane & 1)) continue;
      ASSERT_EQ(found[i].count[lane], expected[i].count[lane]) << "packet " << i << " lane " << lane;
    }
  }
}

// Adds the points of which all rays are free, and the others.
void count_points(const std::vector<PointPacket>& packets, const std::vector<FreeRays>& rays, int strata,
                  uint64_t& open, uint64_t& occluded) {
  for (size_t i = 0; i < rays.size(); ++i) {
    for (int lane = 0; lane < kPacketSize; ++lane) {
      if (packets[i].live >> lane & 1)
        ++(rays[i].count[lane] == static_cast<uint32_t>(strata * strata) ? open : occluded);
    }
  }
}

TEST_P(BlocksOfEveryIsa, AmbientShortcutsCannotBeSeen) {
  const Kernels& kernels = *GetParam();
  uint64_t open = 0, occluded = 0;
  for (const Place& place : kPlaces) {
    Random random(9);
    const Tree tree(courtyard(random, place.at, place.scale), {left_half_only, nullptr});
    for (int group = 0; group < 12; ++group) {
      const float reaches[] = {0, 0.4f, 1, 20}, distances[] = {0.05f, 0.3f, 1, 20};
      const std::vector<PointPacket> packets =
          neighbours(random, tree.triangles, reaches[group % 4] * place.scale, group % 2 ? 0.3f : 0.0f);
      AmbientSettings settings{1 + group % 5, distances[(group + group / 4) % 4] * place.scale};
      constexpr size_t kPackets = 6;
      const auto points = pointers(packets, kPackets);
      std::vector<FreeRays> taken(kPackets), none(kPackets);
      kernels.ambient_blocks(tree.view, points.data(), kPackets, settings, taken.data());
      settings.shortcuts = Shortcuts::none;
      kernels.ambient_blocks(tree.view, points.data(), kPackets, settings, none.data());
      SCOPED_TRACE(std::string(kernels.isa) + " group " + std::to_string(group) + " scale " +
                   std::to_string(place.scale));
      expect_equal_rays(packets, taken, none);
      count_points(packets, none, settings.strata, open, occluded);
      if (HasFailure()) return;
    }
  }
  EXPECT_GT(open, 3000u);
  EXPECT_GT(occluded, 3000u);
}

// A valley between two slopes of small bumps: from every point far more triangles are in reach than a list
// can hold, and the opposite slope blocks many rays.
std::vector<KdTriangle> valley(Random& random, const Vec3& at, float scale) {
  constexpr size_t kSide = 80;
  std::vector<Vec3> corners;
  for (size_t i = 0; i <= kSide; ++i) {
    for (size_t j = 0; j <= kSide; ++j) {
      const float x = static_cast<float>(i) * 0.1f, z = static_cast<float>(j) * 0.1f;
      const float height = absolute(x - 4) * 1.5f + random.between(0, 0.05f);
      corners.push_back(at + Vec3{x, height, z} * scale);
    }
  }
  std::vector<KdTriangle> out;
  for (size_t i = 0; i < kSide; ++i) {
    for (size_t j = 0; j < kSide; ++j) {
      const size_t k = i * (kSide + 1) + j;
      const uint32_t flags = (i * 7 + j) % 11 == 0 ? kGlassTriangle
                             : (i + j) % 13 == 0   ? kCutOutTriangle
                                                   : 0u;
      add_triangle(out, corners[k], corners[k + 1], corners[k + kSide + 2], flags);
      add_triangle(out, corners[k], corners[k + kSide + 2], corners[k + kSide + 1], flags);
    }
  }
  return out;
}

TEST_P(BlocksOfEveryIsa, AmbientRaysOfADenseMeshEqualTheWalk) {
  const Kernels& kernels = *GetParam();
  uint64_t open = 0, occluded = 0, walked = 0;
  for (const Place& place : {kPlaces[0], kPlaces[1], kPlaces[2]}) {
    Random random(13);
    const Tree tree(valley(random, place.at, place.scale), {left_half_only, nullptr});
    for (int group = 0; group < 6; ++group) {
      const std::vector<PointPacket> packets =
          neighbours(random, tree.triangles, 0.2f * place.scale, group % 2 ? 0.3f : 0.0f);
      const size_t count = group % 3 == 2 ? 3 : 16;
      const auto points = pointers(packets, count);
      AmbientSettings settings{group == 5 ? 6 : 1 + group % 4, (group % 2 ? 9.0f : 2.0f) * place.scale};
      std::vector<FreeRays> taken(count), none(count), counted(count);
      TraversalCounts totals;
      kernels.ambient_blocks(tree.view, points.data(), static_cast<int>(count), settings, taken.data());
      kernels.count_ambient(tree.view, points.data(), static_cast<int>(count), settings, counted.data(),
                            {&totals, nullptr});
      walked += totals.lanes_in_steps;
      settings.shortcuts = Shortcuts::none;
      kernels.ambient_blocks(tree.view, points.data(), static_cast<int>(count), settings, none.data());
      SCOPED_TRACE(std::string(kernels.isa) + " group " + std::to_string(group) + " scale " +
                   std::to_string(place.scale));
      expect_equal_rays(packets, taken, none);
      expect_equal_rays(packets, counted, none);
      count_points(packets, none, settings.strata, open, occluded);
      if (HasFailure()) return;
    }
  }
  EXPECT_GT(open, 500u);
  EXPECT_GT(occluded, 3000u);
  EXPECT_GT(walked, 0u);
}

INSTANTIATE_TEST_SUITE_P(Trace, BlocksOfEveryIsa, testing::ValuesIn(available_kernels()),
                         [](const auto& instance) { return std::string(instance.param->isa); });

}  // namespace
}  // namespace vitral::test
