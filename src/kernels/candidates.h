// Short rays from one block of points: the few triangles that any of them could meet.
//
// The ambient rays of a block start in one small box and end within a known distance. All they can
// meet lies in the leaves that the box, grown by that distance, overlaps. When these hold few
// triangles, every ray is tested against them and the tree is not walked at all; when they hold none,
// there is nothing to trace. What cannot be met is left out by margins that cover all rounding, so
// the answer is the same as the walk's.
#pragma once
#include "kdtree/kdtree.h"
#include "kernels/points.h"

namespace vitral {
namespace VITRAL_ISA {

inline constexpr int kMaxCandidates = 24;

struct Candidates {
  int count;      // more than kMaxCandidates: too many, walk from `node` instead
  uint32_t node;  // the deepest node that holds everything
  uint32_t triangle[kMaxCandidates];
  uint64_t lanes[kMaxCandidates];  // the points that may see it
};

// Opaque triangles that rays of length `distance` may meet, from the live points raised by their
// offsets along their geometric normals, going nowhere below the planes through them.
void find_candidates(const KdView& tree, const PointPacket& points, float distance, Candidates& out);

// In trace.cpp: the live rays that meet any of the candidates; the any-hit walk below a node.
uint64_t test_any(const KdView& tree, const Candidates& candidates, const RayPacket& rays);
uint64_t trace_any_from(const KdView& tree, uint32_t node, const RayPacket& rays, GlassRule glass);

}  // namespace VITRAL_ISA
}  // namespace vitral
