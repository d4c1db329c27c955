// The upper part of the tree while it is built, and joining it with the subtrees below.
#pragma once
#include "kdtree/build.h"
#include "kdtree/sah.h"
#include "kdtree/subtree.h"

namespace vitral {

// The upper part of the tree: an inner node with two children, or a finished subtree. Until it is
// decided on, its references are count of them at `first` in the round's buffer.
struct Upper {
  Node node;
  size_t first = 0, count = 0;
  Box4 tight;
  double share = 0;  // of the whole work
  Plane plane{};
  Upper *below = nullptr, *above = nullptr;
  Subtree subtree;
};

// Lays the finished nodes out in depth-first order, which frees the subtrees. Sets all but the bounds.
void join(Upper& root, const Executor& executor, KdTree& tree);

}  // namespace vitral
