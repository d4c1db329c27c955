// A shape as the points of a block see it, each for itself.
#pragma once
#include "kernels/candidates.h"

namespace vitral {
namespace VITRAL_ISA {

// What the points want to know of themselves: their own coordinates along their frames' axes, and how far
// along the tangents it turns a ray of full length to be mirrored back above the geometric surface, which is
// no more than twice the squared sine between the normals.
struct alignas(64) Sights {
  float geometric[kPacketSize], normal[kPacketSize], tangent[kPacketSize], bitangent[kPacketSize];
  float turn[kPacketSize];
};
void make_sights(const PointPacket& points, const Frames& frames, float distance, Sights& out);

// A block of points with everything that is asked of it again and again.
struct Block {
  const PointPacket& points;
  const Frames& frames;
  const Parts& parts;
  Reach reach;
  Sights sights;
};

// Finds the live points that may see a triangle, or a box, in each ring or one above, and in each column;
// false when none sees it at all. Both arrays have parts.count entries, which are overwritten. The triangle's
// plane has a normal of length 1, or not a number where it has no area.
bool look(const KdTriangle& t, const Vec3& plane, const Block& block, uint64_t* ring, uint64_t* column);
bool look(const PlainBox& box, const Block& block, uint64_t* ring, uint64_t* column);

}  // namespace VITRAL_ISA
}  // namespace vitral
