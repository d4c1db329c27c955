#include "app/auto_view.h"

#include "io/project.h"
#include "math/pinhole.h"
#include "vitral/error.h"

#include <algorithm>
#include <array>
#include <limits>

namespace vitral {
namespace {

constexpr float kFov = 40;                               // degrees
constexpr Vec3 kThreeQuarterView{-0.55f, -0.4f, -0.8f};  // from the front, the right and above

Vec3d unit(const Vec3& v) {
  return normalize(to_double(v));
}

// Right, up and forward of a camera that looks along `view`.
struct Basis {
  Vec3d right, up, forward;
};

Basis make_basis(const Vec3& view, const Vec3& up) {
  const Vec3d forward = unit(view);
  const Vec3d right = normalize(cross(forward, unit(up)));
  return {right, cross(right, forward), forward};
}

std::array<Vec3d, 8> corners(const Box& box) {
  const Vec3d low = to_double(box.min), high = to_double(box.max);
  std::array<Vec3d, 8> result;
  for (size_t i = 0; i < 8; ++i) {
    result[i] = {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z};
  }
  return result;
}

Vec3d middle(const Box& box) {
  return (to_double(box.min) + to_double(box.max)) * 0.5;
}

double diagonal_of(const Box& box) {
  return length(to_double(box.max) - to_double(box.min));
}

// A length to measure by, for every box: the diagonal, or some steps of what floats can tell apart out
// there if that is more; of a point at the origin, 1.
double scale_of(const Box& box) {
  const double scale = std::max(diagonal_of(box), 1e-4 * static_cast<double>(magnitude(box)));
  return scale > 0 ? scale : 1;
}

// Along one axis of the picture: the interval in which the eye may stand, as the depth of the box's
// middle grows, for every corner at (x, z) to stay inside |x - eye| <= k (z + depth).
struct Slab {
  double least = -std::numeric_limits<double>::infinity();  // max(x - k z)
  double most = std::numeric_limits<double>::infinity();    // min(x + k z)

  void add(double x, double z, double k) {
    least = std::max(least, x - k * z);
    most = std::min(most, x + k * z);
  }
  double depth(double k) const { return (least - most) / (2 * k); }
  double eye() const { return (least + most) / 2; }
};

// The nearest place from which all corners are inside the frame: for each of the two dimensions the
// depth at which the interval of eyes shrinks to one point, and of these the larger.
Vec3d best_eye(const Box& box, const Basis& basis, double tan_x, double tan_y) {
  const Vec3d target = middle(box);
  Slab horizontal, vertical;
  double nearest = 0;
  for (const Vec3d& corner : corners(box)) {
    const Vec3d offset = corner - target;
    const double depth = dot(offset, basis.forward);
    horizontal.add(dot(offset, basis.right), depth, tan_x);
    vertical.add(dot(offset, basis.up), depth, tan_y);
    nearest = std::min(nearest, depth);
  }
  const double distance =
      std::max({horizontal.depth(tan_x), vertical.depth(tan_y), 0.02 * scale_of(box) - nearest});
  return target + basis.right * horizontal.eye() + basis.up * vertical.eye() - basis.forward * distance;
}

// Near and far enclose the box with some room. From inside it, near is a small part of its size.
void enclose(const Box& box, Camera& camera, const ViewWishes& wishes) {
  const Vec3d forward = unit(camera.view);
  double nearest = std::numeric_limits<double>::infinity(), furthest = 0;
  for (const Vec3d& corner : corners(box)) {
    const double depth = dot(corner - to_double(camera.position), forward);
    nearest = std::min(nearest, depth);
    furthest = std::max(furthest, depth);
  }
  constexpr double kLeastNear = 5e-4;  // of the scale
  const double near = std::max(nearest * 0.5, scale_of(box) * kLeastNear);
  camera.near = wishes.near.value_or(static_cast<float>(near));
  camera.far = wishes.far.value_or(
      static_cast<float>(std::max(furthest * 1.1, 2.0 * static_cast<double>(camera.near))));
}

}  // namespace

Camera auto_camera(const Box& bounds, float aspect, const ViewWishes& wishes) {
  Camera camera;
  camera.name = "auto";
  camera.fov = wishes.fov.value_or(kFov);
  camera.near = 1;  // until the place is known
  camera.far = 2;

  // Where to look: as told; from a given eye, towards the middle; otherwise three-quarter.
  const Vec3d target = middle(bounds);
  camera.view = kThreeQuarterView;
  if (wishes.view) {
    camera.view = *wishes.view;
  } else if (wishes.eye) {
    const Vec3d way = target - to_double(*wishes.eye);
    if (length(way) > 0) camera.view = to_float(normalize(way));
  }
  camera.up = wishes.up.value_or(Vec3{0, 1, 0});
  if (!wishes.up && !camera_fault(camera).empty()) camera.up = {0, 0, -1};  // looks straight up or down
  const std::string fault = camera_fault(camera);
  if (!fault.empty()) throw UsageError("camera: " + fault);

  // Where to stand.
  if (wishes.eye) {
    camera.position = *wishes.eye;
  } else {
    const Pinhole unit_frame = make_pinhole(camera, 1, 1);
    const double tan_y = static_cast<double>(unit_frame.center_y * kFrameFill);
    camera.position = to_float(
        best_eye(bounds, make_basis(camera.view, camera.up), tan_y * static_cast<double>(aspect), tan_y));
  }
  enclose(bounds, camera, wishes);
  if (!(camera.near < camera.far)) throw UsageError("camera: near is not less than far");
  return camera;
}

void light_automatically(const Camera& camera, Scene& scene) {
  // From above, to the left of the viewer and a little behind him.
  const Basis basis = make_basis(camera.view, camera.up);
  Light sun;
  sun.direction = to_float(normalize(basis.right * 0.5 - basis.up * 0.75 + basis.forward * 0.6));
  sun.color = {0.75f, 0.75f, 0.75f};
  scene.lights = {sun};
  scene.ambient = {0.4f, 0.4f, 0.4f};
  scene.background = {0.8f, 0.8f, 0.8f};
}

float auto_ao_distance(const Box& bounds) {
  constexpr double kShare = 0.08;
  const double diagonal = diagonal_of(bounds);
  return static_cast<float>((diagonal > 0 ? diagonal : scale_of(bounds)) * kShare);
}

}  // namespace vitral
