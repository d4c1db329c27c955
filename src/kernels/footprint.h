// What 64 rays see of the textures of the triangles they met.
#pragma once
#include "kernels/packet.h"
#include "math/pinhole.h"

namespace vitral {

// The corners' texture coordinates and the pictures' sizes in texels.
struct alignas(64) TexturedLanes {
  float u[3][kPacketSize], v[3][kPacketSize];
  float columns[kPacketSize], rows[kPacketSize];
};

// How wide the rays are where they meet their triangles: pixels of a camera whose rays they are; or, when
// it is null, cones of these diameters.
struct RayWidths {
  const Pinhole* camera;
  const float* diameter;
};

// Texture coordinates of the hits and the rows of probes around them; see math/footprint.h.
struct alignas(64) Footprints {
  float u[kPacketSize], v[kPacketSize];
  float step_u[kPacketSize], step_v[kPacketSize];
  float width[kPacketSize], count[kPacketSize];
};

}  // namespace vitral
