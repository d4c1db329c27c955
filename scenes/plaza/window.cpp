// What fills a hole in a wall: casements with muntins and panes, doors, shop fronts, and the dark
// rooms behind them.
#include <algorithm>
#include <cmath>

#include "parts.h"
#include "random.h"

namespace plaza {
namespace {

// A pane is never quite in the plane of its neighbours: each mirrors a slightly other piece of world.
void pane(Mesh& mesh, const Frame& f, double x0, double x1, double y0, double y1, double z, uint32_t id) {
  const double lean = 0.007 * (unit(hash(id, 1)) - 0.5), turn = 0.007 * (unit(hash(id, 2)) - 0.5);
  const auto at = [&](double x, double y) {
    return point(f, {x, y, z + lean * (y - 0.5 * (y0 + y1)) + turn * (x - 0.5 * (x0 + x1))});
  };
  quad(mesh, Surface::glass, at(x0, y0), at(x1, y0), at(x1, y1), at(x0, y1));
}

struct Grid {
  int columns, rows;
  double stile, muntin;  // widths of the outer and the inner bars
};

// One glazed leaf: outer bars, muntins and panes. Bars straddle the panes.
void leaf(Mesh& mesh, const Frame& f, const Hole& h, const Grid& grid, const Joinery& j, double z) {
  const double front = z + 0.03, back = z - 0.03;
  const auto upright = [&](double x0, double x1) {
    box(mesh, j.paint, f, {x0, h.y0, back}, {x1, h.y1, front}, kLeft | kRight | kFront | kBack);
  };
  const double x0 = h.x0 + grid.stile, x1 = h.x1 - grid.stile;
  const double y0 = h.y0 + grid.stile * 1.3, y1 = h.y1 - grid.stile;
  upright(h.x0, x0);
  upright(x1, h.x1);
  box(mesh, j.paint, f, {x0, h.y0, back}, {x1, y0, front}, kTop | kFront | kBack);
  box(mesh, j.paint, f, {x0, y1, back}, {x1, h.y1, front}, kBottom | kFront | kBack);
  const double dx = (x1 - x0) / grid.columns, dy = (y1 - y0) / grid.rows, half = grid.muntin / 2;
  for (int i = 1; i < grid.columns; ++i) {
    box(mesh, j.paint, f, {x0 + i * dx - half, y0, z - 0.018}, {x0 + i * dx + half, y1, z + 0.018},
        kLeft | kRight | kFront | kBack);
  }
  // Cross bars are a little thinner than the uprights they meet, so that no faces coincide.
  for (int i = 1; i < grid.rows; ++i) {
    box(mesh, j.paint, f, {x0, y0 + i * dy - half, z - 0.014}, {x1, y0 + i * dy + half, z + 0.014},
        kTop | kBottom | kFront | kBack);
  }
  for (int r = 0; r < grid.rows; ++r) {
    for (int c = 0; c < grid.columns; ++c) {
      pane(mesh, f, x0 + c * dx, x0 + (c + 1) * dx, y0 + r * dy, y0 + (r + 1) * dy, z,
           hash(j.seed, static_cast<uint32_t>(r), static_cast<uint32_t>(c)));
    }
  }
}

void door_leaves(Mesh& mesh, const Frame& f, const Hole& h, double z) {
  const std::array<Vec3d, 4> corners{point(f, {h.x0, h.y0, z}), point(f, {h.x1, h.y0, z}),
                                     point(f, {h.x1, h.y1, z}), point(f, {h.x0, h.y1, z})};
  quad_uv(mesh, Surface::door, corners, {Vec2d{0, 0}, {1, 0}, {1, 1}, {0, 1}}, f.z);
  const double middle = 0.5 * (h.x0 + h.x1);
  if (is_coarse(mesh.detail)) return;
  ellipsoid(mesh, Surface::brass, moved(f, {middle + 0.09, h.y0 + 1.05, z + 0.05}), {0.035, 0.035, 0.04},
            divisions(mesh.detail, 8, 4));
}

}  // namespace

void fill_hole(Mesh& mesh, const Frame& f, const Hole& h, const Joinery& j) {
  const bool fine = j.finish == Finish::fine && !is_coarse(mesh.detail);
  const double z = -kReveal;
  if (j.filling == Filling::door) {
    // Two leaves under a fanlight.
    const double transom = h.y1 - std::min(0.75, 0.25 * (h.y1 - h.y0));
    room(mesh, Surface::stone, Surface::stone, f, {h.x0, h.y0, z}, {h.x1, h.y1, 0},
         kLeft | kRight | kTop | kBottom);
    if (is_coarse(mesh.detail)) return door_leaves(mesh, f, h, z);
    room(mesh, Surface::interior, Surface::interior, f, {h.x0, transom, -1.2}, {h.x1, h.y1, z},
         kAllSides - kFront);
    door_leaves(mesh, f, {h.x0, h.x1, h.y0, transom}, z);
    leaf(mesh, f, {h.x0, h.x1, transom, h.y1}, {fine ? 4 : 1, 1, 0.07, 0.035}, j, z);
    return;
  }
  room(mesh, Surface::stone, Surface::stone, f, {h.x0, h.y0, z}, {h.x1, h.y1, 0},
       kLeft | kRight | kTop | kBottom);
  if (is_coarse(mesh.detail)) {
    box(mesh, Surface::interior, f, {h.x0, h.y0, z - 0.2}, {h.x1, h.y1, z - 0.1}, kFront);
  } else if (j.filling != Filling::cafe) {
    room(mesh, Surface::interior, Surface::floorboards, f, {h.x0, h.y0, -kRoom}, {h.x1, h.y1, z},
         kAllSides - kFront);
  }
  if (!fine) {
    pane(mesh, f, h.x0, h.x1, h.y0, h.y1, z, j.seed);
    if (is_coarse(mesh.detail)) return;
    box(mesh, j.paint, f, {0.5 * (h.x0 + h.x1) - 0.06, h.y0, z}, {0.5 * (h.x0 + h.x1) + 0.06, h.y1, z + 0.03},
        kFront | kLeft | kRight);
    return;
  }
  if (j.filling == Filling::cafe) {
    leaf(mesh, f, {h.x0, h.x1, h.y0, h.y1 - 0.85}, {2, 1, 0.09, 0.07}, j, z);
    leaf(mesh, f, {h.x0, h.x1, h.y1 - 0.85, h.y1}, {4, 1, 0.08, 0.04}, j, z);
    return;
  }
  if (j.filling == Filling::shopfront) {
    leaf(mesh, f, {h.x0, h.x1, h.y0, h.y1 - 0.8}, {3, 1, 0.09, 0.06}, j, z);
    leaf(mesh, f, {h.x0, h.x1, h.y1 - 0.8, h.y1}, {6, 1, 0.08, 0.035}, j, z);
    furnish_shop(mesh, f, h, j.seed);
    return;
  }
  const int rows = std::max(2, static_cast<int>(std::lround((h.y1 - h.y0) / 0.45)));
  const double middle = 0.5 * (h.x0 + h.x1);
  leaf(mesh, f, {h.x0, middle - 0.003, h.y0, h.y1}, {2, rows, 0.065, 0.032}, j, z);
  Joinery other = j;
  other.seed = hash(j.seed, 77);
  leaf(mesh, f, {middle + 0.003, h.x1, h.y0, h.y1}, {2, rows, 0.065, 0.032}, other, z);
  furnish_room(mesh, f, h, j.seed);
}

}  // namespace plaza
