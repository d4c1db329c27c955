#include "kernels/reach.h"

#include "kernels/counts.h"
#include "kernels/lanes.h"
#include "kernels/meet.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

inline void set_component(Vec3& v, int axis, float x) {
  (axis == 0 ? v.x : axis == 1 ? v.y : v.z) = x;
}

}  // namespace

PlainBox start_of(const PointPacket* const* points, int count) {
  BoxLanes box = no_box();
  for (int i = 0; i < count; ++i) {
    const PointPacket& p = *points[i];
    for (int g = 0; g < kPacketSize; g += kLanes)
      extend(box, group_mask(p.live, g), load3(p.px, p.py, p.pz, g));
  }
  return box_of(box);
}

Reach reach_of(const KdView& tree, const PointPacket* const* points, int count, float distance) {
  Vec3T<Float> sum = splat({0, 0, 0});
  Float least_offset = Float(kInfinity), most_offset = Float(0.0f);
  const Float zero = Float(0.0f);
  for (int i = 0; i < count; ++i) {
    const PointPacket& p = *points[i];
    for (int g = 0; g < kPacketSize; g += kLanes) {
      const Mask live = group_mask(p.live, g);
      const Vec3T<Float> n = load3(p.gx, p.gy, p.gz, g);
      sum = sum + Vec3T<Float>{select(live, n.x, zero), select(live, n.y, zero), select(live, n.z, zero)};
      const Float offset = load(p.offset + g);
      least_offset = least(select(live, offset, least_offset), least_offset);
      most_offset = greatest(select(live, offset, most_offset), most_offset);
    }
  }
  Reach reach;
  reach.start = start_of(points, count);
  reach.radius = 0.50001f * length(extent(as_box(reach.start))) + greatest_lane(most_offset);
  reach.distance = distance;
  reach.magnitude = magnitude(as_box(reach.start));
  const float far = distance * 1.00001f + greatest_lane(most_offset);
  const float grow = far + traversal_slack(vitral::greatest(tree.magnitude, reach.magnitude + far));
  reach.box = {reach.start.min - Vec3{grow, grow, grow}, reach.start.max + Vec3{grow, grow, grow}};

  // Any unit vector would do; near the mean the planes of the points differ least from the common one.
  const Vec3 mean{sum_of_lanes(sum.x), sum_of_lanes(sum.y), sum_of_lanes(sum.z)};
  const float squared = dot(mean, mean);
  reach.normal = squared > 1e-6f ? mean * (1.0f / vitral::square_root(squared)) : Vec3{0, 0, 1};
  Float lowest = Float(kInfinity), deviation = zero;
  for (int i = 0; i < count; ++i) {
    const PointPacket& p = *points[i];
    for (int g = 0; g < kPacketSize; g += kLanes) {
      const Mask live = group_mask(p.live, g);
      const Float height = dot(load3(p.px, p.py, p.pz, g), splat(reach.normal));
      lowest = least(select(live, height, lowest), lowest);
      const Vec3T<Float> d = load3(p.gx, p.gy, p.gz, g) - splat(reach.normal);
      deviation = greatest(select(live, dot(d, d), deviation), deviation);
    }
  }
  reach.far = far;
  reach.tilt = vitral::square_root(greatest_lane(deviation)) * 1.00001f;
  reach.floor =
      least_lane(lowest) + least_lane(least_offset) - 3 * margin_of(reach.magnitude + far, distance);
  return reach;
}

Mask within(const Corners& t, const Reach& reach) {
  const Box box = as_box(reach.box);
  const auto overlap = [](Float x, Float y, Float z, float low, float high) {
    return both(greatest_of(x, y, z) >= Float(low), least_of(x, y, z) <= Float(high));
  };
  Mask wanted = overlap(t.a.x, t.b.x, t.c.x, box.min.x, box.max.x);
  wanted = both(wanted, overlap(t.a.y, t.b.y, t.c.y, box.min.y, box.max.y));
  wanted = both(wanted, overlap(t.a.z, t.b.z, t.c.z, box.min.z, box.max.z));
  const Vec3T<Float> n = splat(reach.normal);
  const Float height = greatest_of(dot(n, t.a), dot(n, t.b), dot(n, t.c));
  // What rounding does to the height, for any unit normal.
  const Float size = greatest_of(greatest_of(absolute(t.a.x), absolute(t.a.y), absolute(t.a.z)),
                                 greatest_of(absolute(t.b.x), absolute(t.b.y), absolute(t.b.z)),
                                 greatest_of(absolute(t.c.x), absolute(t.c.y), absolute(t.c.z)));
  // How far the triangle is at most from any point.
  const Vec3T<Float> middle = splat((box.min + box.max) * 0.5f);
  const Vec3T<Float> da = t.a - middle, db = t.b - middle, dc = t.c - middle;
  const Float away =
      square_root(greatest_of(dot(da, da), dot(db, db), dot(dc, dc))) * Float(1.00001f) + Float(reach.radius);
  const Float floor = Float(reach.floor) - least(away, Float(reach.far)) * Float(reach.tilt);
  return both(wanted, invert(height < floor - size * Float(1.0f / 262144)));
}

namespace {

// Of length 1, in double so that the normal of a sliver points the right way.
Vec3 plane_normal(const KdTriangle& t) {
  const auto corner = [&](int k) { return to_double(Vec3{t.corner[k][0], t.corner[k][1], t.corner[k][2]}); };
  return to_float(normalize(cross(corner(1) - corner(0), corner(2) - corner(0))));
}

// Adds those of up to kLanes triangles that are within reach.
void add(const KdView& tree, const Reach& reach, const uint32_t* ids, int count, Pool& out) {
  alignas(64) float corner[9][kLanes];
  alignas(64) uint32_t id[kLanes];
  for (int i = 0; i < kLanes; ++i) {
    id[i] = ids[i < count ? i : 0];
    const float* c = tree.triangles[id[i]].corner[0];
    for (int k = 0; k < 9; ++k) corner[k][i] = c[k];
  }
  const Corners t{{load(corner[0]), load(corner[1]), load(corner[2])},
                  {load(corner[3]), load(corner[4]), load(corner[5])},
                  {load(corner[6]), load(corner[7]), load(corner[8])}};
  const Mask wanted = both(within(t, reach), mask_of_bits((1ull << count) - 1));
  for (int k = 0; k < 9; ++k) compress(out.corner[k] + out.count, load(corner[k]), wanted);
  compress(out.id + out.count, load(id), wanted);
  for (uint32_t left = bits(wanted); left != 0; left &= left - 1)
    out.plane[out.count++] = plane_normal(tree.triangles[id[__builtin_ctz(left)]]);
}

// The cell of a node, as far as the reach's box goes, is it above the floor?
bool rises(const Box& cell, const Reach& reach) {
  float height = 0, size = 0;
  for (int a = 0; a < 3; ++a) {
    const float n = component(reach.normal, a);
    const float low = component(cell.min, a) * n, high = component(cell.max, a) * n;
    height += vitral::greatest(low, high);
    size += vitral::greatest(vitral::absolute(low), vitral::absolute(high));
  }
  return !(height < reach.floor - reach.tilt * reach.far - size * (1.0f / 1048576));
}

}  // namespace

uint32_t entry_node(const KdView& tree, const Box& box) {
  uint32_t node = 0;
  while (!is_leaf(tree.nodes[node])) {
    const KdNode& n = tree.nodes[node];
    const bool below = component(box.min, axis(n)) <= split(n),
               above = component(box.max, axis(n)) >= split(n);
    if (below && above) break;
    node = child(n) + (above ? 1u : 0u);
  }
  return node;
}

namespace {

// A node that waits, and the part of its cell that is within reach.
struct Waiting {
  PlainBox cell;
  uint32_t node;
};

template <class Counts>
struct Collector {
  static constexpr int kSeen = 1024;  // triangles met lately, so that few are taken twice
  const KdView& tree;
  const Reach& reach;
  Pool& out;
  Counts counts;
  float slack;
  int leaves, pending;
  uint32_t ids[kLanes], seen[kSeen];
};

template <class Counts>
void add_pending(Collector<Counts>& c) {
  c.counts.group_test(c.pending);
  if (c.pending > 0) add(c.tree, c.reach, c.ids, c.pending, c.out);
  c.pending = 0;
}

template <class Counts>
void add_leaf(const KdNode& leaf, Collector<Counts>& c) {
  c.counts.group_leaf();
  ++c.leaves;
  for (uint32_t i = 0; i < count(leaf); ++i) {
    const uint32_t id = c.tree.references[first_reference(leaf) + i];
    uint32_t& last = c.seen[id % Collector<Counts>::kSeen];
    if (last == id) continue;
    last = id;
    if (c.tree.triangles[id].flags & kGlassTriangle) continue;
    c.ids[c.pending++] = id;
    if (c.pending == kLanes) add_pending(c);
  }
}

// Seen from the blocks, is it small?
bool is_small(const PlainBox& cell, const Reach& reach, float small) {
  float squared = 0;
  for (int a = 0; a < 3; ++a) {
    const float before = component(reach.start.min, a) - component(cell.max, a),
                beyond = component(cell.min, a) - component(reach.start.max, a);
    const float apart = vitral::greatest(vitral::greatest(before, beyond), 0.0f);
    squared += apart * apart;
  }
  const float size = largest_component(cell.max - cell.min);
  return size * size < squared * (small * small);
}

// Walks from `from` to the leaves within reach, and takes their triangles. A node that looks small is taken
// as a whole.
template <class Counts>
Collected descend(Waiting from, float small, int most_leaves, Collector<Counts>& c) {
  Waiting stack[kMaxTreeDepth];
  int waiting = 0;
  for (;;) {
    c.counts.group_node();
    const KdNode& n = c.tree.nodes[from.node];
    if (is_leaf(n)) {
      if (c.leaves >= most_leaves || c.out.count > kMaxPool - 2 * kLanes) return Collected::too_many;
      add_leaf(n, c);
    } else if (is_small(from.cell, c.reach, small)) {
      if (c.out.nodes == kMaxNodes) return Collected::too_many;
      c.out.cell[c.out.nodes] = from.cell;
      c.out.node[c.out.nodes++] = from.node;
    } else {
      // A cell is as large as the planes above it say, and a little larger.
      const int a = axis(n);
      const float low = component(from.cell.min, a), high = component(from.cell.max, a), s = split(n);
      const bool below = low <= s, above = high >= s;
      Waiting upper{from.cell, child(n) + 1};
      set_component(upper.cell.min, a, vitral::greatest(low, s - c.slack));
      if (below) set_component(from.cell.max, a, vitral::least(high, s + c.slack));
      if (below && above) {
        if (rises(as_box(upper.cell), c.reach)) stack[waiting++] = upper;
        from.node = child(n);
      } else {
        if (!below) from.cell = upper.cell;
        from.node = child(n) + (below ? 0u : 1u);
        continue;
      }
      if (rises(as_box(from.cell), c.reach)) continue;
    }
    if (waiting == 0) return Collected::all;
    from = stack[--waiting];
  }
}

}  // namespace

template <class Counts>
Collected collect(const KdView& tree, const Reach& reach, const Effort& effort, Pool& out, Counts counts) {
  Collector<Counts> c{tree, reach, out, counts, 0, 0, 0, {}, {}};
  c.slack = traversal_slack(vitral::greatest(tree.magnitude, reach.magnitude + reach.distance));
  for (int i = 0; i < Collector<Counts>::kSeen; ++i) c.seen[i] = kNoTriangle;
  out.count = out.nodes = 0;
  const Waiting entry{reach.box, entry_node(tree, as_box(reach.box))};
  if (descend(entry, effort.small, effort.leaves, c) == Collected::too_many) return Collected::too_many;

  // While there is time, nodes are opened after all; one that has too much in it stays closed, with all
  // after.
  add_pending(c);
  int opened = 0;
  while (opened < out.nodes) {
    const int before = out.count;
    if (descend({out.cell[opened], out.node[opened]}, 0, effort.opened, c) == Collected::too_many) {
      out.count = before;
      break;
    }
    add_pending(c);
    ++opened;
  }
  out.nodes -= opened;
  for (int i = 0; i < out.nodes; ++i) out.cell[i] = out.cell[i + opened], out.node[i] = out.node[i + opened];
  return Collected::all;
}
template Collected collect(const KdView&, const Reach&, const Effort&, Pool&, NoCounts);
template Collected collect(const KdView&, const Reach&, const Effort&, Pool&, Counting);

}  // namespace VITRAL_ISA
}  // namespace vitral
