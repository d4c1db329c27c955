// Coverage by the book, for points on the lattice of 1/256 pixel: exact for triangles of every size, as the
// products are made in 128 bits, and independent of the rasterizer's own edge functions.
#pragma once
#include "raster_support.h"

#include <array>
#include <cmath>
#include <cstdint>

namespace vitral::raster_test {

// In 1/256 pixel.
struct Point {
  int64_t x, y;
};
inline bool operator==(const Point& a, const Point& b) {
  return a.x == b.x && a.y == b.y;
}
using Outline = std::array<Point, 3>;
__extension__ typedef __int128 Wide;

inline Point center_of(int x, int y) {
  return {256 * int64_t{x} + 128, 256 * int64_t{y} + 128};
}

inline int sign(Wide v) {
  return v > 0 ? 1 : v < 0 ? -1 : 0;
}

inline Wide turn(const Point& a, const Point& b, const Point& c) {
  return static_cast<Wide>(b.x - a.x) * (c.y - a.y) - static_cast<Wide>(b.y - a.y) * (c.x - a.x);
}

// On which side of the line a-b the point is when it is moved a little to the right and much less
// down. No point is on a line then, and this move puts a point on a left or a top edge inside.
inline int side(const Point& a, const Point& b, const Point& p) {
  if (const int s = sign(turn(a, b, p))) return s;
  if (const int s = sign(-static_cast<Wide>(b.y - a.y))) return s;
  return sign(static_cast<Wide>(b.x - a.x));
}

// Whether the triangle covers the point, the centre of a pixel.
inline bool is_inside(const Outline& t, const Point& p) {
  if (turn(t[0], t[1], t[2]) == 0) return false;
  const int s = side(t[0], t[1], p);
  return s == side(t[1], t[2], p) && s == side(t[2], t[0], p);
}

// Up to here a float holds any number of 1/256 pixels; beyond it lies what the guard band cuts off.
inline constexpr int64_t kExactUnits = int64_t{kGuardBand} * 256;

// A place that pixel_camera() sees at the point once it is snapped: up to half of 1/256 pixel before it, or
// less than that behind it.
inline Vec3 position(const Point& p, Random& random) {
  const auto has_fraction = [](int64_t v) { return v < 1 << 14 && v > -(1 << 14); };  // 9 bits are left
  const bool shifted = has_fraction(p.x) && has_fraction(p.y);
  const auto shift = [&] {
    if (!shifted) return 0.0f;
    const int most = random.below(4) == 0 ? 255 : between(random, -256, 255);
    return static_cast<float>(random.below(8) == 0 ? -256 : most) / 512;
  };
  const float dx = shift(), dy = shift();
  return at_pixel((static_cast<float>(p.x) + dx) / 256.0f, (static_cast<float>(p.y) + dy) / 256.0f, 1);
}

inline bool leaves_guard_band(const Point& p) {
  return p.x > kExactUnits || p.x < -kExactUnits || p.y > kExactUnits || p.y < -kExactUnits;
}

enum class Where { outside, inside, unsure };

// Where an edge leaves the guard band it is cut there and the cut snapped, so that within the frame it is off
// by up to 1/256 pixel. Only within twice of that anything is unsure, and which of the triangles at the edge
// has the pixel; not that one has.
inline Where where(const Outline& t, const Point& p) {
  const int orientation = sign(turn(t[0], t[1], t[2]));
  bool unsure = false;
  for (size_t k = 0; k < 3; ++k) {
    const Point &a = t[k], &b = t[(k + 1) % 3];
    const bool is_cut = leaves_guard_band(a) || leaves_guard_band(b);
    const double length = std::hypot(static_cast<double>(b.x - a.x), static_cast<double>(b.y - a.y));
    if (is_cut && std::abs(static_cast<double>(turn(a, b, p))) <= 2 * length)
      unsure = true;
    else if (side(a, b, p) != orientation)
      return Where::outside;
  }
  return unsure ? Where::unsure : Where::inside;
}

}  // namespace vitral::raster_test
