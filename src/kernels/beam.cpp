// The closest hits of a tile's camera rays, found together.
//
// The tile's rays are a thin pyramid. It walks the tree once, front to back, and what it meets in the leaves
// is tested with the rays that the triangle's outline can touch: first its rectangle in the plane of the rays
// (kernels/batch.h) with those of kLanes cells at a time, then the triangle with the rays of each cell
// that is left. A cell is done with all that lies behind the farthest of its rays' best hits, the tile with
// all behind that of all its cells.
//
// Nothing is skipped that could be an answer: all bounds give way by margins that cover every rounding, and
// what they leave open is decided by the exact test. So the answers are those of trace_closest.
#include "kernels/beam.h"
#include "kernels/lanes.h"
#include "kernels/tables.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

// Do all rays that can be traced start in the same point and at the same tmin?
bool share_origin(const RayPacket* rays, const Shears* shears, int count, Vec3& origin, float& tmin) {
  int first = 0;
  while (first < count && shears[first].traceable == 0) ++first;
  if (first == count) return false;
  const int lane = __builtin_ctzll(shears[first].traceable);
  const RayPacket& p = rays[first];
  origin = {p.ox[lane], p.oy[lane], p.oz[lane]}, tmin = p.tmin;
  if (!(tmin >= 0)) return false;
  for (int i = first; i < count; ++i) {
    if (shears[i].traceable == 0) continue;
    if (rays[i].tmin != tmin) return false;
    for (int g = 0; g < kPacketSize; g += kLanes) {
      const Mask same =
          both(both(load(rays[i].ox + g) == Float(origin.x), load(rays[i].oy + g) == Float(origin.y)),
               load(rays[i].oz + g) == Float(origin.z));
      if (any(both(invert(same), group_mask(shears[i].traceable, g)))) return false;
    }
  }
  return true;
}

// Brings the rays to the cells; they have met nothing yet.
void enter_cells(const RayPacket* rays, const Shears* shears, int count, Cells& cells) {
  cells.packets = count;
  for (int i = 0; i < count; ++i) {
    const int at = i * kPacketSize;
    copy_to_cells(shears[i].sx, cells.sx + at);
    copy_to_cells(shears[i].sy, cells.sy + at);
    copy_to_cells(shears[i].sz, cells.length + at);
    copy_to_cells(rays[i].tmax, cells.tmax + at);
  }
  for (int at = 0; at < count * kPacketSize; at += kLanes) {
    const Float length = absolute(load(cells.length + at)), most = load(cells.tmax + at) * length;
    store(cells.length + at, length);
    store(cells.low + at, most * Float(1 - 0x1p-21f)), store(cells.high + at, most * Float(1 + 0x1p-21f));
    store(cells.t + at, Float(kInfinity));
    store(cells.u + at, Float(0.0f)), store(cells.v + at, Float(0.0f));
    store(cells.id + at, Uint(kNoTriangle));
  }
}

// Bounds of a cell's live rays.
Rectangle4 bounds_of(const Cells& cells, int cell) {
  Float x0 = Float(kInfinity), x1 = -x0, y0 = x0, y1 = x1;
  for (int g = 0; g < kCellSize; g += kLanes) {
    const Mask m = mask_of_bits(cells.live[cell] >> g);
    const Float x = load(cells.sx + cell * kCellSize + g), y = load(cells.sy + cell * kCellSize + g);
    x0 = least(select(m, x, x0), x0), x1 = greatest(select(m, x, x1), x1);
    y0 = least(select(m, y, y0), y0), y1 = greatest(select(m, y, y1), y1);
  }
  return {least_lane(x0), greatest_lane(x1), least_lane(y0), greatest_lane(y1)};
}

// Takes the rays of `lanes` for live, and bounds their cells and groups of cells. Returns the bounds of all.
Rectangle4 set_live(const uint64_t* lanes, int count, Cells& cells) {
  Rectangle4 all = kNothing;
  for (int group = 0; group < kGroups; ++group) {
    cells.group[group] = kNothing;
    for (int cell = group * kCellsOfGroup; cell < (group + 1) * kCellsOfGroup; ++cell) {
      const int packet = cell / kCellsOfPacket;
      const uint32_t live = packet < count ? cell_lanes(lanes[packet], cell % kCellsOfPacket) : 0;
      cells.live[cell] = live, cells.pending[cell] = 0, cells.far[cell] = -kInfinity;
      Rectangle4 r = kNothing;
      if (live != 0) {
        r = bounds_of(cells, cell);
        cells.far[cell] = farthest_ray(cells, cell);
      }
      cells.x0[cell] = r.x0, cells.x1[cell] = r.x1, cells.y0[cell] = r.y0, cells.y1[cell] = r.y1;
      cells.group[group] = join(cells.group[group], r);
    }
    all = join(all, cells.group[group]);
  }
  set_far(cells, 0);
  return all;
}

// Points the beam at the live rays.
void aim(const Vec3& origin, int z_axis, float forward, const Rectangle4& bounds, const Cells& cells,
         Beam& beam) {
  View& v = beam.view;
  v.forward = forward;
  for (int a = 0; a < 3; ++a) {
    v.k[a] = (z_axis + 1 + a) % 3;
    v.o[a] = component(origin, v.k[a]);
    beam.origin[a] = component(origin, a);
  }
  Float least_length = Float(kInfinity), greatest_length = Float(0.0f);
  for (int at = 0; at < kRays; at += kLanes) {
    const Mask m = mask_of_bits(cells.live[at / kCellSize] >> at % kCellSize);
    if (!any(m)) continue;
    const Float length = load(cells.length + at);
    least_length = least(select(m, length, least_length), least_length);
    greatest_length = greatest(select(m, length, greatest_length), greatest_length);
  }
  v.before_all = v.tmin * least_lane(least_length) * (1 - 0x1p-20f) - 1e-36f;
  v.in_all = v.tmin * greatest_lane(greatest_length) * (1 + 0x1p-20f) + 1e-36f;
  const float low[3] = {forward > 0 ? bounds.x0 : -bounds.x1, forward > 0 ? bounds.y0 : -bounds.y1, forward};
  const float high[3] = {forward > 0 ? bounds.x1 : -bounds.x0, forward > 0 ? bounds.y1 : -bounds.y0, forward};
  for (int a = 0; a < 3; ++a) beam.least[v.k[a]] = low[a], beam.greatest[v.k[a]] = high[a];
}

// The rays of each sense of each axis in turn. Returns false when the rays do not start in one point.
template <class Counts>
bool trace_tile(const KdView& tree, const RayPacket* rays, int count, HitPacket* hits, Counts counts) {
  Shears shears[kMaxPackets];
  for (int i = 0; i < count; ++i) derive_shears(rays[i], shears[i]);
  Vec3 origin;
  Beam beam;
  if (!share_origin(rays, shears, count, origin, beam.view.tmin)) return false;
  beam.slack = traversal_slack(vitral::greatest(tree.magnitude, largest_component(origin)));
  Cells cells;
  enter_cells(rays, shears, count, cells);
  for (int side = 0; side < 6; ++side) {
    const int z = side / 2;
    const float forward = side % 2 == 0 ? 1.0f : -1.0f;
    uint64_t lanes[kMaxPackets], some = 0;
    for (int i = 0; i < count; ++i) {
      uint64_t same = 0;
      for (int g = 0; g < kPacketSize; g += kLanes)
        same |= static_cast<uint64_t>(bits(load(shears[i].sz + g) * Float(forward) > Float(0.0f))) << g;
      lanes[i] = shears[i].traceable & shears[i].z_is[z] & same;
      some |= lanes[i];
      counts.of(i).trace(lanes[i]);
    }
    if (some == 0) continue;
    const Rectangle4 bounds = set_live(lanes, count, cells);
    aim(origin, z, forward, bounds, cells, beam);
    walk_beam(tree, beam, cells, counts);
    for (int cell = 0; cell < kCells; ++cell) {
      if (cells.pending[cell] != 0) settle(tree, beam.view, cells, cell, cells.pending[cell]);
    }
  }
  for (int i = 0; i < count; ++i) {
    const int at = i * kPacketSize;
    copy_to_packet(cells.t + at, hits[i].t), copy_to_packet(cells.u + at, hits[i].u);
    copy_to_packet(cells.v + at, hits[i].v), copy_to_packet(cells.id + at, hits[i].triangle);
  }
  return true;
}

}  // namespace

#ifdef VITRAL_COUNTED

void count_closest_blocks(const KdView& tree, const RayPacket* rays, int count, Shortcuts shortcuts,
                          HitPacket* hits, const WorkCounts& work) {
  if (shortcuts == Shortcuts::taken && trace_tile(tree, rays, count, hits, Counting{work.totals, work.work}))
    return;
  for (int i = 0; i < count; ++i)
    count_closest(tree, rays[i], hits[i], {work.totals, work.work ? work.work + i : nullptr});
}

#else

void closest_blocks(const KdView& tree, const RayPacket* rays, int count, Shortcuts shortcuts,
                    HitPacket* hits) {
  if (shortcuts == Shortcuts::taken && trace_tile(tree, rays, count, hits, NoCounts{})) return;
  for (int i = 0; i < count; ++i) trace_closest(tree, rays[i], hits[i]);
}

#endif

}  // namespace VITRAL_ISA
}  // namespace vitral
