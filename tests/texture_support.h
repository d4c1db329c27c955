// Textured planes to the horizon, and what a camera ought to see of them.
#pragma once
#include "math/pinhole.h"
#include "math/srgb.h"
#include "support.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace vitral::test {

// Squares of `square` texels, dark and light in turn; columns x rows texels.
inline Texture checkerboard(int columns, int rows, int square, uint8_t dark = 0, uint8_t light = 255) {
  Texture t{"checkerboard", columns, rows,
            std::vector<uint8_t>(static_cast<size_t>(4 * columns * rows), 255)};
  for (int i = 0; i < columns * rows; ++i) {
    const uint8_t c = (i % columns / square + i / columns / square) % 2 ? light : dark;
    std::fill_n(&t.texels[static_cast<size_t>(4 * i)], 3, c);
  }
  return t;
}

// A floor at height y with the scene's last texture, which repeats `repeats` times a metre.
inline void add_textured_floor(Scene& scene, const Texture& texture, float half, float repeats, float y = 0) {
  Material m;
  m.diffuse = {1, 1, 1};
  m.diffuse_map = static_cast<int>(scene.textures.size());
  scene.textures.push_back(texture);
  const size_t first = scene.mesh.texcoords.size();
  add_quad(scene, add_material(scene, m), {-half, y, half}, {2 * half, 0, 0}, {0, 0, -2 * half});
  for (size_t i = first; i < scene.mesh.texcoords.size(); ++i)
    scene.mesh.texcoords[i].x *= 2 * half * repeats, scene.mesh.texcoords[i].y *= 2 * half * repeats;
}

// A texture's bilinear value at (u, v), red only, linear, in double.
inline double bilinear(const Texture& t, double u, double v) {
  const double x = (u - std::floor(u)) * t.width - 0.5, y = (1 - (v - std::floor(v))) * t.height - 0.5;
  const double fx = x - std::floor(x), fy = y - std::floor(y);
  const auto texel = [&](int dx, int dy) {
    const int i = (static_cast<int>(std::floor(x)) + dx + t.width) % t.width;
    const int j = (static_cast<int>(std::floor(y)) + dy + t.height) % t.height;
    return static_cast<double>(kLinearOfSrgb[t.texels[static_cast<size_t>(4 * (j * t.width + i))]]);
  };
  return (texel(0, 0) * (1 - fx) + texel(1, 0) * fx) * (1 - fy) +
         (texel(0, 1) * (1 - fx) + texel(1, 1) * fx) * fy;
}

// The mean of n x n points of a pixel that looks at add_textured_floor's first floor; NaN where it sees the
// sky.
inline double floor_reference(const Pinhole& c, const Texture& t, float half, float repeats, int x, int y,
                              int n) {
  double sum = 0;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const double a = (x + (i + 0.5) / n) * static_cast<double>(c.step) - static_cast<double>(c.center_x);
      const double b = static_cast<double>(c.center_y) - (y + (j + 0.5) / n) * static_cast<double>(c.step);
      const Vec3d d = to_double(c.forward) + to_double(c.right) * a + to_double(c.up) * b;
      if (d.y >= 0) return std::nan("");
      const Vec3d p = to_double(c.origin) + d * (static_cast<double>(c.origin.y) / -d.y);
      if (std::abs(p.x) > static_cast<double>(half) || std::abs(p.z) > static_cast<double>(half))
        return std::nan("");
      const double r = static_cast<double>(repeats), h = static_cast<double>(half);
      sum += bilinear(t, (p.x + h) * r, (h - p.z) * r);
    }
  }
  return sum / (n * n);
}

// The red of the albedo that a camera sees.
inline std::vector<double> albedo(const Scene& scene, const Camera& camera, Settings settings) {
  settings.effects = kNoEffects;
  settings.aovs = {"albedo"};
  std::vector<double> out;
  const Frame frame = render_scene(scene, camera, settings);
  for (const Vec3& c : frame.aovs.at(0).pixels.pixels) out.push_back(static_cast<double>(c.x));
  return out;
}

}  // namespace vitral::test
