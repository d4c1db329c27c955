// The ambient pass takes shortcuts: no rays where nothing is near, no tree where little is. None may
// be seen: every point's count of free rays is that of its rays tested one by one against everything.
#include "kernels/kernels.h"
#include "kernels/ray_offset.h"
#include "math/random.h"
#include "math/sampling.h"
#include "render/kernel_choice.h"
#include "support.h"

#include <gtest/gtest.h>

#include <string>

namespace vitral::test {
namespace {

bool right_half_only(const void*, uint32_t, float u, float v) {
  return u > v;
}

// A floor of small squares, steps and walls on it, some of glass, some with holes, and loose bits.
std::vector<KdTriangle> town(Random& random, const Vec3& at, float scale) {
  std::vector<KdTriangle> out;
  const auto quad = [&](const Vec3& a, const Vec3& u, const Vec3& v, uint32_t flags) {
    const Vec3 p = at + a * scale, q = p + u * scale, r = p + v * scale;
    add_triangle(out, p, q, q + v * scale, flags);
    add_triangle(out, p, q + v * scale, r, flags);
  };
  for (int i = 0; i < 10; ++i) {
    for (int j = 0; j < 10; ++j)
      quad({static_cast<float>(i), 0, static_cast<float>(j)}, {0, 0, 1}, {1, 0, 0}, 0);
  }
  for (int i = 0; i < 12; ++i) {
    const float x = static_cast<float>(random.below(10)), z = static_cast<float>(random.below(10));
    const uint32_t flags = i % 3 == 0 ? kGlassTriangle : i % 3 == 1 ? kCutOutTriangle : 0u;
    quad({x, 0, z}, {0, 1, 0}, i % 2 ? Vec3{1, 0, 0} : Vec3{0, 0, 1}, flags);
  }
  for (int i = 0; i < 40; ++i) {
    const Vec3 p = at + (random.in_box(0, 10) * Vec3{1, 0.1f, 1}) * scale;
    add_triangle(out, p, p + random.in_box(-0.3f, 0.3f) * scale, p + random.in_box(-0.3f, 0.3f) * scale);
  }
  return out;
}

// 64 points of one triangle or of several, each on its surface.
PointPacket points_on(Random& random, const std::vector<KdTriangle>& triangles, uint32_t spread) {
  PointPacket p;
  p.live = spread == 0 ? ~0ull : (static_cast<uint64_t>(random.bits()) << 32 | random.bits());
  const uint32_t first = random.below(static_cast<uint32_t>(triangles.size()));
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const KdTriangle& t = triangles[(first + random.below(spread + 1)) % triangles.size()];
    const Vec3 a = corner_of(t, 0), b = corner_of(t, 1), c = corner_of(t, 2);
    float u = random.unit(), v = random.unit();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Vec3 x = (a + (b - a) * u) + (c - a) * v;
    Vec3 g = to_float(normalize(cross(to_double(b) - to_double(a), to_double(c) - to_double(a))));
    if (random.below(2)) g = -g;
    Vec3 n = normalize(g + random.in_box(-0.3f, 0.3f));
    if (spread == 0) n = g;
    p.px[lane] = x.x, p.py[lane] = x.y, p.pz[lane] = x.z;
    p.gx[lane] = g.x, p.gy[lane] = g.y, p.gz[lane] = g.z;
    p.nx[lane] = n.x, p.ny[lane] = n.y, p.nz[lane] = n.z;
    p.offset[lane] = ray_offset(a, b, c, g);
    p.key[lane] = random.bits();
  }
  return p;
}

uint32_t free_rays_one_by_one(const Tree& tree, const PointPacket& p, const AmbientSettings& settings,
                              int lane) {
  const Vec3 position{p.px[lane], p.py[lane], p.pz[lane]}, g{p.gx[lane], p.gy[lane], p.gz[lane]};
  const Vec3 n{p.nx[lane], p.ny[lane], p.nz[lane]};
  const float side = 1.0f / static_cast<float>(settings.strata);
  uint32_t free = 0;
  for (int s = 0; s < settings.strata * settings.strata; ++s) {
    const uint32_t h = sample_hash(p.key[lane], static_cast<uint32_t>(s));
    const float u1 =
        (static_cast<float>(s % settings.strata) + static_cast<float>(h & 0xffff) * (1.0f / 65536)) * side;
    const float u2 =
        (static_cast<float>(s / settings.strata) + static_cast<float>(h >> 16) * (1.0f / 65536)) * side;
    Vec3 d = cosine_hemisphere(n, u1, u2);
    const float below = least(dot(d, g), 0.0f);
    d = d - g * (below + below);
    const Ray ray{position + g * p.offset[lane], 0, d, settings.distance};
    free += brute_force_closest(tree.view, tree.size(), ray, GlassRule::passes).triangle == kNoTriangle;
  }
  return free;
}

class AmbientOfEveryIsa : public testing::TestWithParam<const Kernels*> {};

TEST_P(AmbientOfEveryIsa, EqualsItsRaysOneByOne) {
  struct Place {
    Vec3 at;
    float scale;
  };
  uint64_t open = 0, occluded = 0, closed_in = 0;
  for (const Place& place :
       {Place{{0, 0, 0}, 1}, Place{{-3e3f, 50, 1e4f}, 1}, Place{{0, 0, 0}, 1e-5f}, Place{{0, 0, 0}, 1e4f}}) {
    Random random(21);
    const Tree tree(town(random, place.at, place.scale), {right_half_only, nullptr});
    for (uint32_t packet = 0; packet < 48; ++packet) {
      const PointPacket points = points_on(random, tree.triangles, packet % 3 * 7);
      const float reach[] = {0.05f, 0.3f, 1, 20};
      const AmbientSettings settings{3, reach[packet % 4] * place.scale};
      alignas(64) uint32_t free[kPacketSize];
      GetParam()->ambient_occlusion(tree.view, points, settings, free);
      for (int lane = 0; lane < kPacketSize; ++lane) {
        if (!(points.live >> lane & 1)) continue;
        const uint32_t expected = free_rays_one_by_one(tree, points, settings, lane);
        ASSERT_EQ(free[lane], expected)
            << GetParam()->isa << " packet " << packet << " lane " << lane << " scale " << place.scale;
        ++(expected == 9 ? open : expected == 0 ? closed_in : occluded);
      }
    }
  }
  EXPECT_GT(open, 1000u);
  EXPECT_GT(occluded, 1000u);
}

INSTANTIATE_TEST_SUITE_P(Trace, AmbientOfEveryIsa, testing::ValuesIn(available_kernels()),
                         [](const auto& instance) { return std::string(instance.param->isa); });

}  // namespace
}  // namespace vitral::test
