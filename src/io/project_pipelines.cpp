// The pipelines of a project: their passes, effects and material maps.
#include "io/project_reading.h"
#include "io/text.h"

#include <algorithm>
#include <optional>

namespace vitral {
namespace {

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

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
  Figure<Primary> primary;
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

// The attributes of a raster pass.
void read_sampling(const Source& source, const XmlElement& pass, Settings& settings) {
  settings.samples =
      static_cast<int>(integer_attribute(source, pass, "samples", 1, kMostPixelSamples, settings.samples));
  if (const std::string* text = find_attribute(pass, "filter")) {
    const std::optional<Filter> filter = parse_filter(*text);
    if (!filter) fail(source, pass, "filter=" + named(*text) + " is not one of box, tent, mitchell");
    settings.filter = *filter;
  }
}

void read_shadows(const Source& source, const XmlElement& element, Settings& settings) {
  warn_unknown_attributes(source, element, {"samples", "terminator"});
  settings.light_samples = static_cast<int>(
      integer_attribute(source, element, "samples", 1, kMostLightSamples, settings.light_samples));
  if (const std::string* text = find_attribute(element, "terminator")) {
    const std::optional<Terminator> terminator = parse_terminator(*text);
    if (!terminator) fail(source, element, "terminator=" + named(*text) + " is neither facet nor smooth");
    settings.terminator = *terminator;
  }
}

// True when the element was one of the effects of a trace pass.
bool read_effect(const Source& source, const XmlElement& element, Settings& settings, Figures& figures) {
  Effects& effects = settings.effects;
  if (same_name(element.name, "shadows")) {
    read_shadows(source, element, settings);
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
                          {"fromMaterial", "kind", "index", "tint", "reflectivity", "emission", "absorption",
                           "toMaterial", "toLibrary"});
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
  map.tint = color_attribute(source, element, "tint", kTints).value_or(map.tint);
  map.reflectivity = color_attribute(source, element, "reflectivity", kTints);
  map.emission = color_attribute(source, element, "emission", kRadiances);
  map.absorption = color_attribute(source, element, "absorption", kAbsorptions);
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
  const PassClass what = pass_class(source, pass);
  if (what == PassClass::raster) {
    warn_unknown_attributes(source, pass,
                            {"class", "name", "compositing", "seed", "primary", "samples", "filter"});
    read_sampling(source, pass, pipeline.settings);
  } else {
    warn_unknown_attributes(source, pass, {"class", "name", "compositing", "seed"});
  }
  if (const std::string* text = find_attribute(pass, "primary"); text && what == PassClass::raster) {
    const std::optional<Primary> primary = parse_primary(*text);
    if (!primary) fail(source, pass, "primary=" + named(*text) + " is neither raster nor trace");
    figures.primary.set(source, pass, "primary", *primary);
  }
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
  settings.primary = figures.primary.value.value_or(settings.primary);
  settings.seed = static_cast<uint32_t>(figures.seed.value.value_or(settings.seed));
  if (pipeline.camera.empty() && !project.scene.cameras.empty()) {
    pipeline.camera = project.scene.cameras.front().name;
  }
  return pipeline;
}

}  // namespace

void read_pipelines(const Reading& reading, const XmlElement& element, const Settings& defaults) {
  Project& project = reading.project;
  bool has_default = false;
  each(reading, element, "pipeline", [&](const XmlElement& child) {
    project.pipelines.push_back(read_pipeline(reading, child, defaults));
    if (!flag_attribute(reading.source, child, "default")) return;
    if (has_default) fail(reading.source, child, "there is another default pipeline");
    has_default = true;
    project.default_pipeline = project.pipelines.size() - 1;
  });
}

}  // namespace vitral
