// The camera that a bare mesh gets: all of it in the picture, and not lost in it.
#include "app/auto_view.h"

#include "io/project.h"
#include "math/pinhole.h"
#include "vitral/error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace vitral {
namespace {

// Where the corners of a box come to lie: 1 is the edge of the picture.
struct Framing {
  double left = 1e9, right = -1e9, bottom = 1e9, top = -1e9;
  double nearest = 1e9, furthest = -1e9;  // depths

  double fill() const { return std::max(right - left, top - bottom) / 2; }
  bool inside() const { return left > -1 && right < 1 && bottom > -1 && top < 1; }
};

// A mesh whose triangles have the eight corners of a box.
Mesh box_mesh(const Box& box) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.positions.push_back(
        {i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z});
  }
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}, {5, 6, 7}};
  mesh.triangle_material = {0, 0, 0};
  return mesh;
}

Framing frame(const Camera& camera, const Box& box, float aspect) {
  const int height = 1000;
  const Pinhole pinhole = make_pinhole(camera, static_cast<int>(static_cast<float>(height) * aspect), height);
  Framing result;
  for (int i = 0; i < 8; ++i) {
    const Vec3d corner{static_cast<double>(i & 1 ? box.max.x : box.min.x),
                       static_cast<double>(i & 2 ? box.max.y : box.min.y),
                       static_cast<double>(i & 4 ? box.max.z : box.min.z)};
    const Vec3d offset = corner - to_double(pinhole.origin);
    const double depth = dot(offset, to_double(pinhole.forward));
    const double x = dot(offset, to_double(pinhole.right)) / depth / static_cast<double>(pinhole.center_x);
    const double y = dot(offset, to_double(pinhole.up)) / depth / static_cast<double>(pinhole.center_y);
    result.left = std::min(result.left, x);
    result.right = std::max(result.right, x);
    result.bottom = std::min(result.bottom, y);
    result.top = std::max(result.top, y);
    result.nearest = std::min(result.nearest, depth);
    result.furthest = std::max(result.furthest, depth);
  }
  return result;
}

void expect_well_framed(const Box& box, float aspect, const ViewWishes& wishes, const std::string& what) {
  const Camera camera = auto_camera(box_mesh(box), aspect, wishes);
  const Framing framing = frame(camera, box, aspect);
  EXPECT_TRUE(framing.inside()) << what << ": x " << framing.left << ".." << framing.right << ", y "
                                << framing.bottom << ".." << framing.top;
  EXPECT_GT(framing.fill(), 0.7) << what;
  EXPECT_GT(camera.near, 0) << what;
  EXPECT_LT(static_cast<double>(camera.near), framing.nearest) << what;
  EXPECT_GT(static_cast<double>(camera.far), framing.furthest) << what;
}

TEST(AutoView, FramesBoxesOfAnyShapeAndScale) {
  for (const float scale : {1e-6f, 1e-3f, 1.0f, 1e3f, 1e6f}) {
    for (const Vec3& size : {Vec3{1, 1, 1}, Vec3{10, 1, 1}, Vec3{1, 10, 1}, Vec3{1, 1, 10}, Vec3{5, 0, 5},
                             Vec3{0, 5, 5}, Vec3{5, 5, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
      for (const Vec3& place : {Vec3{0, 0, 0}, Vec3{-3, 2, 7}, Vec3{300, -200, 100}}) {
        for (const float aspect : {1.0f, 2.0f, 0.5f, 8.0f}) {
          Box box;
          extend(box, place * scale);
          extend(box, (place + size) * scale);
          const std::string what = "scale " + std::to_string(scale) + " size " + std::to_string(size.x) +
                                   " " + std::to_string(size.y) + " " + std::to_string(size.z) + " aspect " +
                                   std::to_string(aspect);
          expect_well_framed(box, aspect, {}, what);
        }
      }
    }
  }
}

TEST(AutoView, FramesWhateverTheWayItLooksAndTheAngle) {
  const Box box{{-1, 0, -2}, {3, 1, 2}};
  for (const Vec3& view : {Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 1, 0}, Vec3{-1, -1, 1}, Vec3{0, 0, 5}}) {
    for (const float fov : {1.0f, 20.0f, 60.0f, 90.0f}) {
      ViewWishes wishes;
      wishes.view = view;
      wishes.fov = fov;
      expect_well_framed(box, 1.5f, wishes, "fov " + std::to_string(fov));
    }
  }
}

TEST(AutoView, LooksFromTheFrontTheRightAndAbove) {
  const Camera camera = auto_camera(box_mesh({{-1, -1, -1}, {1, 1, 1}}), 1, {});
  EXPECT_GT(camera.position.x, 0);
  EXPECT_GT(camera.position.y, 0);
  EXPECT_GT(camera.position.z, 0);
  EXPECT_EQ(camera.up, (Vec3{0, 1, 0}));
}

TEST(AutoView, SinglePointsAreSeenToo) {
  for (const Vec3& point : {Vec3{0, 0, 0}, Vec3{5, 5, 5}, Vec3{1e6f, 0, 0}}) {
    const Box box{point, point};
    const Camera camera = auto_camera(box_mesh(box), 1, {});
    const Framing framing = frame(camera, box, 1);
    EXPECT_TRUE(framing.inside());
    EXPECT_LT(static_cast<double>(camera.near), framing.nearest);
    EXPECT_GT(static_cast<double>(camera.far), framing.furthest);
    EXPECT_GT(auto_ao_distance(box), 0);
  }
}

TEST(AutoView, TinyMeshesHaveCamerasToo) {
  for (const float scale : {1e-25f, 1e-30f}) {
    const std::vector<View> views =
        candidate_views(box_mesh({Vec3{-1, -1, -1} * scale, Vec3{1, 1, 1} * scale}), 1, {});
    EXPECT_GT(views.size(), 5u) << "inside, too";
    for (const View& view : views) {
      EXPECT_EQ(camera_fault(view.camera), "");
      EXPECT_NEAR(length(view.camera.view), 1, 0.1);
      EXPECT_GT(view.camera.near, 0);
    }
  }
}

TEST(AutoView, WishesAreKept) {
  const Box box{{-1, -1, -1}, {1, 1, 1}};
  ViewWishes wishes;
  wishes.eye = Vec3{10, 0, 0};
  Camera camera = auto_camera(box_mesh(box), 1, wishes);
  EXPECT_EQ(camera.position, (Vec3{10, 0, 0}));
  EXPECT_NEAR(camera.view.x, -1, 1e-6) << "towards the middle";
  EXPECT_LT(camera.near, 9);
  EXPECT_GT(camera.far, 11);

  wishes.near = 0.25f;
  wishes.far = 77.0f;
  wishes.fov = 33.0f;
  wishes.up = Vec3{0, 0, 1};
  camera = auto_camera(box_mesh(box), 1, wishes);
  EXPECT_EQ(camera.near, 0.25f);
  EXPECT_EQ(camera.far, 77);
  EXPECT_EQ(camera.fov, 33);
  EXPECT_EQ(camera.up, (Vec3{0, 0, 1}));

  wishes.eye = Vec3{0, 0, 0};  // in the middle itself
  EXPECT_GT(length(auto_camera(box_mesh(box), 1, wishes).view), 0);
  wishes.eye = Vec3{0, 50, 0};  // straight above, with no wish for up
  wishes.up.reset();
  EXPECT_NO_THROW(auto_camera(box_mesh(box), 1, wishes));

  wishes.view = Vec3{0, 0, 1};
  wishes.up = Vec3{0, 0, 2};
  EXPECT_THROW(auto_camera(box_mesh(box), 1, wishes), UsageError);
  wishes.up.reset();
  wishes.near = 80.0f;
  EXPECT_THROW(auto_camera(box_mesh(box), 1, wishes), UsageError);
}

TEST(AutoView, TheSunShinesOnWhatTheCameraSees) {
  Scene scene;
  const Box box{{-1, -1, -1}, {1, 1, 1}};
  const Camera camera = auto_camera(box_mesh(box), 1, {});
  light_automatically({camera, Place::outside}, scene);
  ASSERT_EQ(scene.lights.size(), 1u);
  const Vec3 travel = scene.lights[0].direction;
  EXPECT_NEAR(length(travel), 1, 1e-6);
  EXPECT_LT(travel.y, -0.3f) << "from above";
  EXPECT_GT(dot(travel, cross(camera.view, camera.up)), 0) << "from the left";
  // The three faces of the box that are seen are lit.
  EXPECT_LT(travel.z, 0);
  EXPECT_LT(travel.y, 0);
  EXPECT_NEAR(auto_ao_distance(box), 0.08 * std::sqrt(12.0), 1e-5);
}

TEST(AutoView, TheCoreLeavesOutTheSea) {
  // A hundred small triangles about the origin and one huge one.
  Mesh mesh;
  for (uint32_t i = 0; i < 100; ++i) {
    const float x = static_cast<float>(i % 10) - 4.5f, z = static_cast<float>(i / 10) - 4.5f;
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {{x, 0, z}, {x + 1, 0, z}, {x, 1, z}});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  mesh.positions.insert(mesh.positions.end(), {{-9000, 0, -9000}, {9000, 0, -9000}, {0, 0, 9000}});
  mesh.triangles.push_back({300, 301, 302});
  EXPECT_LT(diagonal(core(mesh)), 20);
  EXPECT_GT(diagonal(core(mesh)), 5);
  for (const View& view : candidate_views(mesh, 1.5f, {})) {
    EXPECT_EQ(camera_fault(view.camera), "");
    EXPECT_GT(view.camera.near, 0);
    EXPECT_GT(view.camera.far, 5) << "all that lies before it is in reach";
  }
}

TEST(AutoView, TheUsualViewGivesWayOnlyToAMuchRicherOne) {
  const std::vector<View> views = candidate_views(box_mesh({{-1, -1, -1}, {1, 1, 1}}), 1, {});
  ASSERT_GT(views.size(), 3u);
  const auto choice = [&](const std::vector<Richness>& richness) {
    size_t next = 0;
    const View& best = best_view(
        views, [&](const Camera&) { return next < richness.size() ? richness[next++] : Richness{}; });
    return &best - views.data();
  };
  const auto first_inside =
      std::find_if(views.begin(), views.end(), [](const View& v) { return v.place == Place::inside; });
  const auto inside = static_cast<size_t>(first_inside - views.begin());
  ASSERT_TRUE(inside > 2 && inside + 1 < views.size());
  EXPECT_EQ(choice({{10, 100}, {19, 50}, {20, 50}}), 0);
  EXPECT_EQ(choice({{10, 100}, {19, 50}, {21, 500}, {21, 50}}), 2) << "the first of equals";
  std::vector<Richness> rich(inside, Richness{10, 100});
  rich.push_back({15, 50});
  EXPECT_EQ(choice(rich), 0);
  rich.push_back({16, 50});
  EXPECT_EQ(choice(rich), static_cast<std::ptrdiff_t>(inside) + 1);
  rich[0] = {900, 1000};
  rich.back() = {4000, 6000};
  EXPECT_EQ(choice(rich), 0) << "the hollow of a dense mesh";
}

}  // namespace
}  // namespace vitral
