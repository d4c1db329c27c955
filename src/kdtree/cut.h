// Cutting a triangle's part in two at a plane ("perfect splits": each side sees only the bounds of its
// own part; Wald and Havran 2006, section 4.1).
#pragma once
#include "kdtree/kdtree.h"
#include "kdtree/sah.h"

namespace vitral {

// Each part is bounded by the triangle's corners on its side and the points where its edges cross the
// plane, rounded outwards, inside the reference's old bounds.
void cut(const KdTriangle& triangle, const Reference& whole, const Plane& plane, Reference& below,
         Reference& above);

}  // namespace vitral
