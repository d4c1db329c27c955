// The way of a tile's shadow rays through the tree.
#pragma once
#include "kernels/counts.h"
#include "kernels/shadow_cells.h"
#include "kernels/tile_walk.h"

namespace vitral {
namespace VITRAL_ISA {

// The rays of a tile: at depth z, axis by axis, they are between low + slope z and high + slope z.
struct Shaft {
  float low[3], high[3];
  float reciprocal[3];  // of the slope, safe
  float give[3];        // in depth, for the slack
  float reference[3];
};

// Twice the slack that the walk of one ray has: as much again covers the roundings here, each of at most
// 2^-23 of the coordinates, of which there are fewer than ten in a depth.
static Shaft make_shaft(const KdView& tree, const LightFrame& frame, const Starts& starts, float reach) {
  Shaft s;
  const float slack = 2 * traversal_slack(vitral::greatest(tree.magnitude, reach));
  const float slope[2] = {frame.sx * frame.forward, frame.sy * frame.forward};
  const int k[3] = {frame.kx, frame.ky, frame.kz};
  s.low[k[0]] = starts.bounds.x0, s.high[k[0]] = starts.bounds.x1;
  s.low[k[1]] = starts.bounds.y0, s.high[k[1]] = starts.bounds.y1;
  s.low[k[2]] = s.high[k[2]] = 0;
  s.reciprocal[k[0]] = safe_reciprocal(slope[0]), s.reciprocal[k[1]] = safe_reciprocal(slope[1]);
  s.reciprocal[k[2]] = frame.forward;
  for (int a = 0; a < 3; ++a) {
    s.give[a] = slack * vitral::absolute(s.reciprocal[a]);
    s.reference[a] = component(frame.reference, a);
  }
  return s;
}

// The whole tree's; z0 > z1 when the rays miss it.
static Part whole_part(const KdView& tree, const Shaft& shaft, const LightFrame& frame,
                       const Starts& starts) {
  Part p;
  p.z0 = starts.least_z - shaft.give[frame.kz], p.z1 = kInfinity;
  for (int a = 0; a < 3; ++a) {
    p.bound[0][a] = component(tree.bounds.min, a) - shaft.reference[a];
    p.bound[1][a] = component(tree.bounds.max, a) - shaft.reference[a];
    const float r = shaft.reciprocal[a];
    const float enter = r > 0 ? (p.bound[0][a] - shaft.high[a]) * r : (p.bound[1][a] - shaft.low[a]) * r;
    const float leave = r > 0 ? (p.bound[1][a] - shaft.low[a]) * r : (p.bound[0][a] - shaft.high[a]) * r;
    p.z0 = vitral::greatest(enter - shaft.give[a], p.z0), p.z1 = vitral::least(leave + shaft.give[a], p.z1);
  }
  return p;
}

// Does any open ray pass through the part? A cell's rays do between the depth at which the first of them
// comes to the near planes of the box and that at which the last comes to the far ones, and none does if
// these depths are in the wrong order. Where few cells are left it is asked of each ray.
static bool is_wanted(const Shaft& shaft, const LightFrame& frame, const ShadowCells& cells,
                      const Part& part) {
  if (!cells.bounded) return true;
  const int k[2] = {frame.kx, frame.ky};
  float enter[2], leave[2], r[2], give[2];
  bool turned[2];
  for (int a = 0; a < 2; ++a) {
    r[a] = shaft.reciprocal[k[a]], give[a] = shaft.give[k[a]];
    turned[a] = r[a] < 0;
    enter[a] = part.bound[turned[a]][k[a]], leave[a] = part.bound[!turned[a]][k[a]];
  }
  const float* const first_x = turned[0] ? cells.x0 : cells.x1;
  const float* const last_x = turned[0] ? cells.x1 : cells.x0;
  const float* const first_y = turned[1] ? cells.y0 : cells.y1;
  const float* const last_y = turned[1] ? cells.y1 : cells.y0;
  const float slack = shaft.give[frame.kz];
  const Float z0 = Float(part.z0), z1 = Float(part.z1);
  const Float gx = Float(give[0]), gy = Float(give[1]), rx = Float(r[0]), ry = Float(r[1]);
  const auto passes = [&](Float fx, Float lx, Float fy, Float ly, Float start) {
    const Float ex = (Float(enter[0]) - fx) * rx - gx, ey = (Float(enter[1]) - fy) * ry - gy;
    const Float ox = (Float(leave[0]) - lx) * rx + gx, oy = (Float(leave[1]) - ly) * ry + gy;
    return greatest_of(ex, ey, greatest(start, z0)) <= least_of(ox, oy, z1);
  };
  uint64_t open = 0;
  for (int at = 0; at < kCells; at += kLanes) {
    const Float start = -load(cells.far + at) - Float(slack);
    const Mask m =
        both(passes(load(first_x + at), load(last_x + at), load(first_y + at), load(last_y + at), start),
             load(cells.far + at) > Float(-kInfinity));
    open |= static_cast<uint64_t>(bits(m)) << at;
  }
  return any_ray_passes(cells, open, [&](int at) {
    const Float x = load(cells.x + at), y = load(cells.y + at);
    return passes(x, x, y, y, load(cells.z + at) - Float(slack));
  });
}

// Goes on from a node to the leaf nearest to the light.
template <class Counts>
static uint32_t descend(const KdView& tree, const Shaft& shaft, uint32_t node, Part& now, Waiting* stack,
                        int& waiting, Counts counts) {
  while (!is_leaf(tree.nodes[node])) {
    counts.group_node();
    const KdNode& n = tree.nodes[node];
    const int a = axis(n);
    const float at = split(n) - shaft.reference[a], r = shaft.reciprocal[a];
    const float one = (at - shaft.low[a]) * r, other = (at - shaft.high[a]) * r;
    const float first = vitral::least(one, other) - shaft.give[a];
    const float last = vitral::greatest(one, other) + shaft.give[a];
    const uint32_t negative = r < 0 ? 1u : 0u;
    const uint32_t here = child(n) + negative, ahead = here ^ 1;
    if (first > now.z1) {
      node = here;
      now.bound[1 - negative][a] = at;
      continue;
    }
    if (!(last < now.z0)) {
      Waiting& w = stack[waiting++];
      w = {here, now};
      w.part.bound[1 - negative][a] = at;
      w.part.z1 = vitral::least(last, now.z1);
      now.z0 = vitral::greatest(first, now.z0);
      prefetch_below(tree, tree.nodes[here]);
    }
    node = ahead;
    now.bound[negative][a] = at;
  }
  counts.group_node(), counts.group_leaf();
  return node;
}

}  // namespace VITRAL_ISA
}  // namespace vitral
