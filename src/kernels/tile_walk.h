// How the rays of a tile walk the tree together: what the beam of camera rays and the shaft of shadow rays
// have in common.
#pragma once
#include "kernels/pairs.h"

namespace vitral {
namespace VITRAL_ISA {

// A part of the rays: the depths between which they are in a node's box, and that box, relative to the point
// from which coordinates are counted.
struct Part {
  float z0, z1;
  float bound[2][3];  // least, greatest
};

struct Waiting {
  uint32_t node;
  Part part;
};

// Of a node that will be visited later.
static inline void prefetch_below(const KdView& tree, const KdNode& n) {
  const void* const children = tree.nodes + child(n);
  const void* const references = tree.references + first_reference(n);
  __builtin_prefetch(is_leaf(n) ? references : children);
}

// Does any ray pass, when only those of the `open` cells may? `passes` says which rays of a register do;
// where many cells are left they are not asked.
template <class AnyCells, class Passes>
static inline bool any_ray_passes(const AnyCells& cells, uint64_t open, Passes passes) {
  if (__builtin_popcountll(open) > kFewCells) return true;
  for (; open != 0; open &= open - 1) {
    const int cell = __builtin_ctzll(open);
    uint32_t through = 0;
    for (int g = 0; g < kCellSize; g += kLanes) through |= bits(passes(cell * kCellSize + g)) << g;
    if ((through & cells.live[cell]) != 0) return true;
  }
  return false;
}

// Walks the tree from its root, where the rays are in `now`, and hands the triangles of the leaves to `meet`,
// kBatch at a time, until it has no more use for them. `descend` goes on from a node to a leaf and leaves on
// the stack what waits; `is_wanted` says whether a part is to be visited, and may make it smaller.
enum class Use { more, enough };
enum class Walked { through, in_part };
template <class Descend, class Meet, class IsWanted>
static Walked walk_tile(const KdView& tree, Part now, Descend descend, Meet meet, IsWanted is_wanted) {
  if (!(now.z0 <= now.z1)) return Walked::through;
  constexpr int kSeen = 1024;  // triangles met lately: all rays have been tested that they can touch
  uint32_t seen[kSeen];
  for (int i = 0; i < kSeen; ++i) seen[i] = kNoTriangle;
  uint32_t ids[kBatch];
  int gathered = 0;
  Waiting stack[kMaxTreeDepth];
  int waiting = 0;
  uint32_t node = 0;
  for (;;) {
    const KdNode& leaf = tree.nodes[descend(node, now, stack, waiting)];
    for (uint32_t i = 0; i < count(leaf); ++i) {
      const uint32_t id = tree.references[first_reference(leaf) + i];
      __builtin_prefetch(&tree.triangles[id]);
      ids[gathered] = id;
      gathered += seen[id % kSeen] != id;
      seen[id % kSeen] = id;
      if (gathered < kBatch) continue;
      if (meet(ids, gathered) == Use::enough) return Walked::in_part;
      gathered = 0;
    }
    do {
      if (waiting == 0) {
        if (gathered > 0) meet(ids, gathered);
        return Walked::through;
      }
      --waiting;
      node = stack[waiting].node, now = stack[waiting].part;
    } while (!is_wanted(now));
  }
}

}  // namespace VITRAL_ISA
}  // namespace vitral
