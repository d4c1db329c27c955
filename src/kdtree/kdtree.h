// A kd-tree over triangles, built with the surface area heuristic.
//
// How to read this folder: this file (the layout), walk.cpp (one ray through the tree, the text that
// explains traversal), triangle.h (ray meets triangle), sah.h and build.cpp (where the planes go).
#pragma once
#include "math/scalar.h"
#include "vitral/box.h"
#include "vitral/counts.h"
#include "vitral/ray.h"
#include "vitral/scene.h"

#include <cstdint>
#include <cstring>
#include <vector>

namespace vitral {

// Eight bytes. Inner node: the plane x[axis] = split; the children are neighbours, the one below the
// plane at child(), the one above it at child() + 1. Leaf: count() references from first_reference().
struct KdNode {
  uint32_t split_or_count;
  uint32_t axis_and_index;  // bits 0-1: axis, or 3 for a leaf; bits 2-31: child or first reference
};

static inline bool is_leaf(const KdNode& n) {
  return (n.axis_and_index & 3u) == 3u;
}
static inline int axis(const KdNode& n) {
  return static_cast<int>(n.axis_and_index & 3u);
}
static inline uint32_t child(const KdNode& n) {
  return n.axis_and_index >> 2;
}
static inline uint32_t first_reference(const KdNode& n) {
  return n.axis_and_index >> 2;
}
static inline uint32_t count(const KdNode& n) {
  return n.split_or_count;
}
static inline float split(const KdNode& n) {
  float s;
  std::memcpy(&s, &n.split_or_count, sizeof s);
  return s;
}

inline constexpr int kMaxTreeDepth = 64;

// The triangle as the tracer wants it: three corners side by side, and what a ray may do with it.
enum TriangleFlags : uint32_t { kGlassTriangle = 1, kCutOutTriangle = 2 };
struct KdTriangle {
  float corner[3][3];
  uint32_t flags;
};

// Asks whether a triangle with a cut-out texture is really there at barycentric (u, v).
struct CutOuts {
  bool (*is_there)(const void* scene, uint32_t triangle, float u, float v) = nullptr;
  const void* scene = nullptr;
};

// The tree as the traversals see it: pointers only, so that the kernels share no code with the
// containers. Indices in `references` and hits are triangle numbers of the scene.
struct KdView {
  const KdNode* nodes;
  const uint32_t* references;
  const KdTriangle* triangles;
  Box bounds;
  float magnitude;  // largest absolute coordinate of bounds
  CutOuts cut_outs;
};

struct KdTree {
  std::vector<KdNode> nodes;  // nodes[0] is the root; nodes[1] is unused, so that siblings share 16 bytes
  std::vector<uint32_t> references;
  Box bounds;
};

inline size_t tree_bytes(const KdTree& tree) {
  return tree.nodes.size() * sizeof(KdNode) + tree.references.size() * sizeof(uint32_t);
}

KdView make_view(const KdTree& tree, const std::vector<KdTriangle>& triangles, const CutOuts& cut_outs);

// What any-hit rays do at glass: shadows and ambient occlusion let it through.
enum class GlassRule { blocks, passes };

// Every traversal visits all cells within this distance of the ray. It bounds how far the computed
// hit of a triangle (corners relative to the origin, sheared, in float: a few roundings of numbers no
// larger than 2 m, m the largest coordinate of scene and origin) and the computed crossing of a plane
// may be off: under 2^-20 m together. With it no hit that testing all triangles would find is lost,
// and the tree cannot be seen in the result (Ize, "Robust BVH Ray Traversal", JCGT 2013, argues so
// for boxes).
//
// Among denormal numbers errors no longer shrink with the numbers: the slack is at least 2^-110.
static inline float traversal_slack(float magnitude) {
  return greatest(magnitude * (1.0f / 262144.0f), 7.703719777548943e-34f);
}

// Reciprocal of a direction's component, kept finite: with |d| below 2^-64 a ray does not leave the
// slack around its start within any scene (coordinates are at most 1e18, directions about 1 long).
template <class F>
static inline F safe_reciprocal(const F& d) {
  const F least_d = F(5.421010862427522e-20f);  // 2^-64
  return F(1.0f) / copy_sign(greatest(absolute(d), least_d), d);
}

static inline float largest_component(const Vec3& v) {
  return greatest(absolute(v.x), greatest(absolute(v.y), absolute(v.z)));
}

// Rays that are not finite, start beyond 2^60, or whose direction has no usable length hit nothing.
// The comparisons are false for NaN.
template <class F>
static inline auto is_traceable(const Vec3T<F>& origin, const Vec3T<F>& direction) {
  const F o = (absolute(origin.x) + absolute(origin.y)) + absolute(origin.z);
  const F d = (absolute(direction.x) + absolute(direction.y)) + absolute(direction.z);
  return both(o < F(1.152921504606847e18f), both(d > F(2.3283064365386963e-10f), d < F(4294967296.0f)));
}

// One ray, one lane at a time. The text to read first, and the reference for the packets.
Hit walk_closest(const KdView& tree, const Ray& ray);
Hit walk_closest(const KdView& tree, const Ray& ray, TraversalCounts& counts);  // adds nodes and tests
bool walk_any(const KdView& tree, const Ray& ray, GlassRule glass);

// The same answer from testing all triangles [0, triangles): what the tree is measured against.
Hit brute_force_closest(const KdView& tree, uint32_t triangles, const Ray& ray, GlassRule glass);

}  // namespace vitral
