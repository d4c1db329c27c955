// Boxes of what stands in the world by an affine map.
#pragma once
#include "vitral/scene.h"

namespace vitral {

// Of a shape or, for Shape::mesh, of whatever lies in `own`. Without end for planes, whatever their
// placement; rounded to nearest.
Box placed_bounds(Shape shape, const Box& own, const Affine& placement);

// The map that goes after an object's placement at a time, and both together.
Affine placement_at(const Object& object, float time);

}  // namespace vitral
