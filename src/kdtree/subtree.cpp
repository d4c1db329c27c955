#include "kdtree/subtree.h"

#include "kdtree/cut.h"
#include "math/scalar.h"

#include <algorithm>

namespace vitral {
namespace {

void set_component(Vec3& v, int axis, float x) {
  (axis == 0 ? v.x : axis == 1 ? v.y : v.z) = x;
}

// How a node's planes are found, and its candidates.
enum class Planes { exact, binned };
Planes find_candidates(const BuildContext& context, std::span<const Reference> references, BinLayout& layout,
                       Candidates& candidates) {
  if (references.size() <= std::min(context.settings.binned_above, kExactAtMost)) {
    find_exact_candidates(references, candidates);
    return Planes::exact;
  }
  layout = make_bins(bounds_of(references), references.size());
  BinCounts counts;
  clear(layout, counts);
  count_bins(references, layout, counts);
  find_binned_candidates(layout, counts, references.size(), candidates);
  return Planes::binned;
}

// The best plane among the ends of boxes that are no further than a bin from a binned one, if it is better.
void refine(const SahCosts& costs, std::span<const Reference> references, const BinLayout& layout,
            const Box& cell, Plane& plane) {
  const float reach = 1 / layout.scale[plane.axis];
  Candidates near;
  if (!find_candidates_near(references, plane.axis, plane.position - reach, plane.position + reach, near))
    return;
  const Plane refined = best_plane(near, cell, costs);
  if (refined.cost < plane.cost) plane = refined;
}

// Sorts the n references at `first` to the sides of the plane: those below stay there, those above
// go to first + n. All three copies of a reference are written, and the one that counts is kept:
// which it is cannot be predicted. Those that straddle the plane wait at first + 2 n to be cut.
void distribute(const BuildContext& context, const Plane& plane, Reference* first, size_t n) {
  Reference *below = first, *above = first + n, *straddling = first + 2 * n;
  const bool planar_below = plane.planar == PlanarSide::below;
  for (size_t i = 0; i < n; ++i) {
    const Reference r = first[i];
    const bool starts_below =
        r.min[plane.axis]<plane.position, ends_above = r.max[plane.axis]> plane.position;
    const bool planar = !(starts_below | ends_above);
    *below = r;
    *above = r;
    *straddling = r;
    below += (starts_below & !ends_above) | (planar & planar_below);
    above += (ends_above & !starts_below) | (planar & !planar_below);
    straddling += starts_below & ends_above;
  }
  for (const Reference* r = first + 2 * n; r != straddling; ++r) {
    const char* p = reinterpret_cast<const char*>(&context.triangles[r->triangle]);
    __builtin_prefetch(p), __builtin_prefetch(p + 39);
  }
  for (const Reference* r = first + 2 * n; r != straddling; ++r)
    cut(context.triangles[r->triangle], *r, plane, *below++, *above++);
}

// Finds the plane of a node with those references, and what it puts on its sides. Planes that cut off
// empty space come first, as nodes of their own with an empty leaf: `node` and its index `at` become
// those of the rest. False when the rest is to be a leaf.
bool find_plane(const BuildContext& context, std::span<const Reference> references, Node& node, size_t& at,
                Subtree& out, Plane& plane, Counts& counts) {
  const size_t n = references.size();
  const SahCosts& costs = context.settings.costs;
  if (n <= 1) return false;
  Candidates candidates;
  BinLayout layout;
  const Planes planes = find_candidates(context, references, layout, candidates);
  for (; node.depth < context.max_depth; ++node.depth) {
    plane = best_plane(candidates, node.cell, costs);
    // Bins make planes look worse than the ends nearby are, though hardly twice.
    if (!cuts_off_empty_space(plane) && planes == Planes::binned && is_cheaper_than_leaf(plane, 2 * n, costs))
      refine(costs, references, layout, node.cell, plane);
    if (!is_cheaper_than_leaf(plane, n, costs)) return false;
    if (!cuts_off_empty_space(plane)) {
      counts = planes == Planes::exact ? Counts{plane.below, plane.above} : count_sides(references, plane);
      return is_allowed(node, counts, n);
    }
    const size_t pair = out.nodes.size();
    out.nodes.resize(pair + 2);
    out.nodes[at] = inner_node(plane, pair);
    const bool empty_below = plane.below == 0;
    out.nodes[pair + !empty_below] = leaf_node({}, out.references);
    at = pair + empty_below;
    set_component(empty_below ? node.cell.min : node.cell.max, plane.axis, plane.position);
  }
  return false;
}

// Decides on the node whose n references begin at `first` of the scratch; what lies before them is
// kept, what lies behind is free.
void finish(const BuildContext& context, Node node, size_t first, size_t n, size_t at, Scratch& scratch) {
  Subtree& out = scratch.subtree;
  const std::span<const Reference> references(scratch.references.data() + first, n);
  Plane plane;
  Counts counts;
  if (!find_plane(context, references, node, at, out, plane, counts)) {
    out.nodes[at] = leaf_node(references, out.references);
    return;
  }
  const Children children = make_children(node, plane, counts, n);
  scratch.references.grow(first + 3 * n, first + n);
  distribute(context, plane, scratch.references.data() + first, n);

  const size_t pair = out.nodes.size();
  out.nodes.resize(pair + 2);
  out.nodes[at] = inner_node(plane, pair);
  finish(context, children.above, first + n, counts.above, pair + 1, scratch);
  finish(context, children.below, first, counts.below, pair, scratch);
}

}  // namespace

Counts count_sides(std::span<const Reference> references, const Plane& plane) {
  size_t below = 0, above = 0, either = 0;
  for (const Reference& r : references) {
    const bool starts_below =
        r.min[plane.axis]<plane.position, ends_above = r.max[plane.axis]> plane.position;
    below += starts_below;
    above += ends_above;
    either += starts_below | ends_above;
  }
  const size_t planar = references.size() - either;
  return plane.planar == PlanarSide::below ? Counts{below + planar, above} : Counts{below, above + planar};
}

bool is_cheaper_than_leaf(const Plane& plane, size_t references, const SahCosts& costs) {
  return plane.cost < costs.intersection * static_cast<float>(references);
}

bool is_allowed(const Node& node, const Counts& counts, size_t references) {
  return counts.below + counts.above - references <= node.spare &&
         !(counts.below == references && counts.above == references);
}

Children make_children(const Node& node, const Plane& plane, const Counts& counts, size_t references) {
  const size_t total = counts.below + counts.above, spare = node.spare - (total - references);
  Children c{node, node};
  c.below.spare = static_cast<size_t>(static_cast<double>(spare) * static_cast<double>(counts.below) /
                                      static_cast<double>(total));
  c.above.spare = spare - c.below.spare;
  set_component(c.below.cell.max, plane.axis, plane.position);
  set_component(c.above.cell.min, plane.axis, plane.position);
  c.below.depth = c.above.depth = node.depth + 1;
  return c;
}

KdNode inner_node(const Plane& plane, size_t first_child) {
  return {as_bits(plane.position),
          static_cast<uint32_t>(first_child) << 2 | static_cast<uint32_t>(plane.axis)};
}

// Triangles stand in a leaf in the order of their numbers.
KdNode leaf_node(std::span<const Reference> references, std::vector<uint32_t>& out) {
  const size_t first = out.size(), n = references.size();
  out.resize(first + n);
  uint32_t* const numbers = out.data() + first;
  constexpr size_t kInsertAtMost = 16;
  for (size_t i = 0; i < n; ++i) {
    const uint32_t number = references[i].triangle;
    size_t at = i;
    for (; n <= kInsertAtMost && at > 0 && numbers[at - 1] > number; --at) numbers[at] = numbers[at - 1];
    numbers[at] = number;
  }
  if (n > kInsertAtMost) std::sort(numbers, numbers + n);
  return {static_cast<uint32_t>(n), static_cast<uint32_t>(first) << 2 | 3u};
}

void ReferenceBuffer::grow(size_t capacity, size_t kept) {
  if (capacity <= capacity_) return;
  const size_t larger = capacity + capacity / 8;
  auto data = std::make_unique_for_overwrite<Reference[]>(larger);
  std::copy_n(data_.get(), kept, data.get());
  data_ = std::move(data);
  capacity_ = larger;
}

Subtree finish_subtree(const BuildContext& context, const Node& node, std::span<const Reference> references,
                       Scratch& scratch) {
  scratch.subtree.nodes.clear();
  scratch.subtree.references.clear();
  scratch.subtree.nodes.resize(1);
  scratch.references.grow(4 * references.size(), 0);
  std::copy(references.begin(), references.end(), scratch.references.data());
  finish(context, node, 0, references.size(), 0, scratch);
  return scratch.subtree;  // a copy, no larger than need be
}

}  // namespace vitral
