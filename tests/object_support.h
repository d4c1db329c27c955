// Objects for tests: an accelerator over a scene, random placements, small models.
#pragma once
#include "render/accelerator.h"
#include "support.h"

#include <thread>

namespace vitral::test {

// The scene must not move while this lives.
struct Built {
  Accelerator accelerator;
  explicit Built(const Scene& scene) {
    ThreadPool pool(2);
    Control control;
    build_accelerator(scene, pool, control, accelerator);
  }
  const ObjectsView& objects() const { return accelerator.placed.view; }
};

// A mesh of its own, as a model.
inline uint32_t add_model(Scene& scene, uint32_t material, const std::vector<KdTriangle>& triangles) {
  Scene other;
  add_triangles(other, material, triangles);
  scene.models.push_back(std::move(other.mesh));
  return static_cast<uint32_t>(scene.models.size() - 1);
}

inline Affine scaling(float x, float y, float z) {
  return {{x, 0, 0}, {0, y, 0}, {0, 0, z}, {0, 0, 0}};
}
inline Affine translation(const Vec3& by) {
  Affine a;
  a.origin = by;
  return a;
}

inline Object shape_at(Shape shape, uint32_t material, const Affine& placement) {
  Object object;
  object.shape = shape;
  object.material = material;
  object.placement = placement;
  return object;
}
inline Object model_at(uint32_t model, const Affine& placement, uint32_t material = kNoIndex) {
  Object object;
  object.model = model;
  object.material = material;
  object.placement = placement;
  return object;
}

// Turned, mirrored, sheared, squashed; every kind of map by `kind`.
inline Affine random_placement(Random& random, uint32_t kind) {
  Affine a = rotation(random.direction(), random.between(0, 360));
  switch (kind % 6) {
    case 0:
      break;
    case 1:
      a = a * scaling(0.3f, 0.3f, 0.3f);
      break;
    case 2:
      a = a * scaling(-0.5f, 0.4f, 0.3f) * rotation(random.direction(), random.between(0, 360));
      break;
    case 3:
      a = {random.in_box(-1, 1), random.in_box(-1, 1), random.in_box(-1, 1), {0, 0, 0}};
      break;
    case 4:
      a = a * scaling(1e-3f, 1e-3f, 1e-3f);
      break;
    case 5:
      a = a * scaling(1, 1e-3f, 0.7f) * rotation(random.direction(), random.between(0, 360));
      break;
  }
  a.origin = random.in_box(-3, 3);
  return a;
}

}  // namespace vitral::test
