// Ambient rays from one block of points: the few triangles that any of them could meet, and for each
// which of them could.
//
// The ambient rays of a block start in one small box and end within a known distance. All they can
// meet lies in the leaves that the box, grown by that distance, overlaps, and above the planes through
// the points. Of a triangle that is left each point knows two more things: how high it can stand over
// the horizon at most, and in which quadrants around the normal. A stratum of the hemisphere has a least
// height and lies in one quadrant, or a few: most pairs of a stratum and a triangle need no test, and
// where no triangle is left for a stratum, none of its rays is even made.
//
// All of it is by margins that cover every rounding, so that the answer is that of the walk.
#pragma once
#include "kdtree/kdtree.h"
#include "kernels/counts.h"
#include "kernels/lanes.h"

namespace vitral {
namespace VITRAL_ISA {

inline constexpr int kMaxCandidates = 1024;
inline constexpr int kTooMany = -1;
inline constexpr int kHeights = 4;    // d . n at least sqrt(h / 4)
inline constexpr int kQuadrants = 4;  // signs of d . t and d . b: ++ -+ -- +-

// Tangent frames of the points.
struct alignas(64) Frames {
  float tx[kPacketSize], ty[kPacketSize], tz[kPacketSize];
  float bx[kPacketSize], by[kPacketSize], bz[kPacketSize];
};

struct Candidate {
  uint32_t triangle;
  uint64_t height[kHeights];      // the points that may see it that high: each holds the next
  uint64_t quadrant[kQuadrants];  // or there
};

struct Candidates {
  int count;              // or kTooMany
  int seen_at[kHeights];  // the first so many may be seen that high; the first of these is `count`
  Candidate list[kMaxCandidates];
};

// What the rays of some blocks can reach: within the box, above the plane.
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
Reach reach_of(const KdView& tree, const PointPacket* const* points, int count, float distance);

// Opaque triangles within the reach of some blocks, side by side.
inline constexpr int kMaxPool = 4096;
struct alignas(64) TrianglePool {
  float corner[9][kMaxPool + 16];
  uint32_t id[kMaxPool + 16];
  int count;
};

// Gives up when there are too many, or after `most_leaves` leaves.
enum class Collected { all, too_many };
template <class Counts>
Collected collect(const KdView& tree, const Reach& reach, int most_leaves, TrianglePool& out, Counts counts);

// Those of the pool that rays of length `distance` may meet, from the live points raised by their offsets
// along their geometric normals, going nowhere below the planes through them. More than `most`, which is at
// most kMaxCandidates, are too many.
void choose_candidates(const KdView& tree, const TrianglePool& pool, const PointPacket& points,
                       const Frames& frames, float distance, int most, Candidates& out);

// The deepest node that holds everything in the box.
uint32_t entry_node(const KdView& tree, const Box& box);

// In trace.cpp: the any-hit walk below a node.
uint64_t trace_any_from(const KdView& tree, uint32_t node, const RayPacket& rays, GlassRule glass,
                        NoCounts counts);
uint64_t trace_any_from(const KdView& tree, uint32_t node, const RayPacket& rays, GlassRule glass,
                        Counting counts);

}  // namespace VITRAL_ISA
}  // namespace vitral
