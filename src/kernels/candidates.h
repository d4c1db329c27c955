// Ambient rays from one block of points: the few triangles that any of them could meet, and for each
// which of them could.
//
// The rays come by strata of the hemisphere: rings of equal steps in the squared cosine from the normal,
// crossed by columns of equal turns around it. Of a triangle it is known in which rings and in which columns
// each point may see it. Most pairs of a stratum and a triangle need no test, and where no triangle is left
// for a stratum, none of its rays is even made.
//
// All of it is by margins that cover every rounding, so that the answer is that of the walk.
#pragma once
#include "kernels/reach.h"

namespace vitral {
namespace VITRAL_ISA {

inline constexpr int kMaxCandidates = 512;
inline constexpr int kMaxParts = 16;

// Whether the rays of a block are found among candidates, or walk the tree.
enum class Enough { candidates, walk };

// How rings and columns are counted: ring r has squared cosines from r / count on, column c begins at the
// turn c / count from t towards b. The first `lines` of these turns are boundaries of their own; the rest are
// the same lines, run through backwards.
struct Parts {
  int count, lines;
  float cosine[kMaxParts], sine[kMaxParts];
};
Parts parts_of(int strata);

// Tangent frames of the points.
struct alignas(64) Frames {
  float tx[kPacketSize], ty[kPacketSize], tz[kPacketSize];
  float bx[kPacketSize], by[kPacketSize], bz[kPacketSize];
};

// Shapes, and for each the points that may see it in a ring or one above, and in a column.
template <int kMost>
struct alignas(64) Seen {
  int count;
  int reaching[kMaxParts];  // the first so many in `order` may be seen in that ring
  int order[kMost];         // those that are seen highest come first
  uint64_t ring[kMaxParts][kMost], column[kMaxParts][kMost];
};

// Triangles, and nodes of the tree with everything in them.
struct Candidates {
  Seen<kMaxCandidates> triangles;
  uint32_t triangle[kMaxCandidates];
  Seen<kMaxNodes> nodes;
  PlainBox cell[kMaxNodes];
};

// Those of the pool that rays of length `distance` may meet, from the live points raised by their offsets
// along their geometric normals, going nowhere below the planes through them. More than `most` triangles,
// which is at most kMaxCandidates, are too many.
Enough choose_candidates(const KdView& tree, const Pool& pool, const PointPacket& points,
                         const Frames& frames, const Parts& parts, float distance, int most, Candidates& out);

}  // namespace VITRAL_ISA
}  // namespace vitral
