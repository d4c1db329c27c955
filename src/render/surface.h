// From a hit to what light needs to know of the surface there. The same for rasterized pixels,
// camera rays and secondary rays.
#pragma once
#include "kernels/points.h"
#include "vitral/scene.h"

namespace vitral {

struct FrameContext;

struct alignas(64) SurfacePacket {
  PointPacket points;
  float r[kPacketSize], g[kPacketSize], b[kPacketSize];  // albedo: Kd times map_Kd
  float t[kPacketSize];                                  // of the ray that came here
  uint32_t material[kPacketSize];
  uint32_t triangle[kPacketSize];
  uint64_t back = 0;  // lanes that see the back of their triangle
};

// Fills the live rays' lanes that hit something and sets points.live to them; keys are the caller's.
void make_surfaces(const FrameContext& frame, const RayPacket& rays, const HitPacket& hits,
                   SurfacePacket& out);

}  // namespace vitral
