// Stone, plaster, azulejo and roof tiles.
#include <algorithm>
#include <cmath>
#include <string>

#include "geometry.h"
#include "picture.h"
#include "random.h"
#include "textures.h"

namespace plaza {
namespace {

constexpr Color kLioz{0.81, 0.77, 0.69};

// Lioz, the pale limestone of Lisbon: clouds, faint veins and a grain.
Color limestone(double u, double v) {
  const double cloud = fractal(u, v, 3, 5, 21) - 0.5;
  const double vein = std::fabs(fractal(u, v, 4, 4, 22) - 0.5);
  const double grain = fractal(u, v, 64, 2, 23) - 0.5;
  Color c = scaled(kLioz, 1 + 0.22 * cloud + 0.06 * grain);
  return mix({0.66, 0.58, 0.47}, c, 0.75 + 0.25 * smooth_step(0.0, 0.05, vein));
}

Color ashlar(double u, double v) {
  const Block b = block_at(u, v, 4, 8, 31);
  const double shift = unit(hash(b.id, 5));
  Color c = limestone(wrapped(u + shift), wrapped(v + 0.37 * shift));
  c = scaled(c, 0.97 + 0.12 * (unit(b.id) - 0.5));
  // Rain leaves the lower edge of a block darker.
  c = scaled(c, 0.94 + 0.06 * smooth_step(0.0, 0.45, b.y));
  return mix({0.46, 0.42, 0.36}, c, block_face(b, 0.045, 2));
}

// Lime plaster: patches of several repaintings, streaks that ran down, a few worn spots.
Color plaster(const Color& paint_color, double u, double v, uint32_t seed) {
  const double patches = fractal(u, v, 3, 5, seed) - 0.5;
  const double streaks =
      noise(u, wrapped(v), 24, seed + 40) * 0.5 + noise(u, wrapped(v * 0.999), 5, seed + 41) * 0.5;
  const double run = smooth_step(0.55, 0.85, noise(u, 0.5, 48, seed + 42)) * fractal(u, v, 4, 3, seed + 43);
  const double grain = fractal(u, v, 96, 2, seed + 44) - 0.5;
  Color c = scaled(paint_color, 1 + 0.20 * patches + 0.05 * (streaks - 0.5) + 0.05 * grain - 0.10 * run);
  const double worn = smooth_step(0.70, 0.78, fractal(u, v, 5, 4, seed + 45));
  return mix(c, {0.80, 0.77, 0.71}, 0.22 * worn);
}

// Blue and white tiles, four motifs a side: a flower in a ring, quarters of another in the corners.
Color azulejo(double u, double v) {
  constexpr int kMotifs = 4;
  const double x = wrapped(u * kMotifs) - 0.5, y = wrapped(v * kMotifs) - 0.5;
  const uint32_t id =
      hash(static_cast<uint32_t>(u * kMotifs * 2), static_cast<uint32_t>(v * kMotifs * 2), 61);
  const Color white{0.80, 0.825, 0.84}, blue{0.30, 0.42, 0.66}, pale{0.62, 0.71, 0.83};
  const auto flower = [](double px, double py, double size, int petals) {
    const double r = std::sqrt(px * px + py * py), a = std::atan2(py, px);
    return r < size * (0.72 + 0.28 * std::cos(petals * a));
  };
  const double r = std::sqrt(x * x + y * y);
  const double cx = 0.5 - std::fabs(x), cy = 0.5 - std::fabs(y), corner = std::sqrt(cx * cx + cy * cy);
  Color c = white;
  if (flower(x, y, 0.27, 8)) c = blue;
  if (flower(x, y, 0.15, 4)) c = pale;
  if (r < 0.04) c = blue;
  if (std::fabs(r - 0.36) < 0.028) c = blue;
  if (flower(cx, cy, 0.22, 4)) c = blue;
  if (corner < 0.085) c = white;
  if (r > 0.40 && corner > 0.24 && std::fabs(std::fabs(x) - std::fabs(y)) > 0.33) c = pale;
  c = scaled(c, 1 + 0.09 * (unit(id) - 0.5) + 0.06 * (fractal(u, v, 4, 4, 62) - 0.5));
  // The joints of the tiles: two by two to a motif.
  const double jx = std::fabs(wrapped(u * kMotifs * 2 + 0.5) - 0.5),
               jy = std::fabs(wrapped(v * kMotifs * 2 + 0.5) - 0.5);
  return mix({0.62, 0.62, 0.60}, c, smooth_step(0.008, 0.028, std::min(jx, jy)));
}

// Clay tiles seen from above: eight courses up the slope, every tile its own shade of burnt red.
Color roof(double u, double v) {
  const int columns = 16, rows = 8;
  const double x = wrapped(u) * columns, y = wrapped(v) * rows;
  const uint32_t id = hash(static_cast<uint32_t>(x), static_cast<uint32_t>(y), 71);
  Color c = mix({0.66, 0.36, 0.24}, {0.80, 0.53, 0.37}, unit(id));
  if (unit(hash(id, 2)) > 0.9) c = scaled(c, 0.82);
  const double lichen = smooth_step(0.58, 0.72, fractal(u, v, 6, 5, 72));
  c = mix(c, {0.56, 0.50, 0.38}, 0.45 * lichen);
  c = scaled(c, 1 + 0.14 * (fractal(u, v, 4, 4, 73) - 0.5));
  return scaled(c, 0.62 + 0.38 * smooth_step(0.0, 0.22, wrapped(y)));
}

}  // namespace

void paint_wall_textures(const TextureJob& job) {
  const int side = 512 / job.divisor;
  paint(job.folder / "stone.png", side, Alpha::none, limestone);
  paint(job.folder / "ashlar.png", side, Alpha::none, ashlar);
  paint(job.folder / "azulejo.png", side, Alpha::none, azulejo);
  paint(job.folder / "roof.png", side, Alpha::none, roof);
  const struct {
    const char* name;
    Color color;
  } plasters[] = {{"ochre", {0.88, 0.69, 0.38}},
                  {"rose", {0.86, 0.60, 0.53}},
                  {"white", {0.88, 0.86, 0.81}},
                  {"green", {0.62, 0.71, 0.59}},
                  {"blue", {0.57, 0.68, 0.79}}};
  uint32_t seed = 100;
  for (const auto& [name, color] : plasters) {
    paint(job.folder / ("plaster_" + std::string(name) + ".png"), side, Alpha::none,
          [&color = color, seed](double u, double v) { return plaster(color, u, v, seed); });
    seed += 100;
  }
}

}  // namespace plaza
