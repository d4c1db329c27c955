// Placed meshes on the screen, before any surface is looked at: which triangle each pixel sees, whatever the
// batches they are drawn in.
#include "kdtree/objects.h"
#include "raster/coverage.h"
#include "raster/drawn.h"
#include "raster_support.h"

#include <gtest/gtest.h>

#include <cstring>

namespace vitral {
namespace {

using namespace raster_test;

constexpr int kWidth = 200, kHeight = 150;

Affine moved(const Vec3& by) {
  return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, by};
}
Affine scaled(const Vec3& by) {
  return {{by.x, 0, 0}, {0, by.y, 0}, {0, 0, by.z}, {0, 0, 0}};
}

// Meshes and where they stand, as far as the rasterizer asks. Refers to itself.
struct Placed {
  Mesh own;
  std::vector<Mesh> meshes;
  std::vector<std::vector<KdTriangle>> triangles;
  std::vector<ModelView> models;
  std::vector<PlacedObject> objects;
  ObjectsView view{};
  DrawnModels drawn;

  Placed() = default;
  Placed(const Placed&) = delete;
  Placed& operator=(const Placed&) = delete;

  uint32_t add_model(const Mesh& mesh, const CutOuts& cut_outs = {}, uint32_t flags = 0) {
    meshes.push_back(mesh);
    triangles.push_back(kd_triangles(mesh, flags));
    ModelView model{};
    model.mesh = static_cast<uint32_t>(meshes.size() - 1);
    model.tree.cut_outs = cut_outs;
    models.push_back(model);
    drawn.meshes.push_back(cluster_mesh(mesh));
    drawn.has_cut_outs.push_back((flags & kCutOutTriangle) != 0);
    return model.mesh;
  }
  void place(uint32_t model, const Affine& to_world) {
    PlacedObject o{};
    o.to_world = to_world;
    o.to_object = precise_inverse(to_world);
    o.model = model;
    o.material = kNoIndex;
    o.count = static_cast<uint32_t>(meshes[model].triangles.size());
    o.shape = Shape::mesh;
    objects.push_back(o);
  }
  // To be called when all is there.
  void number() {
    uint32_t next = static_cast<uint32_t>(own.triangles.size());
    view.first_number = next;
    for (PlacedObject& o : objects) {
      o.first_number = next;
      next += o.count;
    }
    view.end_number = next;
    for (size_t i = 0; i < models.size(); ++i) models[i].tree.triangles = triangles[i].data();
    view.objects = objects.data();
    view.count = static_cast<uint32_t>(objects.size());
    view.models = models.data();
  }
};

struct Drawing {
  Picture picture;
  size_t clusters = 0;  // that were set up
};

Drawing draw(const Kernels& kernels, const Pinhole& camera, const Placed& scene,
             const DrawSettings& settings = {}, const Rectangle& crop = {},
             const ForEach& for_each = in_order, const CutOuts* cut_outs = nullptr) {
  RasterFrame frame;
  setup_frame(kernels.front_end, camera, kWidth, kHeight, crop, scene.own, nullptr, for_each, frame);
  const RasterView own = make_view(frame, camera, nullptr, cut_outs);
  const DrawStats stats =
      draw_objects({kernels.front_end, kernels.fill_tile, kernels.fill_over}, own, frame.projection,
                   scene.view, scene.drawn, settings, for_each, frame.objects);
  const DrawnObjects& drawn = frame.objects;
  Drawing out{{kWidth, kHeight, {}, {}}, stats.clusters};
  out.picture.triangle.assign(size_t{kWidth} * kHeight, kNoTriangle);
  out.picture.inverse_depth.assign(size_t{kWidth} * kHeight, 0.0f);
  const PixelBox& w = frame.projection.window;
  for (int y = w.y0; y < w.y1; ++y) {
    for (int x = w.x0; x < w.x1; ++x) {
      const TileVisibility& tile = drawn.tiles[tile_of(drawn, x / kTileSide, y / kTileSide)];
      const int tx = x % kTileSide, ty = y % kTileSide;
      const size_t i = static_cast<size_t>((ty / 8 * kTileBlocksAcross + tx / 8) * 64 + ty % 8 * 8 + tx % 8);
      const size_t p = static_cast<size_t>(y) * kWidth + static_cast<size_t>(x);
      out.picture.triangle[p] = tile.triangle[i];
      out.picture.inverse_depth[p] = tile.inverse_depth[i];
    }
  }
  return out;
}

Mesh ball(int bands) {
  Mesh mesh;
  for (const KdTriangle& t : test::sphere({0, 0, 0}, 1, bands))
    add_triangle(mesh, test::corner_of(t, 0), test::corner_of(t, 1), test::corner_of(t, 2));
  return mesh;
}

Pinhole standing_camera(float near = 0.1f) {
  return make_camera({0, 1, 6}, normalize(Vec3{0, -0.15f, -1}), kWidth, kHeight, 0.6f, near, 1000);
}

Affine random_placement(Random& random, float spread) {
  const Affine turned = rotation(random.direction(), random.between(0, 360));
  const Affine sized = scaled({random.between(0.1f, 1), random.between(-1, -0.1f), random.between(0.1f, 1)});
  const Vec3 at{random.between(-spread, spread), random.between(-1, 2), random.between(-4 * spread, 3)};
  return moved(at) * (turned * sized);
}

// A ground and hundreds of balls, from some triangles to thousands, many of them hidden.
void make_crowd(Placed& scene, int objects) {
  add_triangle(scene.own, {-50, -1, 20}, {50, -1, 20}, {0, -1, -200});
  add_triangle(scene.own, {-8, -1, -9}, {2, -1, -9}, {2, 6, -9});
  scene.add_model(ball(4));
  scene.add_model(ball(12));
  scene.add_model(ball(40));
  Random random(17);
  for (int i = 0; i < objects; ++i) scene.place(random.below(3), random_placement(random, 6));
  scene.number();
}

TEST(RasterObjects, PlacedWhereItIsAMeshIsDrawnToTheSameBits) {
  for (const Kernels* kernels : available_kernels()) {
    Random random(3);
    const Mesh mesh = soup(random, 3000, 0.5f, 60);
    const Pinhole camera = pixel_camera();
    Placed scene;
    scene.place(scene.add_model(mesh), Affine{});
    scene.number();
    const Picture expected = rasterize(*kernels, camera, kWidth, kHeight, mesh);
    EXPECT_GT(expected.covered(), 20000u);
    EXPECT_TRUE(draw(*kernels, camera, scene).picture == expected) << kernels->isa;
  }
}

// Eye and placement are whole numbers: every difference is exact, and the numbers of the mesh begin at 2.
TEST(RasterObjects, MovedWithTheCameraAMeshIsDrawnToTheSameBits) {
  const Kernels& kernels = *available_kernels().back();
  Random random(5);
  const Mesh mesh = soup(random, 3000, 0.5f, 60);
  Pinhole camera = pixel_camera();
  const Picture expected = rasterize(kernels, camera, kWidth, kHeight, mesh);
  camera.origin = {-7, 12, 1024};
  Placed scene;
  add_triangle(scene.own, {-7, 12, 2000}, {-6, 12, 2000}, {-7, 13, 2000});
  add_triangle(scene.own, {-7, 12, 2000}, {-6, 12, 2000}, {-7, 13, 2000});
  scene.place(scene.add_model(mesh), moved({-7, 12, 1024}));
  scene.number();
  Picture seen = draw(kernels, camera, scene).picture;
  for (uint32_t& t : seen.triangle) t -= t == kNoTriangle ? 0 : 2;
  EXPECT_TRUE(seen == expected);
}

TEST(RasterObjects, BatchesAndWhatIsHiddenCannotBeSeen) {
  Placed scene;
  make_crowd(scene, 400);
  const Pinhole camera = standing_camera();
  const Drawing expected =
      draw(*available_kernels().front(), camera, scene, {size_t{1} << 40, Hidden::drawn});
  EXPECT_GT(expected.picture.covered(), 20000u);
  ThreadPool pool(3);
  const ForEach threaded = [&](size_t count, const std::function<void(size_t)>& body) {
    pool.parallel_for(count, [&](size_t i, size_t) { body(i); });
  };
  for (const Kernels* kernels : available_kernels()) {
    for (const size_t batch : {size_t{1}, size_t{3000}, size_t{1} << 18}) {
      for (const Hidden hidden : {Hidden::left_out, Hidden::drawn}) {
        const bool many_batches = batch <= 3000;
        const Drawing seen =
            draw(*kernels, camera, scene, {batch, hidden}, {}, many_batches ? ForEach(in_order) : threaded);
        EXPECT_TRUE(seen.picture == expected.picture) << kernels->isa << " " << batch;
        if (hidden == Hidden::drawn) {
          EXPECT_EQ(seen.clusters, expected.clusters);
        } else if (batch <= 3000) {
          EXPECT_LT(seen.clusters, expected.clusters / 2);
        }
      }
    }
  }
}

TEST(RasterObjects, TheOrderOfObjectsChangesNumbersOnly) {
  const Kernels& kernels = *available_kernels().back();
  const Pinhole camera = standing_camera();
  Placed scene, shuffled;
  make_crowd(scene, 200);
  make_crowd(shuffled, 0);
  std::vector<uint32_t> order(scene.objects.size());
  for (uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  Random random(8);
  for (size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[random.below(static_cast<uint32_t>(i))]);
  for (const uint32_t i : order) shuffled.place(scene.objects[i].model, scene.objects[i].to_world);
  shuffled.number();
  const Picture a = draw(kernels, camera, scene).picture, b = draw(kernels, camera, shuffled).picture;
  EXPECT_EQ(a.inverse_depth, b.inverse_depth);
  size_t different = 0;
  for (size_t p = 0; p < a.triangle.size(); ++p) {
    uint32_t t = a.triangle[p];
    if (t != kNoTriangle && is_object(scene.view, t)) {
      const uint32_t object = object_of(scene.view, t);
      const size_t now = static_cast<size_t>(std::find(order.begin(), order.end(), object) - order.begin());
      t = t - scene.objects[object].first_number + shuffled.objects[now].first_number;
    }
    different += t != b.triangle[p];
  }
  EXPECT_EQ(different, 0u);
}

TEST(RasterObjects, CropsShowWhatTheWholeFrameShows) {
  const Kernels& kernels = *available_kernels().back();
  Placed scene;
  make_crowd(scene, 200);
  const Pinhole camera = standing_camera();
  const Picture whole = draw(kernels, camera, scene).picture;
  for (const Rectangle& crop :
       {Rectangle{37, 21, 90, 70}, {0, 0, 1, 1}, {199, 149, 1, 1}, {64, 0, 32, 150}}) {
    const Picture part = draw(kernels, camera, scene, {3000, Hidden::left_out}, crop).picture;
    for (int y = crop.y; y < crop.y + crop.height; ++y) {
      for (int x = crop.x; x < crop.x + crop.width; ++x) {
        ASSERT_EQ(part.at(x, y), whole.at(x, y)) << x << "," << y;
        ASSERT_EQ(part.depth_at(x, y), whole.depth_at(x, y));
      }
    }
  }
}

// The rule keeps a triangle where u < 1/2, and a scene of its own says whether it was asked.
bool keeps_half(const void* asked, uint32_t triangle, float u, float) {
  static_cast<std::vector<uint32_t>*>(const_cast<void*>(asked))->push_back(triangle);
  return u < 0.5f;
}

TEST(RasterObjects, CutOutsOfPlacedMeshesAreAskedByTheirOwnNumbers) {
  for (const Kernels* kernels : available_kernels()) {
    Random random(11);
    Mesh mesh;
    for (int i = 0; i < 1500; ++i) {
      const float x = random.between(0, kWidth), y = random.between(0, kHeight), size = i % 2 == 0 ? 30 : 3;
      const auto corner = [&] {
        const float dx = random.between(-size, size), dy = random.between(-size, size);
        return at_pixel(x + dx, y + dy, random.between(1, 60));
      };
      const Vec3 a = corner(), b = corner(), c = corner();
      add_triangle(mesh, a, b, c);
    }
    const Pinhole camera = pixel_camera();
    std::vector<uint32_t> asked, asked_of_object;
    const CutOuts own{keeps_half, &asked};
    std::vector<KdTriangle> triangles = kd_triangles(mesh);
    for (KdTriangle& t : triangles) t.flags = random.below(2) * kCutOutTriangle;
    const Picture expected = rasterize(*kernels, camera, kWidth, kHeight, mesh, {{}, triangles.data(), &own});
    Placed scene;
    scene.place(scene.add_model(mesh, {keeps_half, &asked_of_object}, kCutOutTriangle), Affine{});
    scene.triangles[0] = triangles;
    scene.number();
    EXPECT_TRUE(draw(*kernels, camera, scene).picture == expected) << kernels->isa;
    EXPECT_FALSE(asked.empty());
    EXPECT_EQ(asked, asked_of_object);
    const Picture whole = rasterize(*kernels, camera, kWidth, kHeight, mesh);
    EXPECT_FALSE(whole == expected);
  }
}

// Every pixel of a large ball that is squashed, turned and mirrored sees one of its front triangles, none is
// drawn twice by any two of them.
TEST(RasterObjects, APlacedMeshIsWatertight) {
  const Kernels& kernels = *available_kernels().back();
  const Pinhole camera = pixel_camera();
  for (const float mirror : {1.0f, -1.0f}) {
    // A sheet of which every triangle faces the camera: all its pixels once.
    Mesh sheet;
    Random random(23);
    constexpr int n = 40;
    std::vector<Vec3> grid;
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i)
        grid.push_back({static_cast<float>(i) + random.between(-0.2f, 0.2f),
                        static_cast<float>(j) + random.between(-0.2f, 0.2f), random.between(-0.2f, 0.2f)});
    }
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const auto at = [&](int di, int dj) {
          return grid[static_cast<size_t>((j + dj) * (n + 1) + i + di)];
        };
        add_triangle(sheet, at(0, 0), at(1, 0), at(1, 1));
        add_triangle(sheet, at(0, 0), at(1, 1), at(0, 1));
      }
    }
    const Affine around_middle = scaled({130 * mirror, 150, 0.1f}) * moved({-n / 2, -n / 2, 0});
    const Affine to_world = moved(at_pixel(100, 75, 40)) * (rotation({0, 0, 1}, 33) * around_middle);
    const auto cover = [&](uint32_t bit, uint32_t value) {
      Mesh half = sheet;
      half.triangles.clear();
      for (uint32_t t = 0; t < sheet.triangles.size(); ++t) {
        if ((t >> bit & 1u) == value) half.triangles.push_back(sheet.triangles[t]);
      }
      Placed scene;
      scene.place(scene.add_model(half), to_world);
      scene.number();
      return draw(kernels, camera, scene).picture;
    };
    Placed scene;
    scene.place(scene.add_model(sheet), to_world);
    scene.number();
    const Picture all = draw(kernels, camera, scene).picture;
    EXPECT_GT(all.covered(), 10000u);
    for (uint32_t bit = 0; bit < 12; ++bit) {
      const Picture with = cover(bit, 1), without = cover(bit, 0);
      for (size_t p = 0; p < all.triangle.size(); ++p) {
        const bool a = with.triangle[p] != kNoTriangle, b = without.triangle[p] != kNoTriangle;
        ASSERT_EQ(a || b, all.triangle[p] != kNoTriangle);
        ASSERT_FALSE(a && b) << bit << " " << p;
      }
    }
    // No hole inside: between the first and the last pixel of a row all are covered, but for bays of the rim.
    size_t holes = 0;
    for (int y = 1; y + 1 < kHeight; ++y) {
      for (int x = 1; x + 1 < kWidth; ++x) {
        holes += all.at(x, y) == kNoTriangle && all.at(x - 1, y) != kNoTriangle &&
                 all.at(x + 1, y) != kNoTriangle && all.at(x, y - 1) != kNoTriangle &&
                 all.at(x, y + 1) != kNoTriangle;
      }
    }
    EXPECT_EQ(holes, 0u);
  }
}

// --- where boxes lie on the screen ----------------------------------------------------------------

TEST(RasterObjects, BoundsHoldWhatIsInTheBox) {
  Random random(29);
  const Pinhole camera = standing_camera();
  const Projection world = make_projection(camera, kWidth, kHeight, {});
  size_t seen = 0, tight = 0, culled = 0;
  for (int round = 0; round < 2000; ++round) {
    PlacedObject object{};
    object.to_world = random_placement(random, 8);
    object.to_object = precise_inverse(object.to_world);
    const Projection projection = project_object(world, camera.origin, object);
    Box box;
    extend(box, random.in_box(-1, 1));
    extend(box, random.in_box(-1, 1));
    const ScreenBound bound = bound_on_screen(projection, box, 1);
    culled += is_empty(bound.pixels);
    tight += bound.nearest < 1e6f;
    for (int k = 0; k < 40; ++k) {
      const Vec3 p{random.between(box.min.x, box.max.x), random.between(box.min.y, box.max.y),
                   random.between(box.min.z, box.max.z)};
      const Vec3 at = transform_point(object.to_world, p);
      const Vec3d v = project(world, to_double(at));
      if (!(v.z >= world.near && v.z <= 1000)) continue;
      const double x = v.x / v.z, y = v.y / v.z;
      if (!(x > 0 && x < kWidth && y > 0 && y < kHeight)) continue;
      ++seen;
      ASSERT_TRUE(x >= bound.pixels.x0 && x <= bound.pixels.x1) << x;
      ASSERT_TRUE(y >= bound.pixels.y0 && y <= bound.pixels.y1) << y;
      ASSERT_LE(1 / v.z, static_cast<double>(bound.nearest));
    }
  }
  EXPECT_GT(seen, 5000u);
  EXPECT_GT(tight, 500u);
  EXPECT_GT(culled, 100u);
}

TEST(RasterObjects, ClustersHaveAllTrianglesOnceAndBoundThem) {
  const Mesh mesh = ball(60);
  ASSERT_GT(mesh.triangles.size(), 3 * kClusterTriangles);
  const ClusteredMesh clustered = cluster_mesh(mesh);
  uint32_t next = 0;
  for (const Cluster& c : clustered.clusters) {
    EXPECT_EQ(c.first_triangle, next);
    next += c.triangles;
    for (uint32_t t = c.first_triangle; t < next; ++t) {
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t local = clustered.corners[size_t{3} * t + k];
        ASSERT_LT(local, c.vertices);
        const Vec3& p = clustered.positions[c.first_vertex + local];
        ASSERT_TRUE(p == mesh.positions[mesh.triangles[t][k]]);
        for (int axis = 0; axis < 3; ++axis) {
          ASSERT_GE(component(p, axis), component(c.bounds.min, axis));
          ASSERT_LE(component(p, axis), component(c.bounds.max, axis));
        }
      }
    }
  }
  EXPECT_EQ(next, mesh.triangles.size());
  EXPECT_TRUE(cluster_mesh(Mesh{}).clusters.empty());
}

}  // namespace
}  // namespace vitral
