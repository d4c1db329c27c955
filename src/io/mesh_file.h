// Reads triangle meshes: OBJ with its MTL and textures, and PLY.
#pragma once
#include "vitral/error.h"
#include "vitral/scene.h"

#include <string>

namespace vitral {

// Reads the mesh at `path` (.obj or .ply by its extension, any case) and appends it to the scene
// with its materials and textures; triangles that name no material get one called "default".
// Warnings are lines `file:line: reason`, at most a few per kind. Throws InputError.
void load_mesh(const std::string& path, Scene& scene, Warnings& warnings);

}  // namespace vitral
