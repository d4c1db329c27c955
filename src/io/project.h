// Reads the project file: scenes, cameras, lights and the pipelines that render them.
#pragma once
#include "vitral/error.h"
#include "vitral/render.h"
#include "vitral/scene.h"

#include <string>
#include <vector>

namespace vitral {

struct Pipeline {
  std::string name;
  std::string camera;  // name of its default camera
  Settings settings;   // effects and their figures; width and height of the project
};

struct Project {
  Scene scene;
  std::vector<Pipeline> pipelines;  // at least one
  size_t default_pipeline = 0;
};

// Throws InputError with file:line; unknown elements and attributes are warnings.
Project load_project(const std::string& path, Warnings& warnings);

}  // namespace vitral
