// What stands out from a wall: surrounds, balconies, railings, balustrades, awnings.
#include <algorithm>
#include <cmath>

#include "parts.h"

namespace plaza {

void surround(Mesh& mesh, const Frame& f, const Hole& h, Surround kind) {
  if (is_coarse(mesh.detail)) return;
  const double jamb = 0.17, out = 0.06, lintel = 0.24;
  const bool to_floor = kind == Surround::plain && h.y0 < 0.02;
  const double low = h.y0;
  box(mesh, Surface::stone, f, {h.x0 - jamb, low, 0}, {h.x0, h.y1, out}, kLeft | kRight | kFront);
  box(mesh, Surface::stone, f, {h.x1, low, 0}, {h.x1 + jamb, h.y1, out}, kLeft | kRight | kFront);
  box(mesh, Surface::stone, f, {h.x0 - jamb, h.y1, 0}, {h.x1 + jamb, h.y1 + lintel, out}, kOnWall);
  if (!to_floor) {
    box(mesh, Surface::stone, f, {h.x0 - jamb - 0.06, low - 0.12, 0}, {h.x1 + jamb + 0.06, low, 0.15},
        kOnWall);
  }
  if (kind == Surround::crowned) {
    const double y = h.y1 + lintel;
    moulding(
        mesh, Surface::stone, f,
        {{0, y + 0.02}, {0.09, y + 0.02}, {0.11, y + 0.08}, {0.2, y + 0.13}, {0.22, y + 0.19}, {0, y + 0.23}},
        h.x0 - jamb - 0.1, h.x1 + jamb + 0.1);
  }
}

void railing(Mesh& mesh, const Frame& f, double x0, double x1, double spacing, double height) {
  box(mesh, Surface::iron, f, {x0, height - 0.05, -0.03}, {x1, height, 0.03});
  box(mesh, Surface::iron, f, {x0, 0.08, -0.015}, {x1, 0.11, 0.015});
  box(mesh, Surface::iron, f, {x0, height - 0.2, -0.015}, {x1, height - 0.175, 0.015});
  const int bars = std::max(1, static_cast<int>(std::lround((x1 - x0) / spacing)));
  for (int i = 0; i <= bars; ++i) {
    const double x = x0 + 0.012 + (x1 - x0 - 0.024) * i / bars;
    box(mesh, Surface::iron, f, {x - 0.012, 0, -0.012}, {x + 0.012, height - 0.05, 0.012},
        kLeft | kRight | kFront | kBack);
  }
}

void iron_balcony(Mesh& mesh, const Frame& f, double x0, double x1, double y, Finish finish) {
  const double out = 0.62, thick = 0.14;
  if (is_coarse(mesh.detail)) {
    if (finish == Finish::fine) box(mesh, Surface::stone, f, {x0, y - thick, 0}, {x1, y, out}, kOnWall);
    return;
  }
  moulding(mesh, Surface::stone, f,
           {{0, y - thick - 0.08},
            {0.38, y - thick - 0.08},
            {0.46, y - thick},
            {out, y - thick + 0.03},
            {out, y},
            {0, y}},
           x0, x1);
  if (finish == Finish::plain) return;
  // Two consoles: scrolls seen from the side.
  for (const double x : {x0 + 0.15, x1 - 0.33}) {
    const Frame side{point(f, {x, y - thick - 0.08, 0}), f.z, f.y, f.x * -1};
    extrude(mesh, Surface::stone, side, {{0.0, -0.36}, {0.10, -0.33}, {0.24, -0.18}, {0.36, 0.0}, {0.0, 0.0}},
            -0.18, 0);
  }
  const double spacing = mesh.detail.level < 0.5 ? 0.3 : 0.115;
  railing(mesh, moved(f, {0, y, out - 0.06}), x0 + 0.05, x1 - 0.05, spacing, 1.02);
  const Frame left = turned(moved(f, {x0 + 0.05, y, 0}), -90),
              right = turned(moved(f, {x1 - 0.05, y, 0}), 90);
  railing(mesh, left, 0.02, out - 0.1, spacing, 1.02);
  railing(mesh, right, -out + 0.1, -0.02, spacing, 1.02);
}

void balustrade(Mesh& mesh, const Frame& f, double x0, double x1) {
  const double height = 1.0;
  box(mesh, Surface::stone, f, {x0, 0, -0.16}, {x1, 0.16, 0.16}, kOnGround);
  box(mesh, Surface::stone, f, {x0, height - 0.16, -0.18}, {x1, height, 0.18});
  const int posts = std::max(1, static_cast<int>(std::lround((x1 - x0) / 3.3)));
  const double span = (x1 - x0) / posts;
  for (int p = 0; p <= posts; ++p) {
    const double x = std::clamp(x0 + p * span, x0 + 0.22, x1 - 0.22);
    box(mesh, Surface::stone, f, {x - 0.22, 0, -0.22}, {x + 0.22, height + 0.06, 0.22}, kOnGround);
  }
  if (is_coarse(mesh.detail)) return;
  const std::vector<Vec2d> profile{{0.085, 0.16}, {0.085, 0.21}, {0.045, 0.26}, {0.10, 0.40},
                                   {0.055, 0.60}, {0.04, 0.72},  {0.085, 0.78}, {0.085, 0.84}};
  const int sides = divisions(mesh.detail, 6, 4);
  for (int p = 0; p < posts; ++p) {
    const int count = static_cast<int>((span - 0.5) / 0.3);
    for (int i = 0; i < count; ++i) {
      const double x = x0 + p * span + 0.25 + (span - 0.5) * (i + 0.5) / count;
      lathe(mesh, Surface::stone, moved(f, {x, 0, 0}), profile, sides);
    }
  }
}

void shop_awning(Mesh& mesh, const Frame& f, double x0, double x1, double y) {
  const double out = 1.5, drop = 0.75;
  const auto at = [&](double x, double z, double h) { return point(f, {x, h, z}); };
  const double u = (x1 - x0) / tile_size(Surface::awning);
  const Vec3d up = normalize(direction(f, {0, out, drop}));
  quad_uv(mesh, Surface::awning,
          {at(x0, out, y - drop), at(x1, out, y - drop), at(x1, 0.03, y), at(x0, 0.03, y)},
          {Vec2d{0, 0}, {u, 0}, {u, 1}, {0, 1}}, up);
  // The valance: scallops of cloth.
  if (is_coarse(mesh.detail)) return;
  const int scallops = std::max(2, static_cast<int>((x1 - x0) / 0.4));
  for (int i = 0; i < scallops; ++i) {
    const double a = x0 + (x1 - x0) * i / scallops, b = x0 + (x1 - x0) * (i + 1) / scallops;
    quad_uv(mesh, Surface::awning,
            {at(a + 0.03, out, y - drop - 0.25), at(b - 0.03, out, y - drop - 0.25), at(b, out, y - drop),
             at(a, out, y - drop)},
            {Vec2d{u * i / scallops, 0},
             {u * (i + 1) / scallops, 0},
             {u * (i + 1) / scallops, 0.2},
             {u * i / scallops, 0.2}},
            f.z);
  }
  for (const double x : {x0 + 0.05, x1 - 0.05}) {
    bar(mesh, Surface::iron, f, {x, y - drop - 0.1, 0.03}, {x, y - drop, out - 0.03}, 0.015);
  }
}

}  // namespace plaza
