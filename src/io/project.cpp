#include "io/project.h"

#include "io/element.h"
#include "io/mesh_file.h"
#include "io/text.h"
#include "io/xml.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

namespace vitral {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMostThings = 1000;  // of one kind: cameras, lights, meshes, pipelines

// What a project holds besides its Scene, while it is being read: the names its parts refer to.
struct Reading {
  Source source;
  Project& project;
  fs::path folder;  // paths in the project are relative to it
  std::vector<std::string> scenes, viewports, lights;
  bool has_ambient = false;
};

std::string named(const std::string& name) {
  return "'" + printable(name) + "'";
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool has_camera(const Project& project, const std::string& name) {
  return std::any_of(project.scene.cameras.begin(), project.scene.cameras.end(),
                     [&](const Camera& camera) { return camera.name == name; });
}

// A path of the project as it can be opened. What is missing is said here, where the line is known.
std::string path_of(const Reading& reading, const XmlElement& element) {
  return (reading.folder / name_of(reading.source, element)).lexically_normal().string();
}

bool exists(const std::string& path) {
  std::error_code code;
  return fs::exists(path, code);
}

// Calls `read(child)` for every child called `name` and warns of every other.
template <class Read>
void each(const Reading& reading, const XmlElement& element, std::string_view name, Read read) {
  size_t count = 0;
  for (const XmlElement& child : element.children) {
    if (!same_name(child.name, name)) {
      warn_unknown_child(reading.source, element, child);
      continue;
    }
    if (++count > kMostThings) {
      fail(reading.source, child,
           "more than " + std::to_string(kMostThings) + " of <" + std::string(name) + ">");
    }
    read(child);
  }
}

// --- assets ------------------------------------------------------------------------------------

std::string attribute_or(const XmlElement& element, std::string_view name, const std::string& otherwise) {
  const std::string* value = find_attribute(element, name);
  return value ? *value : otherwise;
}

void read_scene(Reading& reading, const XmlElement& element) {
  warn_unknown_attributes(reading.source, element, {"name", "type"});
  reading.scenes.push_back(attribute_or(element, "name", ""));
  each(reading, element, "file", [&](const XmlElement& file) {
    const std::string path = path_of(reading, file);
    if (!exists(path)) fail(reading.source, file, path + ": no such file");
    reading.project.meshes.push_back({path, file.line});
  });
}

void read_viewport(Reading& reading, const XmlElement& element) {
  warn_unknown_attributes(reading.source, element, {"name"});
  reading.viewports.push_back(attribute_or(element, "name", ""));
  for (const XmlElement& child : element.children) {
    if (same_name(child.name, "bgcolor")) {
      reading.project.scene.background = color_of(reading.source, child, kRadiances);
    } else {
      warn_unknown_child(reading.source, element, child);
    }
  }
}

void read_camera(Reading& reading, const XmlElement& element) {
  const Source& source = reading.source;
  warn_unknown_attributes(source, element, {"name", "type"});
  Camera camera;
  camera.name = attribute_or(element, "name", "");
  if (camera.name.empty()) fail(source, element, "this camera has no name");
  if (has_camera(reading.project, camera.name)) {
    fail(source, element, "there is another camera " + named(camera.name));
  }
  for (const XmlElement& child : element.children) {
    if (same_name(child.name, "perspective") || same_name(child.name, "projection")) {
      warn_unknown_attributes(source, child, {"type", "fov", "near", "far"});
      camera.fov = number_attribute(source, child, "fov", kFovDegrees, camera.fov);
      camera.near = number_attribute(source, child, "near", kDistances, camera.near);
      camera.far = number_attribute(source, child, "far", kDistances, camera.far);
    } else if (same_name(child.name, "position")) {
      camera.position = vector_of(source, child, kCoordinates);
    } else if (same_name(child.name, "view")) {
      camera.view = vector_of(source, child, kCoordinates);
    } else if (same_name(child.name, "up")) {
      camera.up = vector_of(source, child, kCoordinates);
    } else if (!same_name(child.name, "viewport")) {
      warn_unknown_child(source, element, child);
    }
  }
  const std::string fault = camera_fault(camera);
  if (!fault.empty()) fail(source, element, "camera " + named(camera.name) + ": " + fault);
  reading.project.scene.cameras.push_back(camera);
}

// Directional or point, as its type says or, without a type, as what it has: direction or position.
Light::Kind kind_of(const Source& source, const XmlElement& element, bool has_direction, bool has_position) {
  const std::string type = attribute_or(element, "type", has_direction ? "directional" : "point");
  const bool directional = same_name(type, "directional");
  if (!directional && !same_name(type, "point")) {
    fail(source, element, "type=\"" + printable(type) + "\" is neither directional nor point");
  }
  if (directional && !has_direction) fail(source, element, "this light has no direction");
  if (!directional && !has_position) fail(source, element, "this light has neither direction nor position");
  return directional ? Light::Kind::directional : Light::Kind::point;
}

void read_light(Reading& reading, const XmlElement& element) {
  const Source& source = reading.source;
  warn_unknown_attributes(source, element, {"name", "type"});
  reading.lights.push_back(attribute_or(element, "name", ""));
  Light light;
  bool has_direction = false, has_position = false;
  for (const XmlElement& child : element.children) {
    if (same_name(child.name, "direction")) {
      const Vec3 direction = vector_of(source, child, kCoordinates);
      if (!(length(direction) > 0)) fail(source, child, "the direction is zero");
      light.direction = normalize(direction);
      has_direction = true;
    } else if (same_name(child.name, "position")) {
      light.position = vector_of(source, child, kCoordinates);
      has_position = true;
    } else if (same_name(child.name, "color")) {
      light.color = color_of(source, child, kRadiances);
    } else if (same_name(child.name, "ambient")) {
      if (!reading.has_ambient) reading.project.scene.ambient = {0, 0, 0};
      reading.has_ambient = true;
      reading.project.scene.ambient += color_of(source, child, kRadiances);
    } else {
      warn_unknown_child(source, element, child);
    }
  }
  light.kind = kind_of(source, element, has_direction, has_position);
  reading.project.scene.lights.push_back(light);
}

void read_material_library(Reading& reading, const XmlElement& element) {
  const std::string path = path_of(reading, element);
  if (!exists(path)) warn(reading.source, element.line, path + ": no such file");
}

void read_assets(Reading& reading, const XmlElement& assets) {
  for (const XmlElement& child : assets.children) {
    if (same_name(child.name, "scenes")) {
      each(reading, child, "scene", [&](const XmlElement& e) { read_scene(reading, e); });
    } else if (same_name(child.name, "viewports")) {
      each(reading, child, "viewport", [&](const XmlElement& e) { read_viewport(reading, e); });
    } else if (same_name(child.name, "cameras")) {
      each(reading, child, "camera", [&](const XmlElement& e) { read_camera(reading, e); });
    } else if (same_name(child.name, "lights")) {
      each(reading, child, "light", [&](const XmlElement& e) { read_light(reading, e); });
    } else if (same_name(child.name, "materialLibs")) {
      each(reading, child, "mlib", [&](const XmlElement& e) { read_material_library(reading, e); });
    } else {
      warn_unknown_child(reading.source, assets, child);
    }
  }
}

// --- pipelines ---------------------------------------------------------------------------------

enum class PassClass { raster, trace, combine };

PassClass pass_class(const Source& source, const XmlElement& pass) {
  const std::string name = attribute_or(pass, "class", "");
  if (same_name(name, "raster") || same_name(name, "default")) return PassClass::raster;
  if (same_name(name, "trace") || same_name(name, "optix")) return PassClass::trace;
  if (same_name(name, "combine") || same_name(name, "quad")) return PassClass::combine;
  fail(source, pass, "class=\"" + printable(name) + "\" is not one of raster, trace, combine");
}

// One figure of a pipeline that several elements may give, as long as they agree.
template <class T>
struct Figure {
  std::optional<T> value;

  void set(const Source& source, const XmlElement& element, const char* what, const T& given) {
    if (value && *value != given)
      fail(source, element, std::string(what) + " differs from what was given before");
    value = given;
  }
};

struct Figures {
  Figure<long> depth, seed;
  Figure<float> importance;
  Figure<Fresnel> fresnel;
  Figure<Compositing> compositing;
};

// reflection or refraction: the figures of the paths they share.
void read_paths(const Source& source, const XmlElement& element, Figures& figures) {
  warn_unknown_attributes(source, element, {"maxDepth", "minImportance", "fresnel"});
  if (find_attribute(element, "maxDepth")) {
    figures.depth.set(source, element, "maxDepth",
                      integer_attribute(source, element, "maxDepth", 0, kMostDepth, 0));
  }
  if (find_attribute(element, "minImportance")) {
    figures.importance.set(source, element, "minImportance",
                           number_attribute(source, element, "minImportance", kImportances, 0));
  }
  if (const std::string* text = find_attribute(element, "fresnel")) {
    const std::optional<Fresnel> fresnel = parse_fresnel(*text);
    if (!fresnel) fail(source, element, "fresnel=" + named(*text) + " is not one of exact, schlick, report");
    figures.fresnel.set(source, element, "fresnel", *fresnel);
  }
}

void read_ambient_occlusion(const Source& source, const XmlElement& element, Settings& settings) {
  warn_unknown_attributes(source, element, {"samples", "distance", "exponent"});
  if (const std::string* text = find_attribute(element, "samples")) {
    const std::optional<long> samples = parse_samples(*text);
    if (!samples) {
      fail(source, element,
           "samples=" + named(*text) + " is not a square number from 1 to " + std::to_string(kMostSamples));
    }
    settings.ao_samples = static_cast<int>(*samples);
  }
  settings.ao_distance = number_attribute(source, element, "distance", kDistances, settings.ao_distance);
  settings.ao_exponent = number_attribute(source, element, "exponent", kExponents, settings.ao_exponent);
}

// True when the element was one of the effects of a trace pass.
bool read_effect(const Source& source, const XmlElement& element, Settings& settings, Figures& figures) {
  Effects& effects = settings.effects;
  if (same_name(element.name, "shadows")) {
    warn_unknown_attributes(source, element, {});
    effects.shadows = true;
  } else if (same_name(element.name, "reflection")) {
    read_paths(source, element, figures);
    effects.reflection = true;
  } else if (same_name(element.name, "refraction")) {
    read_paths(source, element, figures);
    effects.refraction = true;
  } else if (same_name(element.name, "ambientOcclusion")) {
    read_ambient_occlusion(source, element, settings);
    effects.ambient_occlusion = true;
  } else {
    return false;
  }
  return true;
}

MaterialMap read_map(const Source& source, const XmlElement& element) {
  warn_unknown_attributes(source, element,
                          {"fromMaterial", "kind", "index", "tint", "toMaterial", "toLibrary"});
  MaterialMap map;
  map.line = element.line;
  map.from = attribute_or(element, "fromMaterial", "");
  if (map.from.empty()) fail(source, element, "<map> has no fromMaterial");
  const std::string kind = attribute_or(element, "kind", "thin");
  if (kind == "thin") {
    map.optics = Optics::thin;
  } else if (kind == "solid") {
    map.optics = Optics::solid;
  } else if (kind == "mirror") {
    map.optics = Optics::mirror;
  } else {
    fail(source, element, "kind=" + named(kind) + " is not one of thin, solid, mirror");
  }
  map.index = number_attribute(source, element, "index", kIndices, map.index);
  if (const std::string* text = find_attribute(element, "tint")) {
    const std::optional<Vec3> tint = parse_color(*text, kTints);
    if (!tint) fail(source, element, "tint=" + named(*text) + " is not one or three numbers from 0 to 1");
    map.tint = *tint;
  }
  return map;
}

// The parts of a pass that name what it uses: they must exist. True when the element was one of them.
bool read_reference(const Reading& reading, const XmlElement& element, Pipeline& pipeline) {
  const auto must_be_one_of = [&](const XmlElement& e, const std::vector<std::string>& names) {
    const std::string name = name_of(reading.source, e);
    if (!contains(names, name)) fail(reading.source, e, "there is no " + e.name + " " + named(name));
  };
  if (same_name(element.name, "camera")) {
    const std::string name = name_of(reading.source, element);
    if (!has_camera(reading.project, name))
      fail(reading.source, element, "there is no camera " + named(name));
    if (pipeline.camera.empty()) pipeline.camera = name;
  } else if (same_name(element.name, "viewport")) {
    must_be_one_of(element, reading.viewports);
  } else if (same_name(element.name, "scenes")) {
    each(reading, element, "scene", [&](const XmlElement& e) { must_be_one_of(e, reading.scenes); });
  } else if (same_name(element.name, "lights")) {
    each(reading, element, "light", [&](const XmlElement& e) { must_be_one_of(e, reading.lights); });
  } else {
    return same_name(element.name, "renderTarget") || same_name(element.name, "renderTargets");
  }
  return true;
}

PassClass read_pass(const Reading& reading, const XmlElement& pass, Pipeline& pipeline, Figures& figures) {
  const Source& source = reading.source;
  warn_unknown_attributes(source, pass, {"class", "name", "compositing", "seed"});
  const PassClass what = pass_class(source, pass);
  if (const std::string* text = find_attribute(pass, "compositing")) {
    const std::optional<Compositing> compositing = parse_compositing(*text);
    if (!compositing) fail(source, pass, "compositing=" + named(*text) + " is neither physical nor report");
    figures.compositing.set(source, pass, "compositing", *compositing);
  }
  if (find_attribute(pass, "seed")) {
    figures.seed.set(source, pass, "seed", integer_attribute(source, pass, "seed", 0, 0xffffffffL, 1));
  }
  for (const XmlElement& child : pass.children) {
    if (read_reference(reading, child, pipeline)) continue;
    if (what == PassClass::trace && read_effect(source, child, pipeline.settings, figures)) continue;
    if (same_name(child.name, "materialMaps")) {
      each(reading, child, "map", [&](const XmlElement& e) { pipeline.maps.push_back(read_map(source, e)); });
    } else {
      warn_unknown_child(source, pass, child);
    }
  }
  return what;
}

Pipeline read_pipeline(const Reading& reading, const XmlElement& element, const Settings& defaults) {
  const Source& source = reading.source;
  const Project& project = reading.project;
  warn_unknown_attributes(source, element, {"name", "default", "defaultCamera"});
  Pipeline pipeline;
  pipeline.settings = defaults;
  pipeline.name = attribute_or(element, "name", "");
  if (pipeline.name.empty()) fail(source, element, "this pipeline has no name");
  for (const Pipeline& other : project.pipelines) {
    if (other.name == pipeline.name)
      fail(source, element, "there is another pipeline " + named(pipeline.name));
  }
  pipeline.camera = attribute_or(element, "defaultCamera", "");
  if (!pipeline.camera.empty() && !has_camera(project, pipeline.camera)) {
    fail(source, element, "there is no camera " + named(pipeline.camera));
  }

  Figures figures;
  bool has_raster = false;
  each(reading, element, "pass", [&](const XmlElement& pass) {
    if (read_pass(reading, pass, pipeline, figures) == PassClass::raster) has_raster = true;
  });
  if (!has_raster) fail(source, element, "pipeline " + named(pipeline.name) + " has no raster pass");

  Settings& settings = pipeline.settings;
  settings.max_depth = static_cast<int>(figures.depth.value.value_or(settings.max_depth));
  settings.min_importance = figures.importance.value.value_or(settings.min_importance);
  settings.fresnel = figures.fresnel.value.value_or(settings.fresnel);
  settings.compositing = figures.compositing.value.value_or(settings.compositing);
  settings.seed = static_cast<uint32_t>(figures.seed.value.value_or(settings.seed));
  if (pipeline.camera.empty() && !project.scene.cameras.empty()) {
    pipeline.camera = project.scene.cameras.front().name;
  }
  return pipeline;
}

void read_pipelines(const Reading& reading, const XmlElement& element, const Settings& defaults) {
  Project& project = reading.project;
  bool has_default = false;
  each(reading, element, "pipeline", [&](const XmlElement& child) {
    project.pipelines.push_back(read_pipeline(reading, child, defaults));
    if (!flag_attribute(reading.source, child, "default", false)) return;
    if (has_default) fail(reading.source, child, "there is another default pipeline");
    has_default = true;
    project.default_pipeline = project.pipelines.size() - 1;
  });
}

// Gives the materials called map.from their glass; the name may stand in several libraries.
void apply(const MaterialMap& map, const Source& source, Scene& scene) {
  bool found = false;
  for (Material& material : scene.materials) {
    if (material.name != map.from) continue;
    found = true;
    material.optics = map.optics;
    material.index = map.index;
    (map.optics == Optics::mirror ? material.specular : material.transmission) = map.tint;
  }
  if (!found) warn(source, map.line, "no material is called " + named(map.from));
}

}  // namespace

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
  if (project.meshes.empty()) fail(reading.source, root, "the project names no scene file");
  if (project.pipelines.empty()) fail(reading.source, root, "the project has no pipeline");
  return project;
}

void load_assets(Project& project, const Pipeline& pipeline, Warnings& warnings) {
  for (const MeshFile& mesh : project.meshes) load_mesh(mesh.path, project.scene, warnings);
  const Source source{project.file, warnings};
  for (const MaterialMap& map : pipeline.maps) apply(map, source, project.scene);
}

Project load_project(const std::string& path, Warnings& warnings) {
  Project project = read_project(path, warnings);
  load_assets(project, Pipeline(project.pipelines[project.default_pipeline]), warnings);
  return project;
}

}  // namespace vitral
