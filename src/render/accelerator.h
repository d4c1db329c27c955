// The scene prepared for tracing: triangles side by side and the trees over them.
#pragma once
#include "kdtree/build.h"
#include "kdtree/kdtree.h"
#include "kdtree/object_tree.h"
#include "kernels/points.h"
#include "parallel/parallel_for.h"
#include "raster/drawn.h"
#include "render/background.h"
#include "render/material_traits.h"
#include "render/mip_map.h"
#include "vitral/render.h"
#include "vitral/scene.h"

#include <array>
#include <memory>
#include <vector>

namespace vitral {

// The triangles of a mesh whose cut-outs are asked for; `material` is theirs where it is not kNoIndex.
struct CutOutMesh {
  const Scene* scene;
  const Mesh* mesh;
  uint32_t material;
};

// A model as the objects see it that give it one material, or leave it its own.
struct PlacedModel {
  uint32_t mesh, material;  // as in ModelView
  Box bounds;               // in the model's space, as are
  std::vector<KdTriangle> triangles;
  KdTree glass;
  CutOutMesh cut_outs;
};

// What objects place, and where they are at one moment.
struct PlacedObjects {
  std::vector<KdTree> trees;                         // of Scene::models; no nodes where nothing is placed
  std::vector<std::unique_ptr<PlacedModel>> models;  // each pair of mesh and material once
  std::vector<ModelView> views;                      // of them
  std::vector<uint32_t> model_of_object;             // into models; 0 of shapes
  std::vector<PlacedObject> objects;                 // those of the scene, in its order
  ObjectTree tree;
  ObjectsView view{};  // count 0: there are none
};

// Keeps pointers into itself and the scene: neither may move while it lives.
struct Accelerator {
  std::vector<KdTriangle> triangles;
  KdTree all;    // every triangle
  KdTree glass;  // only those of glass, for the tint of shadows; empty without glass
  KdView view, glass_view;
  bool has_glass = false;         // in the mesh or in objects
  bool has_cut_outs = false;      // in the mesh
  std::vector<FlatColor> colors;  // of the materials
  TraitTable traits;
  Sky sky;
  SurfaceView surfaces;
  PlacedObjects placed;
  DrawnModels drawn_models;
  std::vector<MipMap> mip_maps;  // of the scene's textures; empty: colours are those without them

  Accelerator() = default;
  Accelerator(const Accelerator&) = delete;
  Accelerator& operator=(const Accelerator&) = delete;
};

// Throws Interrupted when control.stop is set on the way.
void build_accelerator(const Scene& scene, ThreadPool& pool, const Control& control,
                       Accelerator& accelerator);

// Whether any object is at different places at different times.
bool moves(const Scene& scene);

// Puts the objects where they are at a time, once their models are there. May be called again for another
// time: what does not move costs as much as what does, but nothing is built but the tree over the objects.
// Throws UsageError when hits would need more than 2^32 - 2 numbers.
void place_objects(const Scene& scene, float time, Accelerator& accelerator);

// The triangles alone, with trees that are empty: all that the rasterizer needs.
void gather_triangles(const Scene& scene, ThreadPool& pool, Accelerator& accelerator);

// What tracing a mesh's triangles needs: what material m of the scene makes of them, and the triangles of a
// mesh side by side, with the flags of one material for all or, for kNoIndex, of their own.
std::vector<uint32_t> triangle_flags(const Scene& scene);
void gather_mesh(const Mesh& mesh, const std::vector<uint32_t>& flags, uint32_t material, ThreadPool& pool,
                 std::vector<KdTriangle>& triangles);

// The models that objects place; their trees.
void gather_models(const Scene& scene, ThreadPool& pool, Accelerator& accelerator);
void build_models(const Executor& executor, Accelerator& accelerator);

// The same models for the rasterizer.
void gather_drawn_models(const Scene& scene, ThreadPool& pool, Accelerator& accelerator);

// The rule by which a cut-out texture removes parts of a triangle: its finest level, at whatever distance. So
// all rays and the rasterizer agree on one shape, and as each asks one point of it, a share of them finds it
// there that is the shape's own. A mean of alpha over a footprint would go to all or nothing instead.
CutOuts make_cut_outs(const Scene& scene);

// The texture coordinates of a triangle's corners, (0, 0) where the mesh has none; and those at its
// barycentrics (u, v).
using CornerTexcoords = std::array<Vec2, 3>;
CornerTexcoords corner_texcoords(const Mesh& mesh, uint32_t triangle);
// The material of a hit with this number, on the scene's mesh or on an object.
uint32_t material_of(const Scene& scene, const PlacedObjects& placed, uint32_t number);
Vec2 texcoord_at(const Mesh& mesh, uint32_t triangle, float u, float v);

}  // namespace vitral
