// Meshes in clusters: some hundred triangles that follow each other, with the vertices they use side by side
// and a box around them. Whoever draws a mesh many times brings only those clusters to the screen that can be
// seen there, each by itself, and needs no memory for more than one at a time.
#pragma once
#include "vitral/box.h"
#include "vitral/scene.h"

#include <cstdint>
#include <vector>

namespace vitral {

inline constexpr uint32_t kClusterTriangles = 512;

struct Cluster {
  Box bounds;
  uint32_t first_triangle, triangles;  // numbers in Mesh::triangles
  uint32_t first_vertex, vertices;     // in ClusteredMesh::positions
};

struct ClusteredMesh {
  std::vector<Cluster> clusters;  // in the order of their triangles; all but the last are full
  std::vector<Vec3> positions;
  std::vector<uint32_t> corners;  // three per triangle, counted from the first vertex of its cluster
  Box bounds;
};

ClusteredMesh cluster_mesh(const Mesh& mesh);

}  // namespace vitral
