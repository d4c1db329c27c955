// From a hit to what light needs to know of the surface there. The same for rasterized pixels,
// camera rays and secondary rays.
#pragma once
#include "kernels/footprint.h"
#include "kernels/points.h"
#include "vitral/scene.h"

namespace vitral {

struct FrameContext;

// Fills the live rays' lanes that hit something and sets points.live to them; keys are the caller's. The rays
// are the camera's, or cones that have these diameters where they hit.
void make_surfaces(const FrameContext& frame, const RayPacket& rays, const HitPacket& hits,
                   SurfacePacket& out, const float* cone_diameters = nullptr);

// The same of what the pixels of the block at (x, y) see, which the rasterizer found.
void make_visible_surfaces(const FrameContext& frame, int x, int y, const uint32_t* triangles,
                           SurfacePacket& out);

}  // namespace vitral
