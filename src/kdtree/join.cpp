#include "kdtree/upper.h"

#include <algorithm>

namespace vitral {
namespace {

// A finished subtree and where it lands in the tree.
struct Landing {
  Subtree* subtree;
  size_t root, nodes, references;
};

// Lays out a node and all below it, depth first.
void lay_out(Upper& upper, size_t at, KdTree& tree, size_t& nodes, size_t& references,
             std::vector<Landing>& landings) {
  if (upper.below) {
    const size_t pair = nodes;
    nodes += 2;
    tree.nodes.resize(std::max(tree.nodes.size(), pair + 2));
    tree.nodes[at] = inner_node(upper.plane, pair);
    lay_out(*upper.below, pair, tree, nodes, references, landings);
    lay_out(*upper.above, pair + 1, tree, nodes, references, landings);
    return;
  }
  landings.push_back({&upper.subtree, at, nodes, references});
  nodes += upper.subtree.nodes.size() - 1;
  references += upper.subtree.references.size();
}

// Copies a subtree into its place and frees it.
void land(const Landing& landing, KdTree& tree) {
  const uint32_t node_shift = static_cast<uint32_t>(landing.nodes) - 1;  // nodes[1] lands at landing.nodes
  const uint32_t reference_shift = static_cast<uint32_t>(landing.references);
  const std::vector<KdNode>& nodes = landing.subtree->nodes;
  for (size_t i = 0; i < nodes.size(); ++i) {
    KdNode n = nodes[i];
    n.axis_and_index += (is_leaf(n) ? reference_shift : node_shift) << 2;
    tree.nodes[i == 0 ? landing.root : landing.nodes + i - 1] = n;
  }
  std::copy(landing.subtree->references.begin(), landing.subtree->references.end(),
            tree.references.begin() + static_cast<std::ptrdiff_t>(landing.references));
  *landing.subtree = Subtree{};
}

}  // namespace

void join(Upper& root, const Executor& executor, KdTree& tree) {
  tree.nodes.resize(2, KdNode{0, 3});
  std::vector<Landing> landings;
  size_t nodes = 2, references = 0;
  lay_out(root, 0, tree, nodes, references, landings);
  tree.nodes.resize(nodes);
  tree.references.resize(references);
  executor(landings.size(), [&](size_t i) { land(landings[i], tree); });
}

}  // namespace vitral
