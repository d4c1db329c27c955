// A Pombaline house: stone ground floor, storeys of windows between string courses, a cornice, a roof.
#include <algorithm>
#include <cmath>

#include "parts.h"
#include "random.h"

namespace plaza {
namespace {

// One bay of one storey: the wall around a hole, as a frame of quads whose lines meet the neighbours'.
void wall_around(Mesh& mesh, Surface wall, const Frame& f, double x0, double x1, double y0, double y1,
                 const Hole& h) {
  const std::array<double, 4> xs{x0, h.x0, h.x1, x1}, ys{y0, h.y0, h.y1, y1};
  for (size_t r = 0; r < 3; ++r) {
    for (size_t c = 0; c < 3; ++c) {
      if (r == 1 && c == 1) continue;
      box(mesh, wall, f, {xs[c], ys[r], -0.3}, {xs[c + 1], ys[r + 1], 0}, kFront);
    }
  }
}

// A bay with its window or door. From afar, in a coarse mesh, the window lies on the wall.
void bay(Mesh& mesh, Surface wall, const Frame& f, double x0, double x1, double y0, double y1, const Hole& h,
         const Joinery& joinery) {
  if (is_bare(mesh.detail) || (is_coarse(mesh.detail) && joinery.finish == Finish::plain)) {
    box(mesh, wall, f, {x0, y0, -0.3}, {x1, y1, 0}, kFront);
    box(mesh, Surface::interior, f, {h.x0, h.y0, 0}, {h.x1, h.y1, 0.02}, kFront);
    box(mesh, Surface::glass, f, {h.x0, h.y0, 0}, {h.x1, h.y1, 0.04}, kFront);
    return;
  }
  wall_around(mesh, wall, f, x0, x1, y0, y1, h);
  fill_hole(mesh, f, h, joinery);
}

std::vector<Storey> storeys_of(const Building& b) {
  using Balcony = Storey::Balcony;
  std::vector<Storey> storeys;
  storeys.push_back({3.9, 0.0, 2.95, 1.25, Filling::casement, Surround::crowned, Balcony::iron});
  if (b.storeys > 2) {
    const bool balconies = hash(b.seed, 21) % 2 == 0;
    storeys.push_back(balconies
                          ? Storey{3.5, 0.0, 2.6, 1.2, Filling::casement, Surround::plain, Balcony::iron}
                          : Storey{3.5, 0.9, 2.65, 1.2, Filling::casement, Surround::crowned, Balcony::none});
  }
  if (b.storeys > 3)
    storeys.push_back({3.0, 0.8, 2.25, 1.15, Filling::casement, Surround::plain, Balcony::none});
  for (Storey& s : storeys) {
    s.height *= b.height;
    s.head *= b.height;
  }
  return storeys;
}

void string_course(Mesh& mesh, const Frame& f, double width, double y) {
  if (is_coarse(mesh.detail))
    return box(mesh, Surface::stone, f, {0, y - 0.16, 0}, {width, y + 0.08, 0.12}, kOnWall);
  moulding(mesh, Surface::stone, f,
           {{0, y - 0.16}, {0.07, y - 0.16}, {0.10, y - 0.04}, {0.14, y}, {0.14, y + 0.06}, {0, y + 0.1}}, 0,
           width);
}

void cornice(Mesh& mesh, const Frame& f, double width, double y) {
  if (is_bare(mesh.detail))
    return box(mesh, Surface::stone, f, {0, y - 0.3, 0}, {width, y + 0.14, 0.5}, kOnWall);
  moulding(mesh, Surface::stone, f,
           {{0, y - 0.55},
            {0.06, y - 0.55},
            {0.06, y - 0.36},
            {0.14, y - 0.30},
            {0.18, y - 0.20},
            {0.36, y - 0.12},
            {0.42, y - 0.02},
            {0.52, y + 0.02},
            {0.55, y + 0.14},
            {0, y + 0.14}},
           -0.02, width + 0.02);
  if (mesh.detail.level < 0.5) return;
  const int count = static_cast<int>(width / 0.55);
  for (int i = 0; i < count; ++i) {
    const double x = width * (i + 0.5) / count;
    box(mesh, Surface::stone, f, {x - 0.1, y - 0.32, 0.1}, {x + 0.1, y - 0.125, 0.33},
        kLeft | kRight | kFront | kBottom);
  }
}

// Corner strips of long and short blocks.
void quoins(Mesh& mesh, const Frame& f, double width, double y0, double y1) {
  const int rows = std::max(2, static_cast<int>((y1 - y0) / 0.48));
  for (int i = 0; i < rows; ++i) {
    const double length = i % 2 == 0 ? 0.62 : 0.42, gap = 0.012;
    const double low = y0 + (y1 - y0) * i / rows + gap, high = y0 + (y1 - y0) * (i + 1) / rows - gap;
    box(mesh, Surface::stone, f, {0, low, 0}, {length, high, 0.055}, kOnWall - kLeft);
    box(mesh, Surface::stone, f, {width - length, low, 0}, {width, high, 0.055}, kOnWall - kRight);
  }
}

double ground_floor(Mesh& mesh, const Frame& f, const Building& b) {
  if (b.ground == Ground::arcade) return arcade(mesh, f, b.bays, b.bay, b.finish);
  const double height = 4.4, plinth = 0.0;
  const double width = b.bays * b.bay;
  for (int i = 0; i < b.bays; ++i) {
    const uint32_t id = hash(b.seed, static_cast<uint32_t>(i), 5);
    const double x0 = i * b.bay, x1 = x0 + b.bay, middle = 0.5 * (x0 + x1);
    const bool shop = b.ground == Ground::shops && i % 3 != 1;
    if (b.ground == Ground::cafe) {
      const Hole wide{x0 + 0.38, x1 - 0.38, i == 1 ? 0.16 : 0.42, 3.72};
      bay(mesh, Surface::ashlar, f, x0, x1, plinth, height, wide,
          {Filling::cafe, Surface::paint_green, b.finish, id});
      surround(mesh, f, wide, Surround::plain);
      continue;
    }
    const double half = shop ? 1.05 : 0.8;
    const Hole hole{middle - half, middle + half, plinth + 0.14, 3.5};
    const Surface paint = b.joinery == Surface::paint_white ? Surface::paint_green : b.joinery;
    bay(mesh, Surface::ashlar, f, x0, x1, plinth, height, hole,
        {shop ? Filling::shopfront : Filling::door, paint, b.finish, id});
    surround(mesh, f, hole, Surround::plain);
    if (shop && b.finish == Finish::fine && unit(hash(id, 9)) < 0.6)
      shop_awning(mesh, f, x0 + 0.35, x1 - 0.35, 3.62);
  }
  if (b.ground == Ground::cafe) cafe(mesh, moved(f, {0, 0.16, 0}), width, 3.9, 5.5);
  return height;
}

// The walls that no one looks at: ends and back, so that the house casts its shadow.
void shell(Mesh& mesh, const Building& b, const Frame& f, double width, double eaves) {
  box(mesh, b.wall, f, {0, 0, -b.depth}, {width, eaves, 0}, kLeft | kRight | kBack);
}

}  // namespace

double building(Mesh& mesh, const Frame& f, const Building& b) {
  const double width = b.bays * b.bay;
  double y = ground_floor(mesh, f, b);
  const double first = y;
  uint32_t level = 0;
  for (const Storey& s : storeys_of(b)) {
    string_course(mesh, f, width, y);
    for (int i = 0; i < b.bays; ++i) {
      const double x0 = i * b.bay, x1 = x0 + b.bay, middle = 0.5 * (x0 + x1);
      const Hole hole{middle - s.width / 2, middle + s.width / 2, y + s.sill + 0.12, y + s.head};
      bay(mesh, b.wall, f, x0, x1, y, y + s.height, hole,
          {s.filling, b.joinery, b.finish, hash(b.seed, level, static_cast<uint32_t>(i))});
      surround(mesh, f, hole, b.finish == Finish::fine ? s.frame : Surround::plain);
      if (s.balcony == Storey::Balcony::iron) {
        iron_balcony(mesh, f, hole.x0 - 0.4, hole.x1 + 0.4, y + s.sill + 0.12, b.finish);
      }
    }
    y += s.height;
    ++level;
  }
  cornice(mesh, f, width, y);
  if (b.finish == Finish::fine && !is_coarse(mesh.detail)) quoins(mesh, f, width, first + 0.12, y - 0.56);
  shell(mesh, b, f, width, y);
  const Frame top = moved(f, {0, y + 0.14, 0});
  if (b.crown == Crown::tiles) {
    tiled_roof(mesh, top, {width, b.depth, b.bay, b.wall, b.finish, b.seed});
  } else {
    balustrade(mesh, moved(top, {0, 0, 0.25}), 0, width);
    box(mesh, Surface::stone, top, {0, -0.1, -b.depth}, {width, -0.005, 0}, kTop);
    tiled_roof(mesh, moved(top, {0, 0, -1.6}), {width, b.depth - 1.6, b.bay, b.wall, b.finish, b.seed});
  }
  return y;
}

}  // namespace plaza
