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

static inline void store(const Float4& lower, const Float4& upper, Reference& r) {
  std::memcpy(&r, &lower, sizeof lower);
  std::memcpy(r.max, &upper, sizeof upper);
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
  float traversal = 5.0f;
  float intersection = 1.5f;
  float empty_bonus = 0.9f;  // factor on the cost of a plane that cuts off empty space
};

// Which side takes the references that lie in the plane itself.
enum class PlanarSide { below, above };

struct Plane {
  float cost;  // +inf: no plane is worth it
  float position;
  int axis;
  PlanarSide planar;
  uint32_t below, above;  // references on its sides; among bins, only 0 is exact
};

// The planes worth looking at, on each axis, with the references on their sides. They depend on the
// references alone: when a plane cuts empty space off a cell, those of the rest are the same again.
inline constexpr size_t kExactAtMost = 64;  // references
inline constexpr size_t kMaxBins = 64;
struct alignas(16) Candidates {
  static constexpr size_t kMost = 2 * kExactAtMost;
  struct Axis {
    size_t count;     // a multiple of four; the last ones may lie at +inf
    bool has_planar;  // false: what lies in a plane goes below, above if nothing else is below
    float position[kMost];
    float below[kMost], above[kMost];  // references that lie below or above at least in part
    float planar[kMost];               // and in the plane; not set unless has_planar
  } axis[3];
};

// The best candidate strictly inside the cell. Ties go to the lower axis, then to the first candidate,
// then to PlanarSide::below. A cell of no area has none.
Plane best_plane(const Candidates& candidates, const Box& cell, const SahCosts& costs);

// All planes at the ends of the references' boxes. Every plane is counted against every reference,
// which for at most kExactAtMost of them is quicker than sorting.
void find_exact_candidates(std::span<const Reference> references, Candidates& candidates);

// Only the ends that lie between two positions on one axis, for the neighbourhood of a plane among
// many references; false when it has too many of them.
bool find_candidates_near(std::span<const Reference> references, int axis, float from, float to,
                          Candidates& candidates);

// Planes evenly spaced on each axis between the outermost ends (Hunt, Mark and Stoll 2006; Shevtsov,
// Soupikov and Kapustin 2007): how many boxes start and end between two of them is counted, for a
// large node in several pieces whose counts are added.
struct BinLayout {
  Float4 lower, scale;  // bin = (x - lower) * scale; scale is 0 on an axis that is too thin to cut
  Float4 upper;
  size_t bins;  // per axis
};
struct BinCounts {
  uint32_t starts[3][kMaxBins];
  uint32_t ends[3][kMaxBins];
};
BinLayout make_bins(const Box4& tight, size_t references);
void clear(const BinLayout& layout, BinCounts& counts);
void count_bins(std::span<const Reference> references, const BinLayout& layout, BinCounts& counts);
void add_counts(const BinLayout& layout, const BinCounts& more, BinCounts& counts);
void find_binned_candidates(const BinLayout& layout, const BinCounts& counts, size_t references,
                            Candidates& candidates);

}  // namespace vitral
