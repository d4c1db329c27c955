// Polygon against plane: Sutherland and Hodgman, "Reentrant Polygon Clipping", CACM 17(1), 1974.
#include "raster/clip.h"

#include "raster/raster.h"

namespace vitral {
namespace {

ClipVertex crossing(const ClipVertex& inner, double inner_distance, const ClipVertex& outer,
                    double outer_distance) {
  const double s = inner_distance / (inner_distance - outer_distance);
  return {inner.x + (outer.x - inner.x) * s, inner.y + (outer.y - inner.y) * s,
          inner.z + (outer.z - inner.z) * s};
}

ClipPolygon clip(const ClipPolygon& polygon, int plane, double near) {
  ClipPolygon clipped{{}, 0};
  for (int i = 0; i < polygon.corners; ++i) {
    const ClipVertex& p = polygon.corner[i];
    const ClipVertex& q = polygon.corner[i + 1 == polygon.corners ? 0 : i + 1];
    const double dp = plane_distance(p, plane, near), dq = plane_distance(q, plane, near);
    const bool p_inside = dp >= 0, q_inside = dq >= 0;
    if (p_inside && clipped.corners < kMaxClippedCorners) clipped.corner[clipped.corners++] = p;
    if (p_inside != q_inside && clipped.corners < kMaxClippedCorners) {
      ClipVertex& c = clipped.corner[clipped.corners++];
      c = p_inside ? crossing(p, dp, q, dq) : crossing(q, dq, p, dp);
      if (plane == 0) c.z = near;
    }
  }
  return clipped;
}

}  // namespace

ClipPolygon clip_triangle(const ClipVertex triangle[3], double near) {
  ClipPolygon polygon{{triangle[0], triangle[1], triangle[2]}, 3};
  for (int plane = 0; plane < kClipPlanes && polygon.corners >= 3; ++plane)
    polygon = clip(polygon, plane, near);
  return polygon;
}

}  // namespace vitral
