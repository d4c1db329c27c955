#include "io/mesh_file.h"

#include "io/obj.h"
#include "io/ply.h"
#include "io/text.h"

#include <filesystem>

namespace vitral {

void load_mesh(const std::string& path, Scene& scene, Warnings& warnings) {
  const std::string extension = lower_case(std::filesystem::path(path).extension().string());
  if (extension == ".obj") {
    load_obj(path, scene, warnings);
  } else if (extension == ".ply") {
    load_ply(path, scene, warnings);
  } else {
    fail(path, "not a mesh: the name must end in .obj or .ply");
  }
}

}  // namespace vitral
