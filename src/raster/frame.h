// The whole frame's part of rasterization, before tiles go their own ways.
#pragma once
#include "raster/bin.h"
#include "raster/drawn.h"
#include "raster/raster.h"
#include "raster/setup.h"

#include <vector>

namespace vitral {

// Kept from frame to frame, so that the memory is. What is binned are the scene's own triangles.
struct RasterFrame : BinnedTriangles {
  Projection projection;
  std::vector<ScreenVertex> vertices;
  DrawnObjects objects;
};

// The three stages of setting a frame up, in this order: the vertices on the screen, the triangles ready to
// be filled, and which of them each tile has to look at. Frames up to kMaxImageSide a side. `flags_of` has
// one entry for each triangle of the mesh; it is null where none is a cut-out.
void transform_vertices(ProjectKernel kernel, const Pinhole& camera, int width, int height,
                        const Rectangle& crop, const Mesh& mesh, const ForEach& for_each, RasterFrame& frame);
void setup_triangles(SetupKernel kernel, const Mesh& mesh, const KdTriangle* flags_of,
                     const ForEach& for_each, RasterFrame& frame);
void bin_triangles(const ForEach& for_each, BinnedTriangles& binned);

// What the fill kernel is given. Everything pointed to must outlive it, and the frame stay as it is.
// `triangles` has one entry for each triangle of the mesh; it and `cut_outs` matter only to cut-outs
// and may be null.
RasterView make_view(const RasterFrame& frame, const Pinhole& camera, const KdTriangle* triangles,
                     const CutOuts* cut_outs);

}  // namespace vitral
