// What the secondary passes need to know of 64 surface points.
#pragma once
#include "kernels/packet.h"

namespace vitral {

struct alignas(64) PointPacket {
  float px[kPacketSize], py[kPacketSize], pz[kPacketSize];  // position
  float gx[kPacketSize], gy[kPacketSize], gz[kPacketSize];  // geometric normal, unit, turned to the viewer
  float nx[kPacketSize], ny[kPacketSize], nz[kPacketSize];  // shading normal, unit, turned to the viewer
  float offset[kPacketSize];                                // ray_offset() of the point's triangle
  uint32_t key[kPacketSize];                                // seeds the point's random numbers
  uint64_t live;
};

// A secondary ray starts this far off the surface along the geometric normal. A position is computed
// from its triangle's corners, the largest coordinate of which is `magnitude`, with an error of about
// 2^-22 of that: the offset is well beyond it, and knows nothing of the rest of the scene.
static inline float ray_offset(float magnitude) {
  return magnitude * (1.0f / 262144.0f);
}

struct AmbientSettings {
  int strata;      // n of n x n samples
  float distance;  // rays end here
};

}  // namespace vitral
