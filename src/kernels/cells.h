// The rays of a tile that start in one point, in cells of 4x4 pixels, and what each has met so far.
//
// A ray's best hit is at first only a triangle and two depths between which it lies. Which of two triangles
// is nearer is mostly clear from that, and of a ray's triangles only the last is tested for t, u and v: for
// a register of rays at a time, each with its own triangle. Where it is not clear both are tested at once.
#pragma once
#include "kernels/batch.h"
#include "kernels/meet.h"
#include "kernels/packet.h"
#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {

inline constexpr int kCellSize = 16;
inline constexpr int kCellsOfPacket = kPacketSize / kCellSize;
inline constexpr int kMaxPackets = 16;
inline constexpr int kCells = kMaxPackets * kCellsOfPacket;
inline constexpr int kRays = kMaxPackets * kPacketSize;
inline constexpr int kGroups = 4;  // of cells
inline constexpr int kCellsOfGroup = kCells / kGroups;

// A rectangle in the plane of the rays.
struct Rectangle4 {
  float x0, x1, y0, y1;
};
inline constexpr Rectangle4 kNothing{kInfinity, -kInfinity, kInfinity, -kInfinity};
static inline Rectangle4 join(const Rectangle4& a, const Rectangle4& b) {
  return {vitral::least(a.x0, b.x0), vitral::greatest(a.x1, b.x1), vitral::least(a.y0, b.y0),
          vitral::greatest(a.y1, b.y1)};
}

struct alignas(64) Cells {
  int packets;
  float sx[kRays], sy[kRays], length[kRays], tmax[kRays];  // length: |dz|
  float low[kRays], high[kRays];                           // the best hit's depth is between these
  float t[kRays], u[kRays], v[kRays];                      // known but for the pending lanes
  uint32_t id[kRays];
  // Of each cell: the bounds of its live rays, and how deep a hit may be that still matters.
  float x0[kCells], x1[kCells], y0[kCells], y1[kCells], far[kCells];
  uint32_t live[kCells], pending[kCells];  // bits of lanes
  // Of groups of cells, and of all.
  Rectangle4 group[kGroups];
  float group_far[kGroups], all_far;
};

// A packet's lanes are rows of 8 pixels, a cell's are rows of 4.
static inline int first_lane(int cell) {
  return (cell >> 1 & 1) * 32 + (cell & 1) * 4;
}
template <class T>
static inline void copy_to_cells(const T* packet, T* cells) {
  for (int c = 0; c < kCellsOfPacket; ++c) {
    for (int row = 0; row < 4; ++row)
      std::memcpy(cells + c * kCellSize + row * 4, packet + first_lane(c) + row * 8, 4 * sizeof(T));
  }
}
template <class T>
static inline void copy_to_packet(const T* cells, T* packet) {
  for (int c = 0; c < kCellsOfPacket; ++c) {
    for (int row = 0; row < 4; ++row)
      std::memcpy(packet + first_lane(c) + row * 8, cells + c * kCellSize + row * 4, 4 * sizeof(T));
  }
}
static inline uint32_t cell_lanes(uint64_t packet, int cell) {
  const uint64_t rows = packet >> first_lane(cell);
  return static_cast<uint32_t>((rows & 15) | (rows >> 4 & 0xf0) | (rows >> 8 & 0xf00) |
                               (rows >> 12 & 0xf000));
}
static inline uint64_t packet_lanes(uint32_t lanes, int cell) {
  const uint64_t l = lanes;
  return ((l & 15) | (l & 0xf0) << 4 | (l & 0xf00) << 8 | (l & 0xf000) << 12) << first_lane(cell);
}

// The rays of a packet, from those of all cells.
static inline uint64_t rays_of(const uint32_t* cells, int packet) {
  uint64_t lanes = 0;
  for (int c = 0; c < kCellsOfPacket; ++c) lanes |= packet_lanes(cells[packet * kCellsOfPacket + c], c);
  return lanes;
}
template <class AnyCells>
static inline uint64_t live_rays(const AnyCells& cells, int packet) {
  return rays_of(cells.live, packet);
}

// --- the exact test --------------------------------------------------------------------------------

// A depth from t has two roundings.
static inline void set_depth(Cells& cells, int at, Mask m, Float t) {
  const Float depth = t * load(cells.length + at), tiny = Float(1e-36f);
  store(cells.low + at, select(m, depth * Float(1 - 0x1p-21f) - tiny, load(cells.low + at)));
  store(cells.high + at, select(m, depth * Float(1 + 0x1p-21f) + tiny, load(cells.high + at)));
}

static inline Shear<Float> shear_at(const Cells& cells, const View& view, int at) {
  const Float length = load(cells.length + at);
  return {load(cells.sx + at), load(cells.sy + at), length * Float(view.forward)};
}

// Finds t, u and v of pending lanes of a cell.
static inline void settle(const KdView& tree, const View& view, Cells& cells, int cell, uint32_t lanes) {
  for (int g = 0; g < kCellSize; g += kLanes) {
    const int at = cell * kCellSize + g;
    uint32_t left = lanes >> g & ((1u << kLanes) - 1);
    if (left == 0) continue;
    const Mask wanted = mask_of_bits(left);
    const Uint ids = load(cells.id + at);
    Vec3T<Float> corner[3];
    for (Vec3T<Float>& c : corner) c = {Float(0.0f), Float(0.0f), Float(1.0f)};
    while (left != 0) {
      const uint32_t id = cells.id[at + __builtin_ctz(left)];
      const Mask same = ids == Uint(id);
      const KdTriangle& triangle = tree.triangles[id];
      for (int k = 0; k < 3; ++k) {
        const float* c = triangle.corner[k];
        corner[k] = {select(same, Float(c[view.k[0]] - view.o[0]), corner[k].x),
                     select(same, Float(c[view.k[1]] - view.o[1]), corner[k].y),
                     select(same, Float(c[view.k[2]] - view.o[2]), corner[k].z)};
      }
      left &= ~bits(same);
    }
    const Shear<Float> shear = shear_at(cells, view, at);
    const auto found = surround_origin(project(corner[0], shear), project(corner[1], shear),
                                       project(corner[2], shear), shear);
    store(cells.t + at, select(wanted, found.t, load(cells.t + at)));
    store(cells.u + at, select(wanted, found.u, load(cells.u + at)));
    store(cells.v + at, select(wanted, found.v, load(cells.v + at)));
    set_depth(cells, at, wanted, found.t);
  }
  cells.pending[cell] &= ~lanes;
}

// Tests triangle i of the batch with lanes of the register at g of a cell. What they have met before is
// settled first.
static inline void test_exactly(const KdView& tree, const View& view, const Batch& batch, int i, int cell,
                                int g, uint32_t lanes, Cells& cells) {
  const uint32_t unsettled = cells.pending[cell] & lanes << g;
  if (unsettled != 0) settle(tree, view, cells, cell, unsettled);
  const int at = cell * kCellSize + g;
  const Shear<Float> shear = shear_at(cells, view, at);
  const auto found =
      surround_origin(project(corner_at(batch, i, 0), shear), project(corner_at(batch, i, 1), shear),
                      project(corner_at(batch, i, 2), shear), shear);
  const Uint id = Uint(batch.id[i]);
  const Float best = load(cells.t + at);
  const Mask closer = either(found.t < best, both(found.t == best, id < load(cells.id + at)));
  const Mask in_range = both(found.t > Float(view.tmin), found.t < load(cells.tmax + at));
  uint64_t hit = bits(both(both(found.hit, mask_of_bits(lanes)), both(in_range, closer)));
  if (hit != 0 && (batch.flags[i] & kCutOutTriangle))
    hit = keep_visible(tree, batch.id[i], hit, found.u, found.v);
  if (hit == 0) return;
  const Mask keep = mask_of_bits(hit);
  store(cells.t + at, select(keep, found.t, best));
  store(cells.u + at, select(keep, found.u, load(cells.u + at)));
  store(cells.v + at, select(keep, found.v, load(cells.v + at)));
  store(cells.id + at, select(keep, id, load(cells.id + at)));
  set_depth(cells, at, keep, found.t);
}

// --- a triangle and a cell -------------------------------------------------------------------------

// The live rays of a cell that triangle i of the batch may surround.
static inline uint32_t covered_lanes(const Cells& cells, int cell, const Batch& batch, int i) {
  uint32_t covered = 0;
  for (int g = 0; g < kCellSize; g += kLanes) {
    const int at = cell * kCellSize + g;
    const Shear<Float> shear{load(cells.sx + at), load(cells.sy + at), Float(1.0f)};
    covered |= bits(may_surround_origin(project(corner_at(batch, i, 0), shear),
                                        project(corner_at(batch, i, 1), shear),
                                        project(corner_at(batch, i, 2), shear)))
               << g;
  }
  return covered & cells.live[cell];
}

// Tests triangle i of the batch with rays of a cell that it may surround. Returns whether any may have got a
// new best hit.
//
// The edge values in float have the exact ones' signs, where they are not zero: a hit is certain when all are
// positive, or all negative. Each is off by at most 2^-22 E^2, for E the triangle's extent as any of the rays
// sees it, so the depth, their mean of the corners', by less than 2^-20 E^2 / area of what the corners'
// depths differ by, and 2^-21 of their greatest. It is taken to be off by 2^-20 of that, which leaves enough
// between two depths that are not mistaken for each other to tell their t apart, too.
static inline bool meet_cell(const KdView& tree, const View& view, const Batch& batch, int i, int cell,
                             uint32_t covered, Cells& cells) {
  bool changed = false;
  for (int g = 0; g < kCellSize; g += kLanes) {
    if (kLanes < kCellSize && (covered >> g & ((1u << kLanes) - 1)) == 0) continue;
    const int at = cell * kCellSize + g;
    const Shear<Float> shear{load(cells.sx + at), load(cells.sy + at), Float(1.0f)};
    const Vec3T<Float> a = project(corner_at(batch, i, 0), shear), b = project(corner_at(batch, i, 1), shear),
                       c = project(corner_at(batch, i, 2), shear);
    const Vec3T<Float> e = rounded_edge_values(a, b, c);
    const Float zero = Float(0.0f), area = (e.x + e.y) + e.z, inverse = Float(view.forward) / area;
    const Float depth = ((e.x * a.z + e.y * b.z) + e.z * c.z) * inverse;
    const Float error =
        select(absolute(area) > Float(1e-30f),
               absolute(inverse) * Float(batch.spread[i]) + Float(batch.rounding[i]), Float(kInfinity));
    const Float low = depth - error, high = depth + error;
    const Float best_low = load(cells.low + at), best_high = load(cells.high + at);
    const Mask never = either(low > best_high, high < Float(view.before_all));
    uint32_t possible = bits(both(mask_of_bits(covered >> g), invert(never)));
    if (possible == 0) continue;
    changed = true;
    const Mask inside = either(least_of(e.x, e.y, e.z) > zero, greatest_of(e.x, e.y, e.z) < zero);
    const Mask nearer = both(high<best_low, low> Float(view.in_all));
    uint32_t sure = bits(both(inside, nearer)) & possible;
    if (batch.flags[i] & kCutOutTriangle) sure = 0;
    const Mask take = mask_of_bits(sure);
    store(cells.low + at, select(take, low, best_low));
    store(cells.high + at, select(take, high, best_high));
    store(cells.id + at, select(take, Uint(batch.id[i]), load(cells.id + at)));
    cells.pending[cell] |= sure << g;
    possible &= ~sure;
    if (possible != 0) test_exactly(tree, view, batch, i, cell, g, possible, cells);
  }
  return changed;
}

}  // namespace VITRAL_ISA
}  // namespace vitral
