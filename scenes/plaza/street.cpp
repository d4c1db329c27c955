// Street furniture: lamps, benches, bollards, cafe tables, the kiosk.
#include <cmath>

#include "parts.h"
#include "random.h"

namespace plaza {

// A cast-iron candelabrum with three opal globes.
void street_lamp(Mesh& mesh, const Frame& f) {
  const int around = divisions(mesh.detail, 12, 5);
  lathe(
      mesh, Surface::iron, f,
      {{0.34, 0}, {0.34, 0.2}, {0.3, 0.28}, {0.22, 0.34}, {0.2, 0.9}, {0.24, 0.96}, {0.2, 1.02}, {0.1, 1.1}},
      is_bare(mesh.detail) ? 4 : 8, Shading::faceted);
  lathe(mesh, Surface::iron, f,
        {{0.11, 1.05},
         {0.13, 1.2},
         {0.08, 1.34},
         {0.07, 2.3},
         {0.1, 2.36},
         {0.1, 2.44},
         {0.065, 2.52},
         {0.05, 3.6},
         {0.09, 3.66},
         {0.09, 3.74},
         {0.05, 3.8},
         {0.045, 4.35},
         {0.12, 4.4},
         {0.12, 4.44},
         {0.0, 4.46}},
        around);
  const auto globe = [&](const Vec3d& foot) {
    const Frame at = moved(f, foot);
    ellipsoid(mesh, Surface::globe, moved(at, {0, 0.25, 0}), {0.23, 0.23, 0.23},
              divisions(mesh.detail, 16, 6));
    lathe(mesh, Surface::iron, at, {{0.04, -0.12}, {0.12, -0.02}, {0.13, 0.06}, {0, 0.07}}, around);
    lathe(mesh, Surface::iron, at, {{0, 0.46}, {0.09, 0.455}, {0.06, 0.50}, {0.02, 0.54}, {0, 0.62}}, around);
  };
  globe({0, 4.46, 0});
  if (is_bare(mesh.detail)) return;
  for (const double side : {-1.0, 1.0}) {
    // An arm that swings out, dips and rises to its globe.
    std::vector<Vec3d> path;
    const int steps = divisions(mesh.detail, 10, 4);
    for (int i = 0; i <= steps; ++i) {
      const double t = static_cast<double>(i) / steps;
      path.push_back(point(f, {side * 0.78 * t, 3.68 - 0.22 * std::sin(t * kPi) + 0.12 * t * t, 0}));
    }
    tube(mesh, Surface::iron, path, std::vector<double>(path.size(), 0.028), divisions(mesh.detail, 6, 4));
    globe({side * 0.78, 3.92, 0});
  }
}

void bench(Mesh& mesh, const Frame& f) {
  const double half = 0.95;
  for (const double x : {-0.75, 0.75}) {
    box(mesh, Surface::iron, f, {x - 0.03, 0, -0.25}, {x + 0.03, 0.42, -0.18});
    box(mesh, Surface::iron, f, {x - 0.03, 0, 0.16}, {x + 0.03, 0.42, 0.22});
    box(mesh, Surface::iron, f, {x - 0.03, 0.38, -0.17}, {x + 0.03, 0.42, 0.15});
    box(mesh, Surface::iron, leaned(moved(f, {x, 0.42, -0.22}), -14), {-0.03, 0, -0.03}, {0.03, 0.5, 0.02});
  }
  for (int i = 0; i < 5; ++i) {
    box(mesh, Surface::bench, f, {-half, 0.42, -0.2 + i * 0.09}, {half, 0.455, -0.13 + i * 0.09});
  }
  const Frame back = leaned(moved(f, {0, 0.42, -0.2}), -14);
  for (int i = 0; i < 3; ++i) {
    box(mesh, Surface::bench, back, {-half, 0.12 + i * 0.14, 0.0}, {half, 0.22 + i * 0.14, 0.035});
  }
}

void bollard(Mesh& mesh, const Frame& f) {
  lathe(mesh, Surface::iron, f,
        {{0.13, 0},
         {0.13, 0.12},
         {0.1, 0.16},
         {0.075, 0.62},
         {0.1, 0.66},
         {0.1, 0.72},
         {0.07, 0.76},
         {0.085, 0.84},
         {0.05, 0.91},
         {0, 0.93}},
        divisions(mesh.detail, 10, 5));
}

// The sitter looks along -z.
void chair(Mesh& mesh, const Frame& f, Surface paint) {
  for (const double x : {-0.19, 0.19}) {
    for (const double z : {-0.19, 0.19}) {
      box(mesh, Surface::iron, f, {x - 0.015, 0, z - 0.015}, {x + 0.015, z > 0 ? 0.88 : 0.45, z + 0.015},
          kOnGround);
    }
  }
  box(mesh, paint, f, {-0.22, 0.45, -0.22}, {0.22, 0.48, 0.17});
  box(mesh, paint, f, {-0.17, 0.66, 0.176}, {0.17, 0.86, 0.204});
}

void cafe_table(Mesh& mesh, const Frame& f, uint32_t seed) {
  const int around = divisions(mesh.detail, 14, 6);
  lathe(mesh, Surface::steel, f,
        {{0.25, 0}, {0.25, 0.03}, {0.03, 0.06}, {0.03, 0.70}, {0.36, 0.71}, {0.36, 0.74}, {0, 0.74}}, around);
  bar(mesh, Surface::paint_white, f, {0, 0.74, 0}, {0, 2.55, 0}, 0.025, 5);
  lathe(mesh, Surface::canvas, f, {{1.36, 1.98}, {1.42, 2.16}, {0.1, 2.62}, {0, 2.62}}, 8, Shading::faceted,
        kPi / 8);
  for (int i = 0; i < 3; ++i) {
    const double angle = 120.0 * i + 50 * unit(hash(seed, static_cast<uint32_t>(i)));
    const Frame chair_frame = moved(turned(f, angle), {0, 0, 0.72});
    chair(mesh, chair_frame, Surface::paint_red);
  }
}

// A flower seller's tiers under a parasol.
void flower_stall(Mesh& mesh, const Frame& f) {
  const Surface petals[] = {Surface::cloth_red, Surface::tram_yellow, Surface::paint_white, Surface::lilac,
                            Surface::rose};
  for (int tier = 0; tier < 3; ++tier) {
    const double y = 0.3 + 0.26 * tier, z = 0.55 - 0.42 * tier;
    box(mesh, Surface::bench, f, {-1.15, y - 0.3, z - 0.2}, {1.15, y, z + 0.2}, kOnGround);
    for (int pot = 0; pot < (is_coarse(mesh.detail) ? 3 : 7); ++pot) {
      const uint32_t id = hash(static_cast<uint32_t>(tier), static_cast<uint32_t>(pot), 33);
      const Frame at = moved(f, {-0.99 + 0.33 * pot, y, z});
      lathe(mesh, Surface::steel, at, {{0.08, 0}, {0.12, 0.22}, {0.1, 0.22}, {0, 0.15}},
            divisions(mesh.detail, 8, 5));
      Random random{id, 0};
      const int heads = many(mesh.detail, 9, 3);
      for (int k = 0; k < heads; ++k) {
        const double a = 2.4 * k, r = 0.14 * std::sqrt((k + 0.5) / heads);
        const Vec3d head{r * std::sin(a), 0.36 + between(random, -0.03, 0.06) - 1.5 * r * r, r * std::cos(a)};
        ellipsoid(mesh, k % 5 == 4 ? Surface::paint_green : petals[id % 5], moved(at, head),
                  {0.055, 0.045, 0.055}, divisions(mesh.detail, 6, 4));
      }
    }
  }
  bar(mesh, Surface::paint_white, f, {0, 0, -0.75}, {0, 2.5, -0.75}, 0.03, 6);
  lathe(mesh, Surface::canvas, moved(f, {0, 0, -0.3}), {{1.62, 1.98}, {1.7, 2.18}, {0.1, 2.66}, {0, 2.66}}, 8,
        Shading::faceted, kPi / 8);
}

// The quiosque: an octagon of green iron with a counter, a canopy and an onion roof.
void kiosk(Mesh& mesh, const Frame& f) {
  begin_group(mesh, "kiosk");
  const double turn = kPi / 8, flat = std::cos(kPi / 8);
  lathe(mesh, Surface::stone, f, {{1.75, 0}, {1.75, 0.14}, {1.3, 0.14}}, 8, Shading::faceted, turn);
  lathe(mesh, Surface::paint_green, f,
        {{1.45, 0.13}, {1.45, 0.25}, {1.38, 0.3}, {1.38, 1.0}, {1.6, 1.06}, {1.6, 1.12}, {0.3, 1.12}}, 8,
        Shading::faceted, turn);
  lathe(mesh, Surface::interior, f, {{0.35, 1.12}, {0.35, 2.35}, {0.3, 2.35}}, 8, Shading::faceted, turn);
  lathe(mesh, Surface::paint_green, f,
        {{0.2, 2.35},
         {1.3, 2.35},
         {1.42, 2.4},
         {1.42, 2.72},
         {1.62, 2.82},
         {1.7, 2.9},
         {1.66, 2.96},
         {1.3, 3.02},
         {1.14, 3.3},
         {1.0, 3.62},
         {0.72, 3.88},
         {0.34, 4.05},
         {0.16, 4.2},
         {0.22, 4.3},
         {0.1, 4.42},
         {0.04, 4.8},
         {0, 5.0}},
        8, Shading::faceted, turn);
  ellipsoid(mesh, Surface::brass, moved(f, {0, 5.02, 0}), {0.09, 0.09, 0.09}, divisions(mesh.detail, 10, 6));
  for (int i = 0; i < 8; ++i) {
    const Frame side = turned(f, 45.0 * i);
    const Frame corner = moved(turned(f, 45.0 * i + 22.5), {0, 0, 1.33});
    lathe(mesh, Surface::paint_green, corner, {{0.07, 1.1}, {0.05, 1.2}, {0.04, 2.2}, {0.08, 2.36}},
          divisions(mesh.detail, 8, 5));
    // Panels on the parapet and a canopy of cloth over every second side.
    box(mesh, Surface::brass, side, {-0.36, 0.42, 1.38 * flat - 0.01}, {0.36, 0.88, 1.38 * flat + 0.015},
        kOnWall);
    box(mesh, Surface::paint_green, side, {-0.31, 0.47, 1.38 * flat}, {0.31, 0.83, 1.38 * flat + 0.022},
        kOnWall);
    if (i % 2 == 0) shop_awning(mesh, moved(side, {0, 0, 1.42 * flat}), -0.55, 0.55, 2.66);
    if (i % 2 == 1) {
      const double z = 1.26 * flat;
      quad(mesh, Surface::glass, point(side, {-0.46, 1.13, z}), point(side, {0.46, 1.13, z}),
           point(side, {0.46, 2.34, z}), point(side, {-0.46, 2.34, z}));
    }
  }
}

}  // namespace plaza
