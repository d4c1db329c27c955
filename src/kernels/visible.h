// The point of a triangle that a camera ray sees, given that the rasterizer found the triangle at the
// ray's pixel: the text for one pixel. kernels/facet.h has it for a register of them, and asks here where
// a ray misses.
//
// Where the ray meets the true triangle, t, u and v have the same bits as the tracer's hit. Where the
// pixel's centre is inside the snapped triangle only, it is the nearby point of kdtree/triangle.h.
#pragma once
#include "kdtree/kdtree.h"
#include "kdtree/objects.h"
#include "kdtree/triangle.h"
#include "math/pinhole.h"

namespace vitral {

static inline Vec3 corner_from(const Vec3& origin, const KdTriangle& triangle, int k) {
  return Vec3{triangle.corner[k][0], triangle.corner[k][1], triangle.corner[k][2]} - origin;
}

// The camera, as an object sees it: its rays in the object's space, by the roundings of the tracer's.
struct Eye {
  const Pinhole* camera;
  const PlacedObject* object;  // null: the world
  Vec3 origin;
};
static inline Eye eye_of(const Pinhole& camera, const PlacedObject* object) {
  if (object == nullptr) return {&camera, nullptr, camera.origin};
  return {&camera, object, narrowed(ray_to_object(*object, camera.origin, camera.forward).origin)};
}
template <class F>
static inline Vec3T<F> direction_from(const Eye& eye, const F& x, const F& y) {
  const Vec3T<F> d = primary_direction(*eye.camera, x, y);
  return eye.object == nullptr ? d : narrowed(ray_to_object(*eye.object, d, d).direction);
}

static inline TriangleHit<float, bool> visible_point(const Eye& eye, const KdTriangle& triangle, int x,
                                                     int y) {
  const Vec3 direction = direction_from(eye, to_float(x), to_float(y));
  const int z = dominant_axis(direction);
  const Shear<float> shear = make_shear(permute(direction, z));
  Vec3 corner[3];
  for (int k = 0; k < 3; ++k) corner[k] = project(permute(corner_from(eye.origin, triangle, k), z), shear);
  const auto edges = edge_values(corner[0], corner[1], corner[2]);
  const auto hit = surround_origin(corner[0], corner[1], corner[2], shear, edges);
  if (hit.hit && hit.t > 0) return hit;
  return nearby_point(corner[0], corner[1], corner[2], shear, edges, eye.camera->near, eye.camera->far);
}
static inline TriangleHit<float, bool> visible_point(const Pinhole& camera, const KdTriangle& triangle, int x,
                                                     int y) {
  return visible_point(eye_of(camera, nullptr), triangle, x, y);
}

}  // namespace vitral
