// From the root down: find the best plane, sort the references to its sides, cut those that straddle
// it ("perfect splits": each side sees only the bounds of its own part of the triangle), and stop when
// no plane is cheaper than a leaf (Wald and Havran 2006).
//
// Large nodes are split in rounds, all nodes of a round in parallel; small ones are finished as
// subtrees, in parallel too. What becomes of a node depends on its references alone, and the pieces
// are joined in depth-first order: the tree does not depend on the threads.
#include "kdtree/build.h"

#include "math/scalar.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>

namespace vitral {
namespace {

// A node still to be decided on, apart from its references.
struct Node {
  Box cell;
  int depth = 0;
  size_t spare = 0;  // references that its subtree may hold beyond its own
};

struct Context {
  const std::vector<KdTriangle>& triangles;
  const BuildSettings& settings;
  int max_depth;
};

float& component_of(Vec3& v, int axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

// One ulp further out, for bounds that were rounded to nearest.
float outward_down(double x) {
  const float f = static_cast<float>(x);
  return static_cast<double>(f) <= x ? f : std::nextafterf(f, -std::numeric_limits<float>::infinity());
}
float outward_up(double x) {
  const float f = static_cast<float>(x);
  return static_cast<double>(f) >= x ? f : std::nextafterf(f, std::numeric_limits<float>::infinity());
}

// Cuts a reference in two at the plane. Each part is bounded by the triangle's corners on its side
// and the points where its edges cross the plane, inside the reference's old bounds. A part that
// comes out empty by rounding keeps the old bounds on its side: no part of a triangle is ever lost.
void cut(const Context& context, const Reference& whole, const Plane& plane, Reference& below,
         Reference& above) {
  const KdTriangle& t = context.triangles[whole.triangle];
  Box part[2];
  for (int k = 0; k < 3; ++k) {
    const float* a = t.corner[k];
    const float* b = t.corner[(k + 1) % 3];
    const float at = a[plane.axis], bt = b[plane.axis];
    if (at <= plane.position) extend(part[0], Vec3{a[0], a[1], a[2]});
    if (at >= plane.position) extend(part[1], Vec3{a[0], a[1], a[2]});
    if ((at < plane.position && bt > plane.position) || (at > plane.position && bt < plane.position)) {
      const double s = (static_cast<double>(plane.position) - static_cast<double>(at)) /
                       (static_cast<double>(bt) - static_cast<double>(at));
      Vec3 low{}, high{};
      for (int axis = 0; axis < 3; ++axis) {
        const double x =
            static_cast<double>(a[axis]) + s * (static_cast<double>(b[axis]) - static_cast<double>(a[axis]));
        component_of(low, axis) = axis == plane.axis ? plane.position : outward_down(x);
        component_of(high, axis) = axis == plane.axis ? plane.position : outward_up(x);
      }
      for (Box& p : part) extend(p, low), extend(p, high);
    }
  }
  Reference* out[2] = {&below, &above};
  for (int side = 0; side < 2; ++side) {
    Box kept = whole.box;
    if (side == 0)
      component_of(kept.max, plane.axis) = plane.position;
    else
      component_of(kept.min, plane.axis) = plane.position;
    Box tight;
    for (int axis = 0; axis < 3; ++axis) {
      component_of(tight.min, axis) = greatest(component(part[side].min, axis), component(kept.min, axis));
      component_of(tight.max, axis) = least(component(part[side].max, axis), component(kept.max, axis));
    }
    *out[side] = {is_empty(tight) ? kept : tight, whole.triangle};
  }
}

bool find_plane(const Context& context, std::span<const Reference> references, const Node& node,
                Plane& plane) {
  const size_t n = references.size();
  if (n <= 1 || node.depth >= context.max_depth) return false;
  plane = n > context.settings.binned_above ? best_plane_binned(references, node.cell, context.settings.costs)
                                            : best_plane_exact(references, node.cell, context.settings.costs);
  return plane.cost < context.settings.costs.intersection * static_cast<float>(n);
}

struct Sides {
  bool below, above;
};
Sides sides_of(const Reference& r, const Plane& plane) {
  const float lo = component(r.box.min, plane.axis), hi = component(r.box.max, plane.axis);
  if (lo == plane.position && hi == plane.position) {
    return {plane.planar == PlanarSide::below, plane.planar == PlanarSide::above};
  }
  return {lo<plane.position, hi> plane.position};
}

// How many references go to each side. A split that would use up more references than the node has to
// spare, or that separates nothing, is not made.
struct Counts {
  size_t below = 0, above = 0;
};
bool count_sides(std::span<const Reference> references, const Node& node, const Plane& plane,
                 Counts& counts) {
  for (const Reference& r : references) {
    const Sides sides = sides_of(r, plane);
    counts.below += sides.below;
    counts.above += sides.above;
  }
  const size_t n = references.size();
  return counts.below + counts.above - n <= node.spare && !(counts.below == n && counts.above == n);
}

// The children of a node; what references it has to spare are theirs in proportion to their own.
void make_children(const Node& node, const Plane& plane, const Counts& counts, size_t references, Node& below,
                   Node& above) {
  const size_t total = counts.below + counts.above, spare = node.spare - (total - references);
  below.spare = static_cast<size_t>(static_cast<double>(spare) * static_cast<double>(counts.below) /
                                    static_cast<double>(total));
  above.spare = spare - below.spare;
  below.cell = above.cell = node.cell;
  component_of(below.cell.max, plane.axis) = plane.position;
  component_of(above.cell.min, plane.axis) = plane.position;
  below.depth = above.depth = node.depth + 1;
}

KdNode inner_node(const Plane& plane, size_t first_child) {
  return {as_bits(plane.position),
          static_cast<uint32_t>(first_child) << 2 | static_cast<uint32_t>(plane.axis)};
}

KdNode leaf_node(std::span<const Reference> references, std::vector<uint32_t>& out) {
  const KdNode leaf{static_cast<uint32_t>(references.size()), static_cast<uint32_t>(out.size()) << 2 | 3u};
  for (const Reference& r : references) out.push_back(r.triangle);
  std::sort(out.end() - static_cast<std::ptrdiff_t>(references.size()), out.end());
  return leaf;
}

// A finished part of the tree; nodes[0] is its root, new nodes are appended in pairs.
struct Subtree {
  std::vector<KdNode> nodes;
  std::vector<uint32_t> references;
};

// Builds everything below a node whose references are the last ones on the stack, from `first` on,
// and takes them off. The stack is all the memory that a subtree needs while it is built.
void finish_subtree(const Context& context, const Node& node, size_t first, size_t at,
                    std::vector<Reference>& stack, Subtree& out) {
  const size_t n = stack.size() - first;
  const std::span<const Reference> references(stack.data() + first, n);
  Plane plane;
  Counts counts;
  if (!find_plane(context, references, node, plane) || !count_sides(references, node, plane, counts)) {
    out.nodes[at] = leaf_node(references, out.references);
    stack.resize(first);
    return;
  }
  Node below, above;
  make_children(node, plane, counts, n, below, above);

  // Those below stay at the bottom, those above go on top of the old ones and then move down.
  size_t kept = first;
  for (size_t i = first; i < first + n; ++i) {
    const Reference r = stack[i];
    const Sides sides = sides_of(r, plane);
    if (sides.below && sides.above) {
      Reference b, a;
      cut(context, r, plane, b, a);
      stack[kept++] = b;
      stack.push_back(a);
    } else if (sides.below) {
      stack[kept++] = r;
    } else {
      stack.push_back(r);
    }
  }
  stack.erase(stack.begin() + static_cast<std::ptrdiff_t>(kept),
              stack.begin() + static_cast<std::ptrdiff_t>(first + n));

  const size_t pair = out.nodes.size();
  out.nodes.resize(pair + 2);
  out.nodes[at] = inner_node(plane, pair);
  finish_subtree(context, above, kept, pair + 1, stack, out);
  finish_subtree(context, below, first, pair, stack, out);
}

// The upper part of the tree while it grows: an inner node with two children, or a finished subtree.
struct Upper {
  Node node;
  std::vector<Reference> references;
  Plane plane{};
  std::unique_ptr<Upper> below, above;
  Subtree subtree;
};

// Splits a large node in two; true when that was worth it.
bool split_upper(const Context& context, Upper& upper) {
  Counts counts;
  if (!find_plane(context, upper.references, upper.node, upper.plane) ||
      !count_sides(upper.references, upper.node, upper.plane, counts)) {
    return false;
  }
  upper.below = std::make_unique<Upper>();
  upper.above = std::make_unique<Upper>();
  make_children(upper.node, upper.plane, counts, upper.references.size(), upper.below->node,
                upper.above->node);
  std::vector<Reference>&below = upper.below->references, &above = upper.above->references;
  below.reserve(counts.below);
  above.reserve(counts.above);
  for (const Reference& r : upper.references) {
    const Sides sides = sides_of(r, upper.plane);
    if (sides.below && sides.above) {
      Reference b, a;
      cut(context, r, upper.plane, b, a);
      below.push_back(b);
      above.push_back(a);
    } else {
      (sides.below ? below : above).push_back(r);
    }
  }
  std::vector<Reference>().swap(upper.references);
  return true;
}

void decide(const Context& context, Upper& upper) {
  if (upper.references.size() > context.settings.subtree_at_most) {
    if (!split_upper(context, upper))
      upper.subtree.nodes.push_back(leaf_node(upper.references, upper.subtree.references));
    return;
  }
  upper.subtree.nodes.resize(1);
  finish_subtree(context, upper.node, 0, 0, upper.references, upper.subtree);
  std::vector<Reference>().swap(upper.references);
  upper.subtree.nodes.shrink_to_fit();
  upper.subtree.references.shrink_to_fit();
}

// Appends a node and all below it to the tree, depth first, and frees it on the way.
void join(Upper& upper, size_t at, KdTree& tree) {
  if (upper.below) {
    const size_t pair = tree.nodes.size();
    tree.nodes.resize(pair + 2);
    tree.nodes[at] = inner_node(upper.plane, pair);
    join(*upper.below, pair, tree);
    upper.below.reset();
    join(*upper.above, pair + 1, tree);
    upper.above.reset();
    return;
  }
  const uint32_t node_shift = static_cast<uint32_t>(tree.nodes.size()) - 1;  // nodes[1] lands at the end
  const uint32_t reference_shift = static_cast<uint32_t>(tree.references.size());
  const std::vector<KdNode>& nodes = upper.subtree.nodes;
  for (size_t i = 0; i < nodes.size(); ++i) {
    KdNode n = nodes[i];
    n.axis_and_index += (is_leaf(n) ? reference_shift : node_shift) << 2;
    if (i == 0)
      tree.nodes[at] = n;
    else
      tree.nodes.push_back(n);
  }
  tree.references.insert(tree.references.end(), upper.subtree.references.begin(),
                         upper.subtree.references.end());
}

// How many nodes and references there are in all, so that the tree is allocated once.
void count_all(const Upper& upper, size_t& nodes, size_t& references) {
  nodes += upper.below ? 2 : upper.subtree.nodes.size() - 1;
  references += upper.subtree.references.size();
  if (upper.below) count_all(*upper.below, nodes, references), count_all(*upper.above, nodes, references);
}

int depth_limit(size_t triangles) {
  int log2 = 0;
  while (triangles >> log2 > 1) ++log2;
  return std::min(8 + 13 * log2 / 10, kMaxTreeDepth - 1);
}

}  // namespace

KdTree build_kdtree(const std::vector<KdTriangle>& triangles, const std::vector<uint32_t>& members,
                    const BuildSettings& settings, const Executor& executor) {
  KdTree tree;
  Upper root;
  root.references.reserve(members.size());
  for (const uint32_t id : members) {
    Reference r{{}, id};
    for (const float* c : {triangles[id].corner[0], triangles[id].corner[1], triangles[id].corner[2]}) {
      extend(r.box, Vec3{c[0], c[1], c[2]});
    }
    extend(tree.bounds, r.box);
    root.references.push_back(r);
  }
  root.node = {tree.bounds, 0, 3 * members.size()};
  const Context context{triangles, settings, depth_limit(members.size())};

  std::vector<Upper*> round{&root};
  while (!round.empty()) {
    executor(round.size(), [&](size_t i) { decide(context, *round[i]); });
    std::vector<Upper*> next;
    for (Upper* upper : round) {
      if (upper->below) next.insert(next.end(), {upper->below.get(), upper->above.get()});
    }
    round.swap(next);
  }

  size_t nodes = 2, references = 0;
  count_all(root, nodes, references);
  tree.nodes.reserve(nodes);
  tree.references.reserve(references);
  tree.nodes.resize(2, KdNode{0, 3});
  join(root, 0, tree);
  return tree;
}

KdView make_view(const KdTree& tree, const std::vector<KdTriangle>& triangles, const CutOuts& cut_outs) {
  return {tree.nodes.data(), tree.references.data(), triangles.data(),
          tree.bounds,       magnitude(tree.bounds), cut_outs};
}

}  // namespace vitral
