#include "io/mesh_builder.h"

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace vitral {

Vec3 clean_normal(const Vec3& normal) {
  const Vec3d n = to_double(normal);
  const double size = length(n);
  if (!(size > 0) || !std::isfinite(size)) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    return {nan, nan, nan};
  }
  return to_float({n.x / size, n.y / size, n.z / size});
}

Vec2 clean_texcoord(const Vec2& texcoord) {
  constexpr float kNoFraction = 8388608;  // 2^23
  const auto clean = [](float x) { return std::fabs(x) < kNoFraction ? x : 0.0f; };
  return {clean(texcoord.x), clean(texcoord.y)};
}

uint32_t add_default_material(Scene& scene) {
  scene.materials.emplace_back();
  scene.materials.back().name = "default";
  return static_cast<uint32_t>(scene.materials.size() - 1);
}

namespace {

// Appends `part`, numbered from 0, to a list of indices into a list that had `base` entries.
void append_corners(const std::vector<Corners>& part, size_t part_size, size_t base, size_t size,
                    std::vector<Corners>& list) {
  if (part.empty() && list.empty()) return;
  const Corners none{kNoIndex, kNoIndex, kNoIndex};
  list.resize(size, none);
  list.reserve(size + part_size);
  for (Corners corners : part) {
    for (uint32_t& index : corners) {
      if (index != kNoIndex) index += static_cast<uint32_t>(base);
    }
    list.push_back(corners);
  }
  list.resize(size + part_size, none);
}

template <class T>
void append_list(const std::vector<T>& part, std::vector<T>& list) {
  list.reserve(list.size() + part.size());
  list.insert(list.end(), part.begin(), part.end());
}

}  // namespace

void append(Mesh part, uint32_t first_material, Mesh& mesh) {
  for (uint32_t& material : part.triangle_material) material += first_material;
  if (mesh.triangles.empty()) {
    mesh = std::move(part);
    return;
  }
  const size_t size = mesh.triangles.size(), part_size = part.triangles.size();
  append_corners(part.triangles, part_size, mesh.positions.size(), size, mesh.triangles);
  append_corners(part.triangle_normals, part_size, mesh.normals.size(), size, mesh.triangle_normals);
  append_corners(part.triangle_texcoords, part_size, mesh.texcoords.size(), size, mesh.triangle_texcoords);
  append_list(part.triangle_material, mesh.triangle_material);
  append_list(part.positions, mesh.positions);
  append_list(part.normals, mesh.normals);
  append_list(part.texcoords, mesh.texcoords);
}

void report_dropped(const std::string& path, size_t kept, size_t dropped, Scene& scene, Warnings& warnings) {
  if (kept == 0 && dropped == 0) fail(path, "there are no triangles in it");
  if (kept == 0) fail(path, "no triangle is left: " + std::to_string(dropped) + " degenerate or not finite");
  scene.dropped_triangles += dropped;
  if (dropped > 0) {
    warnings.push_back(path + ": " + std::to_string(dropped) + " triangle" + (dropped == 1 ? "" : "s") +
                       " left out, degenerate or not finite");
  }
}

Box bounds(const Mesh& mesh) {
  Box box;
  for (const Corners& triangle : mesh.triangles) {
    for (const uint32_t p : triangle) extend(box, mesh.positions[p]);
  }
  return box;
}

}  // namespace vitral
