// What tracing came to, for those who ask: how often something was visited or tested.
#pragma once
#include <cstdint>

namespace vitral {

// A node or a triangle counts once for every ray of its own that visits it or is tested with it; and once
// when it is visited or tested for many rays together, as when the triangles that a block's rays could meet
// are collected. No initial values: TraversalCounts{} is zero.
struct TraversalCounts {
  uint64_t nodes;           // inner nodes and leaves
  uint64_t leaves;          // of them
  uint64_t triangle_tests;  // rays with triangles, or blocks of rays with triangles
  uint64_t steps;           // nodes visited by packets
  uint64_t lanes_in_steps;  // rays that were alive there; over steps: how full the packets are
  uint64_t rays_traced;     // rays that walked or were tested themselves
  uint64_t rays_culled;     // rays that needed no work of their own
};

inline void add(TraversalCounts& sum, const TraversalCounts& c) {
  sum.nodes += c.nodes, sum.leaves += c.leaves, sum.triangle_tests += c.triangle_tests;
  sum.steps += c.steps, sum.lanes_in_steps += c.lanes_in_steps;
  sum.rays_traced += c.rays_traced, sum.rays_culled += c.rays_culled;
}

}  // namespace vitral
