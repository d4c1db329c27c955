// Deciding on one node, and finishing all that lies below a small one.
#pragma once
#include "kdtree/build.h"
#include "kdtree/sah.h"

#include <memory>
#include <span>
#include <vector>

namespace vitral {

// A node still to be decided on, apart from its references.
struct Node {
  Box cell;
  int depth = 0;
  size_t spare = 0;  // references that its subtree may hold beyond its own
};

struct BuildContext {
  const std::vector<KdTriangle>& triangles;
  const BuildSettings& settings;
  int max_depth;
};

// How many references go to each side; those that straddle the plane go to both.
struct Counts {
  size_t below = 0, above = 0;
};
Counts count_sides(std::span<const Reference> references, const Plane& plane);

// A split that costs more than a leaf, that would use up more references than the node has to spare,
// or that separates nothing is not made.
// A plane with nothing on one side needs no sorting and leaves the candidates as they are.
static inline bool cuts_off_empty_space(const Plane& plane) {
  return plane.below == 0 || plane.above == 0;
}
bool is_cheaper_than_leaf(const Plane& plane, size_t references, const SahCosts& costs);
bool is_allowed(const Node& node, const Counts& counts, size_t references);

// The children of a node; what references it has to spare are theirs in proportion to their own.
struct Children {
  Node below, above;
};
Children make_children(const Node& node, const Plane& plane, const Counts& counts, size_t references);

KdNode inner_node(const Plane& plane, size_t first_child);
KdNode leaf_node(std::span<const Reference> references, std::vector<uint32_t>& out);

// A finished part of the tree; nodes[0] is its root, new nodes are appended in pairs.
struct Subtree {
  std::vector<KdNode> nodes;
  std::vector<uint32_t> references;
};

// References without initial values: growing it keeps the first `kept`.
class ReferenceBuffer {
 public:
  Reference* data() { return data_.get(); }
  const Reference* data() const { return data_.get(); }
  size_t capacity() const { return capacity_; }
  void grow(size_t capacity, size_t kept);

 private:
  std::unique_ptr<Reference[]> data_;
  size_t capacity_ = 0;
};

// What one worker needs while it finishes subtrees, kept from one to the next.
struct Scratch {
  ReferenceBuffer references;
  Subtree subtree;
};

// Builds everything below a node.
Subtree finish_subtree(const BuildContext& context, const Node& node, std::span<const Reference> references,
                       Scratch& scratch);

}  // namespace vitral
