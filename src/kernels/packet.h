// Packets: the 64 rays of an 8x8 block of pixels, or 64 others, one array per component. Lane
// y * 8 + x of a block belongs to the pixel x to the right of and y below the block's corner.
#pragma once
#include "vitral/ray.h"

#include <cstdint>

namespace vitral {

inline constexpr int kBlockSide = 8;
inline constexpr int kPacketSize = kBlockSide * kBlockSide;

// A bit of `live` is set where the lane holds a ray; the other lanes hold any finite numbers. There
// are no initial values: whoever makes a packet fills it.
struct alignas(64) RayPacket {
  float ox[kPacketSize], oy[kPacketSize], oz[kPacketSize];
  float dx[kPacketSize], dy[kPacketSize], dz[kPacketSize];
  float tmax[kPacketSize];
  float tmin;  // of all lanes
  uint64_t live;
};

struct alignas(64) HitPacket {
  float t[kPacketSize], u[kPacketSize], v[kPacketSize];
  uint32_t triangle[kPacketSize];  // kNoTriangle: nothing there
};

// A lane of each.
static inline Ray ray_of(const RayPacket& p, int lane) {
  return {{p.ox[lane], p.oy[lane], p.oz[lane]}, p.tmin, {p.dx[lane], p.dy[lane], p.dz[lane]}, p.tmax[lane]};
}
static inline void set_ray(RayPacket& p, int lane, const Ray& r) {
  p.ox[lane] = r.origin.x, p.oy[lane] = r.origin.y, p.oz[lane] = r.origin.z;
  p.dx[lane] = r.direction.x, p.dy[lane] = r.direction.y, p.dz[lane] = r.direction.z;
  p.tmax[lane] = r.tmax;
}
static inline Hit hit_of(const HitPacket& p, int lane) {
  return {p.t[lane], p.u[lane], p.v[lane], p.triangle[lane]};
}
static inline void set_hit(HitPacket& p, int lane, const Hit& h) {
  p.t[lane] = h.t, p.u[lane] = h.u, p.v[lane] = h.v, p.triangle[lane] = h.triangle;
}

}  // namespace vitral
