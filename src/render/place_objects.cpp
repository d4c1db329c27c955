// Models and objects: each mesh that is placed gets one tree, each choice of material for it the flags of its
// triangles; and at a moment every object gets its place, and all together a tree over them.
#include "math/bounds.h"
#include "math/footprint.h"
#include "render/accelerator.h"
#include "render/texture.h"
#include "vitral/error.h"

#include <algorithm>

namespace vitral {
namespace {

bool shows(const Scene& scene, const Material& m, const Vec2& uv) {
  return sample_alpha(scene.textures[static_cast<size_t>(m.opacity_map)], uv) >= 0.5f;
}

bool model_is_there(const void* pointer, uint32_t triangle, float u, float v) {
  const CutOutMesh& at = *static_cast<const CutOutMesh*>(pointer);
  const uint32_t material = at.material != kNoIndex ? at.material : at.mesh->triangle_material[triangle];
  return shows(*at.scene, at.scene->materials[material], texcoord_at(*at.mesh, triangle, u, v));
}

bool shape_is_there(const void* pointer, uint32_t object, float u, float v) {
  const Scene& scene = *static_cast<const Scene*>(pointer);
  return shows(scene, scene.materials[scene.objects[object].material], {u, v});
}

// Their number is that of the models used, with few materials each.
uint32_t find_model(const Scene& scene, const Object& object, PlacedObjects& placed) {
  for (uint32_t i = 0; i < placed.models.size(); ++i) {
    if (placed.models[i]->mesh == object.model && placed.models[i]->material == object.material) return i;
  }
  auto model = std::make_unique<PlacedModel>();
  model->mesh = object.model, model->material = object.material;
  const Mesh& mesh = scene.models[object.model];
  model->bounds = bounds(mesh);
  model->cut_outs = {&scene, &mesh, object.material};
  placed.models.push_back(std::move(model));
  return static_cast<uint32_t>(placed.models.size() - 1);
}

ModelView view_of(const PlacedObjects& placed, const PlacedModel& model) {
  const CutOuts cut_outs{model_is_there, &model.cut_outs};
  return {make_view(placed.trees[model.mesh], model.triangles, cut_outs),
          make_view(model.glass, model.triangles, cut_outs), !model.glass.references.empty(), model.mesh,
          model.material};
}

uint32_t count_of(const Scene& scene, const Object& object) {
  return object.shape == Shape::mesh ? static_cast<uint32_t>(scene.models[object.model].triangles.size())
                                     : 1u;
}

// The largest coordinate that goes into a hit in the object: the placement's origin, and the object's own as
// large as they are in the world.
float reach_of(const PlacedObject& object, const Box& own) {
  const Affine& a = object.to_world;
  const float m = object.shape == Shape::mesh ? magnitude(own) : 1.0f;
  const auto along = [&](float x, float y, float z, float o) {
    return absolute(o) + ((absolute(x) + absolute(y)) + absolute(z)) * m;
  };
  return greatest(along(a.x.x, a.y.x, a.z.x, a.origin.x),
                  greatest(along(a.x.y, a.y.y, a.z.y, a.origin.y), along(a.x.z, a.y.z, a.z.z, a.origin.z)));
}

void set_view(const Scene& scene, Accelerator& a) {
  PlacedObjects& p = a.placed;
  ObjectsView& view = p.view;
  view = {};
  view.objects = p.objects.data(), view.count = static_cast<uint32_t>(p.objects.size());
  view.models = p.views.data();
  view.nodes = p.tree.nodes.empty() ? nullptr : p.tree.nodes.data();
  view.unbounded = p.tree.unbounded.data();
  view.unbounded_count = static_cast<uint32_t>(p.tree.unbounded.size());
  view.first_number = static_cast<uint32_t>(a.triangles.size());
  view.end_number =
      p.objects.empty() ? view.first_number : p.objects.back().first_number + p.objects.back().count;
  for (const PlacedObject& o : p.objects) {
    const Box own = o.shape == Shape::mesh ? p.models[o.model]->bounds : Box{};
    view.magnitude = greatest(view.magnitude, reach_of(o, own));
  }
  view.cut_outs = {shape_is_there, &scene};
}

}  // namespace

uint32_t material_of(const Scene& scene, const PlacedObjects& placed, uint32_t number) {
  if (!is_object(placed.view, number)) return scene.mesh.triangle_material[number];
  const PlacedObject& o = placed.objects[object_of(placed.view, number)];
  if (o.material != kNoIndex) return o.material;
  return scene.models[placed.models[o.model]->mesh].triangle_material[number - o.first_number];
}

std::vector<uint32_t> triangle_flags(const Scene& scene) {
  std::vector<uint32_t> flags(scene.materials.size());
  for (size_t m = 0; m < flags.size(); ++m) {
    flags[m] = (is_glass(scene.materials[m]) ? kGlassTriangle : 0u) |
               (scene.materials[m].opacity_map != kNoTexture ? kCutOutTriangle : 0u);
  }
  return flags;
}

void gather_models(const Scene& scene, ThreadPool& pool, Accelerator& a) {
  PlacedObjects& p = a.placed;
  p = {};
  p.trees.resize(scene.models.size());
  const std::vector<uint32_t> flags = triangle_flags(scene);
  for (const Object& object : scene.objects) {
    p.model_of_object.push_back(object.shape == Shape::mesh ? find_model(scene, object, p) : 0);
    if (object.shape != Shape::mesh && (flags[object.material] & kGlassTriangle)) a.has_glass = true;
  }
  for (const auto& model : p.models) {
    gather_mesh(scene.models[model->mesh], flags, model->material, pool, model->triangles);
    for (const KdTriangle& t : model->triangles) a.has_glass |= (t.flags & kGlassTriangle) != 0;
    p.views.push_back(view_of(p, *model));
  }
}

void gather_drawn_models(const Scene& scene, ThreadPool& pool, Accelerator& a) {
  DrawnModels& drawn = a.drawn_models;
  drawn.meshes.assign(scene.models.size(), {});
  drawn.has_cut_outs.clear();
  std::vector<bool> used(scene.models.size());
  for (const auto& model : a.placed.models) {
    used[model->mesh] = true;
    drawn.has_cut_outs.push_back(
        std::any_of(model->triangles.begin(), model->triangles.end(),
                    [](const KdTriangle& t) { return (t.flags & kCutOutTriangle) != 0; }));
  }
  pool.parallel_for(used.size(), [&](size_t i, size_t) {
    if (used[i]) drawn.meshes[i] = cluster_mesh(scene.models[i]);
  });
}

void build_models(const Executor& executor, Accelerator& a) {
  PlacedObjects& p = a.placed;
  const BuildSettings settings;
  for (const auto& model : p.models) {
    std::vector<uint32_t> all(model->triangles.size()), glass;
    for (uint32_t i = 0; i < all.size(); ++i) {
      all[i] = i;
      if (model->triangles[i].flags & kGlassTriangle) glass.push_back(i);
    }
    if (p.trees[model->mesh].nodes.empty())
      p.trees[model->mesh] = build_kdtree(model->triangles, all, settings, executor);
    if (!glass.empty()) model->glass = build_kdtree(model->triangles, glass, settings, executor);
  }
  for (size_t i = 0; i < p.models.size(); ++i) p.views[i] = view_of(p, *p.models[i]);
}

bool moves(const Scene& scene) {
  return std::any_of(scene.objects.begin(), scene.objects.end(),
                     [](const Object& object) { return object.motion.size() > 1; });
}

void place_objects(const Scene& scene, float time, Accelerator& a) {
  PlacedObjects& p = a.placed;
  const std::vector<uint32_t> flags = triangle_flags(scene);
  p.objects.resize(scene.objects.size());
  uint64_t number = a.triangles.size();
  for (size_t i = 0; i < p.objects.size(); ++i) {
    const Object& object = scene.objects[i];
    PlacedObject& o = p.objects[i];
    o.to_world = placement_at(object, time);
    o.to_object = precise_inverse(o.to_world);
    o.shape = object.shape;
    o.mirrored = determinant(o.to_world) < 0;
    o.model = p.model_of_object[i];
    o.material = object.material;
    o.flags = object.shape == Shape::mesh ? 0 : flags[object.material];
    o.bounds = placed_bounds(o.shape, o.shape == Shape::mesh ? p.models[o.model]->bounds : Box{}, o.to_world);
    o.first_number = static_cast<uint32_t>(number);
    o.count = count_of(scene, object);
    number += o.count;
    if (number >= kNoTriangle)
      throw UsageError("the objects have more than " + std::to_string(kNoTriangle - 1) + " triangles");
  }
  p.tree = build_object_tree(p.objects);
  set_view(scene, a);
}

}  // namespace vitral
