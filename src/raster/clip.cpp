// Polygon against plane: Sutherland and Hodgman, "Reentrant Polygon Clipping", CACM 17(1), 1974.
#include "raster/clip.h"

#include "raster/raster.h"

namespace vitral {
namespace {

// Not negative inside. Plane 0 is the near plane.
double distance(const ClipVertex& v, int plane, double near) {
  constexpr double guard = kGuardBand;
  switch (plane) {
    case 0:
      return v.w - near;
    case 1:
      return v.x + guard * v.w;
    case 2:
      return guard * v.w - v.x;
    case 3:
      return v.y + guard * v.w;
    default:
      return guard * v.w - v.y;
  }
}

ClipVertex crossing(const ClipVertex& inner, double inner_distance, const ClipVertex& outer,
                    double outer_distance) {
  const double s = inner_distance / (inner_distance - outer_distance);
  return {inner.x + (outer.x - inner.x) * s, inner.y + (outer.y - inner.y) * s,
          inner.w + (outer.w - inner.w) * s};
}

ClipPolygon clip(const ClipPolygon& polygon, int plane, double near) {
  ClipPolygon clipped{{}, 0};
  for (int i = 0; i < polygon.corners; ++i) {
    const ClipVertex& p = polygon.corner[i];
    const ClipVertex& q = polygon.corner[i + 1 == polygon.corners ? 0 : i + 1];
    const double dp = distance(p, plane, near), dq = distance(q, plane, near);
    const bool p_inside = dp >= 0, q_inside = dq >= 0;
    if (p_inside && clipped.corners < kMaxClippedCorners) clipped.corner[clipped.corners++] = p;
    if (p_inside != q_inside && clipped.corners < kMaxClippedCorners) {
      ClipVertex& c = clipped.corner[clipped.corners++];
      c = p_inside ? crossing(p, dp, q, dq) : crossing(q, dq, p, dp);
      if (plane == 0) c.w = near;
    }
  }
  return clipped;
}

}  // namespace

uint32_t outside_planes(const ClipVertex& v, double near) {
  uint32_t outside = 0;
  for (int plane = 0; plane < kClipPlanes; ++plane) {
    if (!(distance(v, plane, near) >= 0)) outside |= 1u << plane;
  }
  return outside;
}

ClipPolygon clip_triangle(const ClipVertex triangle[3], double near) {
  ClipPolygon polygon{{triangle[0], triangle[1], triangle[2]}, 3};
  for (int plane = 0; plane < kClipPlanes && polygon.corners >= 3; ++plane)
    polygon = clip(polygon, plane, near);
  return polygon;
}

}  // namespace vitral
