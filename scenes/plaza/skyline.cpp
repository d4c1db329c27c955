// What shows over the roofs: a hill with houses and a castle, and a church. Colours fade with distance.
#include <algorithm>
#include <cmath>

#include "parts.h"
#include "random.h"

namespace plaza {
namespace {

struct Hill {
  Vec3d center;
  double height, radius;
};

double hill_height(const Hill& hill, double x, double z) {
  const double dx = (x - hill.center.x) / (hill.radius * 1.25), dz = (z - hill.center.z) / hill.radius;
  const double d = dx * dx + dz * dz;
  return hill.height * (1.25 / (1 + 1.6 * d) - 0.25) - 1;
}

// A house with a gabled roof along its x.
void far_house(Mesh& mesh, const Frame& f, double half, double deep, double height, uint32_t id) {
  const Surface wall = id % 3 == 0 ? Surface::far_warm : Surface::far_wall;
  box(mesh, wall, f, {-half, -6, -deep}, {half, height, deep}, kOnGround - kTop);
  const double rise = deep * 0.55, lip = 0.3;
  const auto at = [&](double x, double y, double z) { return point(f, {x, y, z}); };
  quad(mesh, Surface::far_roof, at(-half, height - 0.2, deep + lip), at(half, height - 0.2, deep + lip),
       at(half, height + rise, 0), at(-half, height + rise, 0));
  quad(mesh, Surface::far_roof, at(half, height - 0.2, -deep - lip), at(-half, height - 0.2, -deep - lip),
       at(-half, height + rise, 0), at(half, height + rise, 0));
  triangle(mesh, wall, at(half, height, deep), at(half, height, -deep), at(half, height + rise - 0.05, 0));
  triangle(mesh, wall, at(-half, height, -deep), at(-half, height, deep), at(-half, height + rise - 0.05, 0));
  // Two rows of windows, dark from afar.
  if (mesh.detail.level < 0.5) return;
  for (double x = -half + 1.5; x < half - 0.8; x += 2.6) {
    for (double y = height - 2.4; y > height - 7 && y > 0; y -= 3.2) {
      box(mesh, Surface::interior, f, {x - 0.5, y, deep - 0.05}, {x + 0.5, y + 1.5, deep + 0.04}, kFront);
    }
  }
}

void battlements(Mesh& mesh, const Frame& f, double x0, double x1, double height, double deep) {
  box(mesh, Surface::far_stone, f, {x0, -12, -deep}, {x1, height, 0}, kOnGround);
  const int count = std::max(2, static_cast<int>((x1 - x0) / 2.4));
  for (int i = 0; i < count; ++i) {
    const double x = x0 + (x1 - x0) * (i + 0.2) / count;
    box(mesh, Surface::far_stone, f, {x, height, -0.8}, {x + (x1 - x0) * 0.6 / count, height + 1.3, 0},
        kOnGround);
  }
}

void castle(Mesh& mesh, const Frame& f) {
  battlements(mesh, f, -34, 30, 7, 20);
  const struct {
    double x, half, height;
  } towers[] = {{-34, 4.5, 12}, {-14, 4, 11}, {4, 5, 16}, {18, 4, 11}, {30, 4.5, 13}};
  for (const auto& t : towers) {
    battlements(mesh, moved(f, {t.x, 0, 2}), -t.half, t.half, t.height, 2 * t.half);
    battlements(mesh, moved(turned(f, -90), {1, 0, -t.x + t.half + 0.03}), -7, 1, t.height - 0.05, 0.5);
  }
  bar(mesh, Surface::far_stone, f, {4, 16, -3}, {4, 24, -3}, 0.18, 5);
  box(mesh, Surface::cloth_red, f, {4.1, 21.4, -3.05}, {8.3, 24, -2.95});
}

// A church front with two bell towers, and its dome behind.
void church(Mesh& mesh, const Frame& f) {
  box(mesh, Surface::far_wall, f, {-9, 0, -30}, {9, 27, 0}, kOnGround);
  triangle(mesh, Surface::far_wall, point(f, {-9, 27, 0}), point(f, {9, 27, 0}), point(f, {0, 32, 0}));
  // Pilasters, the gable's cornice and a round window.
  for (const double x : {-8.6, -2.6, 2.6, 8.6}) {
    box(mesh, Surface::far_stone, f, {x - 0.45, 0, -0.1}, {x + 0.45, 26, 0.35}, kOnGround);
  }
  box(mesh, Surface::far_stone, f, {-9.3, 26, -0.2}, {9.3, 27, 0.8});
  lathe(mesh, Surface::far_stone, leaned(moved(f, {0, 22.5, 0}), 90),
        {{2.2, 0}, {2.2, 0.4}, {1.6, 0.4}, {1.6, 0.1}}, divisions(mesh.detail, 20, 8));
  lathe(mesh, Surface::interior, leaned(moved(f, {0, 22.5, 0}), 90), {{1.7, 0.15}, {0, 0.15}},
        divisions(mesh.detail, 20, 8));
  for (const double x : {-11.5, 11.5}) {
    const Frame t = moved(f, {x, 0, -2});
    box(mesh, Surface::far_wall, t, {-3.2, 0, -3.2}, {3.2, 33, 3.2}, kOnGround);
    for (const double cx : {-2.85, 2.85}) {
      box(mesh, Surface::far_stone, t, {cx - 0.4, 0, 3.1}, {cx + 0.4, 33, 3.4}, kOnGround);
    }
    box(mesh, Surface::far_stone, t, {-3.5, 21.5, -3.5}, {3.5, 22.1, 3.5});
    box(mesh, Surface::far_stone, t, {-3.6, 33, -3.6}, {3.6, 33.7, 3.6});
    for (const double cx : {-2.3, 2.3}) {
      for (const double cz : {-2.3, 2.3})
        box(mesh, Surface::far_wall, t, {cx - 0.7, 33.7, cz - 0.7}, {cx + 0.7, 38, cz + 0.7}, kOnGround);
    }
    box(mesh, Surface::interior, t, {-1.6, 33.7, -1.6}, {1.6, 38, 1.6}, kOnGround);
    box(mesh, Surface::far_stone, t, {-3.4, 38, -3.4}, {3.4, 38.8, 3.4});
    lathe(mesh, Surface::far_wall, t,
          {{3.0, 38.8},
           {3.0, 39.6},
           {2.8, 40.6},
           {2.1, 41.8},
           {1.1, 42.7},
           {0.7, 43.4},
           {0.7, 44.4},
           {0.25, 45},
           {0, 46.8}},
          divisions(mesh.detail, 12, 6));
    box(mesh, Surface::interior, t, {-0.8, 24, 3.15}, {0.8, 28, 3.24}, kFront);
  }
  for (const double x : {-4.5, 4.5})
    box(mesh, Surface::interior, f, {x - 0.9, 20.5, -0.1}, {x + 0.9, 24.5, 0.05}, kFront);
  lathe(mesh, Surface::far_wall, moved(f, {0, 26, -24}),
        {{7.5, 0},
         {7.5, 7},
         {8.0, 7.2},
         {8.0, 8.0},
         {7.2, 8.3},
         {6.9, 10},
         {6.0, 12.4},
         {4.4, 14.4},
         {2.2, 15.7},
         {1.3, 16.0},
         {1.3, 18.2},
         {0.6, 19.2},
         {0, 21.5}},
        divisions(mesh.detail, 24, 8));
}

}  // namespace

void skyline(Mesh& mesh, const Plan& plan) {
  begin_group(mesh, "skyline");
  const Hill hill{{plan.east + 88, 0, plan.north + 205}, 46, 110};
  const int cells = divisions(mesh.detail, 28, 8);
  surface_grid(mesh, Surface::far_hill, cells, cells,
               [&](double u, double v) {
                 const double x = hill.center.x + (u - 0.5) * 4.4 * hill.radius,
                              z = hill.center.z - (v - 0.5) * 3.4 * hill.radius;
                 return Vec3d{x, std::max(hill_height(hill, x, z), -2.0), z};
               },
               Ends::open, {1, 1});
  Frame toward;  // looks back at the square
  toward = turned(toward, 180);
  const auto on_hill = [&](double x, double z) { return moved(toward, {-x, hill_height(hill, x, z), -z}); };
  castle(mesh, turned(moved(on_hill(hill.center.x, hill.center.z - 8), {0, 3, 0}), 12));
  const int count = many(mesh.detail, 190, is_bare(mesh.detail) ? 40 : 60);
  Random random{4711, 0};
  for (int i = 0; i < std::min(count, 600); ++i) {
    const double x = hill.center.x + between(random, -190, 190), z = hill.center.z - between(random, 34, 130);
    if (z < plan.north + 70) continue;
    const uint32_t id = hash(900, static_cast<uint32_t>(i));
    // One draw a statement: the order in which arguments are evaluated is the compiler's own.
    const double heading = between(random, -35, 35), half = between(random, 3.5, 8);
    const double deep = between(random, 3, 5), height = between(random, 6, 11);
    far_house(mesh, turned(on_hill(x, z), heading), half, deep, height, id);
  }
  church(mesh, turned(moved(toward, {-9, 0, -(plan.north + 85)}), 8));
}

}  // namespace plaza
