// How the kernels count what they do, or do not.
//
// What counts is a template argument: every kernel is compiled once with NoCounts, whose members are empty,
// and once with Counting. The first is the same machine code as one that knows nothing of counting.
#pragma once
#include "kdtree/kdtree.h"
#include "kernels/meet.h"
#include "kernels/points.h"
#include "simd/simd.h"
#include "vitral/counts.h"

namespace vitral {
namespace VITRAL_ISA {

struct NoCounts {
  NoCounts of(int) const { return {}; }
  void node(uint64_t) const {}
  void leaf(uint64_t) const {}
  void test(uint64_t) const {}
  void trace(uint64_t) const {}
  void group_node() const {}
  void group_leaf() const {}
  void group_test(int) const {}
  Hit group_walk(const KdView& tree, const Ray& ray) const { return walk_closest(tree, ray); }
  uint64_t mark() const { return 0; }
  template <class LanesOf>
  void share(uint64_t, int, LanesOf) const {}
  template <class Walk>
  uint64_t of_lanes(const uint32_t*, int, Walk walk) const {
    return walk(*this);
  }
};

struct Counting {
  TraversalCounts* totals;
  LaneWork* work;  // of the packet at hand, or of the first of several; null: totals only

  // The i-th packet from here on.
  Counting of(int i) const { return {totals, work ? work + i : nullptr}; }

  // A packet's lanes come to an inner node, to a leaf, to a triangle.
  void node(uint64_t lanes) const {
    totals->lanes_in_steps += static_cast<uint64_t>(__builtin_popcountll(lanes));
    ++totals->steps;
    add_work(lanes, 1);
  }
  void leaf(uint64_t lanes) const {
    node(lanes);
    totals->leaves += static_cast<uint64_t>(__builtin_popcountll(lanes));
  }
  void test(uint64_t lanes) const {
    totals->triangle_tests += static_cast<uint64_t>(__builtin_popcountll(lanes));
    add_work(lanes, 1);
  }

  // These rays walk or are tested themselves.
  void trace(uint64_t lanes) const {
    totals->rays_traced += static_cast<uint64_t>(__builtin_popcountll(lanes));
  }

  // The same for many rays together.
  void group_node() const { ++totals->other_nodes; }
  void group_leaf() const { ++totals->leaves; }  // a node that has been counted
  void group_test(int triangles) const { totals->triangle_tests += static_cast<uint64_t>(triangles); }
  Hit group_walk(const KdView& tree, const Ray& ray) const { return walk_closest(tree, ray, *totals); }

  // What has been counted since the mark was work for the lanes of `count` packets, to equal parts.
  uint64_t mark() const { return work_of(*totals); }
  template <class LanesOf>
  void share(uint64_t since, int count, LanesOf lanes_of) const {
    if (!work || mark() == since) return;
    int rays = 0;
    for (int i = 0; i < count; ++i) rays += __builtin_popcountll(lanes_of(i));
    if (rays == 0) return;
    const float part = static_cast<float>(mark() - since) / static_cast<float>(rays);
    for (int i = 0; i < count; ++i) of(i).add_work(lanes_of(i), part);
  }

  // Counts a walk whose lane i belongs to lane id[i] % 64 of the packet id[i] / 64 from here on.
  template <class Walk>
  uint64_t of_lanes(const uint32_t* id, int lanes, Walk walk) const {
    if (!work) return walk(*this);
    LaneWork mixed;
    for (int lane = 0; lane < kPacketSize; ++lane) mixed.work[lane] = 0;
    const uint64_t met = walk(Counting{totals, &mixed});
    for (int lane = 0; lane < lanes; ++lane)
      work[id[lane] / kPacketSize].work[id[lane] % kPacketSize] += mixed.work[lane];
    return met;
  }

  void add_work(uint64_t lanes, float amount) const {
    if (!work) return;
    for (int g = 0; g < kPacketSize; g += kLanes) {
      if (group_empty(lanes, g)) continue;
      float* const here = work->work + g;
      store(here, load(here) + select(group_mask(lanes, g), Float(amount), Float(0.0f)));
    }
  }
};

}  // namespace VITRAL_ISA
}  // namespace vitral
