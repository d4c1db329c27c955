// A two-axle tram of the old kind, nine metres long, on rails that run along x.
#include <cmath>

#include "parts.h"

namespace plaza {
namespace {

constexpr double kHalfLength = 4.3, kHalfWidth = 1.18, kFloor = 0.72, kBelt = 1.62, kEave = 2.72;

void side_wall(Mesh& mesh, const Frame& f) {
  box(mesh, Surface::tram_yellow, f, {-kHalfLength, kFloor - 0.2, kHalfWidth - 0.06},
      {kHalfLength, kBelt, kHalfWidth});
  box(mesh, Surface::tram_cream, f, {-kHalfLength, kBelt + 0.004, kHalfWidth - 0.05},
      {kHalfLength, kBelt + 0.09, kHalfWidth + 0.02});
  box(mesh, Surface::tram_cream, f, {-kHalfLength, kEave - 0.2, kHalfWidth - 0.06},
      {kHalfLength, kEave, kHalfWidth});
  for (const double y : {0.82, 1.42}) {
    box(mesh, Surface::tram_cream, f, {-kHalfLength, y, kHalfWidth - 0.03},
        {kHalfLength, y + 0.035, kHalfWidth + 0.006}, kFront | kTop | kBottom);
  }
  box(mesh, Surface::tyre, f, {-2.1, 0.16, kHalfWidth - 0.24}, {2.1, 0.5, kHalfWidth - 0.14});
  const int windows = 7;
  const double width = 2 * kHalfLength / windows;
  for (int i = 0; i < windows; ++i) {
    const double x0 = -kHalfLength + i * width, x1 = x0 + width, z = kHalfWidth - 0.03;
    box(mesh, Surface::tram_yellow, f, {x0, kBelt + 0.09, kHalfWidth - 0.055},
        {x0 + 0.09, kEave - 0.2, kHalfWidth - 0.005}, kLeft | kRight | kFront | kBack);
    box(mesh, Surface::tram_yellow, f, {x1 - 0.09, kBelt + 0.09, kHalfWidth - 0.055},
        {x1, kEave - 0.2, kHalfWidth - 0.005}, kLeft | kRight | kFront | kBack);
    quad(mesh, Surface::glass, point(f, {x0 + 0.09, kBelt + 0.09, z}), point(f, {x1 - 0.09, kBelt + 0.09, z}),
         point(f, {x1 - 0.09, kEave - 0.2, z}), point(f, {x0 + 0.09, kEave - 0.2, z}));
  }
}

// A 2 and an 8 out of seven strokes each.
void line_number(Mesh& mesh, const Frame& f) {
  const struct {
    double x;
    unsigned
        strokes;  // from the least bit: top, upper left, upper right, middle, lower left, lower right, bottom
  } digits[] = {{-0.085, 0b1011101}, {0.085, 0b1111111}};
  const Vec2d low[] = {{-0.05, 0.14}, {-0.05, 0.09}, {0.03, 0.09},  {-0.05, 0.08},
                       {-0.05, 0.02}, {0.03, 0.02},  {-0.05, 0.005}};
  const Vec2d high[] = {{0.05, 0.16},  {-0.03, 0.14}, {0.05, 0.14}, {0.05, 0.095},
                        {-0.03, 0.08}, {0.05, 0.08},  {0.05, 0.025}};
  for (const auto& digit : digits) {
    for (unsigned s = 0; s < 7; ++s) {
      if (!(digit.strokes >> s & 1)) continue;
      box(mesh, Surface::globe, f, {digit.x + low[s].x, low[s].y, 0}, {digit.x + high[s].x, high[s].y, 0.008},
          kOnWall);
    }
  }
}

// z of the frame points out of the front.
void front(Mesh& mesh, const Frame& f) {
  const double w = kHalfWidth - 0.06, z = 0;
  box(mesh, Surface::tram_yellow, f, {-w, kFloor - 0.25, z - 0.06}, {w, kBelt - 0.05, z + 0.06});
  box(mesh, Surface::tram_cream, f, {-w, kEave - 0.22, z - 0.06}, {w, kEave, z + 0.02});
  for (int i = 0; i < 4; ++i) {
    const double x = -w + i * (2 * w - 0.1) / 3;
    box(mesh, Surface::tram_yellow, f, {x, kBelt - 0.05, z - 0.04}, {x + 0.1, kEave - 0.22, z + 0.02},
        kLeft | kRight | kFront | kBack);
  }
  quad(mesh, Surface::glass, point(f, {-w, kBelt - 0.05, z - 0.01}), point(f, {w, kBelt - 0.05, z - 0.01}),
       point(f, {w, kEave - 0.22, z - 0.01}), point(f, {-w, kEave - 0.22, z - 0.01}));
  ellipsoid(mesh, Surface::globe, moved(f, {0, 1.2, z + 0.07}), {0.15, 0.15, 0.07},
            divisions(mesh.detail, 12, 6));
  box(mesh, Surface::paint_white, f, {-0.35, kEave + 0.02, z - 0.1}, {0.35, kEave + 0.3, z + 0.02});
  box(mesh, Surface::hair, f, {-0.29, kEave + 0.07, z}, {0.29, kEave + 0.25, z + 0.03}, kOnWall);
  line_number(mesh, moved(f, {0, kEave + 0.07, z + 0.03}));
  box(mesh, Surface::iron, f, {-0.8, 0.25, z - 0.1}, {0.8, 0.4, z + 0.2});
}

}  // namespace

void tram(Mesh& mesh, const Frame& f) {
  begin_group(mesh, "tram");
  side_wall(mesh, f);
  side_wall(mesh, turned(f, 180));
  front(mesh, moved(turned(f, 90), {0, 0, kHalfLength}));
  front(mesh, moved(turned(f, -90), {0, 0, kHalfLength}));
  box(mesh, Surface::bench, f, {-kHalfLength, kFloor - 0.1, -kHalfWidth + 0.06},
      {kHalfLength, kFloor, kHalfWidth - 0.06}, kTop | kBottom);
  for (int i = 0; i < (is_bare(mesh.detail) ? 0 : 6); ++i) {
    const double x = -3.2 + i * 1.2;
    for (const double z : {-0.68, 0.68}) {
      box(mesh, Surface::bench, f, {x, kFloor, z - 0.4}, {x + 0.42, kFloor + 0.45, z + 0.4}, kOnGround);
      box(mesh, Surface::bench, f, {x - 0.06, kFloor, z - 0.4}, {x - 0.005, kFloor + 0.95, z + 0.4},
          kOnGround);
    }
  }
  // The roof: a shallow barrel, a lantern deck on it, and the trolley pole.
  const auto barrel = [&](double half_length, double half_width, double y, double rise, Surface surface) {
    const int steps = divisions(mesh.detail, 12, 5);
    surface_grid(mesh, surface, 1, steps,
                 [&](double u, double v) {
                   return point(f, {half_length * (2 * u - 1), y + rise * std::sin(v * kPi),
                                    half_width * std::cos(v * kPi)});
                 },
                 Ends::open, {1, 1});
    for (const double x : {-half_length, half_length}) {
      for (int i = 0; i < steps; ++i) {
        const double a = kPi * i / steps, b = kPi * (i + 1) / steps;
        const Vec3d p = point(f, {x, y + rise * std::sin(a), half_width * std::cos(a)});
        const Vec3d q = point(f, {x, y + rise * std::sin(b), half_width * std::cos(b)}),
                    c = point(f, {x, y, 0});
        x > 0 ? triangle(mesh, surface, c, q, p) : triangle(mesh, surface, c, p, q);
      }
    }
  };
  box(mesh, Surface::tram_cream, f, {-kHalfLength - 0.05, kEave - 0.02, -kHalfWidth - 0.06},
      {kHalfLength + 0.05, kEave + 0.04, kHalfWidth + 0.06});
  barrel(kHalfLength, kHalfWidth, kEave + 0.04, 0.22, Surface::tram_cream);
  box(mesh, Surface::tram_yellow, f, {-3.2, kEave + 0.1, -0.62}, {3.2, kEave + 0.36, 0.62}, kOnGround);
  for (int i = 0; i < 8; ++i) {
    for (const double side : {0.0, 180.0}) {
      const double x = -3.1 + i * 0.78;
      box(mesh, Surface::hair, turned(f, side), {x, kEave + 0.27, 0.6}, {x + 0.6, kEave + 0.34, 0.625},
          kOnWall);
    }
  }
  barrel(3.3, 0.68, kEave + 0.36, 0.14, Surface::tram_cream);
  bar(mesh, Surface::iron, f, {0.2, kEave + 0.45, 0}, {-3.9, 5.3, 0}, 0.03, 5);
  // Underframe, wheels and lifeguards.
  box(mesh, Surface::tyre, f, {-2.2, 0.3, -0.8}, {2.2, kFloor - 0.1, 0.8});
  for (const double x : {-1.45, 1.45}) {
    for (const double z : {-0.5, 0.5}) {
      lathe(mesh, Surface::iron, leaned(moved(f, {x, 0.38, z - 0.05}), 90),
            {{0, -0.02}, {0.36, -0.02}, {0.36, 0.1}, {0, 0.1}}, divisions(mesh.detail, 18, 8));
    }
  }
}

}  // namespace plaza
