// The closest hits of rays that start in one point are found tile by tile, with one walk through the tree for
// all of them and with few exact tests. None of that may be seen: ray for ray the hits are those of the walk
// of each packet, and of testing every triangle.
#include "kernels/kernels.h"
#include "math/pinhole.h"
#include "render/kernel_choice.h"
#include "support.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace vitral::test {
namespace {

constexpr size_t kPackets = 16;

bool left_half_only(const void*, uint32_t, float u, float v) {
  return u < v;
}

struct Place {
  Vec3 at;
  float scale;
};
constexpr Place kPlaces[] = {{{0, 0, 0}, 1},    {{-3e3f, 50, 1e4f}, 1}, {{0, 0, 0}, 1e-5f},
                             {{0, 0, 0}, 1e5f}, {{0, 0, 0}, 1e-18f},    {{0, 0, 0}, 1e-30f}};

// Within [-1, 1]^3: a ball, walls of large triangles, some of them twice and in the same plane, soup from
// smaller than a pixel to larger than a tile, slivers, cut-outs, glass.
std::vector<KdTriangle> gallery(Random& random, const Place& place) {
  std::vector<KdTriangle> list = sphere({0.3f, 0, 0}, 0.4f, 16);
  const auto quad = [&](const Vec3& a, const Vec3& u, const Vec3& v, uint32_t flags = 0) {
    add_triangle(list, a, a + u, a + u + v, flags), add_triangle(list, a, a + u + v, a + v, flags);
  };
  for (int twice = 0; twice < 2; ++twice) quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0});
  quad({-1, -1, -1}, {0, 0, 2}, {2, 0, 0});
  quad({-0.5f, -1, -0.5f}, {0, 0, 1}, {1, 0, 0});
  quad({-1, -0.2f, 0.5f}, {2, 0.1f, 0}, {0, 0.3f, 0}, kCutOutTriangle);
  quad({-1, 0.2f, 0.7f}, {2, 0.1f, 0}, {0, 0.3f, 0}, kGlassTriangle);
  for (const float size : {0.01f, 0.1f, 0.6f}) {
    for (const KdTriangle& t : soup(random, 120, size)) list.push_back(t);
  }
  for (int i = 0; i < 24; ++i) {
    const Vec3 p = random.in_box(-1, 1);
    add_triangle(list, p, p + Vec3{random.between(-1, 1), 1e-6f, 0.3f}, p + Vec3{0, 1e-5f, 1e-6f},
                 i % 4 ? 0u : kCutOutTriangle);
  }
  for (size_t i = 0; i < 40; ++i) {
    const KdTriangle copy = list[random.below(static_cast<uint32_t>(list.size()))];
    add_triangle(list, corner_of(copy, 1), corner_of(copy, 2), corner_of(copy, 0), copy.flags);
  }
  for (KdTriangle& t : list) {
    for (float(&c)[3] : t.corner) {
      const Vec3 p = place.at + Vec3{c[0], c[1], c[2]} * place.scale;
      c[0] = p.x, c[1] = p.y, c[2] = p.z;
    }
  }
  return list;
}

enum class Aim { camera, edges, anywhere };

// Sixteen packets from one point: through pixels of a camera, at edges and corners, and at the corners'
// neighbours in float, or in all directions.
std::vector<RayPacket> tile(Random& random, const Kernels& kernels, const std::vector<KdTriangle>& triangles,
                            const Place& place, Aim aim) {
  Vec3 origin = place.at + random.in_box(-1.5f, 1.5f) * place.scale;
  const KdTriangle& own = triangles[random.below(static_cast<uint32_t>(triangles.size()))];
  if (random.below(4) == 0) origin = corner_of(own, 0);
  if (random.below(6) == 0) origin = origin + Vec3{3, 2, 4} * place.scale;
  const Vec3 middle = place.at + random.in_box(-0.5f, 0.5f) * place.scale;
  const Vec3 view = random.below(3) ? normalize((middle - origin) * (1 / place.scale)) : Vec3{0, 0, -1};
  const float fovs[] = {1, 40, 100, 170};
  Camera camera = camera_at(origin, view, fovs[random.below(4)], normalize(random.direction() + view * 0.1f));
  camera.near = random.below(3) ? 1e-3f * place.scale : 0.8f * place.scale;
  camera.far = random.below(3) ? 100 * place.scale : 1.5f * place.scale;
  const Pinhole pinhole = make_pinhole(camera, 256, 256);
  const int x = static_cast<int>(random.below(8)) * 32, y = static_cast<int>(random.below(8)) * 32;
  const int across[] = {0, 1, 0, 1, 2, 3, 2, 3, 0, 1, 0, 1, 2, 3, 2, 3},
            down[] = {0, 0, 1, 1, 0, 0, 1, 1, 2, 2, 3, 3, 2, 2, 3, 3};
  const uint32_t first = random.below(static_cast<uint32_t>(triangles.size()));
  std::vector<RayPacket> out(kPackets);
  for (size_t i = 0; i < kPackets; ++i) {
    RayPacket& p = out[i];
    kernels.primary_rays(pinhole, x + across[i] * 8, y + down[i] * 8, p);
    p.live = random.below(3) ? ~0ull : (static_cast<uint64_t>(random.bits()) << 32 | random.bits());
    if (random.below(10) == 0) p.live = 0;
    for (int lane = 0; lane < kPacketSize && aim != Aim::camera; ++lane) {
      Vec3 d = random.direction();
      if (aim == Aim::edges) {
        const KdTriangle& t = triangles[(first + random.below(8)) % triangles.size()];
        const size_t k = random.below(3);
        const Vec3 a = corner_of(t, k), b = corner_of(t, (k + 1) % 3);
        d = ((a + (b - a) * (random.below(3) ? random.unit() : 0.0f)) - origin) * (1 / place.scale);
        if (random.below(2)) d = normalize(d);
      }
      p.dx[lane] = d.x, p.dy[lane] = d.y, p.dz[lane] = d.z;
    }
  }
  return out;
}

class BeamOfEveryIsa : public testing::TestWithParam<const Kernels*> {};

TEST_P(BeamOfEveryIsa, EqualsTheWalkRayForRay) {
  const Kernels& kernels = *GetParam();
  uint64_t met = 0, missed = 0, brute = 0;
  for (const Place& place : kPlaces) {
    Random random(17);
    const Tree tree(gallery(random, place), {left_half_only, nullptr});
    for (int group = 0; group < 30; ++group) {
      const std::vector<RayPacket> rays = tile(random, kernels, tree.triangles, place,
                                               group % 4 < 2    ? Aim::camera
                                               : group % 4 == 2 ? Aim::edges
                                                                : Aim::anywhere);
      const size_t count = group % 6 == 5 ? 1 + random.below(16) : kPackets;
      std::vector<HitPacket> taken(kPackets), none(kPackets), counted(kPackets);
      std::vector<LaneWork> work(kPackets, LaneWork{});
      TraversalCounts totals{};
      const int n = static_cast<int>(count);
      kernels.closest_blocks(tree.view, rays.data(), n, Shortcuts::taken, taken.data());
      kernels.closest_blocks(tree.view, rays.data(), n, Shortcuts::none, none.data());
      kernels.count_closest_blocks(tree.view, rays.data(), n, Shortcuts::taken, counted.data(),
                                   {&totals, work.data()});
      double sum = 0;
      uint64_t live = 0;
      for (size_t i = 0; i < count; ++i) {
        live += static_cast<uint64_t>(__builtin_popcountll(rays[i].live));
        for (int lane = 0; lane < kPacketSize; ++lane) {
          sum += static_cast<double>(work[i].work[lane]);
          const Hit expected = hit_of(none[i], lane);
          ASSERT_TRUE(same_bits(hit_of(taken[i], lane), expected))
              << kernels.isa << " scale " << place.scale << " group " << group << " packet " << i << " lane "
              << lane << ": triangle " << taken[i].triangle[lane] << " for " << expected.triangle << ", t "
              << taken[i].t[lane] << " for " << expected.t;
          ASSERT_TRUE(same_bits(hit_of(counted[i], lane), expected));
          if (rays[i].live >> lane & 1) ++(expected.triangle == kNoTriangle ? missed : met);
        }
        const int lane = static_cast<int>(random.below(kPacketSize));
        if (!(rays[i].live >> lane & 1)) continue;
        const Hit all = brute_force_closest(tree.view, tree.size(), ray_of(rays[i], lane), GlassRule::blocks);
        ASSERT_TRUE(same_bits(hit_of(taken[i], lane), all)) << kernels.isa << " scale " << place.scale;
        ++brute;
      }
      ASSERT_NEAR(sum, static_cast<double>(work_of(totals)), 1e-4 * sum);
      ASSERT_LE(totals.rays_traced, live);
    }
  }
  EXPECT_GT(met, 30000u);
  EXPECT_GT(missed, 15000u);
  EXPECT_GT(brute, 1000u);
}

// Rays that do not start in one point, or not at the same tmin, are traced packet by packet.
TEST_P(BeamOfEveryIsa, TakesAnyRays) {
  const Kernels& kernels = *GetParam();
  Random random(23);
  const Tree tree(gallery(random, kPlaces[0]), {left_half_only, nullptr});
  for (int group = 0; group < 24; ++group) {
    std::vector<RayPacket> rays = tile(random, kernels, tree.triangles, kPlaces[0], Aim::camera);
    switch (group % 6) {
      case 0:
        rays[7].ox[5] += 0.25f;
        break;
      case 1:
        rays[3].tmin = 0.3f;
        break;
      case 2:
        rays[9].dx[0] = kInfinity;
        break;
      case 3:
        for (RayPacket& p : rays) p.live = 0;
        break;
      case 4:
        for (RayPacket& p : rays) p.tmin = -1;
        break;
      case 5:
        for (RayPacket& p : rays) p.tmax[group] = group % 12 == 5 ? kInfinity : 0.5f;
        break;
    }
    std::vector<HitPacket> taken(kPackets), none(kPackets);
    kernels.closest_blocks(tree.view, rays.data(), kPackets, Shortcuts::taken, taken.data());
    kernels.closest_blocks(tree.view, rays.data(), kPackets, Shortcuts::none, none.data());
    for (size_t i = 0; i < kPackets; ++i) {
      for (int lane = 0; lane < kPacketSize; ++lane)
        ASSERT_TRUE(same_bits(hit_of(taken[i], lane), hit_of(none[i], lane)))
            << kernels.isa << " group " << group;
    }
  }
}

// A tile before a wall comes to two triangles, however many rays it has.
TEST_P(BeamOfEveryIsa, DoesForATileWhatItNeedDoOnce) {
  std::vector<KdTriangle> wall;
  add_triangle(wall, {-8, -8, -4}, {8, -8, -4}, {8, 8, -4});
  add_triangle(wall, {-8, -8, -4}, {8, 8, -4}, {-8, 8, -4});
  const Tree tree(std::move(wall));
  const Pinhole camera = make_pinhole(camera_at({0, 0, 0}, {0, 0, -1}), 256, 256);
  std::vector<RayPacket> rays(4);
  for (size_t i = 0; i < 4; ++i) {
    GetParam()->primary_rays(camera, 96 + static_cast<int>(i % 2) * 8, 32 + static_cast<int>(i / 2) * 8,
                             rays[i]);
    rays[i].live = ~0ull;
  }
  std::vector<HitPacket> hits(4);
  TraversalCounts totals{};
  GetParam()->count_closest_blocks(tree.view, rays.data(), 4, Shortcuts::taken, hits.data(),
                                   {&totals, nullptr});
  EXPECT_EQ(totals.rays_traced, 256u);
  EXPECT_EQ(totals.steps, 0u);
  EXPECT_EQ(totals.other_nodes, 1u);
  EXPECT_EQ(totals.leaves, 1u);
  EXPECT_LE(totals.triangle_tests, 2u + 256u * 2);
  for (const HitPacket& p : hits) EXPECT_EQ(p.triangle[0], 1u);
}

INSTANTIATE_TEST_SUITE_P(Trace, BeamOfEveryIsa, testing::ValuesIn(available_kernels()),
                         [](const auto& instance) { return std::string(instance.param->isa); });

}  // namespace
}  // namespace vitral::test
