// What the parts of the project reader share: project_assets.cpp, project_lights.cpp, project_pipelines.cpp.
#pragma once
#include "io/element.h"
#include "io/project.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vitral {

// What a project holds besides its Scene, while it is being read: the names its parts refer to.
struct Reading {
  Source source;
  Project& project;
  std::filesystem::path folder;  // paths in the project are relative to it
  std::vector<std::string> scenes, viewports, lights;
  bool has_ambient = false;
};

void read_camera(Reading& reading, const XmlElement& element);
// A colour written as an attribute: one or three numbers. Nothing when it is not there.
std::optional<Vec3> color_attribute(const Source& source, const XmlElement& element, const char* name,
                                    Range range);

// project_materials.cpp: a <material> and a <background>; and what is done with them when the meshes are
// there.
void read_material(Reading& reading, const XmlElement& element);
void read_background(Reading& reading, const XmlElement& element);
void apply_materials(const Project& project, Scene& scene, Warnings& warnings);
void load_background(const Project& project, Scene& scene);

void read_assets(Reading& reading, const XmlElement& assets);
void read_light(Reading& reading, const XmlElement& element);

// The assets have been read: pipelines refer to them by name. `defaults` is what a pipeline starts from.
void read_pipelines(const Reading& reading, const XmlElement& pipelines, const Settings& defaults);

std::string named(const std::string& name);  // as it stands in a message
bool has_camera(const Project& project, const std::string& name);
std::string attribute_or(const XmlElement& element, std::string_view name, const std::string& otherwise);

inline constexpr size_t kMostThings = 1000;  // of one kind: cameras, lights, meshes, pipelines

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

}  // namespace vitral
