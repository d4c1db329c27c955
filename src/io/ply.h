// Reads PLY, the Stanford polygon format (Turk 1994).
#pragma once
#include "vitral/error.h"
#include "vitral/scene.h"

#include <string>

namespace vitral {

// Reads the polygons of a PLY file, ascii or binary of either byte order, and appends them to the
// scene in the material "default". Of the vertices it takes x y z, nx ny nz and the texture
// coordinates (s t, u v, texture_u texture_v); of the faces the list vertex_indices (vertex_index),
// and the same list of tristrips, where -1 begins a new strip. Everything else is skipped. Polygons
// are cut as triangulate.h says and missing normals computed as normals.h says. Throws InputError;
// the scene is then unchanged.
void load_ply(const std::string& path, Scene& scene, Warnings& warnings, int threads = 0);

}  // namespace vitral
