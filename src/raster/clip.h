// Clipping in homogeneous pixel coordinates, before the division by W.
//
// A point where an edge meets a plane is computed from the edge's inner end to its outer one, so both
// triangles at the edge compute the same bits, and every triangle that is clipped at all is clipped
// by all planes in the same order: no crack opens.
#pragma once
#include "raster/project.h"
#include "vitral/vec.h"

namespace vitral {

// (X, Y, W), W as z: the pixel (X / W, Y / W) at depth W.
using ClipVertex = Vec3d;

inline constexpr int kMaxClippedCorners = 3 + kClipPlanes;

struct ClipPolygon {
  ClipVertex corner[kMaxClippedCorners];
  int corners;
};

// The part of the triangle inside all planes; fewer than three corners: nothing.
ClipPolygon clip_triangle(const ClipVertex triangle[3], double near);

}  // namespace vitral
