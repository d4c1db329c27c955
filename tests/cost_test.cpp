// What is counted of the tracer's work: exact where it can be said beforehand, the same in the sums and
// in the picture, and without a trace in any pixel.
#include "json_text.h"
#include "kernels/kernels.h"
#include "process.h"
#include "render/kernel_choice.h"
#include "scratch.h"
#include "support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace vitral::test {
namespace {

// 64 rays down onto the plane y = 0, in a square grid over [-1, 1]^2.
RayPacket rays_down() {
  RayPacket rays{};
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const float x = (static_cast<float>(lane % 8) - 3.5f) / 4, z = (static_cast<float>(lane / 8) - 3.5f) / 4;
    set_ray(rays, lane, {{x, 1, z}, 0, {0, -1, 0}, kInfinity});
  }
  rays.live = ~0ull;
  return rays;
}

// Points of the same grid, on a floor.
PointPacket points_below() {
  PointPacket p{};
  for (int lane = 0; lane < kPacketSize; ++lane) {
    p.px[lane] = (static_cast<float>(lane % 8) - 3.5f) / 4,
    p.pz[lane] = (static_cast<float>(lane / 8) - 3.5f) / 4;
    p.gy[lane] = p.ny[lane] = p.vy[lane] = 1;
    p.offset[lane] = 1e-3f;
    p.key[lane] = static_cast<uint32_t>(lane);
  }
  p.live = ~0ull;
  return p;
}

double sum_of(const LaneWork& work) {
  double sum = 0;
  for (const float w : work.work) sum += static_cast<double>(w);
  return sum;
}

std::vector<KdTriangle> one_triangle(float side, float y, uint32_t flags = 0) {
  std::vector<KdTriangle> out;
  add_triangle(out, {-side, y, -side}, {-side, y, 3 * side}, {3 * side, y, -side}, flags);
  return out;
}

class CostOfEveryIsa : public testing::TestWithParam<const Kernels*> {};

TEST_P(CostOfEveryIsa, OneTriangleIsOneNodeAndOneTest) {
  const Tree tree(one_triangle(2, 0));
  ASSERT_TRUE(is_leaf(tree.tree.nodes[0]));
  RayPacket rays = rays_down();
  rays.live = 0xffffull;
  TraversalCounts totals{};
  LaneWork work{};
  HitPacket hits, expected;
  GetParam()->count_closest(tree.view, rays, hits, {&totals, &work});
  GetParam()->trace_closest(tree.view, rays, expected);
  for (int lane = 0; lane < kPacketSize; ++lane) {
    ASSERT_TRUE(same_bits(hit_of(hits, lane), hit_of(expected, lane)));
    EXPECT_EQ(work.work[lane], lane < 16 ? 2.0f : 0.0f) << "its leaf and its triangle";
    EXPECT_EQ(hits.triangle[lane], lane < 16 ? 0u : kNoTriangle);
  }
  EXPECT_EQ(totals.steps, 1u);
  EXPECT_EQ(totals.lanes_in_steps, 16u);
  EXPECT_EQ(totals.other_nodes, 0u);
  EXPECT_EQ(totals.leaves, 16u);
  EXPECT_EQ(totals.triangle_tests, 16u);
  EXPECT_EQ(totals.rays_traced, 16u);

  // A ray that misses the tree's box comes to nothing.
  for (int lane = 0; lane < kPacketSize; ++lane) rays.ox[lane] += 100;
  totals = {};
  GetParam()->count_closest(tree.view, rays, hits, {&totals, nullptr});
  EXPECT_EQ(work_of(totals) + totals.steps + totals.rays_traced, 0u);
}

// The packet's counts are those of its rays one by one, which walk the same nodes where the rays' intervals
// are the same; parallel rays from one plane on a tree of small triangles.
TEST_P(CostOfEveryIsa, ARayComesToWhatItDoesByItself) {
  Random random(3);
  std::vector<KdTriangle> list;
  for (int i = 0; i < 400; ++i) {
    const Vec3 p = random.in_box(-1, 1);
    add_triangle(list, p, p + Vec3{0.1f, 0, 0}, p + Vec3{0, 0.05f, 0.1f});
  }
  const Tree tree(std::move(list));
  const RayPacket rays = rays_down();
  uint64_t visited = 0;
  for (int lane = 0; lane < kPacketSize; ++lane) {
    RayPacket one = rays;
    one.live = 1ull << lane;
    TraversalCounts packet{}, walk{};
    LaneWork work{};
    HitPacket hits;
    GetParam()->count_closest(tree.view, one, hits, {&packet, &work});
    walk_closest(tree.view, ray_of(rays, lane), walk);
    ASSERT_EQ(nodes_of(packet), nodes_of(walk)) << lane;
    ASSERT_EQ(packet.leaves, walk.leaves) << lane;
    ASSERT_EQ(packet.triangle_tests, walk.triangle_tests) << lane;
    ASSERT_EQ(static_cast<double>(work_of(walk)), sum_of(work)) << lane;
    ASSERT_EQ(static_cast<double>(work_of(walk)), static_cast<double>(work.work[lane])) << lane;
    visited += nodes_of(walk);
  }
  EXPECT_GT(visited, 64u * 5) << "the tree has inner nodes";
}

TEST_P(CostOfEveryIsa, BlocksThatSomethingCoversAreDarkWithoutARay) {
  Light light = sun({0, -1, 0});
  const PointPacket points = points_below();
  const PointPacket* const packets[] = {&points};
  for (const bool roof : {true, false}) {
    const Tree tree(one_triangle(8, roof ? 2.0f : -2.0f));
    ShadowAnswer answer, expected;
    TraversalCounts totals{};
    LaneWork work{};
    GetParam()->count_shadows(tree.view, light, GlassRule::passes, packets, 1, &answer, {&totals, &work});
    GetParam()->trace_shadows(tree.view, light, GlassRule::passes, packets, 1, &expected);
    EXPECT_EQ(answer.facing, ~0ull);
    EXPECT_EQ(answer.blocked, roof ? ~0ull : 0ull);
    EXPECT_EQ(answer.blocked, expected.blocked);
    EXPECT_EQ(totals.rays_traced, 0u);
    EXPECT_EQ(totals.steps, 0u);
    EXPECT_NEAR(sum_of(work), static_cast<double>(work_of(totals)), 1e-3);
    EXPECT_EQ(*std::min_element(work.work, work.work + 64), *std::max_element(work.work, work.work + 64))
        << "what is done together is shared evenly";
    EXPECT_EQ(totals.triangle_tests > 0, roof);
  }
}

TEST_P(CostOfEveryIsa, AmbientRaysWithNothingNearAreNotTraced) {
  const PointPacket points = points_below();
  const PointPacket* const packets[] = {&points};
  for (const float height : {50.0f, 0.3f}) {
    const Tree tree(one_triangle(8, height));
    FreeRays free, expected;
    TraversalCounts totals{};
    LaneWork work{};
    const AmbientSettings settings{3, 1};
    GetParam()->count_ambient(tree.view, packets, 1, settings, &free, {&totals, &work});
    GetParam()->ambient_blocks(tree.view, packets, 1, settings, &expected);
    for (int lane = 0; lane < kPacketSize; ++lane) ASSERT_EQ(free.count[lane], expected.count[lane]);
    EXPECT_NEAR(sum_of(work), static_cast<double>(work_of(totals)), 1e-3);
    if (height > 1) {
      EXPECT_EQ(totals.rays_traced, 0u);
      EXPECT_EQ(free.count[0], 9u);
    } else {
      EXPECT_GT(totals.rays_traced, 64u);
      EXPECT_LE(totals.rays_traced, 64u * 9);
      EXPECT_LT(free.count[0], 9u);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Trace, CostOfEveryIsa, testing::ValuesIn(available_kernels()),
                         [](const auto& instance) { return std::string(instance.param->isa); });

// A floor, a ball, a mirror and a pane of glass under a sun and a lamp.
Scene still_life() {
  Scene scene;
  Material grey, mirror, glass;
  grey.diffuse = {0.5f, 0.5f, 0.5f};
  mirror.optics = Optics::mirror;
  mirror.specular = {1, 1, 1};
  glass.optics = Optics::thin;
  const uint32_t matte = add_material(scene, grey);
  add_quad(scene, matte, {-4, 0, -4}, {0, 0, 8}, {8, 0, 0});
  add_quad(scene, add_material(scene, mirror), {-2, 0, -2}, {4, 0, 0}, {0, 2, 0});
  add_quad(scene, add_material(scene, glass), {-1, 0, 1}, {1.5f, 0, 0}, {0, 1.5f, 0});
  add_triangles(scene, matte, sphere({0.7f, 0.5f, 0}, 0.5f, 8));
  Light lamp = sun({0, 0, 1});
  lamp.kind = Light::Kind::point;
  lamp.position = {-1, 2, 2};
  scene.lights = {sun({0.4f, -1, -0.3f}), lamp};
  return scene;
}

TEST(Cost, IsNotSeenInThePictureAndAddsUp) {
  const Scene scene = still_life();
  const Camera camera = camera_at({0, 1.5f, 4}, {0, -0.3f, -1});
  for (const Primary primary : {Primary::raster, Primary::trace}) {
    Settings s;
    s.width = 75, s.height = 50;
    s.ao_samples = 4;
    s.primary = primary;
    s.threads = 2;
    const Frame plain = render_scene(scene, camera, s);
    EXPECT_FALSE(plain.stats.counted);
    EXPECT_EQ(work_of(plain.stats.traversal), 0u);
    s.count_traversal = true;
    const Frame counted = render_scene(scene, camera, s);
    s.count_traversal = false;
    s.aovs = {"depth", "cost"};
    const Frame pictured = render_scene(scene, camera, s);
    EXPECT_TRUE(same_bytes(plain, counted));
    EXPECT_TRUE(same_bytes(plain, pictured));

    double sum = 0;
    ASSERT_EQ(pictured.aovs.at(1).name, "cost");
    EXPECT_EQ(pictured.aovs[1].channels, 1);
    for (const Vec3& v : pictured.aovs[1].pixels.pixels) {
      ASSERT_GE(v.x, 0);
      sum += static_cast<double>(v.x);
    }
    for (const Frame* frame : {&counted, &pictured}) {
      const TraversalCounts& c = frame->stats.traversal;
      EXPECT_TRUE(frame->stats.counted);
      EXPECT_NEAR(sum / static_cast<double>(work_of(c)), 1, 1e-5);
      uint64_t rays = 0;
      TraversalCounts passes{};
      for (const PassStats& pass : frame->stats.passes) {
        EXPECT_EQ(pass.traversal.rays_traced + pass.traversal.rays_culled, pass.rays) << pass.name;
        EXPECT_LE(pass.traversal.rays_traced, pass.rays) << pass.name;
        rays += pass.rays;
        add(passes, pass.traversal);
      }
      EXPECT_EQ(c.rays_traced + c.rays_culled, rays);
      EXPECT_EQ(work_of(passes), work_of(c));
      EXPECT_GT(c.rays_traced, 1000u);
      EXPECT_GT(c.rays_culled, 1000u);
      EXPECT_GT(c.lanes_in_steps, c.steps);
      EXPECT_LE(c.lanes_in_steps, c.steps * 64);
      EXPECT_LT(c.leaves, nodes_of(c));
    }
    EXPECT_EQ(pictured.stats.passes.at(0).traversal.rays_traced > 0, primary == Primary::trace);
  }
}

// Where nothing is to be seen nothing was done.
TEST(Cost, IsNothingInTheEmptySky) {
  Settings s;
  s.width = s.height = 32;
  s.aovs = {"cost"};
  const Frame frame = render_scene(still_life(), camera_at({0, 1, 4}, {0, 0.2f, 1}), s);
  for (const Vec3& v : frame.aovs.at(0).pixels.pixels) ASSERT_EQ(v.x, 0);
  EXPECT_EQ(work_of(frame.stats.traversal), 0u);
}

TEST(Cost, StandsInTheStatistics) {
  ASSERT_NE(program(), "") << "set VITRAL to the program to be tested, as `make test` does";
  const ScratchFolder folder;
  folder.write("a.obj",
               "v -1 0 -1\nv 1 0 -1\nv 0 0 1\nv -1 0.5 -1\nv 0 0.5 -1\nv 0 0.5 0\nf 1 3 2\nf 4 6 5\n");
  const Finished done =
      Process(program(), {"a.obj", "--size", "40x40", "--stats", "-", "--aov", "cost", "-q"}, folder.path())
          .wait();
  ASSERT_EQ(done.code, 0) << done.err;
  const Json json = JsonReader::read(done.out);
  const Json& all = json["traversal"];
  for (const char* key : {"nodes", "leaves", "triangle_tests", "rays_traced", "rays_culled", "packet_steps",
                          "lanes_per_step"}) {
    EXPECT_EQ(all[key].kind, Json::Kind::number) << key;
    EXPECT_EQ(json["passes"].items.at(0)[key].kind, Json::Kind::number) << key;
  }
  EXPECT_GT(all["triangle_tests"].number, 0);
  EXPECT_EQ(read_text(folder / "a.cost.pfm").substr(0, 2), "Pf");
}

}  // namespace
}  // namespace vitral::test
