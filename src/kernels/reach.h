// What the ambient rays of some blocks can reach.
//
// They start in one small box and end within a known distance: all they can meet lies in the leaves that
// the box, grown by that distance, overlaps, and above the planes through the points.
#pragma once
#include "kdtree/kdtree.h"
#include "kernels/counts.h"
#include "kernels/lanes.h"

namespace vitral {
namespace VITRAL_ISA {

// Within the box, above the plane.
struct Reach {
  PlainBox start;   // of the points
  PlainBox box;     // grown by how far the rays go and by the traversal's slack
  float magnitude;  // largest coordinate of the points
  float radius;     // half the diagonal of `start`
  float distance;   // how far the rays go
  float far;        // and what they hit is from the points
  Vec3 normal;      // the points' mean: from its plane no point's differs by more than `tilt` per length
  float tilt;
  float floor;  // lower than this along the normal, less the tilt, is below the planes of all points
};
// The box of the live points.
PlainBox start_of(const PointPacket* const* points, int count);

Reach reach_of(const KdView& tree, const PointPacket* const* points, int count, float distance);

static inline Vec3T<Float> splat(const Vec3& v) {
  return {Float(v.x), Float(v.y), Float(v.z)};
}

// Rounding moves a point of a triangle, and a point of a ray, by less than 2^-20 of the largest
// coordinates that go in. Directions are unit within 2^-20, and their polynomials off by 2^-19.
template <class F>
static inline F margin_of(const F& magnitude, float distance) {
  return magnitude * F(1.0f / 1048576) + F(distance * (1.0f / 262144));
}

// A triangle for kLanes points, or kLanes triangles.
struct Corners {
  Vec3T<Float> a, b, c;
};

// Those that overlap the box and rise above the floor.
Mask within(const Corners& t, const Reach& reach);

// What is within the reach of some blocks: opaque triangles, side by side, and nodes that look small from
// there, with everything in them.
inline constexpr int kMaxPool = 4096, kMaxNodes = 256;
struct alignas(64) Pool {
  float corner[9][kMaxPool + 16];
  uint32_t id[kMaxPool + 16];
  Vec3 plane[kMaxPool];  // normals of length 1; not a number where there is no area
  int count;
  PlainBox cell[kMaxNodes];
  uint32_t node[kMaxNodes];
  int nodes;
};

// What is smaller than this part of its distance looks small; and how many leaves are opened at most: of what
// does not look small, or it is given up, and in all while there are nodes left to open.
struct Effort {
  float small;
  int leaves, opened;
};
enum class Collected { all, too_many };
template <class Counts>
Collected collect(const KdView& tree, const Reach& reach, const Effort& effort, Pool& out, Counts counts);

// The deepest node that holds everything in the box.
uint32_t entry_node(const KdView& tree, const Box& box);

}  // namespace VITRAL_ISA
}  // namespace vitral
