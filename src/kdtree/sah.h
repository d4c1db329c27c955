// The surface area heuristic: what a plane through a node would cost, and the best plane there is.
//
// The cost of a plane is the expected work of a ray that crosses the node (MacDonald and Booth 1990;
// Wald and Havran, "On building fast kd-trees for ray tracing, and on doing that in O(N log N)",
// 2006, section 3): traversal + intersection * (SA_below / SA * N_below + SA_above / SA * N_above),
// lowered when one side is empty.
#pragma once
#include "vitral/box.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace vitral {

// A triangle's part inside a node: its number and the bounds of that part.
struct Reference {
  Box box;
  uint32_t triangle;
};

struct SahCosts {
  float traversal = 2.0f;
  float intersection = 1.5f;
  float empty_bonus = 0.8f;  // factor on the cost of a plane that cuts off empty space
};

// Which side takes the references that lie in the plane itself.
enum class PlanarSide { below, above };

struct Plane {
  float cost;  // +inf: no plane is worth it
  float position;
  int axis;
  PlanarSide planar;
};

// The best of all planes at the ends of the references' boxes (`exact`), or of 64 planes evenly
// spaced on each axis between the outermost ends (`binned`, Hunt, Mark and Stoll 2006; Shevtsov,
// Soupikov and Kapustin 2007). Ties go to the lower axis, then to the lower position.
Plane best_plane_exact(std::span<const Reference> references, const Box& cell, const SahCosts& costs);
Plane best_plane_binned(std::span<const Reference> references, const Box& cell, const SahCosts& costs);

}  // namespace vitral
