// What several tests need: random numbers, meshes, trees over them.
#pragma once
#include "kdtree/build.h"
#include "kdtree/kdtree.h"
#include "kernels/packet.h"
#include "vitral/render.h"
#include "vitral/scene.h"

#include <cmath>
#include <cstring>
#include <functional>
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

inline void add_triangle(std::vector<KdTriangle>& out, const Vec3& a, const Vec3& b, const Vec3& c,
                         uint32_t flags = 0) {
  out.push_back({{{a.x, a.y, a.z}, {b.x, b.y, b.z}, {c.x, c.y, c.z}}, flags});
}

inline Vec3 corner_of(const KdTriangle& t, size_t k) {
  return {t.corner[k][0], t.corner[k][1], t.corner[k][2]};
}

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
    return center + Vec3{static_cast<float>(std::sin(theta) * std::cos(phi)),
                         static_cast<float>(std::cos(theta)),
                         static_cast<float>(std::sin(theta) * std::sin(phi))} *
                        radius;
  };
  std::vector<KdTriangle> out;
  for (int ring = 0; ring < rings; ++ring) {
    for (int i = 0; i < around; ++i) {
      if (ring > 0) add_triangle(out, corner(ring, i), corner(ring, i + 1), corner(ring + 1, i));
      if (ring < rings - 1)
        add_triangle(out, corner(ring, i + 1), corner(ring + 1, i + 1), corner(ring + 1, i));
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

// --- scenes for whole renders ---------------------------------------------------------------------

inline uint32_t add_material(Scene& scene, const Material& m) {
  scene.materials.push_back(m);
  return static_cast<uint32_t>(scene.materials.size() - 1);
}

// The parallelogram a, a+u, a+u+v, a+v, facing cross(u, v); texture coordinates (0,0) to (1,1).
inline void add_quad(Scene& scene, uint32_t material, const Vec3& a, const Vec3& u, const Vec3& v) {
  Mesh& m = scene.mesh;
  const uint32_t p = static_cast<uint32_t>(m.positions.size()), t = static_cast<uint32_t>(m.texcoords.size());
  m.positions.insert(m.positions.end(), {a, a + u, a + u + v, a + v});
  m.texcoords.insert(m.texcoords.end(), {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  for (const uint32_t k : {1u, 2u}) {
    m.triangles.push_back({p, p + k, p + k + 1});
    m.triangle_texcoords.push_back({t, t + k, t + k + 1});
    m.triangle_material.push_back(material);
  }
}

inline void add_triangles(Scene& scene, uint32_t material, const std::vector<KdTriangle>& triangles) {
  Mesh& m = scene.mesh;
  for (const KdTriangle& t : triangles) {
    const uint32_t p = static_cast<uint32_t>(m.positions.size());
    for (size_t k = 0; k < 3; ++k) m.positions.push_back(corner_of(t, k));
    m.triangles.push_back({p, p + 1, p + 2});
    m.triangle_texcoords.push_back({kNoIndex, kNoIndex, kNoIndex});
    m.triangle_material.push_back(material);
  }
}

// White, lit by nothing but the ambient light, before black: a picture of it shows how much of it each pixel
// sees.
inline Scene white_scene() {
  Scene scene;
  Material m;
  m.diffuse = {1, 1, 1};
  add_material(scene, m);
  scene.ambient = {1, 1, 1};
  scene.background.color = {0, 0, 0};
  return scene;
}

inline Light sun(const Vec3& direction, const Vec3& color = {1, 1, 1}) {
  Light light;
  light.direction = normalize(direction);
  light.color = color;
  return light;
}

inline Camera camera_at(const Vec3& position, const Vec3& view, float fov = 60, const Vec3& up = {0, 1, 0}) {
  Camera camera;
  camera.position = position, camera.view = view, camera.up = up;
  camera.fov = fov, camera.near = 0.01f, camera.far = 1000;
  return camera;
}

inline Effects only(bool Effects::*effect) {
  Effects e{false, false, false, false};
  e.*effect = true;
  return e;
}
inline constexpr Effects kNoEffects{false, false, false, false};

inline Frame render_scene(const Scene& scene, const Camera& camera, const Settings& settings) {
  Control control;
  return render(scene, camera, settings, control);
}

inline const Vec3& pixel(const Frame& frame, int x, int y) {
  return frame.radiance.row(y)[x];
}

inline bool same_bytes(const Frame& a, const Frame& b) {
  return a.radiance.pixels.size() == b.radiance.pixels.size() &&
         std::memcmp(a.radiance.pixels.data(), b.radiance.pixels.data(),
                     a.radiance.pixels.size() * sizeof(Vec3)) == 0 &&
         std::memcmp(a.pixels.pixels.data(), b.pixels.pixels.data(), a.pixels.pixels.size() * sizeof(Rgb8)) ==
             0;
}

inline bool same_bits(const Hit& a, const Hit& b) {
  return as_bits(a.t) == as_bits(b.t) && as_bits(a.u) == as_bits(b.u) && as_bits(a.v) == as_bits(b.v) &&
         a.triangle == b.triangle;
}

}  // namespace vitral::test
