// The point of a triangle that a camera ray sees, given that the rasterizer found the triangle at the
// ray's pixel: the text for one pixel. kernels/facet.h has it for a register of them, and asks here where
// a ray misses.
//
// Where the ray meets the true triangle, t, u and v have the same bits as the tracer's hit. Where the
// pixel's centre is inside the snapped triangle only, it is the nearby point of kdtree/triangle.h.
#pragma once
#include "kdtree/kdtree.h"
#include "kdtree/triangle.h"
#include "math/pinhole.h"

namespace vitral {

static inline Vec3 corner_from(const Vec3& origin, const KdTriangle& triangle, int k) {
  return Vec3{triangle.corner[k][0], triangle.corner[k][1], triangle.corner[k][2]} - origin;
}

static inline TriangleHit<float, bool> visible_point(const Pinhole& camera, const KdTriangle& triangle, int x,
                                                     int y) {
  const Vec3 direction = primary_direction(camera, to_float(x), to_float(y));
  const int z = dominant_axis(direction);
  const Shear<float> shear = make_shear(permute(direction, z));
  Vec3 corner[3];
  for (int k = 0; k < 3; ++k) corner[k] = project(permute(corner_from(camera.origin, triangle, k), z), shear);
  const auto edges = edge_values(corner[0], corner[1], corner[2]);
  const auto hit = surround_origin(corner[0], corner[1], corner[2], shear, edges);
  if (hit.hit && hit.t > 0) return hit;
  return nearby_point(corner[0], corner[1], corner[2], shear, edges, camera.near, camera.far);
}

}  // namespace vitral
