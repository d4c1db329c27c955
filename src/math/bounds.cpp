#include "math/bounds.h"

#include "math/scalar.h"

namespace vitral {
namespace {

// How far a body reaches from the middle of its box along one axis of the world, for the images of its half
// axes: a box by their sum, round ones by the root of squares.
double reach(Shape shape, double x, double y, double z) {
  switch (shape) {
    case Shape::sphere:
      return square_root((x * x + y * y) + z * z);
    case Shape::cylinder:
      return square_root(x * x + z * z) + absolute(y);
    case Shape::disk:
      return square_root(x * x + z * z);
    default:
      return (absolute(x) + absolute(y)) + absolute(z);
  }
}

}  // namespace

Box placed_bounds(Shape shape, const Box& own, const Affine& placement) {
  const float endless = std::numeric_limits<float>::infinity();
  if (shape == Shape::plane) return {{-endless, -endless, -endless}, {endless, endless, endless}};
  if (shape == Shape::mesh && is_empty(own)) return {};
  const PreciseAffine a = to_double(placement);
  const bool mesh = shape == Shape::mesh;
  const Vec3d middle = mesh ? (to_double(own.min) + to_double(own.max)) * 0.5 : Vec3d{0, 0, 0};
  const Vec3d half = mesh ? (to_double(own.max) - to_double(own.min)) * 0.5 : Vec3d{1, 1, 1};
  const Vec3d x = a.x * half.x, y = a.y * half.y, z = a.z * half.z;
  const Vec3d center = transform_point(a, middle);
  const Vec3d around{reach(shape, x.x, y.x, z.x), reach(shape, x.y, y.y, z.y), reach(shape, x.z, y.z, z.z)};
  return {to_float(center - around), to_float(center + around)};
}

Affine placement_at(const Object& object, float time) {
  if (object.motion.empty()) return object.placement;
  const RigidKey pose = pose_at(object.motion, time);
  Affine turned = object.placement;
  turned.origin = {0, 0, 0};
  turned = affine_of({pose.time, {0, 0, 0}, pose.rotation}) * turned;
  turned.origin = object.placement.origin + pose.translation;
  return turned;
}

Box bounds(const Scene& scene) {
  Box all = bounds(scene.mesh);
  std::vector<Box> models;
  for (const Mesh& mesh : scene.models) models.push_back(bounds(mesh));
  const auto add = [&](const Object& object, const Affine& placement) {
    const Box own = object.shape == Shape::mesh ? models[object.model] : Box{};
    const Box box = placed_bounds(object.shape, own, placement);
    const float size = diagonal(box);
    if (!is_empty(box) && size - size == 0) extend(all, box);
  };
  for (const Object& object : scene.objects) {
    if (object.motion.empty()) add(object, object.placement);
    for (const RigidKey& key : object.motion) add(object, affine_of(key) * object.placement);
  }
  return all;
}

}  // namespace vitral
