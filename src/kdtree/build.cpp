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

namespace vitral {
namespace {

// A node still to be decided on.
struct Work {
  std::vector<Reference> references;
  Box cell;
  int depth = 0;
  size_t spare = 0;  // references that its subtree may hold beyond its own
};

struct Context {
  const std::vector<KdTriangle>& triangles;
  const BuildSettings& settings;
  int max_depth;
};

float& component_of(Vec3& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

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
void cut(const Context& context, const Reference& whole, const Plane& plane, Reference& below, Reference& above) {
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
        const double x = static_cast<double>(a[axis]) + s * (static_cast<double>(b[axis]) - static_cast<double>(a[axis]));
        component_of(low, axis) = axis == plane.axis ? plane.position : outward_down(x);
        component_of(high, axis) = axis == plane.axis ? plane.position : outward_up(x);
      }
      for (Box& p : part) extend(p, low), extend(p, high);
    }
  }
  Reference* out[2] = {&below, &above};
  for (int side = 0; side < 2; ++side) {
    Box kept = whole.box;
    if (side == 0) component_of(kept.max, plane.axis) = plane.position;
    else component_of(kept.min, plane.axis) = plane.position;
    Box tight;
    for (int axis = 0; axis < 3; ++axis) {
      component_of(tight.min, axis) = greatest(component(part[side].min, axis), component(kept.min, axis));
      component_of(tight.max, axis) = least(component(part[side].max, axis), component(kept.max, axis));
    }
    *out[side] = {is_empty(tight) ? kept : tight, whole.triangle};
  }
}

// Decides on a node: true when it is split, its references then being in `below` and `above`.
bool try_split(const Context& context, Work& work, Plane& plane, Work& below, Work& above) {
  const size_t n = work.references.size();
  if (n <= 1 || work.depth >= context.max_depth) return false;
  plane = n > context.settings.binned_above ? best_plane_binned(work.references, work.cell, context.settings.costs)
                                            : best_plane_exact(work.references, work.cell, context.settings.costs);
  if (!(plane.cost < context.settings.costs.intersection * static_cast<float>(n))) return false;

  for (const Reference& r : work.references) {
    const float lo = component(r.box.min, plane.axis), hi = component(r.box.max, plane.axis);
    const bool planar = lo == plane.position && hi == plane.position;
    const bool is_below = planar ? plane.planar == PlanarSide::below : lo < plane.position;
    const bool is_above = planar ? plane.planar == PlanarSide::above : hi > plane.position;
    if (is_below && is_above) {
      Reference b, a;
      cut(context, r, plane, b, a);
      below.references.push_back(b);
      above.references.push_back(a);
    } else {
      (is_below ? below : above).references.push_back(r);
    }
  }
  const size_t total = below.references.size() + above.references.size();
  if (total - n > work.spare || (below.references.size() == n && above.references.size() == n)) {
    below.references.clear();
    above.references.clear();
    return false;
  }
  const size_t spare = work.spare - (total - n);
  below.spare = static_cast<size_t>(static_cast<double>(spare) * static_cast<double>(below.references.size()) /
                                    static_cast<double>(total));
  above.spare = spare - below.spare;
  below.cell = above.cell = work.cell;
  component_of(below.cell.max, plane.axis) = plane.position;
  component_of(above.cell.min, plane.axis) = plane.position;
  below.depth = above.depth = work.depth + 1;
  std::vector<Reference>().swap(work.references);
  return true;
}

KdNode inner_node(const Plane& plane, size_t first_child) {
  return {as_bits(plane.position), static_cast<uint32_t>(first_child) << 2 | static_cast<uint32_t>(plane.axis)};
}

KdNode leaf_node(const std::vector<Reference>& references, std::vector<uint32_t>& out) {
  const KdNode leaf{static_cast<uint32_t>(references.size()), static_cast<uint32_t>(out.size()) << 2 | 3u};
  for (const Reference& r : references) out.push_back(r.triangle);
  std::sort(out.end() - static_cast<std::ptrdiff_t>(references.size()), out.end());
  return leaf;
}

// Builds everything below `work` into nodes[at]; new nodes are appended in pairs.
void finish_subtree(const Context& context, Work work, size_t at, std::vector<KdNode>& nodes, std::vector<uint32_t>& references) {
  Plane plane;
  Work below, above;
  if (!try_split(context, work, plane, below, above)) {
    nodes[at] = leaf_node(work.references, references);
    return;
  }
  const size_t pair = nodes.size();
  nodes.resize(pair + 2);
  nodes[at] = inner_node(plane, pair);
  finish_subtree(context, std::move(below), pair, nodes, references);
  finish_subtree(context, std::move(above), pair + 1, nodes, references);
}

// The upper part of the tree while it grows: an inner node with two children, or a finished subtree.
struct Upper {
  Work work;
  Plane plane{};
  std::unique_ptr<Upper> below, above;
  std::vector<KdNode> nodes;  // of the subtree; nodes[0] is its root
  std::vector<uint32_t> references;
};

void decide(const Context& context, Upper& node) {
  if (node.work.references.size() > context.settings.subtree_at_most) {
    auto below = std::make_unique<Upper>(), above = std::make_unique<Upper>();
    if (try_split(context, node.work, node.plane, below->work, above->work)) {
      node.below = std::move(below);
      node.above = std::move(above);
      return;
    }
    node.nodes.push_back(leaf_node(node.work.references, node.references));
    return;
  }
  node.nodes.resize(1);
  finish_subtree(context, std::move(node.work), 0, node.nodes, node.references);
}

// Appends the node and all below it to the tree, depth first, and frees it on the way.
void join(Upper& node, size_t at, KdTree& tree) {
  if (node.below) {
    const size_t pair = tree.nodes.size();
    tree.nodes.resize(pair + 2);
    tree.nodes[at] = inner_node(node.plane, pair);
    join(*node.below, pair, tree);
    node.below.reset();
    join(*node.above, pair + 1, tree);
    node.above.reset();
    return;
  }
  const uint32_t node_shift = static_cast<uint32_t>(tree.nodes.size()) - 1;  // nodes[1] lands at the end
  const uint32_t reference_shift = static_cast<uint32_t>(tree.references.size());
  for (size_t i = 0; i < node.nodes.size(); ++i) {
    KdNode n = node.nodes[i];
    n.axis_and_index += (is_leaf(n) ? reference_shift : node_shift) << 2;
    if (i == 0) tree.nodes[at] = n;
    else tree.nodes.push_back(n);
  }
  tree.references.insert(tree.references.end(), node.references.begin(), node.references.end());
  std::vector<KdNode>().swap(node.nodes);
  std::vector<uint32_t>().swap(node.references);
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
  root.work.references.reserve(members.size());
  for (const uint32_t id : members) {
    Reference r{{}, id};
    for (const float* c : {triangles[id].corner[0], triangles[id].corner[1], triangles[id].corner[2]}) {
      extend(r.box, Vec3{c[0], c[1], c[2]});
    }
    extend(tree.bounds, r.box);
    root.work.references.push_back(r);
  }
  root.work.cell = tree.bounds;
  root.work.spare = 3 * members.size();
  const Context context{triangles, settings, depth_limit(members.size())};

  std::vector<Upper*> round{&root};
  while (!round.empty()) {
    executor(round.size(), [&](size_t i) { decide(context, *round[i]); });
    std::vector<Upper*> next;
    for (Upper* node : round) {
      if (node->below) next.insert(next.end(), {node->below.get(), node->above.get()});
    }
    round.swap(next);
  }

  tree.nodes.resize(2, KdNode{0, 3});
  join(root, 0, tree);
  tree.nodes.shrink_to_fit();
  tree.references.shrink_to_fit();
  return tree;
}

KdView make_view(const KdTree& tree, const std::vector<KdTriangle>& triangles, const CutOuts& cut_outs) {
  return {tree.nodes.data(), tree.references.data(), triangles.data(), tree.bounds, magnitude(tree.bounds), cut_outs};
}

}  // namespace vitral
