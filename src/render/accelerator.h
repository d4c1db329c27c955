// The scene prepared for tracing: triangles side by side and the trees over them.
#pragma once
#include "kdtree/build.h"
#include "kdtree/kdtree.h"
#include "kernels/points.h"
#include "parallel/parallel_for.h"
#include "vitral/render.h"
#include "vitral/scene.h"

#include <vector>

namespace vitral {

// Keeps pointers into itself and the scene: neither may move while it lives.
struct Accelerator {
  std::vector<KdTriangle> triangles;
  KdTree all;    // every triangle
  KdTree glass;  // only those of glass, for the tint of shadows; empty without glass
  KdView view, glass_view;
  bool has_glass = false, has_cut_outs = false;
  std::vector<FlatColor> colors;  // of the materials
  SurfaceView surfaces;

  Accelerator() = default;
  Accelerator(const Accelerator&) = delete;
  Accelerator& operator=(const Accelerator&) = delete;
};

// Throws Interrupted when control.stop is set on the way.
void build_accelerator(const Scene& scene, ThreadPool& pool, const Control& control,
                       Accelerator& accelerator);

// The triangles alone, with trees that are empty: all that the rasterizer needs.
void gather_triangles(const Scene& scene, ThreadPool& pool, Accelerator& accelerator);

// The rule by which a cut-out texture removes parts of a triangle.
CutOuts make_cut_outs(const Scene& scene);

// The texture coordinates at barycentrics (u, v) of a triangle; (0, 0) where the mesh has none.
Vec2 texcoord_at(const Mesh& mesh, uint32_t triangle, float u, float v);

}  // namespace vitral
