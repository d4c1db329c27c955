// Calcada portuguesa: small hand-cut stones of white limestone and black basalt. A stone takes the
// colour that the drawing has at its centre, so the pattern's edges follow the joints.
#include <algorithm>
#include <cmath>

#include "geometry.h"
#include "picture.h"
#include "random.h"
#include "textures.h"

namespace plaza {
namespace {

constexpr Color kLimestone{0.845, 0.81, 0.735};
constexpr Color kBasalt{0.335, 0.335, 0.345};
constexpr Color kJoint{0.52, 0.49, 0.44};

using Drawing = std::function<double(double u, double v)>;  // 0 is white, 1 is black

Color mosaic(double u, double v, int cells, uint32_t seed, const Drawing& drawing) {
  const Stone s = stone_at(u, v, cells, 0.55, seed);
  const bool black = drawing(wrapped(s.u), wrapped(s.v)) > 0.5;
  const double own = unit(hash(s.id, 3)) - 0.5, warm = unit(hash(s.id, 4)) - 0.5;
  Color c = scaled(black ? kBasalt : kLimestone, 1 + own * (black ? 0.25 : 0.13));
  c.r += 0.025 * warm;
  c.b -= 0.03 * warm;
  // Wear: broad paler and darker patches, and dust in the joints.
  const double wear = fractal(u, v, 3, 4, seed + 50) - 0.5;
  c = scaled(c, 1 + 0.16 * wear);
  const Color joint = mix(kJoint, c, black ? 0.5 : 0.35);
  return mix(joint, c, smooth_step(0.05, 0.2, s.border));
}

// The "wide sea" of Rossio: bands that swing left and right.
double wide_sea(double u, double v) {
  const double y = v * 4 + 0.36 * std::sin(u * 2 * 2 * kPi);
  return wrapped(y) < 0.43 ? 1.0 : 0.0;
}

// A running lozenge between two black lines.
double frieze(double u, double v) {
  if (v < 0.09 || v > 0.91 || (v > 0.16 && v < 0.2) || (v > 0.8 && v < 0.84)) return 1;
  const double x = std::fabs(wrapped(u * 3) - 0.5), y = std::fabs(v - 0.5);
  const double lozenge = x / 0.42 + y / 0.27;
  if (lozenge < 0.42) return 1;
  return lozenge < 1 && lozenge > 0.7 ? 1 : 0;
}

// A compass rose of sixteen points in a ring of waves; the monument stands on its middle.
double compass(double u, double v) {
  const double x = 2 * u - 1, y = 2 * v - 1;
  const double r = std::sqrt(x * x + y * y), angle = std::atan2(x, y) / (2 * kPi) + 1;
  if (r > 0.985) return 0;
  if (r > 0.94) return 1;
  if (r > 0.90) return 0;
  if (r > 0.74) {
    const double middle = 0.82 + 0.045 * std::sin(angle * 24 * 2 * kPi);
    return std::fabs(r - middle) < 0.028 ? 1 : 0;
  }
  if (r > 0.715) return 1;
  // Points: each a narrow kite, half of it black. The longer lie over the shorter.
  const auto kite = [&](int points, double offset, double length, double width) {
    const double a = wrapped(angle * points + offset + 0.5) - 0.5;
    const double across = std::fabs(a) / width, reach = r / length;
    if (across + reach >= 1) return -1;
    return a > 0 ? 1 : 0;
  };
  for (const int value : {kite(4, 0, 0.70, 0.62), kite(4, 0.5, 0.60, 0.55), kite(8, 0.5, 0.47, 0.6)}) {
    if (value >= 0) return value;
  }
  return std::fabs(r - 0.50) < 0.014 || std::fabs(r - 0.57) < 0.008 ? 1 : 0;
}

// Granite setts of the roadway, in rows.
Color setts(double u, double v) {
  const Block b = block_at(u, v, 18, 26, 77);
  const double tone = 0.55 + 0.10 * (unit(b.id) - 0.5);
  const double warm = 0.02 * (unit(hash(b.id, 9)) - 0.5);
  const double grain = 0.06 * (fractal(u, v, 64, 3, 5) - 0.5) + 0.12 * (fractal(u, v, 3, 4, 6) - 0.5);
  const Color face{tone + grain + 0.025 + warm, tone + grain + 0.005, tone + grain - 0.025 - warm};
  return mix({0.40, 0.38, 0.35}, face, block_face(b, 0.16, 1.2));
}

}  // namespace

void paint_ground_textures(const TextureJob& job) {
  const int large = 1024 / job.divisor, small = 512 / job.divisor;
  paint(job.folder / "calcada_wave.png", large, Alpha::none,
        [](double u, double v) { return mosaic(u, v, 80, 11, wide_sea); });
  paint(job.folder / "calcada_plain.png", small, Alpha::none,
        [](double u, double v) { return mosaic(u, v, 40, 12, [](double, double) { return 0.0; }); });
  paint(job.folder / "calcada_frieze.png", small, Alpha::none,
        [](double u, double v) { return mosaic(u, v, 32, 13, frieze); });
  paint(job.folder / "rosette.png", large, Alpha::none,
        [](double u, double v) { return mosaic(u, v, 200, 14, compass); });
  paint(job.folder / "setts.png", small, Alpha::none, setts);
}

}  // namespace plaza
