// Cuts polygons into triangles.
#pragma once
#include "vitral/vec.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace vitral {

// A triangle that can be neither seen nor hit: a corner is not finite or beyond 1e18 in magnitude
// (products of three coordinates must stay finite in double, of two in float), two corners are
// equal, or the cross product, computed in double, is exactly zero.
bool is_degenerate(const Vec3& a, const Vec3& b, const Vec3& c);

using LocalCorners = std::array<uint32_t, 3>;  // numbers of corners within the polygon

// Memory that is reused from one polygon to the next.
struct TriangulateScratch {
  std::vector<Vec2T<double>> points;  // projected
  std::vector<uint32_t> next, previous;
  // Corners where the outline does not turn left, sorted into the cells of a square grid.
  std::vector<uint32_t> reflex, cell_begin, cell_end;
  std::vector<uint32_t> queue;  // corners to be looked at
};

// Replaces `triangles` by the n - 2 triangles of a polygon of n >= 3 corners, wound as the polygon
// is. Concave outlines are cut correctly (ear clipping, Meisters 1975, in the plane of the axes in
// which the polygon is largest); outlines that cross themselves, or whose cutting would take more
// than about a thousand steps a corner, get some triangles that cover about the same area.
void triangulate(std::span<const Vec3> polygon, TriangulateScratch& scratch,
                 std::vector<LocalCorners>& triangles);

}  // namespace vitral
