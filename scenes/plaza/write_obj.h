#pragma once
#include <filesystem>

#include "geometry.h"

namespace plaza {

size_t triangle_count(const Mesh& mesh);

// Writes the mesh as OBJ, faces ordered by group and material. Coordinates are rounded to 0.1 mm, so
// that the last bits of a compiler's mathematics do not show. Throws on failure.
void write_obj(const Mesh& mesh, const std::filesystem::path& file);

}  // namespace plaza
