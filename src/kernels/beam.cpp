// The closest hits of a tile's camera rays, found together.
//
// The tile's rays are a thin pyramid. It walks the tree once, front to back, and what it meets in the leaves
// is tested with the rays that the triangle's outline can touch: first its rectangle in the plane of the rays
// (kernels/cells.h) with those of kLanes cells at a time, then the triangle with the rays of each cell
// that is left. A cell is done with all that lies behind the farthest of its rays' best hits, the tile with
// all behind that of all its cells.
//
// Nothing is skipped that could be an answer: all bounds give way by margins that cover every rounding, and
// what they leave open is decided by the exact test. So the answers are those of trace_closest.
#include "kernels/cells.h"
#include "kernels/counts.h"
#include "kernels/lanes.h"
#include "kernels/tables.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

// --- triangles -------------------------------------------------------------------------------------

inline Vec3T<Float> load_corner(const Batch& batch, int k, int g) {
  return {load(batch.corner[3 * k] + g), load(batch.corner[3 * k + 1] + g),
          load(batch.corner[3 * k + 2] + g)};
}

// Fetches triangles, and bounds them.
//
// Where a corner lies at (s, r) z, the exact test sees it at s z - sx z, off by 2^-24 (2 + |s|) z; s itself
// is computed with two roundings. A ray farther than 2^-20 outside in s finds all three corners on one side.
// A triangle that comes too near the origin's plane, or crosses it, has no bounds.
void fetch(const KdView& tree, const View& view, const uint32_t* ids, int count, Batch& batch) {
  batch.count = count;
  for (int i = 0; i < kBatch; ++i) {
    const uint32_t id = ids[i < count ? i : 0];
    const KdTriangle& t = tree.triangles[id];
    batch.id[i] = id, batch.flags[i] = t.flags;
    for (int k = 0; k < 3; ++k) {
      for (int a = 0; a < 3; ++a) batch.corner[3 * k + a][i] = t.corner[k][view.k[a]];
    }
  }
  for (int g = 0; g < count; g += kLanes) {
    Vec3T<Float> p[3];
    Vec3T<Float> low{Float(kInfinity), Float(kInfinity), Float(kInfinity)}, high = -low;
    Float x0 = Float(kInfinity), y0 = x0, x1 = Float(-kInfinity), y1 = x1;
    for (int k = 0; k < 3; ++k) {
      const Vec3T<Float> c = load_corner(batch, k, g);
      p[k] = {c.x - Float(view.o[0]), c.y - Float(view.o[1]), c.z - Float(view.o[2])};
      store(batch.corner[3 * k] + g, p[k].x), store(batch.corner[3 * k + 1] + g, p[k].y);
      store(batch.corner[3 * k + 2] + g, p[k].z);
      low = {least(p[k].x, low.x), least(p[k].y, low.y), least(p[k].z, low.z)};
      high = {greatest(p[k].x, high.x), greatest(p[k].y, high.y), greatest(p[k].z, high.z)};
      const Float r = Float(1.0f) / p[k].z, sx = p[k].x * r, sy = p[k].y * r;
      x0 = least(sx, x0), x1 = greatest(sx, x1), y0 = least(sy, y0), y1 = greatest(sy, y1);
    }
    const Float nearest = view.forward > 0 ? low.z : -high.z, farthest = view.forward > 0 ? high.z : -low.z;
    const Float magnitude = greatest(absolute(nearest), absolute(farthest));
    const Float reach = greatest_of(greatest(absolute(low.x), absolute(high.x)),
                                    greatest(absolute(low.y), absolute(high.y)), magnitude);
    const Float depth = farthest - nearest;
    const Float extent = (greatest(high.x - low.x, high.y - low.y) + depth) + reach * Float(0x1p-20f);
    const Float rounding = magnitude * Float(0x1p-20f) + Float(1e-36f), margin = Float(0x1p-20f);
    const Mask ahead = nearest > Float(0x1p-120f);
    const Mask behind = farthest + rounding < Float(view.before_all);
    const Float all = Float(kInfinity);
    store(batch.x0 + g, select(ahead, x0 - margin, -all)),
        store(batch.x1 + g, select(ahead, x1 + margin, all));
    store(batch.y0 + g, select(ahead, y0 - margin, -all)),
        store(batch.y1 + g, select(ahead, y1 + margin, all));
    store(batch.nearest + g, select(behind, all, nearest - rounding));
    store(batch.spread + g, extent * extent * depth * Float(0x1p-20f));
    store(batch.rounding + g, rounding);
    for (int k = 0; k < 3; ++k) {
      const Vec3T<Float> e = cross(p[k], p[(k + 1) % 3]);
      store(batch.edge[k].x + g, e.x), store(batch.edge[k].y + g, e.y), store(batch.edge[k].c + g, e.z);
    }
    store(batch.doubt + g, reach * reach * Float(0x1p-18f) + Float(1e-36f));
  }
}

// --- the beam --------------------------------------------------------------------------------------

// What the walk knows of the rays, axis by axis: at depth z they are between least * z and greatest * z.
struct Slopes {
  float least[3], greatest[3];
};

inline constexpr int kFewCells = 4;

struct alignas(64) Beam {
  View view;
  Slopes slopes;
  Rectangle4 group[kGroups];
  float group_far[kGroups], far;
  float slack;
  uint64_t shared;  // what was done for all rays together
  uint32_t tested[kCells];
};

float farthest_of(const float* far, int count) {
  Float most = Float(-kInfinity);
  for (int i = 0; i < count; i += kLanes) most = greatest(load(far + i), most);
  return greatest_lane(most);
}

float farthest_ray(const Cells& cells, int cell) {
  Float far = Float(-kInfinity);
  for (int g = 0; g < kCellSize; g += kLanes) {
    const Float high = load(cells.high + cell * kCellSize + g);
    far = greatest(select(mask_of_bits(cells.live[cell] >> g), high, far), far);
  }
  return greatest_lane(far);
}

// Triangles and the cells that they are to be tested with.
struct Pair {
  uint32_t number;   // kCells * triangle in the batch + cell
  uint32_t covered;  // rays of the cell that the triangle may surround
};
struct alignas(64) Pairs {
  uint32_t number[kBatch * kCells + kBatch];
  Pair covered[kBatch * kCells];
};

// The cells from `at` on through which a line through an edge of triangle i passes, or that lie on the same
// side of all three.
inline Mask within_edges(const Cells& cells, int at, const Batch& batch, int i) {
  const float *x[2] = {cells.x0 + at, cells.x1 + at}, *y[2] = {cells.y0 + at, cells.y1 + at};
  Float highest = Float(-kInfinity), lowest = Float(kInfinity);
  for (int k = 0; k < 3; ++k) {
    const float ex = batch.edge[k].x[i], ey = batch.edge[k].y[i];
    const Float c = Float(batch.edge[k].c[i]);
    const Float least_e = (Float(ex) * load(x[ex < 0]) + Float(ey) * load(y[ey < 0])) + c;
    const Float greatest_e = (Float(ex) * load(x[!(ex < 0)]) + Float(ey) * load(y[!(ey < 0)])) + c;
    highest = greatest(least_e, highest), lowest = least(greatest_e, lowest);
  }
  const Float doubt = Float(batch.doubt[i]);
  return invert(both(highest > doubt, lowest < -doubt));
}

// Appends the pairs of triangle i of the batch and cells of a group that it can touch.
inline int add_touched(const Cells& cells, int group, const Batch& batch, int i, uint32_t* pairs, int count) {
  const Float x0 = Float(batch.x0[i]), x1 = Float(batch.x1[i]), y0 = Float(batch.y0[i]),
              y1 = Float(batch.y1[i]);
  const Float nearest = Float(batch.nearest[i]);
  for (int g = 0; g < kCellsOfGroup; g += kLanes) {
    const int at = group * kCellsOfGroup + g;
    Mask m = both(both(both(x0 <= load(cells.x1 + at), x1 >= load(cells.x0 + at)),
                       both(y0 <= load(cells.y1 + at), y1 >= load(cells.y0 + at))),
                  nearest <= load(cells.far + at));
    if (__builtin_popcount(bits(m)) > kFewCells) m = both(m, within_edges(cells, at, batch, i));
    compress(pairs + count, lane_numbers() + Uint(static_cast<uint32_t>(kCells * i + at)), m);
    count += __builtin_popcount(bits(m));
  }
  return count;
}

int find_pairs(const Beam& beam, const Cells& cells, const Batch& batch, uint32_t* pairs) {
  int count = 0;
  for (int group = 0; group < kGroups; ++group) {
    const Rectangle4& r = beam.group[group];
    uint32_t wanted = 0;
    for (int g = 0; g < kBatch; g += kLanes) {
      const Mask m = both(both(both(load(batch.x0 + g) <= Float(r.x1), load(batch.x1 + g) >= Float(r.x0)),
                               both(load(batch.y0 + g) <= Float(r.y1), load(batch.y1 + g) >= Float(r.y0))),
                          load(batch.nearest + g) <= Float(beam.group_far[group]));
      wanted |= bits(m) << g;
    }
    wanted &= (1u << batch.count) - 1;
    for (; wanted != 0; wanted &= wanted - 1)
      count = add_touched(cells, group, batch, __builtin_ctz(wanted), pairs, count);
  }
  return count;
}

// Tests triangles with the rays that they can touch. First all pairs are found, then those with rays that the
// triangle may surround, then these are tested: three loops without a choice that a processor could get
// wrong.
template <class Counts>
void meet(const KdView& tree, const uint32_t* ids, int count, Beam& beam, Cells& cells, Counts counts) {
  Batch batch;
  fetch(tree, beam.view, ids, count, batch);
  counts.group_test(count);
  beam.shared += static_cast<uint64_t>(count);
  Pairs pairs;
  const int touched = find_pairs(beam, cells, batch, pairs.number);
  int found = 0;
  for (int p = 0; p < touched; ++p) {
    const uint32_t number = pairs.number[p];
    const int cell = static_cast<int>(number % kCells);
    counts.of(cell / kCellsOfPacket).test(packet_lanes(cells.live[cell], cell % kCellsOfPacket));
    const uint32_t covered = covered_lanes(cells, cell, batch, static_cast<int>(number / kCells));
    pairs.covered[found] = {number, covered};
    found += covered != 0;
  }
  uint64_t changed = 0;
  for (int p = 0; p < found; ++p) {
    const uint32_t number = pairs.covered[p].number;
    const int cell = static_cast<int>(number % kCells);
    if (meet_cell(tree, beam.view, batch, static_cast<int>(number / kCells), cell, pairs.covered[p].covered,
                  cells))
      changed |= 1ull << cell;
  }
  if (changed == 0) return;
  for (uint64_t left = changed; left != 0; left &= left - 1) {
    const int cell = __builtin_ctzll(left);
    cells.far[cell] = farthest_ray(cells, cell);
  }
  for (int group = 0; group < kGroups; ++group)
    beam.group_far[group] = farthest_of(cells.far + group * kCellsOfGroup, kCellsOfGroup);
  beam.far = vitral::greatest(vitral::greatest(beam.group_far[0], beam.group_far[1]),
                              vitral::greatest(beam.group_far[2], beam.group_far[3]));
}

// --- the walk --------------------------------------------------------------------------------------

// A part of the beam: the depths between which it is in a node's box, and that box, relative to the origin.
struct Part {
  float z0, z1;
  float bound[2][3];  // least, greatest
};

// The whole tree's; z0 > z1 when the beam misses it.
Part whole_part(const KdView& tree, const Beam& beam) {
  const View& v = beam.view;
  Part p;
  for (int a = 0; a < 3; ++a) {
    p.bound[0][v.k[a]] = component(tree.bounds.min, v.k[a]) - v.o[a];
    p.bound[1][v.k[a]] = component(tree.bounds.max, v.k[a]) - v.o[a];
  }
  const float low = p.bound[0][v.k[2]] - beam.slack, high = p.bound[1][v.k[2]] + beam.slack;
  p.z0 = vitral::greatest(v.forward > 0 ? low : -high, 0.0f), p.z1 = v.forward > 0 ? high : -low;
  for (int a = 0; a < 2; ++a) {
    const int k = v.k[a];
    const float least_s = beam.slopes.least[k], greatest_s = beam.slopes.greatest[k];
    const float below = least_s * (least_s < 0 ? p.z1 : p.z0),
                above = greatest_s * (greatest_s > 0 ? p.z1 : p.z0);
    if (below > p.bound[1][k] + beam.slack || above < p.bound[0][k] - beam.slack) p.z1 = -1;
  }
  return p;
}

// Of a node that will be visited later.
inline void prefetch_below(const KdView& tree, const KdNode& n) {
  const void* const children = tree.nodes + child(n);
  const void* const references = tree.references + first_reference(n);
  __builtin_prefetch(is_leaf(n) ? references : children);
}

// Does any ray pass through the part of the beam, for which it still matters what is there?
bool is_wanted(const Beam& beam, const Cells& cells, const Part& part) {
  if (!(part.z0 > 0)) return true;
  const View& v = beam.view;
  const float r0 = v.forward / part.z0, r1 = v.forward / part.z1;
  float low[2], high[2];
  for (int a = 0; a < 2; ++a) {
    const float least_x = part.bound[0][v.k[a]] - beam.slack, greatest_x = part.bound[1][v.k[a]] + beam.slack;
    const float one = least_x * (least_x < 0 ? r0 : r1), other = greatest_x * (greatest_x > 0 ? r0 : r1);
    low[a] = vitral::least(one, other), high[a] = vitral::greatest(one, other);
  }
  const Float x0 = Float(low[0]), x1 = Float(high[0]), y0 = Float(low[1]), y1 = Float(high[1]);
  const Float z0 = Float(part.z0);
  uint64_t open = 0;
  for (int at = 0; at < kCells; at += kLanes) {
    const Mask m = both(both(both(x0 <= load(cells.x1 + at), x1 >= load(cells.x0 + at)),
                             both(y0 <= load(cells.y1 + at), y1 >= load(cells.y0 + at))),
                        z0 <= load(cells.far + at));
    open |= static_cast<uint64_t>(bits(m)) << at;
  }
  if (__builtin_popcountll(open) > kFewCells) return true;
  for (; open != 0; open &= open - 1) {
    const int cell = __builtin_ctzll(open);
    uint32_t through = 0;
    for (int g = 0; g < kCellSize; g += kLanes) {
      const int at = cell * kCellSize + g;
      const Float x = load(cells.sx + at), y = load(cells.sy + at);
      const Mask m = both(both(both(x0 <= x, x1 >= x), both(y0 <= y, y1 >= y)), z0 <= load(cells.high + at));
      through |= bits(m) << g;
    }
    if ((through & cells.live[cell]) != 0) return true;
  }
  return false;
}

// Walks the tree with the beam: the child that holds the origin's side of a plane comes first, so that cells
// come in order of depth. A cell is skipped when the beam surely is not in it, grown by the slack, at any
// depth where it still matters.
template <class Counts>
void walk(const KdView& tree, Beam& beam, Cells& cells, Counts counts) {
  Part now = whole_part(tree, beam);
  if (!(now.z0 <= now.z1)) return;
  float origin[3];
  for (int a = 0; a < 3; ++a) origin[beam.view.k[a]] = beam.view.o[a];
  constexpr int kSeen = 1024;  // triangles met lately: all rays have been tested that they can touch
  uint32_t seen[kSeen];
  for (int i = 0; i < kSeen; ++i) seen[i] = kNoTriangle;
  uint32_t ids[kBatch];
  int pending = 0;
  struct Waiting {
    uint32_t node;
    Part part;
  } stack[kMaxTreeDepth];
  int waiting = 0;
  uint32_t node = 0;
  for (;;) {
    while (!is_leaf(tree.nodes[node])) {
      counts.group_node(), ++beam.shared;
      const KdNode& n = tree.nodes[node];
      const int a = axis(n);
      // Mirrored so that the origin is below the plane.
      const float at = split(n) - origin[a];
      float plane = at, least_s = beam.slopes.least[a], greatest_s = beam.slopes.greatest[a];
      uint32_t above = 0;  // the near child is
      if (plane < 0) {
        plane = -plane, above = 1;
        const float s = least_s;
        least_s = -greatest_s, greatest_s = -s;
      }
      const uint32_t near = child(n) + above, far = near ^ 1;
      const float low = least_s * (least_s < 0 ? now.z1 : now.z0);
      const float high = greatest_s * (greatest_s > 0 ? now.z1 : now.z0);
      if (high < plane - beam.slack) {
        node = near;
      } else if (low > plane + beam.slack) {
        node = far;
        now.bound[above][a] = at;
        continue;
      } else {
        Waiting& w = stack[waiting++];
        w = {far, now};
        w.part.bound[above][a] = at;
        if (greatest_s > 0) w.part.z0 = vitral::greatest((plane - beam.slack) / greatest_s, now.z0);
        if (least_s > 0) now.z1 = vitral::least((plane + beam.slack) / least_s, now.z1);
        prefetch_below(tree, tree.nodes[far]);
        node = near;
      }
      now.bound[1 - above][a] = at;
    }

    counts.group_node(), counts.group_leaf(), ++beam.shared;
    const KdNode& leaf = tree.nodes[node];
    for (uint32_t i = 0; i < count(leaf); ++i) {
      const uint32_t id = tree.references[first_reference(leaf) + i];
      __builtin_prefetch(&tree.triangles[id]);
      ids[pending] = id;
      pending += seen[id % kSeen] != id;
      seen[id % kSeen] = id;
      if (pending < kBatch) continue;
      meet(tree, ids, pending, beam, cells, counts);
      pending = 0;
    }
    do {
      if (waiting == 0) {
        if (pending > 0) meet(tree, ids, pending, beam, cells, counts);
        return;
      }
      --waiting;
      node = stack[waiting].node, now = stack[waiting].part;
    } while (beam.far < now.z0 || !is_wanted(beam, cells, now));
    now.z1 = vitral::least(now.z1, beam.far);
  }
}

// --- a tile ----------------------------------------------------------------------------------------

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

void enter_cells(const RayPacket* rays, const Shears* shears, int count, Cells& cells) {
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

// Takes the rays of `lanes` for live, and bounds them and their cells. Those of other packets have no rays.
void aim(const uint64_t* lanes, int count, Cells& cells, Beam& beam) {
  float least_length = kInfinity, greatest_length = 0;
  Rectangle4 all{kInfinity, -kInfinity, kInfinity, -kInfinity};
  for (int group = 0; group < kGroups; ++group) beam.group[group] = all;
  for (int cell = 0; cell < kCells; ++cell) {
    const int packet = cell / kCellsOfPacket;
    const uint32_t live = packet < count ? cell_lanes(lanes[packet], cell % kCellsOfPacket) : 0;
    cells.live[cell] = live, cells.pending[cell] = 0;
    Rectangle4 r{kInfinity, -kInfinity, kInfinity, -kInfinity};
    cells.far[cell] = -kInfinity;
    if (live != 0) {
      Float x0 = Float(kInfinity), x1 = -x0, y0 = x0, y1 = x1, l0 = x0, l1 = x1;
      for (int g = 0; g < kCellSize; g += kLanes) {
        const int at = cell * kCellSize + g;
        const Mask m = mask_of_bits(live >> g);
        const Float x = load(cells.sx + at), y = load(cells.sy + at), length = load(cells.length + at);
        x0 = least(select(m, x, x0), x0), x1 = greatest(select(m, x, x1), x1);
        y0 = least(select(m, y, y0), y0), y1 = greatest(select(m, y, y1), y1);
        l0 = least(select(m, length, l0), l0), l1 = greatest(select(m, length, l1), l1);
      }
      r = {least_lane(x0), greatest_lane(x1), least_lane(y0), greatest_lane(y1)};
      least_length = vitral::least(least_lane(l0), least_length);
      greatest_length = vitral::greatest(greatest_lane(l1), greatest_length);
      cells.far[cell] = farthest_ray(cells, cell);
    }
    cells.x0[cell] = r.x0, cells.x1[cell] = r.x1, cells.y0[cell] = r.y0, cells.y1[cell] = r.y1;
    Rectangle4& g = beam.group[cell / kCellsOfGroup];
    g = {vitral::least(r.x0, g.x0), vitral::greatest(r.x1, g.x1), vitral::least(r.y0, g.y0),
         vitral::greatest(r.y1, g.y1)};
    all = {vitral::least(r.x0, all.x0), vitral::greatest(r.x1, all.x1), vitral::least(r.y0, all.y0),
           vitral::greatest(r.y1, all.y1)};
  }
  for (int group = 0; group < kGroups; ++group)
    beam.group_far[group] = farthest_of(cells.far + group * kCellsOfGroup, kCellsOfGroup);
  beam.far = vitral::greatest(vitral::greatest(beam.group_far[0], beam.group_far[1]),
                              vitral::greatest(beam.group_far[2], beam.group_far[3]));

  View& v = beam.view;
  v.before_all = v.tmin * least_length * (1 - 0x1p-20f) - 1e-36f;
  v.in_all = v.tmin * greatest_length * (1 + 0x1p-20f) + 1e-36f;
  const float s = v.forward;
  beam.slopes.least[v.k[0]] = s > 0 ? all.x0 : -all.x1,
  beam.slopes.greatest[v.k[0]] = s > 0 ? all.x1 : -all.x0;
  beam.slopes.least[v.k[1]] = s > 0 ? all.y0 : -all.y1,
  beam.slopes.greatest[v.k[1]] = s > 0 ? all.y1 : -all.y0;
  beam.slopes.least[v.k[2]] = beam.slopes.greatest[v.k[2]] = s;
}

// The rays of one sense of one axis.
template <class Counts>
void trace_beam(const KdView& tree, const uint64_t* lanes, int count, Beam& beam, Cells& cells,
                Counts counts) {
  aim(lanes, count, cells, beam);
  beam.shared = 0;
  walk(tree, beam, cells, counts);
  for (int cell = 0; cell < count * kCellsOfPacket; ++cell) {
    if (cells.pending[cell] != 0) settle(tree, beam.view, cells, cell, cells.pending[cell]);
  }
  counts.share(counts.mark() - beam.shared, count, [&](int i) { return lanes[i]; });
}

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
  for (int z = 0; z < 3; ++z) {
    for (int sense = 0; sense < 2; ++sense) {
      uint64_t lanes[kMaxPackets], some = 0;
      for (int i = 0; i < count; ++i) {
        uint64_t forward = 0;
        for (int g = 0; g < kPacketSize; g += kLanes)
          forward |= static_cast<uint64_t>(bits(load(shears[i].sz + g) > Float(0.0f))) << g;
        lanes[i] = shears[i].traceable & shears[i].z_is[z] & (sense == 0 ? forward : ~forward);
        some |= lanes[i];
        counts.of(i).trace(lanes[i]);
      }
      if (some == 0) continue;
      View& v = beam.view;
      for (int a = 0; a < 3; ++a) {
        v.k[a] = (z + 1 + a) % 3;
        v.o[a] = component(origin, v.k[a]);
      }
      v.forward = sense == 0 ? 1.0f : -1.0f;
      trace_beam(tree, lanes, count, beam, cells, counts);
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
