// The surface area heuristic: what a plane through a node would cost, and the best plane there is.
//
// The cost of a plane is the expected work of a ray that crosses the node (MacDonald and Booth 1990;
// Wald and Havran, "On building fast kd-trees for ray tracing, and on doing that in O(N log N)",
// 2006, section 3): traversal + intersection * (SA_below / SA * N_below + SA_above / SA * N_above),
// lowered when one side is empty.
#pragma once
#include "kdtree/float4.h"
#include "vitral/box.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace vitral {

// A triangle's part inside a node: the bounds of that part, and in their fourth lanes the triangle's
// number and nothing.
struct alignas(16) Reference {
  float min[3];
  uint32_t triangle;
  float max[3];
  uint32_t unused;
};

static inline Float4 lower(const Reference& r) {
  return load4(r.min);
}
static inline Float4 upper(const Reference& r) {
  return load4(r.max);
}

// Bounds as two registers; the fourth lanes hold anything.
struct Box4 {
  Float4 min = splat(std::numeric_limits<float>::infinity());
  Float4 max = splat(-std::numeric_limits<float>::infinity());
};
static inline void extend(Box4& b, const Float4& min, const Float4& max) {
  b.min = least(min, b.min);
  b.max = greatest(max, b.max);
}
static inline Box to_box(const Box4& b) {
  return {{b.min[0], b.min[1], b.min[2]}, {b.max[0], b.max[1], b.max[2]}};
}
Box4 bounds_of(std::span<const Reference> references);

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

// The best of all planes at the ends of the references' boxes. Every plane is counted against every
// reference, which is quicker than sorting for as few as these: at most kExactAtMost.
// Ties go to the lower axis, then to the lower position, then to PlanarSide::below.
inline constexpr size_t kExactAtMost = 64;
Plane best_plane_exact(std::span<const Reference> references, const Box& cell, const SahCosts& costs);

// The best of the planes evenly spaced on each axis between the outermost ends (Hunt, Mark and Stoll
// 2006; Shevtsov, Soupikov and Kapustin 2007): how many boxes start and end between two of them is
// counted, for a large node in several pieces whose counts are added. Ties as above.
inline constexpr int kMaxBins = 64;
struct BinLayout {
  Float4 lower, scale;  // bin = (x - lower) * scale; scale is 0 on an axis that is too thin to cut
  Box tight;            // the outermost ends
  int bins;             // per axis
};
struct BinCounts {
  uint32_t starts[3][kMaxBins];
  uint32_t ends[3][kMaxBins];
};
BinLayout make_bins(const Box4& tight, size_t references);
void clear(const BinLayout& layout, BinCounts& counts);
void count_bins(std::span<const Reference> references, const BinLayout& layout, BinCounts& counts);
void add_counts(const BinLayout& layout, const BinCounts& more, BinCounts& counts);
Plane best_plane_binned(const BinLayout& layout, const BinCounts& counts, size_t references, const Box& cell,
                        const SahCosts& costs);

}  // namespace vitral
