#include "render/accelerator.h"

#include "math/footprint.h"
#include "render/texture.h"
#include "vitral/error.h"

#include <algorithm>

namespace vitral {
namespace {

bool cut_out_is_there(const void* scene_pointer, uint32_t triangle, float u, float v) {
  const Scene& scene = *static_cast<const Scene*>(scene_pointer);
  const Material& m = scene.materials[scene.mesh.triangle_material[triangle]];
  const Texture& map = scene.textures[static_cast<size_t>(m.opacity_map)];
  return sample_alpha(map, texcoord_at(scene.mesh, triangle, u, v)) >= 0.5f;
}

uint32_t in_255ths(float x) {
  return static_cast<uint32_t>((x > 0 ? least(x, 1.0f) : 0.0f) * 255 + 0.5f);
}

void set_views(const Scene& scene, Accelerator& a) {
  const Mesh& mesh = scene.mesh;
  a.colors.clear();
  for (const Material& m : scene.materials) {
    const Vec3& kd = m.diffuse;
    a.colors.push_back({kd, in_255ths(kd.x) | in_255ths(kd.y) << 8 | in_255ths(kd.z) << 16 | 255u << 24});
  }
  a.traits = make_traits(scene.materials);
  a.sky = make_sky(scene);
  a.surfaces = {a.triangles.data(),
                mesh.triangle_normals.empty() ? nullptr : mesh.triangle_normals.front().data(),
                mesh.normals.data(), mesh.triangle_material.data(), a.colors.data()};
  const CutOuts cut_outs = make_cut_outs(scene);
  a.view = make_view(a.all, a.triangles, cut_outs);
  a.glass_view = make_view(a.glass, a.triangles, cut_outs);
}

}  // namespace

CutOuts make_cut_outs(const Scene& scene) {
  return {cut_out_is_there, &scene};
}

CornerTexcoords corner_texcoords(const Mesh& mesh, uint32_t triangle) {
  CornerTexcoords corner{};
  if (mesh.triangle_texcoords.empty()) return corner;
  for (size_t k = 0; k < 3; ++k) {
    const uint32_t i = mesh.triangle_texcoords[triangle][k];
    if (i != kNoIndex) corner[k] = mesh.texcoords[i];
  }
  return corner;
}

Vec2 texcoord_at(const Mesh& mesh, uint32_t triangle, float u, float v) {
  const CornerTexcoords c = corner_texcoords(mesh, triangle);
  return {at_barycentrics(c[0].x, c[1].x, c[2].x, u, v), at_barycentrics(c[0].y, c[1].y, c[2].y, u, v)};
}

void gather_mesh(const Mesh& mesh, const std::vector<uint32_t>& flags, uint32_t material, ThreadPool& pool,
                 std::vector<KdTriangle>& triangles) {
  triangles.resize(mesh.triangles.size());
  constexpr size_t kChunk = 16384;
  pool.parallel_for((triangles.size() + kChunk - 1) / kChunk, [&](size_t chunk, size_t) {
    const size_t end = std::min(triangles.size(), (chunk + 1) * kChunk);
    for (size_t i = chunk * kChunk; i < end; ++i) {
      for (size_t k = 0; k < 3; ++k) {
        const Vec3& p = mesh.positions[mesh.triangles[i][k]];
        triangles[i].corner[k][0] = p.x;
        triangles[i].corner[k][1] = p.y;
        triangles[i].corner[k][2] = p.z;
      }
      triangles[i].flags = flags[material != kNoIndex ? material : mesh.triangle_material[i]];
    }
  });
}

void gather_triangles(const Scene& scene, ThreadPool& pool, Accelerator& accelerator) {
  const std::vector<uint32_t> flags = triangle_flags(scene);
  accelerator.has_cut_outs =
      std::any_of(flags.begin(), flags.end(), [](uint32_t f) { return (f & kCutOutTriangle) != 0; });
  gather_mesh(scene.mesh, flags, kNoIndex, pool, accelerator.triangles);
  gather_models(scene, pool, accelerator);
  gather_drawn_models(scene, pool, accelerator);
  place_objects(scene, 0, accelerator);
  set_views(scene, accelerator);
}

void build_accelerator(const Scene& scene, ThreadPool& pool, const Control& control, Accelerator& a) {
  gather_triangles(scene, pool, a);
  std::vector<uint32_t> all(a.triangles.size()), glass;
  for (uint32_t i = 0; i < all.size(); ++i) {
    all[i] = i;
    if (a.triangles[i].flags & kGlassTriangle) glass.push_back(i);
  }
  const Executor executor = [&](size_t count, const std::function<void(size_t)>& body) {
    pool.parallel_for(count, [&](size_t i, size_t) {
      if (control.stop.load(std::memory_order_relaxed)) throw Interrupted();
      body(i);
    });
  };
  const BuildSettings settings;
  const BuildProgress progress = [&](double share) {
    if (control.on_progress) control.on_progress({"build", share, 0});
  };
  a.all = build_kdtree(a.triangles, all, settings, executor, progress);
  a.glass = build_kdtree(a.triangles, glass, settings, executor);
  a.has_glass |= !glass.empty();
  build_models(executor, a);
  set_views(scene, a);
}

}  // namespace vitral
