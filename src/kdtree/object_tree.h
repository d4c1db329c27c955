// The tree over the objects' boxes: a binary tree of boxes (bounding volume hierarchy), one object a leaf.
// Its planes are chosen by the surface area heuristic among evenly spaced ones (Wald, "On fast Construction
// of SAH-based Bounding Volume Hierarchies", 2007).
#pragma once
#include "kdtree/objects.h"

#include <vector>

namespace vitral {

struct ObjectTree {
  std::vector<ObjectNode> nodes;    // as ObjectsView has them
  std::vector<uint32_t> unbounded;  // objects without a box, in their order
};

// How far off the world's ray, in traversal_slack(), an object's hits may lie: a ray is rounded in its space,
// and what it misses there by one rounding comes back larger by as much as the object is longer than wide.
float slack_of(const PlacedObject& object);

// The same tree whatever the order of evaluation; a pure function of the objects.
ObjectTree build_object_tree(const std::vector<PlacedObject>& objects);

// Depth is at most this.
inline constexpr int kMaxObjectDepth = 96;

}  // namespace vitral
