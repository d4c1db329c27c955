// The materials and the background of a project.
#include "io/image_file.h"
#include "io/project_reading.h"
#include "io/textures.h"

#include <algorithm>
#include <filesystem>

namespace vitral {
namespace {

namespace fs = std::filesystem;

// A colour or number of a material, which may stand as an attribute or as an element of its own.
struct ColorFigure {
  const char* name;
  std::optional<Vec3> MaterialFigures::*value;
  Range range;
};
constexpr ColorFigure kColorFigures[] = {
    {"diffuse", &MaterialFigures::diffuse, kTints},
    {"specular", &MaterialFigures::specular, kTints},
    {"transmission", &MaterialFigures::transmission, kTints},
    {"reflectivity", &MaterialFigures::reflectivity, kTints},
    {"emission", &MaterialFigures::emission, kRadiances},
    {"absorption", &MaterialFigures::absorption, kAbsorptions},
};
struct NumberFigure {
  const char* name;
  std::optional<float> MaterialFigures::*value;
  Range range;
};
constexpr NumberFigure kNumberFigures[] = {
    {"shininess", &MaterialFigures::shininess, kShininesses},
    {"index", &MaterialFigures::index, kIndices},
    {"opacity", &MaterialFigures::opacity, kTints},
};

Optics optics_of(const Source& source, const XmlElement& element, const std::string& kind) {
  constexpr std::pair<const char*, Optics> kKinds[] = {
      {"opaque", Optics::opaque}, {"mirror", Optics::mirror}, {"polished", Optics::polished},
      {"solid", Optics::solid},   {"thin", Optics::thin},     {"dissolve", Optics::dissolve}};
  for (const auto& [name, optics] : kKinds) {
    if (kind == name) return optics;
  }
  fail(source, element,
       "kind=" + named(kind) + " is not one of opaque, mirror, polished, solid, thin, dissolve");
}

// True when the element was a pattern.
bool read_pattern(const Source& source, const XmlElement& element, MaterialFigures& figures) {
  Pattern p;
  if (same_name(element.name, "checker")) {
    warn_unknown_attributes(source, element, {"first", "second", "size"});
    p.kind = Pattern::Kind::checker;
  } else if (same_name(element.name, "brick")) {
    warn_unknown_attributes(source, element, {"first", "second", "size", "height", "mortar"});
    p.kind = Pattern::Kind::brick;
  } else if (same_name(element.name, "marble")) {
    warn_unknown_attributes(source, element, {"first", "second", "size", "turbulence"});
    p.kind = Pattern::Kind::marble;
  } else {
    return false;
  }
  if (figures.pattern) fail(source, element, "there is another pattern");
  p.first = color_attribute(source, element, "first", kTints).value_or(p.first);
  p.second = color_attribute(source, element, "second", kTints).value_or(p.second);
  p.size = number_attribute(source, element, "size", kDistances, p.size);
  p.height = number_attribute(source, element, "height", kDistances, p.height);
  p.mortar = number_attribute(source, element, "mortar", {0, kDistances.most}, p.mortar);
  p.turbulence = number_attribute(source, element, "turbulence", {0, 100}, p.turbulence);
  if (p.kind == Pattern::Kind::brick && !(p.mortar < p.size && p.mortar < p.height)) {
    fail(source, element, "the mortar leaves no room for bricks");
  }
  figures.pattern = p;
  return true;
}

// A picture that must be there; its path as the project writes it.
std::string picture_of(const Reading& reading, const XmlElement& element, const std::string& file) {
  if (find_beside(reading.source.file, file).empty()) {
    fail(reading.source, element, (reading.folder / file).lexically_normal().string() + ": no such file");
  }
  return file;
}

// True when the element was one of the figures.
bool read_figure(const Source& source, const XmlElement& element, MaterialFigures& figures) {
  for (const ColorFigure& f : kColorFigures) {
    if (!same_name(element.name, f.name)) continue;
    figures.*f.value = color_of(source, element, f.range);
    return true;
  }
  return read_pattern(source, element, figures);
}

void apply(const MaterialFigures& f, Material& m) {
  override_with(f.diffuse, m.diffuse);
  override_with(f.specular, m.specular);
  override_with(f.transmission, m.transmission);
  override_with(f.reflectivity, m.reflectivity);
  override_with(f.emission, m.emission);
  override_with(f.absorption, m.absorption);
  override_with(f.shininess, m.shininess);
  override_with(f.index, m.index);
  override_with(f.opacity, m.opacity);
  override_with(f.pattern, m.pattern);
  // As in a library: what lets something through and is of no other kind dissolves.
  if (f.opacity && m.opacity < 1 && m.optics == Optics::opaque) m.optics = Optics::dissolve;
  override_with(f.optics, m.optics);
}

}  // namespace

std::optional<Vec3> color_attribute(const Source& source, const XmlElement& element, const char* name,
                                    Range range) {
  const std::string* text = find_attribute(element, name);
  if (!text) return {};
  const std::optional<Vec3> color = parse_color(*text, range);
  if (!color) {
    fail(source, element,
         std::string(name) + "=" + named(*text) + " is not one or three numbers " + in_words(range));
  }
  return color;
}

void read_material(Reading& reading, const XmlElement& element) {
  const Source& source = reading.source;
  warn_unknown_attributes(source, element,
                          {"name", "kind", "diffuse", "specular", "transmission", "reflectivity", "emission",
                           "absorption", "shininess", "index", "opacity"});
  MaterialFigures figures;
  figures.line = element.line;
  figures.name = attribute_or(element, "name", "");
  if (figures.name.empty()) fail(source, element, "this material has no name");
  for (const MaterialFigures& other : reading.project.materials) {
    if (other.name == figures.name) fail(source, element, "there is another material " + named(figures.name));
  }
  if (const std::string* kind = find_attribute(element, "kind"))
    figures.optics = optics_of(source, element, *kind);
  for (const ColorFigure& f : kColorFigures)
    figures.*f.value = color_attribute(source, element, f.name, f.range);
  for (const NumberFigure& f : kNumberFigures) {
    if (find_attribute(element, f.name))
      figures.*f.value = number_attribute(source, element, f.name, f.range, 0);
  }
  for (const XmlElement& child : element.children) {
    if (same_name(child.name, "texture")) {
      figures.texture = picture_of(reading, child, name_of(source, child));
    } else if (same_name(child.name, "cutout")) {
      figures.cut_out = picture_of(reading, child, name_of(source, child));
    } else if (!read_figure(source, child, figures)) {
      warn_unknown_child(source, element, child);
    }
  }
  reading.project.materials.push_back(std::move(figures));
}

void apply_materials(const Project& project, Scene& scene, Warnings& warnings) {
  std::vector<TextureUse> uses;
  for (const MaterialFigures& f : project.materials) {
    bool found = false;
    const auto give = [&](size_t i) {
      apply(f, scene.materials[i]);
      for (const auto& [role, file] : {std::pair{TextureUse::Role::diffuse, f.texture},
                                       std::pair{TextureUse::Role::opacity, f.cut_out}}) {
        if (!file.empty()) uses.push_back({role, i, file, project.file, f.line});
      }
    };
    for (size_t i = 0; i < scene.materials.size(); ++i) {
      if (scene.materials[i].name != f.name) continue;
      found = true;
      give(i);
    }
    if (found) continue;
    scene.materials.emplace_back().name = f.name;
    give(scene.materials.size() - 1);
  }
  load_textures(uses, scene, warnings, 0);
}

void read_background(Reading& reading, const XmlElement& element) {
  const Source& source = reading.source;
  warn_unknown_attributes(source, element, {"kind", "color", "zenith", "file", "scale"});
  Background& b = reading.project.scene.background;
  const bool has_file = find_attribute(element, "file") != nullptr;
  const std::string kind = attribute_or(element, "kind",
                                        has_file                            ? "panorama"
                                        : find_attribute(element, "zenith") ? "gradient"
                                                                            : "constant");
  if (kind == "constant") {
    b.kind = Background::Kind::constant;
  } else if (kind == "gradient") {
    b.kind = Background::Kind::gradient;
  } else if (kind == "panorama") {
    b.kind = Background::Kind::panorama;
  } else {
    fail(source, element, "kind=" + named(kind) + " is not one of constant, gradient, panorama");
  }
  override_with(color_attribute(source, element, "color", kRadiances), b.color);
  override_with(color_attribute(source, element, "zenith", kRadiances), b.zenith);
  b.scale = number_attribute(source, element, "scale", kRadiances, b.scale);
  if (b.kind != Background::Kind::panorama) return;
  if (!has_file) fail(source, element, "a panorama needs a file");
  reading.project.panorama =
      find_beside(source.file, picture_of(reading, element, attribute_or(element, "file", "")));
}

void load_background(const Project& project, Scene& scene) {
  if (scene.background.kind != Background::Kind::panorama) return;
  scene.background.panorama = static_cast<int>(scene.textures.size());
  scene.textures.push_back(load_texture(project.panorama));
}

}  // namespace vitral
