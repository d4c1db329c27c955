// Objects: meshes and exact shapes that stand in the world by an affine map, and the tree over them.
//
// Two levels: every model has one kd-tree in its own space, however often it is placed, and one structure
// over the boxes of all objects leads rays to them. A ray goes into an object's space by the inverse map and
// keeps its parameter: t is the same in both, so that hits of all objects and of the mesh can be compared.
//
// Hits have one numbering for everything: the scene's own triangles first, then the objects in their order,
// each with as many numbers as its model has triangles, a shape with one. Of two hits at the same t the lower
// number is the closer one. The barycentrics of a hit on a mesh are those of the model's triangle; a shape's
// are 0, its point follows from the ray and t (shapes.h).
#pragma once
#include "kdtree/kdtree.h"
#include "vitral/scene.h"

namespace vitral {

struct PlacedObject {
  Affine to_world;
  PreciseAffine to_object;
  Box bounds;             // in the world; not finite for planes
  uint32_t first_number;  // the object's hits have the numbers [first_number, first_number + count)
  uint32_t count;
  uint32_t model;     // into ObjectsView::models; of shapes without meaning
  uint32_t material;  // kNoIndex: those of the model's triangles
  uint32_t flags;     // TriangleFlags of a shape, by its material
  Shape shape;
  bool mirrored;  // to_world turns left to right: the counter-clockwise corners of a front come out clockwise
};

// A ray in an object's space, in double: exact enough that what is left is the rounding of the ray itself.
// The direction is not normalized. Shapes take it as it is, kd-trees rounded to float.
template <class D>
struct ObjectRay {
  Vec3T<D> origin, direction;
};
template <class F>
static inline auto ray_to_object(const PlacedObject& object, const Vec3T<F>& origin,
                                 const Vec3T<F>& direction) {
  using D = decltype(widen(origin.x));
  const Vec3T<D> o{widen(origin.x), widen(origin.y), widen(origin.z)};
  const Vec3T<D> d{widen(direction.x), widen(direction.y), widen(direction.z)};
  return ObjectRay<D>{transform_point(object.to_object, o), transform_vector(object.to_object, d)};
}
template <class D>
static inline auto narrowed(const Vec3T<D>& v) {
  using F = decltype(narrow(v.x));
  return Vec3T<F>{narrow(v.x), narrow(v.y), narrow(v.z)};
}

// A model as its objects share it; one whose objects give it another material is a model of its own here,
// with the same tree and other flags.
struct ModelView {
  KdView tree;        // all triangles, numbered from 0
  KdView glass;       // only those of glass
  bool has_glass;     // where it has not, `glass` has no nodes
  uint32_t mesh;      // into Scene::models
  uint32_t material;  // kNoIndex: the triangles' own
};

// A node of the tree over the objects' boxes. `left` and `left + 1` are its children; of a leaf, `left` is
// the number of its object.
struct ObjectNode {
  Box bounds;
  float slack;  // times traversal_slack(): the most that any object below needs
  uint32_t left;
  uint32_t axis;  // along which the left child comes first; 3: a leaf
};

// The objects as the traversals see them: pointers only.
struct ObjectsView {
  const PlacedObject* objects;
  uint32_t count;  // of objects; 0: nothing else here means anything
  const ModelView* models;
  const ObjectNode* nodes;  // nodes[0] is the root; null: no object has bounds
  const uint32_t* unbounded;
  uint32_t unbounded_count;
  uint32_t first_number, end_number;  // the objects' hits have numbers in [first_number, end_number)
  float magnitude;                    // largest absolute coordinate that goes into the objects' hits
  CutOuts cut_outs;                   // of shapes: of which object, and its texture coordinates
};

static inline bool is_object(const ObjectsView& view, uint32_t number) {
  return number >= view.first_number && number < view.end_number;
}

// The object that has a number, which must be one of theirs.
static inline uint32_t object_of(const ObjectsView& view, uint32_t number) {
  uint32_t low = 0, high = view.count;
  while (high - low > 1) {
    const uint32_t middle = low + (high - low) / 2;
    (view.objects[middle].first_number <= number ? low : high) = middle;
  }
  return low;
}

// The nearest point in (tmin, tmax) at which a ray meets a shape with kCutOutTriangle, and its texture is
// there.
bool meet_cut_out(const ObjectsView& view, uint32_t object, const Ray& ray, float& t);

// One ray, one lane at a time: the text to read first, and the reference for the packets. `best` becomes the
// closest hit of the objects where that is closer. With glass_only nothing else is seen, a hit's t and number
// alone count.
enum class Seen { everything, glass_only };
void walk_objects(const ObjectsView& view, const Ray& ray, Seen seen, Hit& best);
void walk_objects(const ObjectsView& view, const Ray& ray, Seen seen, Hit& best, TraversalCounts& counts);
bool walk_objects_any(const ObjectsView& view, const Ray& ray, GlassRule glass);

// The same answers from testing all triangles and shapes: what the tree is measured against.
void brute_force_objects(const ObjectsView& view, const Ray& ray, Hit& best);
bool brute_force_objects_any(const ObjectsView& view, const Ray& ray, GlassRule glass);

// False when no object comes near the box.
bool comes_near(const ObjectsView& view, const Box& box);

}  // namespace vitral
