#include "raster/on_screen.h"

#include "kdtree/objects.h"
#include "raster/coverage.h"
#include "raster/project.h"

#include <algorithm>
#include <cmath>

namespace vitral {
namespace {

constexpr ScreenBound kNotSeen{{0, 0, 0, 0}, 0};

// Rounded down and up to whole pixels; whatever is beyond the window is its border.
int32_t lower(double pixels, int32_t from, int32_t to) {
  return pixels > from ? (pixels < to ? static_cast<int32_t>(std::floor(pixels)) : to) : from;
}
int32_t upper(double pixels, int32_t from, int32_t to) {
  return pixels < to ? (pixels > from ? static_cast<int32_t>(std::ceil(pixels)) : from) : to;
}

}  // namespace

// With a point q of the object at L q + t in the world, row . (L q + t - eye) = (L^T row) . (q - q_eye).
Projection project_object(const Projection& world, const Vec3& eye, const PlacedObject& object) {
  const PreciseAffine to_world = to_double(object.to_world);
  const auto turned = [&](const Vec3d& row) {
    return Vec3d{dot(to_world.x, row), dot(to_world.y, row), dot(to_world.z, row)};
  };
  Projection p = world;
  p.origin = to_double(narrowed(transform_point(object.to_object, to_double(eye))));
  p.row_x = turned(world.row_x), p.row_y = turned(world.row_y), p.row_w = turned(world.row_w);
  return p;
}

ScreenBound bound_on_screen(const Projection& projection, const Box& box, double margin) {
  const PixelBox& window = projection.window;
  const double low_x = window.x0 - margin, high_x = window.x1 + margin;
  const double low_y = window.y0 - margin, high_y = window.y1 + margin;
  double x0 = INFINITY, x1 = -INFINITY, y0 = INFINITY, y1 = -INFINITY, nearest = INFINITY;
  // Whether all corners lie on the outer side of the planes through the eye and the window's borders, and in
  // front of the near one: what holds for the corners holds for all between them.
  bool left = true, right = true, above = true, below = true, behind = true, all_before = true;
  for (int i = 0; i < 8; ++i) {
    const Vec3d corner{widen(i & 1 ? box.max.x : box.min.x), widen(i & 2 ? box.max.y : box.min.y),
                       widen(i & 4 ? box.max.z : box.min.z)};
    const Vec3d v = project(projection, corner);
    left &= v.x < low_x * v.z;
    right &= v.x > high_x * v.z;
    above &= v.y < low_y * v.z;
    below &= v.y > high_y * v.z;
    behind &= v.z < projection.near * 0.999;
    all_before &= v.z > projection.near;
    x0 = std::min(x0, v.x / v.z), x1 = std::max(x1, v.x / v.z);
    y0 = std::min(y0, v.y / v.z), y1 = std::max(y1, v.y / v.z);
    nearest = std::min(nearest, v.z);
  }
  if (left || right || above || below || behind) return kNotSeen;
  // Numbers that are not finite fail the test, too.
  if (!all_before || !std::isfinite(nearest)) return {window, INFINITY};
  const float inverse = narrow(1 / nearest * (1 + 1.0 / (1 << 20)));
  if (inverse < projection.least_inverse_depth) return kNotSeen;
  const PixelBox pixels{lower(x0 - margin, window.x0, window.x1), lower(y0 - margin, window.y0, window.y1),
                        upper(x1 + margin, window.x0, window.x1), upper(y1 + margin, window.y0, window.y1)};
  return {is_empty(pixels) ? PixelBox{0, 0, 0, 0} : pixels, inverse};
}

// Directions are rounded to 2^-24 of their largest component, a few times; the map stretches the error by no
// more than the product of its and its inverse's norms. A pixel is `step` wide at depth 1.
double ray_margin(const Pinhole& camera, const PlacedObject& object) {
  const auto squared = [](const PreciseAffine& a) { return dot(a.x, a.x) + dot(a.y, a.y) + dot(a.z, a.z); };
  const double stretch = std::sqrt(squared(to_double(object.to_world)) * squared(object.to_object));
  const double corner =
      1 + widen(camera.center_x) * widen(camera.center_x) + widen(camera.center_y) * widen(camera.center_y);
  return 1 + stretch * corner / (widen(camera.step) * (1 << 20));
}

}  // namespace vitral
