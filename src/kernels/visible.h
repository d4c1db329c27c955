// The point of a triangle that a camera ray sees, given that the rasterizer found the triangle at the
// ray's pixel. One formula for one pixel (cut-outs in the fill) and for a register of them.
//
// Where the ray meets the true triangle, t, u and v have the same bits as the tracer's hit. Where the
// pixel's centre is inside the snapped triangle only, it is the nearby point of kdtree/triangle.h.
#pragma once
#include "kdtree/kdtree.h"
#include "kdtree/triangle.h"
#include "math/pinhole.h"

namespace vitral {

// Corners relative to the camera and, like the direction, permuted; near and far as in Pinhole. Where it
// is not `wanted` the answer means nothing.
template <class F, class M>
static inline auto visible_point(const Vec3T<F>& a, const Vec3T<F>& b, const Vec3T<F>& c,
                                 const Vec3T<F>& permuted_direction, const F& near, const F& far,
                                 const M& wanted) {
  const Shear<F> shear = make_shear(permuted_direction);
  const Vec3T<F> pa = project(a, shear), pb = project(b, shear), pc = project(c, shear);
  const auto edges = edge_values(pa, pb, pc);
  auto hit = surround_origin(pa, pb, pc, shear, edges);
  hit.hit = both(hit.hit, hit.t > F(0.0f));
  if (any(both(wanted, invert(hit.hit)))) {
    const auto nearby = nearby_point(pa, pb, pc, shear, edges, near, far);
    hit.t = select(hit.hit, hit.t, nearby.t);
    hit.u = select(hit.hit, hit.u, nearby.u);
    hit.v = select(hit.hit, hit.v, nearby.v);
  }
  return hit;
}

static inline Vec3 corner_from(const Vec3& origin, const KdTriangle& triangle, int k) {
  return Vec3{triangle.corner[k][0], triangle.corner[k][1], triangle.corner[k][2]} - origin;
}

static inline TriangleHit<float, bool> visible_point(const Pinhole& camera, const KdTriangle& triangle, int x,
                                                     int y) {
  const Vec3 direction = primary_direction(camera, to_float(x), to_float(y));
  const int z = dominant_axis(direction);
  return visible_point(permute(corner_from(camera.origin, triangle, 0), z),
                       permute(corner_from(camera.origin, triangle, 1), z),
                       permute(corner_from(camera.origin, triangle, 2), z), permute(direction, z),
                       camera.near, camera.far, true);
}

}  // namespace vitral
