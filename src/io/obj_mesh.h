// The second half of reading OBJ: the chunks' numbers to one mesh.
#pragma once
#include "vitral/error.h"
#include "vitral/scene.h"

#include "io/obj_chunk.h"

#include <string>
#include <vector>

namespace vitral {

// What comes before a chunk in the file.
struct ObjBefore {
  size_t lines = 0, positions = 0, texcoords = 0, normals = 0, triangles = 0;
  uint32_t material = kNoIndex;
  uint32_t smoothing = 0;
};

struct ObjFile {
  std::string path;
  std::vector<ObjChunk> chunks;   // their states' materials are numbers for triangle_material
  std::vector<ObjBefore> before;  // one per chunk, and one for the end of the file
};

struct ObjMesh {
  Mesh mesh;
  size_t dropped = 0;  // triangles left out
};

// Resolves indices, cuts polygons, leaves out degenerate triangles and computes missing normals.
// The chunks are emptied on the way. Throws InputError for an index out of range.
ObjMesh build_obj_mesh(ObjFile& file, int threads);

}  // namespace vitral
