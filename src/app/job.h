// From the command line to what render() takes. A job is planned first: everything that can be
// refused is refused then, before anything large is loaded.
#pragma once
#include "app/options.h"
#include "io/project.h"

#include <string>

namespace vitral {

enum class InputKind { project, mesh };

struct Job {
  std::string input;
  InputKind kind = InputKind::project;
  Project project;    // of a bare mesh: one mesh file and one pipeline
  Pipeline pipeline;  // the chosen one, its settings overridden by the options
  Camera camera;
  bool automatic = false;  // the camera has yet to be found from the bounds
  Warnings warnings;
  double load_seconds = 0;
};

// Reads a project file, or notes a mesh, and settles what of it is wanted. Throws InputError or
// UsageError.
Job plan_job(const Options& options);

// Loads the meshes and sets up camera and light. Throws InputError.
void load_job(Job& job, const Options& options);

// Bytes that a frame of these settings needs until it is written, without the scene.
size_t frame_bytes(const Settings& settings);

// What this process may use: the machine's memory, or the limit it is under if that is less.
size_t memory_limit();
size_t peak_memory();  // bytes this process has had in memory at most

}  // namespace vitral
