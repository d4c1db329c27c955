// Shading normals for corners that a file gives none.
#pragma once
#include "vitral/scene.h"

#include <cstdint>
#include <span>

namespace vitral {

// cos(40 degrees). Two triangles that share an edge look like one round surface when their normals
// differ by less.
inline constexpr float kCreaseCosine = 0.76604444f;

// Gives corners of the triangles from `first` on whose normal is kNoIndex a smooth one where there
// is one to give; the others stay flat. mesh.triangle_normals has one entry per triangle.
//
// `groups` holds the smoothing group of each of these triangles, and the triangles of one group that
// meet at a position share a normal there; group 0 is flat. Where `groups` is empty, triangles at a
// position share a normal when a chain of triangles leads from one to the other over edges at that
// position, each less sharp than kCreaseCosine. Positions with equal coordinates count as one.
//
// The normal is the sum of the triangles' unit normals weighted by their angle at the position
// (Thuermer and Wuethrich 1998). A corner whose neighbours all have its own normal stays flat.
// The result does not depend on `threads` (0: one per processor).
void compute_normals(Mesh& mesh, size_t first, std::span<const uint32_t> groups, int threads);

}  // namespace vitral
