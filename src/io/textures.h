// The pictures that materials name.
#pragma once
#include "vitral/error.h"
#include "vitral/scene.h"

#include <cstddef>
#include <span>
#include <string>

namespace vitral {

// One material's wish for one texture.
struct TextureUse {
  enum class Role { diffuse, opacity };
  Role role = Role::diffuse;
  size_t material = 0;   // into Scene::materials
  std::string file;      // as the material file writes it
  std::string mtl_path;  // the material file, in whose folder it lies
  size_t mtl_line = 0;
};

// Finds a file that another file names, relative to the other's folder. Backslashes separate
// folders too; where there is no such file, one whose name differs only in the case of its letters
// is taken, and for a path from another machine the file of that name in the folder itself. Returns
// an empty string when there is none.
std::string find_beside(const std::string& other, const std::string& name);

// Loads each picture once, several at a time, and sets the materials' maps. What cannot be loaded is
// a warning and leaves no map. A picture that serves for opacity and has no alpha channel (or, being
// no material's colour as well, one that is opaque everywhere) gets its grey value as alpha.
void load_textures(std::span<const TextureUse> uses, Scene& scene, Warnings& warnings, int threads);

}  // namespace vitral
