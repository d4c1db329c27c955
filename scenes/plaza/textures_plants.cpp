// Wood, bark, cloth, and sprigs of leaves with their cut-out.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "geometry.h"
#include "picture.h"
#include "random.h"
#include "textures.h"

namespace plaza {
namespace {

// Fibres along v.
double fibres(double u, double v, uint32_t seed) {
  const double bend = 0.02 * noise(u, v, 4, seed + 9);
  return 0.6 * noise(wrapped(u + bend), v * 0.06, 128, seed) +
         0.4 * noise(wrapped(u + bend), v, 16, seed + 1);
}

// A panelled door leaf of bottle green paint: two tall panels over a square one.
Color door(double u, double v) {
  const Color green{0.17, 0.30, 0.24};
  const double x = wrapped(u * 2), y = v;
  const auto inside = [&](double low, double high, double inset) {
    return x > 0.16 + inset && x < 0.84 - inset && y > low + inset * 0.5 && y < high - inset * 0.5;
  };
  double shade = 1;
  for (const auto& [low, high] : {std::array{0.06, 0.30}, std::array{0.36, 0.94}}) {
    if (inside(low, high, 0)) shade = 0.62;
    if (inside(low, high, 0.04)) shade = 1.22;
    if (inside(low, high, 0.07)) shade = 1.06;
  }
  if (x < 0.02 || x > 0.98) shade = 0.4;
  return scaled(green, shade * (0.92 + 0.16 * fibres(u, v, 81)));
}

Color boards(double u, double v) {
  const double x = wrapped(u) * 6;
  const uint32_t id = hash(static_cast<uint32_t>(x), 0, 91);
  const Color c = mix({0.50, 0.35, 0.22}, {0.66, 0.48, 0.31},
                      0.6 * unit(id) + 0.4 * fibres(u, wrapped(v + unit(id)), 92));
  return mix({0.22, 0.15, 0.10}, c, smooth_step(0.0, 0.06, std::min(wrapped(x), 1 - wrapped(x))));
}

Color bark(double u, double v) {
  const double plates = std::fabs(fractal(wrapped(u + 0.04 * noise(u, v, 8, 95)), v * 0.5, 10, 4, 96) - 0.5);
  const Color c = mix({0.25, 0.20, 0.16}, {0.50, 0.44, 0.37}, smooth_step(0.0, 0.16, plates));
  return scaled(c, 0.9 + 0.2 * noise(u, v, 64, 97));
}

Color awning(double u, double v) {
  const bool red = wrapped(u * 4) < 0.5;
  const Color c = red ? Color{0.68, 0.20, 0.17} : Color{0.90, 0.87, 0.79};
  return scaled(c, 0.93 + 0.14 * fractal(u, v, 4, 5, 98));
}

// One leaf or petal of a sprig: a pointed oval about its middle, in the unit square.
struct Leaf {
  double x, y, cosine, sine, length, width, tone;
};

std::vector<Leaf> sprig(int count, double length, double slenderness, uint32_t seed) {
  std::vector<Leaf> leaves;
  Random random{seed, 0};
  for (int k = 0; k < count; ++k) {
    const double around = 2 * kPi * (k * 0.618034), away = 0.40 * std::sqrt((k + 0.5) / count);
    const double heading = around + between(random, -0.7, 0.7);
    leaves.push_back({0.5 + away * std::cos(around), 0.5 + away * std::sin(around), std::cos(heading),
                      std::sin(heading), length * between(random, 0.8, 1.15), slenderness, uniform(random)});
  }
  return leaves;
}

// The topmost leaf at a point; later leaves lie over earlier ones.
Color foliage(const std::vector<Leaf>& leaves, const Color& dark, const Color& light, double u, double v) {
  Color c = mix(dark, light, 0.5);
  c.a = 0;
  for (const Leaf& leaf : leaves) {
    const double dx = u - leaf.x, dy = v - leaf.y;
    const double along = (dx * leaf.cosine + dy * leaf.sine) / leaf.length;
    const double across = std::fabs(dy * leaf.cosine - dx * leaf.sine) / (leaf.length * leaf.width);
    const double edge = 1 - along * along - across / (1 + 0.35 * along);
    if (std::fabs(along) >= 1 || edge <= 0) continue;
    const double rib = smooth_step(0.0, 0.12, across);
    const double vein = 0.06 * std::cos((along * 7 + across * 2) * 2 * kPi);
    c = mix(dark, light, std::clamp(0.2 + 0.7 * leaf.tone + vein, 0.0, 1.0));
    c = scaled(c, (1.12 - 0.12 * rib) * (0.85 + 0.15 * smooth_step(0.0, 0.3, edge)));
    c.a = 1;
  }
  return c;
}

}  // namespace

void paint_wood_textures(const TextureJob& job) {
  const int side = 512 / job.divisor;
  paint(job.folder / "door.png", side, Alpha::none, door);
  paint(job.folder / "boards.png", side, Alpha::none, boards);
  paint(job.folder / "bark.png", side, Alpha::none, bark);
  paint(job.folder / "awning.png", side, Alpha::none, awning);
}

void paint_leaf_textures(const TextureJob& job) {
  const int side = 512 / job.divisor;
  const std::vector<Leaf> leaves = sprig(26, 0.125, 0.42, 7), petals = sprig(40, 0.085, 0.62, 8);
  paint(job.folder / "leaves.png", side, Alpha::straight, [&](double u, double v) {
    return foliage(leaves, {0.24, 0.36, 0.13}, {0.50, 0.60, 0.25}, u, v);
  });
  paint(job.folder / "blossom.png", side, Alpha::straight, [&](double u, double v) {
    return foliage(petals, {0.50, 0.41, 0.62}, {0.74, 0.66, 0.84}, u, v);
  });
}

}  // namespace plaza
