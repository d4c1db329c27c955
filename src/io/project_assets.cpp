// The assets of a project: scenes, viewports, cameras, lights, material libraries.
#include "io/project_objects.h"
#include "io/project_reading.h"
#include "io/text.h"

#include <algorithm>
#include <filesystem>

namespace vitral {
namespace {

namespace fs = std::filesystem;

// A path of the project as it can be opened. What is missing is said here, where the line is known.
std::string path_of(const Reading& reading, const XmlElement& element) {
  return (reading.folder / name_of(reading.source, element)).lexically_normal().string();
}

bool exists(const std::string& path) {
  std::error_code code;
  return fs::exists(path, code);
}

void read_scene(Reading& reading, const XmlElement& element) {
  warn_unknown_attributes(reading.source, element, {"name", "type"});
  reading.scenes.push_back(attribute_or(element, "name", ""));
  for (const XmlElement& child : element.children) {
    if (same_name(child.name, "file")) {
      const std::string path = path_of(reading, child);
      if (!exists(path)) fail(reading.source, child, path + ": no such file");
      if (reading.project.meshes.size() == kMostThings)
        fail(reading.source, child, "more than " + std::to_string(kMostThings) + " of <file>");
      reading.project.meshes.push_back({path, child.line});
    } else if (!read_object_element(reading, child)) {
      warn_unknown_child(reading.source, element, child);
    }
  }
}

void read_viewport(Reading& reading, const XmlElement& element) {
  warn_unknown_attributes(reading.source, element, {"name"});
  reading.viewports.push_back(attribute_or(element, "name", ""));
  for (const XmlElement& child : element.children) {
    if (same_name(child.name, "bgcolor")) {
      reading.project.scene.background.color = color_of(reading.source, child, kRadiances);
    } else if (same_name(child.name, "background")) {
      read_background(reading, child);
    } else {
      warn_unknown_child(reading.source, element, child);
    }
  }
}

void read_material_library(Reading& reading, const XmlElement& element) {
  const std::string path = path_of(reading, element);
  if (exists(path)) {
    reading.project.libraries.push_back(path);
  } else {
    warn(reading.source, element.line, path + ": no such file");
  }
}

}  // namespace

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
    } else if (same_name(child.name, "materials")) {
      each(reading, child, "material", [&](const XmlElement& e) { read_material(reading, e); });
    } else if (same_name(child.name, "materialLibs")) {
      each(reading, child, "mlib", [&](const XmlElement& e) { read_material_library(reading, e); });
    } else {
      warn_unknown_child(reading.source, assets, child);
    }
  }
}

}  // namespace vitral
