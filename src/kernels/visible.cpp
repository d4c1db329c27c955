// The visible points of a block of pixels.
#include "kernels/visible.h"

#include "kernels/packet.h"
#include "kernels/tables.h"
#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

// What the lanes of a register look at: each its own triangle, permuted for its own ray.
struct alignas(64) Seen {
  float corner[9][kLanes];
  float direction[3][kLanes];
};

// Lanes that see nothing look at a triangle without extent, which gives finite numbers.
void gather(const Pinhole& camera, const KdTriangle* triangles, const uint32_t* numbers, Seen& seen) {
  for (int lane = 0; lane < kLanes; ++lane) {
    const Vec3 direction{seen.direction[0][lane], seen.direction[1][lane], seen.direction[2][lane]};
    const int z = dominant_axis(direction);
    const Vec3 permuted = permute(direction, z);
    seen.direction[0][lane] = permuted.x, seen.direction[1][lane] = permuted.y,
    seen.direction[2][lane] = permuted.z;
    for (int k = 0; k < 3; ++k) {
      const Vec3 corner = numbers[lane] == kNoTriangle
                              ? Vec3{0, 0, 0}
                              : permute(corner_from(camera.origin, triangles[numbers[lane]], k), z);
      seen.corner[3 * k][lane] = corner.x;
      seen.corner[3 * k + 1][lane] = corner.y;
      seen.corner[3 * k + 2][lane] = corner.z;
    }
  }
}

inline Vec3T<Float> load_three(const float (*rows)[kLanes]) {
  return {load(rows[0]), load(rows[1]), load(rows[2])};
}

}  // namespace

void intersect_visible(const Pinhole& camera, const KdTriangle* triangles, int x, int y,
                       const uint32_t* numbers, HitPacket& hits) {
  const Hit nothing;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Uint lane = lane_numbers() + Uint(static_cast<uint32_t>(g));
    const Float px = to_float(Uint(static_cast<uint32_t>(x)) + (lane & Uint(7u)));
    const Float py = to_float(Uint(static_cast<uint32_t>(y)) + (lane >> 3));
    const Uint number = load(numbers + g);
    const Mask empty = number == Uint(kNoTriangle);

    Seen seen;
    const Vec3T<Float> direction = primary_direction(camera, px, py);
    store(seen.direction[0], direction.x), store(seen.direction[1], direction.y),
        store(seen.direction[2], direction.z);
    gather(camera, triangles, numbers + g, seen);
    const auto hit =
        visible_point(load_three(seen.corner), load_three(seen.corner + 3), load_three(seen.corner + 6),
                      load_three(seen.direction), Float(camera.near), Float(camera.far));

    store(hits.t + g, select(empty, Float(nothing.t), hit.t));
    store(hits.u + g, select(empty, Float(0.0f), hit.u));
    store(hits.v + g, select(empty, Float(0.0f), hit.v));
    store(hits.triangle + g, number);
  }
}

}  // namespace VITRAL_ISA
}  // namespace vitral
