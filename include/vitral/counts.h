// What tracing came to, for those who ask: how often something was visited or tested.
#pragma once
#include <cstdint>

namespace vitral {

// A node or a triangle counts once for every ray of its own that visits it or is tested with it; and once
// when it is visited or tested for many rays together, as when the triangles that a block's rays could meet
// are collected. No initial values: TraversalCounts{} is zero.
struct TraversalCounts {
  uint64_t steps;           // nodes visited by packets of rays
  uint64_t lanes_in_steps;  // rays that were alive there; over steps: how full the packets are
  uint64_t other_nodes;     // visited by one ray alone, or for many rays together
  uint64_t leaves;          // of both
  uint64_t triangle_tests;  // rays with triangles, or blocks of rays with triangles
  uint64_t rays_traced;     // rays that walked or were tested themselves
  uint64_t rays_culled;     // rays that needed no work of their own
};

// Visits of inner nodes and leaves; and what `cost` holds.
static inline uint64_t nodes_of(const TraversalCounts& c) {
  return c.lanes_in_steps + c.other_nodes;
}
static inline uint64_t work_of(const TraversalCounts& c) {
  return nodes_of(c) + c.triangle_tests;
}

static inline void add(TraversalCounts& sum, const TraversalCounts& c) {
  sum.steps += c.steps, sum.lanes_in_steps += c.lanes_in_steps, sum.other_nodes += c.other_nodes;
  sum.leaves += c.leaves, sum.triangle_tests += c.triangle_tests;
  sum.rays_traced += c.rays_traced, sum.rays_culled += c.rays_culled;
}

}  // namespace vitral
