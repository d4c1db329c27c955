#include "app/auto_view.h"

#include "io/project.h"
#include "math/pinhole.h"
#include "vitral/error.h"

#include <algorithm>
#include <array>
#include <limits>

namespace vitral {
namespace {

constexpr float kInsideFov = 65;
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

// The nearest place from which all points are inside the frame: for each of the two dimensions the
// depth at which the interval of eyes shrinks to one point, and of these the larger.
template <class ForEachPoint>
Vec3d best_eye(const Box& box, const Basis& basis, double tan_x, double tan_y, ForEachPoint for_each_point) {
  const Vec3d target = middle(box);
  Slab horizontal, vertical;
  double nearest = std::numeric_limits<double>::infinity();
  for_each_point([&](const Vec3d& point) {
    const Vec3d offset = point - target;
    const double depth = dot(offset, basis.forward);
    horizontal.add(dot(offset, basis.right), depth, tan_x);
    vertical.add(dot(offset, basis.up), depth, tan_y);
    nearest = std::min(nearest, depth);
  });
  const double distance =
      std::max({horizontal.depth(tan_x), vertical.depth(tan_y), 0.02 * scale_of(box) - nearest});
  return target + basis.right * horizontal.eye() + basis.up * vertical.eye() - basis.forward * distance;
}

template <class ForEachPoint>
void stand_back(const Box& box, float aspect, Camera& camera, ForEachPoint for_each_point) {
  const double tan_y = static_cast<double>(make_pinhole(camera, 1, 1).center_y * kFrameFill);
  const double tan_x = tan_y * static_cast<double>(aspect);
  camera.position = to_float(best_eye(box, make_basis(camera.view, camera.up), tan_x, tan_y, for_each_point));
}

// Near and far enclose the bounds with some room. From inside them, near is a small part of `scale`.
void enclose(const Box& bounds, double scale, Camera& camera, const ViewWishes& wishes) {
  const Vec3d forward = unit(camera.view);
  double nearest = std::numeric_limits<double>::infinity(), furthest = 0;
  for (const Vec3d& corner : corners(bounds)) {
    const double depth = dot(corner - to_double(camera.position), forward);
    nearest = std::min(nearest, depth);
    furthest = std::max(furthest, depth);
  }
  constexpr double kLeastNear = 5e-4;  // of the scale
  const double near =
      std::max({nearest * 0.5, scale * kLeastNear, static_cast<double>(std::numeric_limits<float>::min())});
  camera.near = wishes.near.value_or(static_cast<float>(near));
  const double far = std::max(furthest * 1.1, 2.0 * static_cast<double>(camera.near));
  camera.far = wishes.far.value_or(static_cast<float>(far));
  if (!(camera.near < camera.far)) throw UsageError("camera: near is not less than far");
}

// The way it looks, up and the angle; the place is yet to be found.
Camera aimed_camera(const Vec3& view, float fov, const ViewWishes& wishes) {
  Camera camera;
  camera.name = "auto";
  camera.fov = wishes.fov.value_or(fov);
  camera.near = 1;
  camera.far = 2;
  camera.view = view;
  camera.up = wishes.up.value_or(Vec3{0, 1, 0});
  if (!wishes.up && !camera_fault(camera).empty()) camera.up = {0, 0, -1};  // looks straight up or down
  const std::string fault = camera_fault(camera);
  if (!fault.empty()) throw UsageError("camera: " + fault);
  return camera;
}

}  // namespace

Camera auto_camera(const Mesh& mesh, float aspect, const ViewWishes& wishes) {
  // Where to look: as told; from a given eye, towards the middle; otherwise three-quarter.
  const Box box = bounds(mesh);
  Vec3 view = kThreeQuarterView;
  if (wishes.view) {
    view = *wishes.view;
  } else if (wishes.eye) {
    const Vec3d way = middle(box) - to_double(*wishes.eye);
    if (length(way) > 0) view = to_float(normalize(way));
  }
  Camera camera = aimed_camera(view, kFov, wishes);

  // Where to stand.
  if (wishes.eye) {
    camera.position = *wishes.eye;
  } else {
    stand_back(box, aspect, camera, [&](const auto& add) {
      for (const Corners& triangle : mesh.triangles) {
        for (const uint32_t corner : triangle) add(to_double(mesh.positions[corner]));
      }
    });
  }
  enclose(box, scale_of(box), camera, wishes);
  return camera;
}

Box core(const Mesh& mesh) {
  // Some thousands of triangles, evenly taken, tell as much as all.
  constexpr size_t kMostSamples = 4096;
  const size_t step = mesh.triangles.size() / kMostSamples + 1;
  std::array<std::vector<float>, 3> values;
  for (size_t i = 0; i < mesh.triangles.size(); i += step) {
    for (int axis = 0; axis < 3; ++axis) {
      values[static_cast<size_t>(axis)].push_back(component(mesh.positions[mesh.triangles[i][0]], axis));
    }
  }
  for (std::vector<float>& sorted : values) std::sort(sorted.begin(), sorted.end());
  const size_t last = values[0].size() - 1, left_out = last / 20;
  const auto at = [&](size_t i) { return Vec3{values[0][i], values[1][i], values[2][i]}; };
  return {at(left_out), at(last - left_out)};
}

std::vector<View> candidate_views(const Mesh& mesh, float aspect, const ViewWishes& wishes) {
  std::vector<View> views{{auto_camera(mesh, aspect, wishes), Place::outside}};
  const Box whole = bounds(mesh), box = core(mesh);
  const Vec3 middle_of_core = center(box), size = extent(box);
  const double scale = scale_of(box);

  // From around the core, as if there were nothing else.
  for (const Vec3& sides : {Vec3{1, 1, 1}, Vec3{-1, 1, 1}, Vec3{1, 1, -1}, Vec3{-1, 1, -1}}) {
    Camera camera = aimed_camera(kThreeQuarterView * sides, kFov, wishes);
    stand_back(box, aspect, camera, [&](const auto& add) {
      for (const Vec3d& corner : corners(box)) add(corner);
    });
    enclose(whole, scale, camera, wishes);
    views.push_back({camera, Place::outside});
  }

  // What is flat has no inside.
  if (!(size.x > 0 && size.y > 0 && size.z > 0)) return views;

  // From the ends and corners of the core, at two heights, level and a little down, through its middle.
  constexpr float kFromMiddle = 0.42f;  // of the size
  for (const float height : {0.3f, 0.5f}) {
    for (const Vec3& way : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{1, 0, 1},
                            Vec3{-1, 0, 1}, Vec3{1, 0, -1}, Vec3{-1, 0, -1}}) {
      const Vec3d level = normalize(to_double(way) * to_double(size));  // in floats, squares may vanish
      Camera camera = aimed_camera(to_float(normalize(level + Vec3d{0, -0.08, 0})), kInsideFov, wishes);
      camera.position = middle_of_core - way * size * kFromMiddle;
      camera.position.y = box.min.y + size.y * height;
      enclose(whole, scale, camera, wishes);
      views.push_back({camera, Place::inside});
    }
  }
  return views;
}

const View& best_view(const std::vector<View>& views, const std::function<Richness(const Camera&)>& look) {
  const auto triangles = [](const Richness& r) { return static_cast<double>(r.triangles); };
  const auto density = [&](const Richness& r) {
    return triangles(r) / static_cast<double>(std::max<size_t>(r.pixels, 1));
  };
  const View* best = &views.front();
  const Richness usual = look(best->camera);
  double most = 0;
  for (size_t i = 1; i < views.size(); ++i) {
    const Richness here = look(views[i].camera);
    const bool is_better = views[i].place == Place::outside ? triangles(here) > 2 * triangles(usual)
                                                            : triangles(here) > 1.5 * triangles(usual) &&
                                                                  density(here) > 1.5 * density(usual);
    if (!is_better || triangles(here) <= most) continue;
    most = triangles(here);
    best = &views[i];
  }
  return *best;
}

void light_automatically(const View& view, Scene& scene) {
  // From above, to the left of the viewer and behind him. Little of it comes into a room.
  const Basis basis = make_basis(view.camera.view, view.camera.up);
  Light sun;
  sun.direction = to_float(normalize(basis.right * 0.7 - basis.up * 0.65 + basis.forward * 0.45));
  sun.color = {0.75f, 0.75f, 0.75f};
  scene.lights = {sun};
  const float ambient = view.place == Place::inside ? 0.75f : 0.35f;
  scene.ambient = {ambient, ambient, ambient};
  scene.background.color = {0.8f, 0.8f, 0.8f};
}

float auto_ao_distance(const Box& core) {
  constexpr double kShare = 0.08;
  const double diagonal = diagonal_of(core);
  return static_cast<float>((diagonal > 0 ? diagonal : scale_of(core)) * kShare);
}

}  // namespace vitral
