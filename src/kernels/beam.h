// A beam walks the tree: all rays from one point that run fastest along the same axis, front to back.
#pragma once
#include "kernels/counts.h"
#include "kernels/tile_walk.h"

namespace vitral {
namespace VITRAL_ISA {

struct Beam {
  View view;
  // Axis by axis: at depth z the rays are between least * z and greatest * z.
  float least[3], greatest[3];
  float origin[3];
  float slack;
};

// The whole tree's; z0 > z1 when the beam misses it.
static inline Part whole_part(const KdView& tree, const Beam& beam) {
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
    const float least_s = beam.least[k], greatest_s = beam.greatest[k];
    const float below = least_s * (least_s < 0 ? p.z1 : p.z0),
                above = greatest_s * (greatest_s > 0 ? p.z1 : p.z0);
    if (below > p.bound[1][k] + beam.slack || above < p.bound[0][k] - beam.slack) p.z1 = -1;
  }
  return p;
}

// Does any ray pass through the part of the beam, for which it still matters what is there? In the plane of
// the rays a box is at most as wide as its near or far end; the slack covers the roundings of that, too.
// Where triangles are smaller than a pixel most nodes lie between the rays.
static inline bool is_wanted(const Beam& beam, const Cells& cells, const Part& part) {
  if (!(part.z0 > 0)) return true;
  const View& v = beam.view;
  const float r0 = v.forward / part.z0, r1 = v.forward / part.z1;
  float low[2], high[2];
  for (int a = 0; a < 2; ++a) {
    const float least_x = part.bound[0][v.k[a]] - beam.slack, greatest_x = part.bound[1][v.k[a]] + beam.slack;
    const float one = least_x * (least_x < 0 ? r0 : r1), other = greatest_x * (greatest_x > 0 ? r0 : r1);
    low[a] = vitral::least(one, other), high[a] = vitral::greatest(one, other);
  }
  const Rectangles bounds{Float(low[0]), Float(high[0]), Float(low[1]), Float(high[1])};
  const Float z0 = Float(part.z0);
  uint64_t open = 0;
  for (int at = 0; at < kCells; at += kLanes) {
    const Mask m = both(overlap(bounds, cell_bounds(cells, at)), z0 <= load(cells.far + at));
    open |= static_cast<uint64_t>(bits(m)) << at;
  }
  return any_ray_passes(cells, open, [&](int at) {
    const Float x = load(cells.sx + at), y = load(cells.sy + at);
    return both(overlap(bounds, {x, x, y, y}), z0 <= load(cells.high + at));
  });
}

// Goes on from a node to the leaf nearest to the origin. The child on the origin's side of a plane comes
// first, so that leaves come in order of depth; the other waits, unless the beam, grown by the slack, surely
// is on one side only.
template <class Counts>
static uint32_t descend(const KdView& tree, const Beam& beam, uint32_t node, Part& now, Waiting* stack,
                        int& waiting, Counts counts) {
  while (!is_leaf(tree.nodes[node])) {
    counts.group_node();
    const KdNode& n = tree.nodes[node];
    const int a = axis(n);
    // Mirrored so that the origin is below the plane.
    const float at = split(n) - beam.origin[a];
    float plane = at, least_s = beam.least[a], greatest_s = beam.greatest[a];
    uint32_t above = 0;  // the near child is
    if (plane < 0) {
      plane = -plane, above = 1;
      const float s = least_s;
      least_s = -greatest_s, greatest_s = -s;
    }
    const uint32_t near = child(n) + above, far = near ^ 1;
    const float low = least_s * (least_s < 0 ? now.z1 : now.z0);
    const float high = greatest_s * (greatest_s > 0 ? now.z1 : now.z0);
    if (low > plane + beam.slack) {
      node = far;
      now.bound[above][a] = at;
      continue;
    }
    if (!(high < plane - beam.slack)) {
      Waiting& w = stack[waiting++];
      w = {far, now};
      w.part.bound[above][a] = at;
      if (greatest_s > 0) w.part.z0 = vitral::greatest((plane - beam.slack) / greatest_s, now.z0);
      if (least_s > 0) now.z1 = vitral::least((plane + beam.slack) / least_s, now.z1);
      prefetch_below(tree, tree.nodes[far]);
    }
    node = near;
    now.bound[1 - above][a] = at;
  }
  counts.group_node(), counts.group_leaf();
  return node;
}

// Walks the tree with the beam, front to back, and tests what stands in the leaves. A node is skipped when no
// ray passes through it for which it still matters.
template <class Counts>
static void walk_beam(const KdView& tree, const Beam& beam, Cells& cells, Counts counts) {
  walk_tile(
      tree, whole_part(tree, beam),
      [&](uint32_t node, Part& now, Waiting* stack, int& waiting) {
        const uint64_t mark = counts.mark();
        const uint32_t leaf = descend(tree, beam, node, now, stack, waiting, counts);
        share_work(mark, cells, counts);
        return leaf;
      },
      [&](const uint32_t* ids, int count) {
        meet(tree, beam.view, ids, count, cells, counts);
        return Use::more;
      },
      [&](Part& now) {
        if (cells.all_far < now.z0 || !is_wanted(beam, cells, now)) return false;
        now.z1 = vitral::least(now.z1, cells.all_far);
        return true;
      });
}

}  // namespace VITRAL_ISA
}  // namespace vitral
