// What the tests of the tree's builder share: meshes that are hard on it, and its leaves.
#pragma once
#include "support.h"

#include <functional>
#include <vector>

namespace vitral::test {

using Triangles = std::vector<KdTriangle>;

inline std::vector<uint32_t> all_of(const Triangles& triangles) {
  std::vector<uint32_t> members(triangles.size());
  for (uint32_t i = 0; i < members.size(); ++i) members[i] = i;
  return members;
}

inline void one_by_one(size_t n, const std::function<void(size_t)>& body) {
  for (size_t i = 0; i < n; ++i) body(i);
}

// Faces of boxes on a lattice: planes, triangles and edges coincide everywhere.
inline Triangles city(Random& random, int faces) {
  Triangles out;
  for (int i = 0; i < faces; ++i) {
    const Vec3 p = Vec3{static_cast<float>(random.below(32)), static_cast<float>(random.below(32)),
                        static_cast<float>(random.below(32))} *
                   0.25f;
    const uint32_t flat = random.below(3);
    const Vec3 u = flat == 0 ? Vec3{0, 0.25f, 0} : Vec3{0.25f, 0, 0},
               v = flat == 2 ? Vec3{0, 0.25f, 0} : Vec3{0, 0, 0.25f};
    add_triangle(out, p, p + u, p + v);
    add_triangle(out, p + u, p + u + v, p + v);
  }
  return out;
}

inline Triangles needles(Random& random, int count) {
  Triangles out;
  for (int i = 0; i < count; ++i) {
    const Vec3 d = random.direction() * 2, e = random.direction() * 1e-6f;
    add_triangle(out, -d, d, d + e);
  }
  return out;
}

inline Triangles scaled(Triangles triangles, float scale, const Vec3& shift) {
  for (KdTriangle& t : triangles) {
    for (auto& c : t.corner) {
      c[0] = c[0] * scale + shift.x, c[1] = c[1] * scale + shift.y, c[2] = c[2] * scale + shift.z;
    }
  }
  return triangles;
}

// The cells of a tree, leaf by leaf.
template <class Visit>
void for_each_leaf(const KdTree& tree, uint32_t node, const Box& cell, int depth, const Visit& visit) {
  const KdNode& n = tree.nodes.at(node);
  if (is_leaf(n)) return visit(n, cell, depth);
  Box below = cell, above = cell;
  (axis(n) == 0 ? below.max.x : axis(n) == 1 ? below.max.y : below.max.z) = split(n);
  (axis(n) == 0 ? above.min.x : axis(n) == 1 ? above.min.y : above.min.z) = split(n);
  for_each_leaf(tree, child(n), below, depth + 1, visit);
  for_each_leaf(tree, child(n) + 1, above, depth + 1, visit);
}

}  // namespace vitral::test
