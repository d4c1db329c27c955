// Rays of several blocks that walk the tree, sorted so that those of a packet have much in common.
#pragma once
#include "kernels/counts.h"
#include "kernels/lanes.h"
#include "kernels/meet.h"
#include "kernels/trace.h"

namespace vitral {
namespace VITRAL_ISA {

// Rays of several blocks, sorted by the signs of their directions and by the axis along which they run
// fastest: packets of one kind visit the cells of the tree in one order and are tested without a choice
// per lane.
inline constexpr int kRayKinds = 24;
struct alignas(64) RayBin {
  static constexpr int kRoom = kPacketSize + 16;
  float ox[kRoom], oy[kRoom], oz[kRoom], dx[kRoom], dy[kRoom], dz[kRoom];
  uint32_t id[kRoom];  // 64 * block + lane
  int count;
};
struct RaySorter {
  RayBin bins[kRayKinds];
  uint32_t node;  // where the walk begins
};

static inline Uint kind_of(const Vec3T<Float>& d) {
  const Float zero = Float(0.0f), x = absolute(d.x), y = absolute(d.y), z = absolute(d.z);
  const auto bit = [](Mask m, uint32_t value) { return select(m, Uint(value), Uint(0u)); };
  const Uint signs = bit(d.x < zero, 1) + bit(d.y < zero, 2) + bit(d.z < zero, 4);
  const Mask x_leads = both(x > y, x > z), y_leads = both(invert(x_leads), y > z);
  return signs + bit(x_leads, 8) + bit(y_leads, 16);
}

// Traces up to 64 rays of a bin and takes them out.
template <class Counts>
static void flush(const KdView& tree, const RaySorter& sorter, float distance, RayBin& bin,
                  FreeRays* free_rays, Counts counts) {
  const int n = bin.count < kPacketSize ? bin.count : kPacketSize;
  RayPacket rays;
  float* const to[6] = {rays.ox, rays.oy, rays.oz, rays.dx, rays.dy, rays.dz};
  float* const from[6] = {bin.ox, bin.oy, bin.oz, bin.dx, bin.dy, bin.dz};
  for (int a = 0; a < 6; ++a) {
    std::memcpy(to[a], from[a], sizeof rays.ox);
    std::memcpy(from[a], from[a] + kPacketSize, sizeof(float) * 16);
  }
  for (int g = 0; g < kPacketSize; g += kLanes) store(rays.tmax + g, Float(distance));
  rays.tmin = 0;
  rays.live = n == kPacketSize ? ~0ull : (1ull << n) - 1;
  uint64_t met = counts.of_lanes(bin.id, n, [&](auto of_packet) {
    return trace_any_from(tree, sorter.node, rays, GlassRule::passes, of_packet);
  });
  for (; met != 0; met &= met - 1) {
    const uint32_t id = bin.id[__builtin_ctzll(met)];
    --free_rays[id / kPacketSize].count[id % kPacketSize];
  }
  std::memcpy(bin.id, bin.id + kPacketSize, sizeof(uint32_t) * 16);
  bin.count -= n;
}

// Puts the live rays of a block into the bins, and traces those that are full.
template <class Counts>
static void sort_rays(const KdView& tree, RaySorter& sorter, const RayPacket& rays, int block, float distance,
                      FreeRays* free_rays, Counts counts) {
  for (int g = 0; g < kPacketSize; g += kLanes) {
    uint32_t left = bits(group_mask(rays.live, g));
    if (left == 0) continue;
    const Vec3T<Float> o = load3(rays.ox, rays.oy, rays.oz, g), d = load3(rays.dx, rays.dy, rays.dz, g);
    const Uint id = lane_numbers() + Uint(static_cast<uint32_t>(block * kPacketSize + g)), kinds = kind_of(d);
    uint32_t kind[kLanes];
    store(kind, kinds);
    while (left != 0) {
      const uint32_t k = kind[__builtin_ctz(left)];
      const uint32_t same = bits(kinds == Uint(k)) & left;
      left &= ~same;
      const Mask m = mask_of_bits(same);
      RayBin& bin = sorter.bins[k];
      const int n = bin.count;
      compress(bin.ox + n, o.x, m), compress(bin.oy + n, o.y, m), compress(bin.oz + n, o.z, m);
      compress(bin.dx + n, d.x, m), compress(bin.dy + n, d.y, m), compress(bin.dz + n, d.z, m);
      compress(bin.id + n, id, m);
      bin.count += __builtin_popcount(same);
      if (bin.count >= kPacketSize) flush(tree, sorter, distance, bin, free_rays, counts);
    }
  }
}

}  // namespace VITRAL_ISA
}  // namespace vitral
