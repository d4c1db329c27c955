#include "app/commands.h"
#include "app/json.h"

#include <charconv>

namespace vitral {
namespace {

const char* name_of(Optics optics) {
  switch (optics) {
    case Optics::opaque:
      return "opaque";
    case Optics::mirror:
      return "mirror";
    case Optics::polished:
      return "polished";
    case Optics::solid:
      return "solid glass";
    case Optics::thin:
      return "thin glass";
    case Optics::dissolve:
      return "dissolve";
  }
  return "";
}

const char* name_of(Light::Kind kind) {
  switch (kind) {
    case Light::Kind::directional:
      return "directional";
    case Light::Kind::point:
      return "point";
    case Light::Kind::spot:
      return "spot";
    case Light::Kind::rectangle:
      return "rectangle";
    case Light::Kind::sphere:
      return "sphere";
    case Light::Kind::sun:
      return "sun";
  }
  return "";
}

std::string effects_of(const Effects& effects) {
  std::string list;
  const auto add = [&](bool on, const char* name) {
    if (on) list += (list.empty() ? "" : ",") + std::string(name);
  };
  add(effects.shadows, "shadows");
  add(effects.reflection, "reflection");
  add(effects.refraction, "refraction");
  add(effects.ambient_occlusion, "ao");
  return list.empty() ? "none" : list;
}

std::string texture_name(const Scene& scene, int index) {
  return index == kNoTexture ? "" : scene.textures[static_cast<size_t>(index)].name;
}

// How many triangles each material has, in the mesh and in models.
std::vector<size_t> triangles_of_materials(const Scene& scene) {
  std::vector<size_t> counts(scene.materials.size());
  const auto add = [&](const Mesh& mesh) {
    for (const uint32_t material : mesh.triangle_material) {
      if (material < counts.size()) ++counts[material];
    }
  };
  add(scene.mesh);
  for (const Mesh& model : scene.models) add(model);
  return counts;
}

struct ObjectCounts {
  size_t instances = 0, shapes = 0, triangles = 0;  // those of instances
};
ObjectCounts count_objects(const Scene& scene) {
  ObjectCounts c;
  for (const Object& object : scene.objects) {
    const bool mesh = object.shape == Shape::mesh;
    ++(mesh ? c.instances : c.shapes);
    if (mesh) c.triangles += scene.models[object.model].triangles.size();
  }
  return c;
}

std::string in_words(const Vec3& v) {
  std::string text;
  for (int axis = 0; axis < 3; ++axis) {
    char digits[32];
    text += (axis ? " " : "") +
            std::string(digits, std::to_chars(digits, digits + sizeof digits, component(v, axis)).ptr);
  }
  return text;
}

std::string as_text(const Job& job) {
  const Scene& scene = job.project.scene;
  const Box box = bounds(scene);
  const auto count = [](size_t n, const char* what) { return std::to_string(n) + " " + what; };
  std::string text = job.input + "\n";
  text += "mesh: " + count(scene.mesh.triangles.size(), "triangles, ") +
          count(scene.mesh.positions.size(), "vertices, ") + count(scene.mesh.normals.size(), "normals, ") +
          count(scene.mesh.texcoords.size(), "texture coordinates, ") +
          count(scene.dropped_triangles, "triangles dropped\n");
  if (!scene.objects.empty()) {
    const ObjectCounts c = count_objects(scene);
    text += "objects: " + count(scene.models.size(), "models, ") + count(c.instances, "instances with ") +
            count(c.triangles, "triangles, ") + count(c.shapes, "shapes\n");
  }
  text += "bounds: " + in_words(box.min) + " to " + in_words(box.max) + "\n";

  text += count(scene.materials.size(), "materials\n");
  const std::vector<size_t> uses = triangles_of_materials(scene);
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& material = scene.materials[i];
    text += "  " + material.name + ": " + name_of(material.optics) + ", " + count(uses[i], "triangles");
    if (material.diffuse_map != kNoTexture) text += ", map_Kd " + texture_name(scene, material.diffuse_map);
    if (material.opacity_map != kNoTexture) text += ", map_d " + texture_name(scene, material.opacity_map);
    text += "\n";
  }
  text += count(scene.textures.size(), "textures\n");
  for (const Texture& texture : scene.textures) {
    text += "  " + texture.name + ": " + std::to_string(texture.width) + "x" +
            std::to_string(texture.height) + "\n";
  }
  if (job.kind == InputKind::mesh) return text;

  text += count(scene.lights.size(), "lights\n");
  for (const Light& light : scene.lights) text += std::string("  ") + name_of(light.kind) + "\n";
  text += count(scene.cameras.size(), "cameras\n");
  for (const Camera& camera : scene.cameras) {
    text +=
        "  " + camera.name + ": eye " + in_words(camera.position) + ", view " + in_words(camera.view) + "\n";
  }
  text += count(job.project.pipelines.size(), "pipelines\n");
  for (const Pipeline& pipeline : job.project.pipelines) {
    text += "  " + pipeline.name + ": camera " + pipeline.camera + ", effects " +
            effects_of(pipeline.settings.effects) + "\n";
  }
  return text;
}

void add_materials(JsonWriter& json, const Scene& scene) {
  const std::vector<size_t> uses = triangles_of_materials(scene);
  json.begin_array("materials");
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& material = scene.materials[i];
    json.begin_object()
        .add("name", material.name)
        .add("optics", name_of(material.optics))
        .add("triangles", uint64_t{uses[i]})
        .add("map_Kd", texture_name(scene, material.diffuse_map))
        .add("map_d", texture_name(scene, material.opacity_map))
        .end_object();
  }
  json.end_array();
  json.begin_array("textures");
  for (const Texture& texture : scene.textures) {
    json.begin_object()
        .add("name", texture.name)
        .add("width", texture.width)
        .add("height", texture.height)
        .end_object();
  }
  json.end_array();
}

void add_project(JsonWriter& json, const Job& job) {
  const Scene& scene = job.project.scene;
  json.begin_array("lights");
  for (const Light& light : scene.lights) json.begin_object().add("kind", name_of(light.kind)).end_object();
  json.end_array().begin_array("cameras");
  for (const Camera& camera : scene.cameras) {
    json.begin_object()
        .add("name", camera.name)
        .add("eye", camera.position)
        .add("view", camera.view)
        .end_object();
  }
  json.end_array().begin_array("pipelines");
  for (const Pipeline& pipeline : job.project.pipelines) {
    json.begin_object()
        .add("name", pipeline.name)
        .add("camera", pipeline.camera)
        .add("effects", effects_of(pipeline.settings.effects))
        .end_object();
  }
  json.end_array();
}

std::string as_json(const Job& job) {
  const Scene& scene = job.project.scene;
  const Box box = bounds(scene);
  const ObjectCounts objects = count_objects(scene);
  JsonWriter json;
  json.begin_object()
      .add("input", job.input)
      .add("triangles", uint64_t{scene.mesh.triangles.size()})
      .add("vertices", uint64_t{scene.mesh.positions.size()})
      .add("normals", uint64_t{scene.mesh.normals.size()})
      .add("texcoords", uint64_t{scene.mesh.texcoords.size()})
      .add("dropped_triangles", uint64_t{scene.dropped_triangles})
      .add("models", uint64_t{scene.models.size()})
      .add("instances", uint64_t{objects.instances})
      .add("instanced_triangles", uint64_t{objects.triangles})
      .add("shapes", uint64_t{objects.shapes})
      .begin_object("bounds")
      .add("min", box.min)
      .add("max", box.max)
      .end_object()
      .add("load_seconds", job.load_seconds);
  add_materials(json, scene);
  if (job.kind == InputKind::project) add_project(json, job);
  return json.end_object().text();
}

}  // namespace

int run_info(const Options& options) {
  Job job = plan_job(options);
  load_job(job, options);
  report_warnings(job.warnings, options);
  print(options.json ? as_json(job) : as_text(job));
  return kDone;
}

}  // namespace vitral
