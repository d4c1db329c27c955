// What stands behind the panes: curtains and pictures, wares, a cafe.
#include <algorithm>
#include <cmath>

#include "parts.h"
#include "random.h"

namespace plaza {
namespace {

// A hanging in folds, from a rod at the top of the window.
void curtain(Mesh& mesh, const Frame& f, double x0, double x1, double y0, double y1, double z,
             Surface surface) {
  const int folds = std::max(2, static_cast<int>((x1 - x0) / 0.12));
  surface_grid(
      mesh, surface, divisions(mesh.detail, folds * 4, folds), divisions(mesh.detail, 1, 1),
      [&](double u, double v) {
        return point(f, {x0 + (x1 - x0) * u, y0 + (y1 - y0) * v, z + 0.035 * std::cos(u * folds * 2 * kPi)});
      },
      Ends::open, {1, 1});
}

}  // namespace

void furnish_room(Mesh& mesh, const Frame& f, const Hole& h, uint32_t seed) {
  const double width = h.x1 - h.x0, z = -kReveal - 0.22;
  const Surface cloth = unit(hash(seed, 3)) < 0.72 ? Surface::curtain : Surface::curtain_warm;
  const double kind = unit(hash(seed, 4));
  const double open = 0.16 + 0.22 * unit(hash(seed, 5));
  if (kind < 0.75) {
    curtain(mesh, f, h.x0 + 0.03, h.x0 + open * width, h.y0 + 0.02, h.y1 - 0.05, z, cloth);
    curtain(mesh, f, h.x1 - open * width, h.x1 - 0.03, h.y0 + 0.02, h.y1 - 0.05, z, cloth);
  } else {
    // A roller blind, drawn part of the way.
    const double y = h.y1 - (h.y1 - h.y0) * (0.2 + 0.5 * unit(hash(seed, 6)));
    box(mesh, cloth, f, {h.x0 + 0.04, y, z}, {h.x1 - 0.04, h.y1 - 0.03, z + 0.02}, kFront | kBack | kBottom);
  }
  if (unit(hash(seed, 7)) < 0.5) {
    // A picture on the far wall.
    const double x = h.x0 + width * (0.35 + 0.2 * unit(hash(seed, 8))), y = h.y0 + 1.2;
    box(mesh, Surface::brass, f, {x, y, -kRoom + 0.02}, {x + 0.35, y + 0.5, -kRoom + 0.05}, kOnWall);
    box(mesh, Surface::cloth_blue, f, {x + 0.05, y + 0.05, -kRoom + 0.02},
        {x + 0.30, y + 0.45, -kRoom + 0.06}, kOnWall);
  }
}

// A table with wares behind the pane.
void furnish_shop(Mesh& mesh, const Frame& f, const Hole& h, uint32_t seed) {
  const double z = -kReveal;
  box(mesh, Surface::bench, f, {h.x0 + 0.1, h.y0 + 0.4, z - 0.9}, {h.x1 - 0.1, h.y0 + 0.48, z - 0.12});
  const Surface wares[] = {Surface::cloth_red, Surface::brass, Surface::cloth_blue, Surface::paint_white};
  for (uint32_t i = 0; i < 7; ++i) {
    const double x = h.x0 + 0.3 + (h.x1 - h.x0 - 0.6) * (i + 0.5 * unit(hash(seed, i))) / 7;
    const double size = 0.1 + 0.1 * unit(hash(seed, i, 2));
    ellipsoid(mesh, wares[hash(seed, i, 3) % 4], moved(f, {x, h.y0 + 0.48 + size * 1.3, z - 0.45}),
              {size, size * 1.3, size}, divisions(mesh.detail, 8, 4));
  }
}

namespace {

// A counter, and shelves of bottles before a mirror, along the back wall.
void cafe_bar(Mesh& mesh, const Frame& f, double width, double depth) {
  box(mesh, Surface::bench, f, {1.2, 0.0, -depth + 1.1}, {width - 1.2, 1.05, -depth + 1.6}, kOnGround);
  box(mesh, Surface::marble, f, {1.1, 1.05, -depth + 1.0}, {width - 1.1, 1.10, -depth + 1.7});
  box(mesh, Surface::mirror, f, {1.4, 1.2, -depth + 0.02}, {width - 1.4, 2.9, -depth + 0.05}, kOnWall);
  const Surface glassware[] = {Surface::cloth_red, Surface::paint_green, Surface::brass, Surface::far_warm};
  for (const double y : {1.3, 1.85, 2.4}) {
    box(mesh, Surface::bench, f, {1.4, y - 0.04, -depth + 0.06}, {width - 1.4, y, -depth + 0.3});
    const int bottles = many(mesh.detail, 3.2 * width, 4);
    for (int i = 0; i < std::min(bottles, 80); ++i) {
      const double x = 1.6 + (width - 3.2) * (i + 0.5) / bottles, high = 0.3 + 0.05 * (i % 3);
      lathe(mesh, glassware[hash(static_cast<uint32_t>(i), static_cast<uint32_t>(y * 100)) % 4],
            moved(f, {x, y, -depth + 0.18}),
            {{0.045, 0}, {0.045, high * 0.6}, {0.016, high * 0.75}, {0.016, high}, {0, high}},
            divisions(mesh.detail, 7, 4));
    }
  }
}

}  // namespace

void cafe(Mesh& mesh, const Frame& f, double width, double height, double depth) {
  room(mesh, Surface::interior, Surface::floorboards, f, {0.1, 0, -depth}, {width - 0.1, height, -kReveal},
       kAllSides - kFront);
  if (is_coarse(mesh.detail)) return;
  cafe_bar(mesh, f, width, depth);
  const int around = divisions(mesh.detail, 16, 6);
  const int tables = static_cast<int>(width / 1.7);
  for (int i = 0; i < tables; ++i) {
    const double x = width * (i + 0.5) / tables, z = i % 2 == 0 ? -1.2 : -2.4;
    const Frame at = moved(f, {x, 0, z});
    lathe(mesh, Surface::iron, at, {{0.24, 0}, {0.22, 0.03}, {0.035, 0.08}, {0.035, 0.72}, {0.1, 0.72}},
          around);
    lathe(mesh, Surface::marble, at, {{0, 0.719}, {0.36, 0.72}, {0.37, 0.735}, {0.36, 0.75}, {0, 0.751}},
          around);
    lathe(mesh, Surface::paint_white, moved(at, {0.1, 0.752, 0.12}),
          {{0.03, 0}, {0.05, 0.07}, {0.044, 0.07}, {0.0, 0.02}}, around);
    for (const double side : {-1.0, 1.0})
      chair(mesh, moved(turned(at, side * 90), {0, 0, 0.66}), Surface::bench);
    // A globe over every table.
    ellipsoid(mesh, Surface::globe, moved(at, {0, height - 0.9, 0}), {0.17, 0.17, 0.17}, around);
    bar(mesh, Surface::brass, at, {0, height - 0.74, 0}, {0, height, 0}, 0.012);
  }
  Figure guest;
  guest.skin = Surface::skin;
  guest.hair = Surface::hair;
  guest.cloth = Surface::paint_white;
  guest.left_fore = 70;
  figure(mesh, moved(f, {width * 0.5, 0, -depth + 0.75}), guest);
  guest.cloth = Surface::cloth_red;
  figure(mesh, turned(moved(f, {width * 0.62, 0, -depth + 2.1}), 190), guest);
}

}  // namespace plaza
