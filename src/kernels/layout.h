// What the rasterizer can write of a picture by itself: blocks of 8x8 pixels, one array a component, pixel
// y * 8 + x of a block at that place in each. Every array is whole cache lines, and every block of the
// picture is written once, from the first byte to the last; so nothing is cleared before.
//
// The values are those of the rendered picture's AOVs of the same names (vitral/render.h). Where nothing is
// seen the depth is 0 and the numbers of material and triangle are all ones; what else there is, is 0.
#pragma once
#include "kernels/packet.h"

#include <cstdint>

namespace vitral {

// 40 bytes a pixel.
struct alignas(64) FullBlock {
  float depth[kPacketSize];                                 // distance along the view
  float px[kPacketSize], py[kPacketSize], pz[kPacketSize];  // position in the world
  float nx[kPacketSize], ny[kPacketSize], nz[kPacketSize];  // shading normal, unit, turned to the viewer
  uint32_t albedo[kPacketSize];    // Kd without its texture: in 255ths, linear, red in the lowest byte, alpha
                                   // 255 in the highest
  uint32_t material[kPacketSize];  // number in Scene::materials
  uint32_t triangle[kPacketSize];  // number in Mesh::triangles
};
static_assert(sizeof(FullBlock) == 40 * kPacketSize);

// 10 bytes a pixel.
struct alignas(64) MinBlock {
  float depth[kPacketSize];
  uint32_t normal[kPacketSize];    // the shading normal: octahedral_normal() in kernels/octahedral.h
  uint16_t material[kPacketSize];  // up to kMaxMinMaterials of them
};
static_assert(sizeof(MinBlock) == 10 * kPacketSize);

inline constexpr uint32_t kNoMaterial = 0xffffffffu;  // FullBlock, where nothing is seen
inline constexpr uint16_t kNoMinMaterial = 0xffffu;   // MinBlock
inline constexpr uint32_t kMaxMinMaterials = 0xffffu;

}  // namespace vitral
