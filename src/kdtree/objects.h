// Objects: meshes and exact shapes that stand in the world by an affine map, and the tree over them.
//
// Two levels: every model has one kd-tree in its own space, however often it is placed, and one structure
// over the boxes of all objects leads rays to them. A ray goes into an object's space by the inverse map and
// keeps its parameter: t is the same in both, so that hits of all objects and of the mesh can be compared.
//
// Hits have one numbering for everything: the scene's own triangles first, then the objects in their order,
// each with as many numbers as its model has triangles, a shape with one. Of two hits at the same t the lower
// number is the closer one.
#pragma once
#include "kdtree/kdtree.h"
#include "vitral/scene.h"

namespace vitral {

struct PlacedObject {
  Affine to_world, to_object;
  Box bounds;             // in the world; not finite for planes
  uint32_t first_number;  // the object's hits have the numbers [first_number, first_number + count)
  uint32_t count;
  uint32_t model;     // into ObjectsView::models; of shapes without meaning
  uint32_t material;  // kNoIndex: those of the model's triangles
  uint32_t flags;     // TriangleFlags of a shape, by its material
  Shape shape;
};

}  // namespace vitral
