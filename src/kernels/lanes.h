// Vectors out of the packets' arrays and back, and the origins of secondary rays.
#pragma once
#include "kernels/points.h"
#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {

// A box without a constructor: kernels share no code, and arrays of these are left as they are.
struct PlainBox {
  Vec3 min, max;
};
static inline Box as_box(const PlainBox& b) {
  return {b.min, b.max};
}
static inline PlainBox plain(const Box& b) {
  return {b.min, b.max};
}

static inline Vec3T<Float> load3(const float* x, const float* y, const float* z, int g) {
  return {load(x + g), load(y + g), load(z + g)};
}
static inline void store3(float* x, float* y, float* z, int g, const Vec3T<Float>& v) {
  store(x + g, v.x), store(y + g, v.y), store(z + g, v.z);
}

// The box of the points in each lane.
struct BoxLanes {
  Vec3T<Float> low, high;
};
static inline BoxLanes no_box() {
  const Float none = Float(kInfinity);
  return {{none, none, none}, {-none, -none, -none}};
}
static inline void extend(BoxLanes& box, Mask m, const Vec3T<Float>& p) {
  box.low = {least(select(m, p.x, box.low.x), box.low.x), least(select(m, p.y, box.low.y), box.low.y),
             least(select(m, p.z, box.low.z), box.low.z)};
  box.high = {greatest(select(m, p.x, box.high.x), box.high.x),
              greatest(select(m, p.y, box.high.y), box.high.y),
              greatest(select(m, p.z, box.high.z), box.high.z)};
}
static inline PlainBox box_of(const BoxLanes& box) {
  return {{least_lane(box.low.x), least_lane(box.low.y), least_lane(box.low.z)},
          {greatest_lane(box.high.x), greatest_lane(box.high.y), greatest_lane(box.high.z)}};
}

static inline void set_origins(const PointPacket& points, RayPacket& rays) {
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Vec3T<Float> p = load3(points.px, points.py, points.pz, g);
    const Vec3T<Float> n = load3(points.gx, points.gy, points.gz, g);
    store3(rays.ox, rays.oy, rays.oz, g, p + n * load(points.offset + g));
  }
}

}  // namespace VITRAL_ISA
}  // namespace vitral
