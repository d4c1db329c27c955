// What the readers of all mesh formats do to a Mesh.
#pragma once
#include "vitral/error.h"
#include "vitral/scene.h"

#include <cstddef>
#include <string>

namespace vitral {

// Unit length; all components NaN for a normal that is zero or not finite.
Vec3 clean_normal(const Vec3& normal);

// Texture coordinates repeat with period 1. One that is not finite, or so large that a float there
// has no fraction, becomes 0.
Vec2 clean_texcoord(const Vec2& texcoord);

// The index of the material called "default" for triangles that name none; appended to the scene.
uint32_t add_default_material(Scene& scene);

// Gives back memory that a vector holds and does not use, if it is worth the copying.
template <class Vector>
void trim(Vector& vector) {
  if (vector.capacity() - vector.size() > vector.size() / 16) vector.shrink_to_fit();
}

// Appends one mesh to another. Its material numbers are moved up by `first_material`.
void append(Mesh part, uint32_t first_material, Mesh& mesh);

// Closes the reading of a file: throws InputError when it gave no triangle, else warns of those that
// were left out and counts them in the scene.
void report_dropped(const std::string& path, size_t kept, size_t dropped, Scene& scene, Warnings& warnings);

}  // namespace vitral
