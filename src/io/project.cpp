#include "io/project.h"

#include "io/mesh_file.h"
#include "io/project_objects.h"
#include "io/project_reading.h"
#include "io/text.h"
#include "io/xml.h"

#include <algorithm>
#include <filesystem>

namespace vitral {
namespace {

namespace fs = std::filesystem;

// Gives the materials called map.from their glass; the name may stand in several libraries.
void apply(const MaterialMap& map, const Source& source, Scene& scene) {
  bool found = false;
  for (Material& material : scene.materials) {
    if (material.name != map.from) continue;
    found = true;
    material.optics = map.optics;
    material.index = map.index;
    (map.optics == Optics::mirror ? material.specular : material.transmission) = map.tint;
    if (map.reflectivity) material.reflectivity = *map.reflectivity;
    if (map.emission) material.emission = *map.emission;
    if (map.absorption) material.absorption = *map.absorption;
  }
  if (!found) warn(source, map.line, "no material is called " + named(map.from));
}

}  // namespace

std::string named(const std::string& name) {
  return "'" + printable(name) + "'";
}

bool has_camera(const Project& project, const std::string& name) {
  return std::any_of(project.scene.cameras.begin(), project.scene.cameras.end(),
                     [&](const Camera& camera) { return camera.name == name; });
}

std::string attribute_or(const XmlElement& element, std::string_view name, const std::string& otherwise) {
  const std::string* value = find_attribute(element, name);
  return value ? *value : otherwise;
}

std::string camera_fault(const Camera& camera) {
  const float view = length(camera.view), up = length(camera.up);
  if (!(view > 0)) return "the view direction is zero";
  if (!(up > 0)) return "the up direction is zero";
  // Nearer than this to parallel, the picture's horizon would be rounding noise.
  constexpr float kLeastSine = 1e-4f;
  if (!(length(cross(normalize(camera.view), normalize(camera.up))) > kLeastSine)) {
    return "the up direction is along the view";
  }
  if (!(camera.near < camera.far)) return "near is not less than far";
  return "";
}

Project read_project(const std::string& path, Warnings& warnings) {
  const XmlElement root = read_xml(path);
  Project project;
  project.file = path;
  Reading reading{{path, warnings}, project, fs::path(path).parent_path(), {}, {}, {}};
  if (!same_name(root.name, "project"))
    fail(reading.source, root, "expected <project>, found <" + printable(root.name) + ">");
  warn_unknown_attributes(reading.source, root, {"name", "width", "height"});

  // A project asks for the effects that its trace passes name, and for no other.
  Settings defaults;
  defaults.effects = {false, false, false, false};
  defaults.width =
      static_cast<int>(integer_attribute(reading.source, root, "width", 1, kMaxImageSide, defaults.width));
  defaults.height =
      static_cast<int>(integer_attribute(reading.source, root, "height", 1, kMaxImageSide, defaults.height));

  // The pipelines refer to the assets, which may stand after them.
  for (const XmlElement& child : root.children) {
    if (same_name(child.name, "assets")) read_assets(reading, child);
  }
  for (const XmlElement& child : root.children) {
    if (same_name(child.name, "pipelines")) {
      read_pipelines(reading, child, defaults);
    } else if (!same_name(child.name, "assets")) {
      warn_unknown_child(reading.source, root, child);
    }
  }
  resolve_models(reading);
  if (project.meshes.empty() && project.object_count == 0)
    fail(reading.source, root, "the project names no scene file");
  if (project.pipelines.empty()) fail(reading.source, root, "the project has no pipeline");
  return project;
}

void load_assets(Project& project, const Pipeline& pipeline, Warnings& warnings) {
  for (const MeshFile& mesh : project.meshes) load_mesh(mesh.path, project.scene, warnings);
  load_models(project, warnings);
  const Source source{project.file, warnings};
  apply_materials(project, project.scene, warnings);
  load_objects(project, warnings);
  load_background(project, project.scene);
  for (const MaterialMap& map : pipeline.maps) apply(map, source, project.scene);
}

Project load_project(const std::string& path, Warnings& warnings) {
  Project project = read_project(path, warnings);
  load_assets(project, Pipeline(project.pipelines[project.default_pipeline]), warnings);
  return project;
}

}  // namespace vitral
