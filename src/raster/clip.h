// Clipping in homogeneous pixel coordinates, before the division by W.
//
// A point where an edge meets a plane is computed from the edge's inner end to its outer one, so both
// triangles at the edge compute the same bits, and every triangle that is clipped at all is clipped
// by all planes in the same order: no crack opens.
#pragma once
#include <cstdint>

namespace vitral {

// (X, Y, W): the pixel (X / W, Y / W) at depth W.
struct ClipVertex {
  double x, y, w;
};

// The near plane W = near, and the four sides of the guard band.
inline constexpr int kClipPlanes = 5;
inline constexpr uint32_t kOutsideAll = (1u << kClipPlanes) - 1;
inline constexpr int kMaxClippedCorners = 3 + kClipPlanes;

struct ClipPolygon {
  ClipVertex corner[kMaxClippedCorners];
  int corners;
};

// A bit for every plane that the vertex is outside of; NaN is outside.
uint32_t outside_planes(const ClipVertex& v, double near);

// The part of the triangle inside all planes; fewer than three corners: nothing.
ClipPolygon clip_triangle(const ClipVertex triangle[3], double near);

}  // namespace vitral
