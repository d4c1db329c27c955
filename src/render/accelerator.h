// The scene prepared for tracing: triangles side by side and the trees over them.
#pragma once
#include "kdtree/build.h"
#include "kdtree/kdtree.h"
#include "kernels/points.h"
#include "parallel/parallel_for.h"
#include "render/mip_map.h"
#include "vitral/render.h"
#include "vitral/scene.h"

#include <array>
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
  std::vector<MipMap> mip_maps;  // of the scene's textures; empty: colours are those without them

  Accelerator() = default;
  Accelerator(const Accelerator&) = delete;
  Accelerator& operator=(const Accelerator&) = delete;
};

// Throws Interrupted when control.stop is set on the way.
void build_accelerator(const Scene& scene, ThreadPool& pool, const Control& control,
                       Accelerator& accelerator);

// The triangles alone, with trees that are empty: all that the rasterizer needs.
void gather_triangles(const Scene& scene, ThreadPool& pool, Accelerator& accelerator);

// The rule by which a cut-out texture removes parts of a triangle: its finest level, at whatever distance. So
// all rays and the rasterizer agree on one shape, and as each asks one point of it, a share of them finds it
// there that is the shape's own. A mean of alpha over a footprint would go to all or nothing instead.
CutOuts make_cut_outs(const Scene& scene);

// The texture coordinates of a triangle's corners, (0, 0) where the mesh has none; and those at its
// barycentrics (u, v).
using CornerTexcoords = std::array<Vec2, 3>;
CornerTexcoords corner_texcoords(const Mesh& mesh, uint32_t triangle);
Vec2 texcoord_at(const Mesh& mesh, uint32_t triangle, float u, float v);

}  // namespace vitral
