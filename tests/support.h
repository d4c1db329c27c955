// What several tests need: random numbers, meshes, trees over them.
#pragma once
#include "kdtree/build.h"
#include "kdtree/kdtree.h"
#include "kernels/packet.h"
#include "vitral/scene.h"

#include <cmath>
#include <random>
#include <vector>

namespace vitral::test {

struct Random {
  std::mt19937 engine;
  explicit Random(uint32_t seed) : engine(seed) {}
  uint32_t bits() { return static_cast<uint32_t>(engine()); }
  uint32_t below(uint32_t n) { return bits() % n; }
  float unit() { return static_cast<float>(bits() >> 8) * 0x1p-24f; }
  float between(float a, float b) { return a + (b - a) * unit(); }
  Vec3 in_box(float a, float b) {
    const float x = between(a, b), y = between(a, b), z = between(a, b);
    return {x, y, z};
  }
  Vec3 direction() {
    for (;;) {
      const Vec3 v = in_box(-1, 1);
      const float squared = dot(v, v);
      if (squared > 0.01f && squared <= 1) return normalize(v);
    }
  }
};

inline void add_triangle(std::vector<KdTriangle>& out, const Vec3& a, const Vec3& b, const Vec3& c, uint32_t flags = 0) {
  out.push_back({{{a.x, a.y, a.z}, {b.x, b.y, b.z}, {c.x, c.y, c.z}}, flags});
}

inline Vec3 corner_of(const KdTriangle& t, size_t k) { return {t.corner[k][0], t.corner[k][1], t.corner[k][2]}; }

// A tree with its triangles, built on this thread.
struct Tree {
  std::vector<KdTriangle> triangles;
  KdTree tree;
  KdView view{};

  explicit Tree(std::vector<KdTriangle> list, const CutOuts& cut_outs = {}) : triangles(std::move(list)) {
    std::vector<uint32_t> members(triangles.size());
    for (uint32_t i = 0; i < members.size(); ++i) members[i] = i;
    tree = build_kdtree(triangles, members, {}, [](size_t n, const std::function<void(size_t)>& body) {
      for (size_t i = 0; i < n; ++i) body(i);
    });
    view = make_view(tree, triangles, cut_outs);
  }
  Tree(const Tree&) = delete;
  Tree& operator=(const Tree&) = delete;
  uint32_t size() const { return static_cast<uint32_t>(triangles.size()); }
};

// A closed sphere of rings x 2 rings quads, each two triangles; corners are shared bit for bit.
inline std::vector<KdTriangle> sphere(const Vec3& center, float radius, int rings) {
  const double pi = 3.14159265358979323846;
  const int around = 2 * rings;
  const auto corner = [&](int ring, int i) -> Vec3 {
    if (ring == 0) return center + Vec3{0, radius, 0};
    if (ring == rings) return center + Vec3{0, -radius, 0};
    const double theta = pi * ring / rings, phi = 2 * pi * (i % around) / around;
    return center + Vec3{static_cast<float>(std::sin(theta) * std::cos(phi)), static_cast<float>(std::cos(theta)),
                         static_cast<float>(std::sin(theta) * std::sin(phi))} * radius;
  };
  std::vector<KdTriangle> out;
  for (int ring = 0; ring < rings; ++ring) {
    for (int i = 0; i < around; ++i) {
      if (ring > 0) add_triangle(out, corner(ring, i), corner(ring, i + 1), corner(ring + 1, i));
      if (ring < rings - 1) add_triangle(out, corner(ring, i + 1), corner(ring + 1, i + 1), corner(ring + 1, i));
    }
  }
  return out;
}

// Small triangles all over the cube [-1, 1]^3.
inline std::vector<KdTriangle> soup(Random& random, int count, float size) {
  std::vector<KdTriangle> out;
  for (int i = 0; i < count; ++i) {
    const Vec3 p = random.in_box(-1, 1);
    const Vec3 a = random.in_box(-size, size), b = random.in_box(-size, size);
    add_triangle(out, p, p + a, p + b);
  }
  return out;
}

inline bool same_bits(const Hit& a, const Hit& b) {
  return as_bits(a.t) == as_bits(b.t) && as_bits(a.u) == as_bits(b.u) && as_bits(a.v) == as_bits(b.v) && a.triangle == b.triangle;
}

}  // namespace vitral::test
