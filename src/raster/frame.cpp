#include "raster/frame.h"

namespace vitral {

void transform_vertices(ProjectKernel kernel, const Pinhole& camera, int width, int height,
                        const Rectangle& crop, const Mesh& mesh, const ForEach& for_each,
                        RasterFrame& frame) {
  frame.projection = make_projection(camera, width, height, crop);
  frame.grid = make_grid(width, height);

  constexpr size_t per_piece = 16384;
  const size_t vertices = mesh.positions.size();
  frame.vertices.resize(vertices);
  for_each((vertices + per_piece - 1) / per_piece, [&](size_t piece) {
    const size_t begin = piece * per_piece;
    const size_t count = begin + per_piece < vertices ? per_piece : vertices - begin;
    kernel(frame.projection, mesh.positions.data() + begin, count, frame.vertices.data() + begin);
  });
}

void setup_triangles(SetupKernel kernel, const Mesh& mesh, const KdTriangle* flags_of,
                     const ForEach& for_each, RasterFrame& frame) {
  const SetupInput in{frame.projection,
                      frame.vertices.data(),
                      mesh.positions.data(),
                      mesh.triangles.empty() ? nullptr : mesh.triangles.front().data(),
                      flags_of,
                      0,
                      0};
  frame.chunks.resize(chunk_count(mesh.triangles.size()));
  for_each(frame.chunks.size(), [&](size_t chunk) {
    setup_chunk(kernel, in, frame.grid, mesh.triangles.size(), chunk, frame.chunks[chunk]);
  });
}

RasterView make_view(const RasterFrame& frame, const Pinhole& camera, const KdTriangle* triangles,
                     const CutOuts* cut_outs) {
  return make_view(frame, frame.projection, camera, triangles, cut_outs);
}

}  // namespace vitral
