#include "kernels/candidates.h"

#include "kernels/meet.h"
#include "kernels/sight.h"
#include "math/elementary.h"

namespace vitral {
namespace VITRAL_ISA {

Parts parts_of(int strata) {
  Parts parts;
  parts.count = strata < kMaxParts ? strata : kMaxParts;
  parts.lines = parts.count % 2 == 0 ? parts.count / 2 : parts.count;
  for (int l = 0; l < parts.lines; ++l)
    sin_cos_turn(static_cast<float>(l) / static_cast<float>(parts.count), parts.sine[l], parts.cosine[l]);
  return parts;
}

namespace {

template <int kMost>
void add_seen(const Parts& parts, const uint64_t* ring, const uint64_t* column, Seen<kMost>& out) {
  for (int p = 0; p < parts.count; ++p)
    out.ring[p][out.count] = ring[p], out.column[p][out.count] = column[p];
  ++out.count;
}

// Sorts by the highest ring, by counting.
template <int kMost>
void sort_by_height(const Parts& parts, Seen<kMost>& seen) {
  for (int r = 0; r < parts.count; ++r) {
    int& reaching = seen.reaching[r] = 0;
    for (int i = 0; i < seen.count; ++i) reaching += seen.ring[r][i] != 0;
  }
  int next[kMaxParts];
  for (int r = 0; r < parts.count; ++r) next[r] = r + 1 < parts.count ? seen.reaching[r + 1] : 0;
  for (int i = 0; i < seen.count; ++i) {
    int r = 0;
    while (r + 1 < parts.count && seen.ring[r + 1][i] != 0) ++r;
    seen.order[next[r]++] = i;
  }
}

// False when they are too many.
bool choose_triangles(const KdView& tree, const Pool& pool, const Block& block, int most, Candidates& out) {
  uint64_t ring[kMaxParts], column[kMaxParts];
  for (int i = 0; i < pool.count; i += kLanes) {
    const Corners corners{load3(pool.corner[0], pool.corner[1], pool.corner[2], i),
                          load3(pool.corner[3], pool.corner[4], pool.corner[5], i),
                          load3(pool.corner[6], pool.corner[7], pool.corner[8], i)};
    const int left = pool.count - i;
    const Mask filled = mask_of_bits(left >= kLanes ? ~0ull : (1ull << left) - 1);
    for (uint32_t some = bits(both(within(corners, block.reach), filled)); some != 0; some &= some - 1) {
      const int at = i + __builtin_ctz(some);
      if (!look(tree.triangles[pool.id[at]], pool.plane[at], block, ring, column)) continue;
      if (out.triangles.count == most) return false;
      out.triangle[out.triangles.count] = pool.id[at];
      add_seen(block.parts, ring, column, out.triangles);
    }
  }
  return true;
}

void choose_nodes(const Pool& pool, const Block& block, Candidates& out) {
  uint64_t ring[kMaxParts], column[kMaxParts];
  for (int i = 0; i < pool.nodes; ++i) {
    if (!look(pool.cell[i], block, ring, column)) continue;
    out.cell[out.nodes.count] = pool.cell[i];
    add_seen(block.parts, ring, column, out.nodes);
  }
}

}  // namespace

Enough choose_candidates(const KdView& tree, const Pool& pool, const PointPacket& points,
                         const Frames& frames, const Parts& parts, float distance, int most,
                         Candidates& out) {
  const PointPacket* const packet = &points;
  Block block{points, frames, parts, reach_of(tree, &packet, 1, distance), {}};
  make_sights(points, frames, distance, block.sights);
  out.triangles.count = out.nodes.count = 0;
  if (!choose_triangles(tree, pool, block, most, out)) return Enough::walk;
  choose_nodes(pool, block, out);
  sort_by_height(parts, out.triangles);
  sort_by_height(parts, out.nodes);
  return Enough::candidates;
}

}  // namespace VITRAL_ISA
}  // namespace vitral
