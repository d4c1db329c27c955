// The visible points of a block of pixels.
#include "kernels/visible.h"

#include "kernels/packet.h"
#include "kernels/tables.h"
#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

// What the pixels look at: each its own triangle, relative to the camera and permuted for its own ray.
struct alignas(64) Seen {
  float corner[9][kPacketSize];
  float direction[3][kPacketSize];
};

// Pixels that see nothing look at a triangle without extent, which gives finite numbers.
void gather(const Pinhole& camera, const KdTriangle* triangles, const uint32_t* numbers, Seen& seen) {
  for (int i = 0; i < kPacketSize; ++i) {
    const Vec3 direction{seen.direction[0][i], seen.direction[1][i], seen.direction[2][i]};
    const int z = dominant_axis(direction);
    const Vec3 permuted = permute(direction, z);
    seen.direction[0][i] = permuted.x, seen.direction[1][i] = permuted.y, seen.direction[2][i] = permuted.z;
    for (int k = 0; k < 3; ++k) {
      const Vec3 corner = numbers[i] == kNoTriangle
                              ? Vec3{0, 0, 0}
                              : permute(corner_from(camera.origin, triangles[numbers[i]], k), z);
      seen.corner[3 * k][i] = corner.x, seen.corner[3 * k + 1][i] = corner.y,
                      seen.corner[3 * k + 2][i] = corner.z;
    }
  }
}

inline Vec3T<Float> load_three(const float (*rows)[kPacketSize], int g) {
  return {load(rows[0] + g), load(rows[1] + g), load(rows[2] + g)};
}

}  // namespace

void intersect_visible(const Pinhole& camera, const KdTriangle* triangles, int x, int y,
                       const uint32_t* numbers, HitPacket& hits) {
  Seen seen;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Uint pixel = lane_numbers() + Uint(static_cast<uint32_t>(g));
    const Float px = to_float(Uint(static_cast<uint32_t>(x)) + (pixel & Uint(7u)));
    const Float py = to_float(Uint(static_cast<uint32_t>(y)) + (pixel >> 3));
    const Vec3T<Float> d = primary_direction(camera, px, py);
    store(seen.direction[0] + g, d.x), store(seen.direction[1] + g, d.y), store(seen.direction[2] + g, d.z);
  }
  gather(camera, triangles, numbers, seen);

  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Uint number = load(numbers + g);
    const Mask empty = number == Uint(kNoTriangle);
    store(hits.triangle + g, number);
    if (!any(invert(empty))) {
      store(hits.t + g, Float(kInfinity)), store(hits.u + g, Float(0.0f)), store(hits.v + g, Float(0.0f));
      continue;
    }
    const auto hit = visible_point(load_three(seen.corner, g), load_three(seen.corner + 3, g),
                                   load_three(seen.corner + 6, g), load_three(seen.direction, g),
                                   Float(camera.near), Float(camera.far));
    store(hits.t + g, select(empty, Float(kInfinity), hit.t));
    store(hits.u + g, select(empty, Float(0.0f), hit.u));
    store(hits.v + g, select(empty, Float(0.0f), hit.v));
  }
}

}  // namespace VITRAL_ISA
}  // namespace vitral
