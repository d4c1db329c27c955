// Building the tree.
#pragma once
#include "kdtree/kdtree.h"
#include "kdtree/sah.h"

#include <functional>
#include <vector>

namespace vitral {

struct BuildSettings {
  SahCosts costs;
  size_t binned_above = 24;  // references in a node above which planes are binned; at most kExactAtMost
  size_t subtree_at_most =
      2048;  // larger nodes are split one by one by all workers, smaller ones are one task
};

// Runs body(i) for every i in [0, count), in any order and on any threads.
using Executor = std::function<void(size_t count, const std::function<void(size_t)>& body)>;

// Is told which share of the references is finished, in [0, 1], never less than before and 1 at last;
// called from any thread, one at a time.
using BuildProgress = std::function<void(double share)>;

// Builds over the triangles listed in `members`, numbers into `triangles`. The tree is the same
// whatever the executor does. Depth is at most kMaxTreeDepth, and there are at most 4 references a
// triangle: a node that would need more becomes a leaf.
KdTree build_kdtree(const std::vector<KdTriangle>& triangles, const std::vector<uint32_t>& members,
                    const BuildSettings& settings, const Executor& executor,
                    const BuildProgress& on_progress = {});

}  // namespace vitral
