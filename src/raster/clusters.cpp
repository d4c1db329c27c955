#include "raster/clusters.h"

#include <algorithm>

namespace vitral {

ClusteredMesh cluster_mesh(const Mesh& mesh) {
  ClusteredMesh out;
  const uint32_t triangles = static_cast<uint32_t>(mesh.triangles.size());
  out.corners.reserve(size_t{3} * triangles);
  std::vector<uint32_t> place(mesh.positions.size(), kNoIndex);  // in the cluster that is being made
  std::vector<uint32_t> used;
  for (uint32_t first = 0; first < triangles; first += kClusterTriangles) {
    Cluster c{{}, first, std::min(kClusterTriangles, triangles - first), 0, 0};
    c.first_vertex = static_cast<uint32_t>(out.positions.size());
    for (uint32_t t = first; t < first + c.triangles; ++t) {
      for (const uint32_t vertex : mesh.triangles[t]) {
        if (place[vertex] == kNoIndex) {
          place[vertex] = c.vertices++;
          used.push_back(vertex);
          out.positions.push_back(mesh.positions[vertex]);
          extend(c.bounds, mesh.positions[vertex]);
        }
        out.corners.push_back(place[vertex]);
      }
    }
    for (const uint32_t vertex : used) place[vertex] = kNoIndex;
    used.clear();
    extend(out.bounds, c.bounds);
    out.clusters.push_back(c);
  }
  return out;
}

}  // namespace vitral
