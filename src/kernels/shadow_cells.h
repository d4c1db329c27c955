// The shadow rays of a tile in cells of 4x4 pixels, and triangles that may block them.
#pragma once
#include "kernels/casters.h"
#include "kernels/cells.h"
#include "kernels/counts.h"
#include "kernels/lanes.h"
#include "kernels/pairs.h"

namespace vitral {
namespace VITRAL_ISA {

// The rays of a tile in the light's frame, in cells of 4x4 pixels. Until the first triangle asks for the
// cells only the bounds of all rays are known.
struct alignas(64) ShadowCells {
  const LightFrame* frame;
  const RayPacket* rays;
  int packets;
  uint32_t live[kCells];    // rays that can be traced and are not known to be blocked
  uint32_t tested[kCells];  // rays that were tested with any triangle
  Starts starts;            // of all open rays
  int effort;               // triangles, and pairs of triangles and cells, so far
  bool bounded;
  float x[kRays], y[kRays], z[kRays];
  // Of each cell's open rays: bounds, the greatest z, and minus the least.
  float x0[kCells], x1[kCells], y0[kCells], y1[kCells], z1[kCells], far[kCells];
  // Of groups of cells, and of all: -inf when none is open.
  Rectangle4 group[kGroups];
  float group_far[kGroups], all_far;
  // For the exact test, when a packet is first in need of it.
  Shears shears[kMaxPackets];
  bool sheared[kMaxPackets];
};

// --- bounds ----------------------------------------------------------------------------------------

// Bounds a cell's open rays.
static void bound_cell(ShadowCells& cells, int cell) {
  BoxLanes lanes = no_box();
  for (int g = 0; g < kCellSize; g += kLanes)
    extend(lanes, mask_of_bits(cells.live[cell] >> g),
           load3(cells.x, cells.y, cells.z, cell * kCellSize + g));
  const PlainBox box = box_of(lanes);
  cells.x0[cell] = box.min.x, cells.x1[cell] = box.max.x;
  cells.y0[cell] = box.min.y, cells.y1[cell] = box.max.y;
  cells.far[cell] = -box.min.z, cells.z1[cell] = box.max.z;
}

static void bound_groups(ShadowCells& cells) {
  cells.all_far = -kInfinity;
  Rectangle4 all = kNothing;
  for (int group = 0; group < kGroups; ++group) {
    Float x0 = Float(kInfinity), x1 = -x0, y0 = x0, y1 = x1, far = x1;
    for (int g = 0; g < kCellsOfGroup; g += kLanes) {
      const int at = group * kCellsOfGroup + g;
      x0 = least(load(cells.x0 + at), x0), x1 = greatest(load(cells.x1 + at), x1);
      y0 = least(load(cells.y0 + at), y0), y1 = greatest(load(cells.y1 + at), y1);
      far = greatest(load(cells.far + at), far);
    }
    cells.group[group] = {least_lane(x0), greatest_lane(x1), least_lane(y0), greatest_lane(y1)};
    cells.group_far[group] = greatest_lane(far);
    all = join(all, cells.group[group]);
    cells.all_far = vitral::greatest(cells.group_far[group], cells.all_far);
  }
  cells.starts.bounds = all;
  cells.starts.least_z = -cells.all_far;
}

static inline Vec3T<Float> origins(const LightFrame& frame, const RayPacket& rays, int g) {
  return shear(frame, Vec3T<Float>{load(rays.ox + g), load(rays.oy + g), load(rays.oz + g)});
}

// Bounds the rays that can be traced, all together.
static Starts bound_rays(const LightFrame& frame, const RayPacket* rays, const uint64_t* lanes_of,
                         int count) {
  BoxLanes lanes = no_box();
  for (int i = 0; i < count; ++i) {
    for (int g = 0; g < kPacketSize; g += kLanes)
      extend(lanes, group_mask(lanes_of[i], g), origins(frame, rays[i], g));
  }
  const PlainBox box = box_of(lanes);
  return {{box.min.x, box.max.x, box.min.y, box.max.y}, box.min.z, box.max.z};
}

// Brings the rays to the cells, and bounds these.
static void enter_cells(ShadowCells& cells) {
  for (int i = 0; i < cells.packets; ++i) {
    float x[kPacketSize], y[kPacketSize], z[kPacketSize];
    for (int g = 0; g < kPacketSize; g += kLanes) {
      const Vec3T<Float> p = origins(*cells.frame, cells.rays[i], g);
      store(x + g, p.x), store(y + g, p.y), store(z + g, p.z);
    }
    const int at = i * kPacketSize;
    copy_to_cells(x, cells.x + at), copy_to_cells(y, cells.y + at), copy_to_cells(z, cells.z + at);
  }
  const int filled = cells.packets * kCellsOfPacket;
  for (int cell = 0; cell < filled; ++cell) bound_cell(cells, cell);
  for (int cell = filled; cell < kCells; ++cell) {
    cells.x0[cell] = cells.y0[cell] = kInfinity;
    cells.x1[cell] = cells.y1[cell] = cells.z1[cell] = cells.far[cell] = -kInfinity;
  }
  bound_groups(cells);
  cells.bounded = true;
}

// --- tests -----------------------------------------------------------------------------------------

// The cells from `at` on that may have rays that caster i blocks.
static inline Mask may_meet(const ShadowCells& cells, int at, const Casters& casters, int i) {
  const Rectangles bounds = cell_bounds(cells, at);
  const Extremes edge = extremes_of(casters.edge, i, bounds);
  const Span plane = span_of(Float(casters.nx[i]), Float(casters.ny[i]), Float(casters.nz[i]),
                             Float(casters.n0[i]), bounds, -load(cells.far + at), load(cells.z1 + at));
  const Mask outside = both(edge.highest > Float(casters.gate[i]), edge.lowest < Float(-casters.doubt[i]));
  return invert(either(outside, plane.greatest < Float(-casters.beyond[i])));
}

// The rays of a cell that caster i surely blocks, and those of which it is not sure.
struct Verdict {
  uint32_t blocked, unsure;
};
static inline Verdict judge(const Casters& casters, int i, const ShadowCells& cells, int cell) {
  Verdict v{0, 0};
  const Float inside = Float(casters.inside[i]), outside = Float(-casters.doubt[i]),
              gate = Float(casters.gate[i]), beyond = Float(casters.beyond[i]);
  for (int g = 0; g < kCellSize; g += kLanes) {
    const int at = cell * kCellSize + g;
    const Float x = load(cells.x + at), y = load(cells.y + at);
    Float e[3];
    for (int k = 0; k < 3; ++k) {
      const Line& edge = casters.edge[k];
      e[k] = (Float(edge.x[i]) * x + Float(edge.y[i]) * y) + Float(edge.c[i]);
    }
    const Float low = least_of(e[0], e[1], e[2]), high = greatest_of(e[0], e[1], e[2]);
    const Float plane = (Float(casters.nx[i]) * x + Float(casters.ny[i]) * y) +
                        (Float(casters.nz[i]) * load(cells.z + at) + Float(casters.n0[i]));
    const Mask misses = either(both(low<outside, high> gate), plane < -beyond);
    const uint32_t sure = bits(both(low > inside, plane > beyond));
    v.blocked |= sure << g;
    v.unsure |= (bits(invert(misses)) & ~sure) << g;
  }
  return {v.blocked & cells.live[cell], v.unsure & cells.live[cell]};
}

// The exact test of some rays of a cell.
static uint32_t test_exactly(const KdView& tree, ShadowCells& cells, int cell, uint32_t lanes, uint32_t id) {
  const int packet = cell / kCellsOfPacket, part = cell % kCellsOfPacket;
  const RayPacket& rays = cells.rays[packet];
  Shears& shears = cells.shears[packet];
  if (!cells.sheared[packet]) derive_shears(rays, shears);
  cells.sheared[packet] = true;
  return cell_lanes(test_any(tree, rays, shears, packet_lanes(lanes, part), id), part);
}

// Thins triangles out for the rays of a tile. When one covers all of them, none is open any more.
static Cover choose_casters(const KdView& tree, const ShadowCells& cells, GlassRule glass,
                            const uint32_t* ids, int count, Casters& out) {
  out.count = 0;
  for (int g = 0; g < count; g += kLanes) {
    const int some = count - g < kLanes ? count - g : kLanes;
    if (add_casters(tree, *cells.frame, cells.starts, glass, ids + g, some, out) == Cover::all)
      return Cover::all;
  }
  return Cover::some;
}

// Tests the pairs of casters and cells. Returns the cells in which rays were blocked.
template <class Counts>
static uint64_t test_pairs(const KdView& tree, const Casters& casters, Pairs& pairs, int touched,
                           ShadowCells& cells, Counts counts) {
  uint64_t changed = 0;
  int unsure = 0;
  for (int p = 0; p < touched; ++p) {
    const uint32_t number = pairs.number[p];
    const int cell = static_cast<int>(number % kCells);
    counts.of(cell / kCellsOfPacket).test(packet_lanes(cells.live[cell], cell % kCellsOfPacket));
    cells.tested[cell] |= cells.live[cell];
    const Verdict v = judge(casters, static_cast<int>(number / kCells), cells, cell);
    cells.live[cell] &= ~v.blocked;
    changed |= static_cast<uint64_t>(v.blocked != 0) << cell;
    pairs.covered[unsure] = {number, v.unsure};
    unsure += v.unsure != 0;
  }
  for (int p = 0; p < unsure; ++p) {
    const Pair& pair = pairs.covered[p];
    const int cell = static_cast<int>(pair.number % kCells);
    const uint32_t lanes = pair.covered & cells.live[cell];
    if (lanes == 0) continue;
    const uint32_t met = test_exactly(tree, cells, cell, lanes, casters.id[pair.number / kCells]);
    cells.live[cell] &= ~met;
    changed |= static_cast<uint64_t>(met != 0) << cell;
  }
  return changed;
}

// Tests triangles with the rays that they may block.
template <class Counts>
static void meet(const KdView& tree, GlassRule glass, const uint32_t* ids, int count, ShadowCells& cells,
                 Counts counts) {
  const uint64_t mark = counts.mark();
  counts.group_test(count);
  share_work(mark, cells, counts);
  Casters casters;
  if (choose_casters(tree, cells, glass, ids, count, casters) == Cover::all) {
    for (uint32_t& live : cells.live) live = 0;
    cells.all_far = -kInfinity;
    return;
  }
  if (casters.count == 0) return;
  if (!cells.bounded) enter_cells(cells);
  Pairs pairs;
  const int touched = find_pairs(cells, casters, pairs.number);
  cells.effort += count + touched;
  uint64_t changed = test_pairs(tree, casters, pairs, touched, cells, counts);
  if (changed == 0) return;
  for (; changed != 0; changed &= changed - 1) bound_cell(cells, __builtin_ctzll(changed));
  bound_groups(cells);
}

}  // namespace VITRAL_ISA
}  // namespace vitral
