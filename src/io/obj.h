// Reads Wavefront OBJ.
#pragma once
#include "vitral/error.h"
#include "vitral/scene.h"

#include <string>

namespace vitral {

// Reads the polygons of an OBJ file with its material libraries and their textures and appends them
// to the scene, as load_mesh() of mesh_file.h promises. Lines, points, curves and surfaces are
// skipped with a warning. Polygons are cut as triangulate.h says; missing normals are computed as
// normals.h says, by smoothing groups where the file has `s` statements. The result does not depend
// on `threads` (0: one per processor). Throws InputError; the scene is then unchanged.
void load_obj(const std::string& path, Scene& scene, Warnings& warnings, int threads = 0);

}  // namespace vitral
