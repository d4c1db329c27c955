#include "picture.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "random.h"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb_image_write.h>

namespace plaza {

Color mix(const Color& a, const Color& b, double t) {
  return {a.r + (b.r - a.r) * t, a.g + (b.g - a.g) * t, a.b + (b.b - a.b) * t, a.a + (b.a - a.a) * t};
}
Color scaled(const Color& c, double s) {
  return {c.r * s, c.g * s, c.b * s, c.a};
}
double smooth_step(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}
double wrapped(double x) {
  return x - std::floor(x);
}

namespace {

uint32_t modulo(int x, int period) {
  const int r = x % period;
  return static_cast<uint32_t>(r < 0 ? r + period : r);
}

}  // namespace

double noise(double u, double v, int period, uint32_t seed) {
  const double x = u * period, y = v * period;
  const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
  const double fx = x - i, fy = y - j;
  const double sx = fx * fx * (3 - 2 * fx), sy = fy * fy * (3 - 2 * fy);
  const auto lattice = [&](int a, int b) {
    return unit(hash((modulo(a, period) | modulo(b, period) << 12) + seed * 0x9e3779b1u));
  };
  const double low = lattice(i, j) + (lattice(i + 1, j) - lattice(i, j)) * sx;
  const double high = lattice(i, j + 1) + (lattice(i + 1, j + 1) - lattice(i, j + 1)) * sx;
  return low + (high - low) * sy;
}

double fractal(double u, double v, int period, int octaves, uint32_t seed) {
  double sum = 0, strength = 0.5, total = 0;
  for (int k = 0; k < octaves; ++k) {
    sum += strength * noise(u, v, period << k, seed + static_cast<uint32_t>(k));
    total += strength;
    strength *= 0.5;
  }
  return sum / total;
}

Stone stone_at(double u, double v, int cells, double jitter, uint32_t seed) {
  const int i = static_cast<int>(std::floor(u * cells)), j = static_cast<int>(std::floor(v * cells));
  double nearest = 1e9, second = 1e9;
  Stone stone;
  for (int b = j - 1; b <= j + 1; ++b) {
    for (int a = i - 1; a <= i + 1; ++a) {
      const uint32_t id = hash(modulo(a, cells), modulo(b, cells), seed);
      const double x = a + 0.5 + jitter * (unit(hash(id, 1)) - 0.5);
      const double y = b + 0.5 + jitter * (unit(hash(id, 2)) - 0.5);
      const double dx = u * cells - x, dy = v * cells - y;
      // Squarish stones: between the round and the square distance.
      const double d = 0.5 * std::sqrt(dx * dx + dy * dy) + 0.5 * std::max(std::fabs(dx), std::fabs(dy));
      if (d < nearest) {
        second = nearest;
        nearest = d;
        stone.u = x / cells;
        stone.v = y / cells;
        stone.id = id;
      } else {
        second = std::min(second, d);
      }
    }
  }
  stone.border = second - nearest;
  return stone;
}

Block block_at(double u, double v, int columns, int rows, uint32_t seed) {
  const double y = wrapped(v) * rows;
  const int row = static_cast<int>(y);
  const double x = wrapped(wrapped(u) + (row % 2) * 0.5 / columns) * columns;
  const int column = static_cast<int>(x);
  return {x - column, y - row, hash(static_cast<uint32_t>(column), static_cast<uint32_t>(row), seed)};
}

double block_face(const Block& block, double joint, double aspect) {
  const double x = std::min(block.x, 1 - block.x) * aspect, y = std::min(block.y, 1 - block.y);
  return smooth_step(joint * 0.5, joint, std::min(x, y));
}

void paint(const std::filesystem::path& file, int side, Alpha alpha,
           const std::function<Color(double u, double v)>& color) {
  const int channels = alpha == Alpha::straight ? 4 : 3;
  std::vector<uint8_t> bytes;
  bytes.reserve(static_cast<size_t>(side) * static_cast<size_t>(side * channels));
  const auto byte = [](double x) { return static_cast<uint8_t>(std::lround(std::clamp(x, 0.0, 1.0) * 255)); };
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const Color c = color((x + 0.5) / side, 1 - (y + 0.5) / side);
      bytes.push_back(byte(c.r));
      bytes.push_back(byte(c.g));
      bytes.push_back(byte(c.b));
      if (channels == 4) bytes.push_back(byte(c.a));
    }
  }
  if (!stbi_write_png(file.string().c_str(), side, side, channels, bytes.data(), side * channels)) {
    throw std::runtime_error(file.string() + ": cannot be written");
  }
}

}  // namespace plaza
