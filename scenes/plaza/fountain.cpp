// A fountain: a wide basin, two bowls on a stem, tritons in the water, jets.
#include <cmath>

#include "parts.h"

namespace plaza {
namespace {

constexpr double kLevel = 0.90;  // of the water in the basin

// A round sheet of water with ripples that run out from the middle and fade at the rim.
void water(Mesh& mesh, const Frame& f, double radius, double y, double ripple) {
  surface_grid(mesh, Surface::water, divisions(mesh.detail, 56, 12),
               divisions(mesh.detail, radius > 3 ? 22 : 6, 3),
               [&](double u, double v) {
                 const double a = u * 2 * kPi, r = radius * (1 - v);
                 const double x = r * std::sin(a), z = r * std::cos(a);
                 const double calm = 1 - std::pow(r / radius, 6);
                 const double h = std::cos(r * 5.5) + 0.6 * std::sin(3.1 * x + 1.3 * z) +
                                  0.5 * std::sin(4.7 * z - 2.3 * x);
                 return point(f, {x, y + ripple * calm * h, z});
               },
               Ends::closed, {1, 1});
}

// A thrown stream: a parabola from `from` to `to`, both in the frame, that rises `height` over the
// chord at its middle. It ends in a crown of drops.
void jet(Mesh& mesh, const Frame& f, const Vec3d& from, const Vec3d& to, double height, double radius) {
  std::vector<Vec3d> path;
  std::vector<double> radii;
  const int steps = divisions(mesh.detail, 12, 3);
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    path.push_back(point(f, from + (to - from) * t + Vec3d{0, 4 * height * t * (1 - t), 0}));
    radii.push_back(radius * (0.7 + 0.8 * t + 0.15 * std::sin(21 * t)));
  }
  tube(mesh, Surface::foam, path, radii, divisions(mesh.detail, 5, 3));
  const int drops = many(mesh.detail, 4, 0);
  for (int i = 0; i < drops; ++i) {
    const double a = 2.4 * i, reach = radius * (2.5 + i % 3);
    ellipsoid(mesh, Surface::foam,
              moved(f, to + Vec3d{reach * std::sin(a), 0.02 + 0.03 * (i % 3), reach * std::cos(a)}),
              {0.03, 0.02, 0.03}, 5);
  }
}

void basin(Mesh& mesh, const Frame& f) {
  const int around = divisions(mesh.detail, 64, 16);
  lathe(mesh, Surface::stone, f, {{6.1, 0}, {6.1, 0.14}, {6.07, 0.17}, {5.2, 0.17}}, around);
  lathe(mesh, Surface::stone, f,
        {{5.45, 0.16},
         {5.45, 0.30},
         {5.36, 0.38},
         {5.24, 0.42},
         {5.16, 0.55},
         {5.16, 0.74},
         {5.26, 0.84},
         {5.42, 0.90},
         {5.45, 0.98},
         {5.42, 1.06},
         {5.36, 1.08},
         {4.92, 1.08},
         {4.86, 1.04},
         {4.82, 0.95},
         {4.80, 0.26}},
        around);
  lathe(mesh, Surface::basin, f, {{4.85, 0.28}, {0.6, 0.28}}, around, Shading::faceted);
  water(mesh, f, 4.83, kLevel, 0.010);
}

void bowls(Mesh& mesh, const Frame& f) {
  const int around = divisions(mesh.detail, 40, 12);
  lathe(mesh, Surface::stone, f, {{1.15, 0.2}, {1.15, 1.0}, {1.05, 1.1}, {0, 1.1}}, 8, Shading::faceted,
        kPi / 8);
  // Stem, underside of the lower bowl, lip, inside.
  lathe(mesh, Surface::stone, f,
        {{0.80, 1.08}, {0.84, 1.16}, {0.60, 1.26}, {0.40, 1.42}, {0.36, 1.60}, {0.50, 1.80}, {0.52, 1.92},
         {0.40, 2.02}, {0.44, 2.10}, {0.80, 2.16}, {1.40, 2.30}, {1.85, 2.52}, {2.05, 2.66}, {2.12, 2.74},
         {2.12, 2.80}, {2.04, 2.84}, {1.94, 2.80}, {1.70, 2.62}, {1.20, 2.46}, {0.3, 2.42}},
        around);
  water(mesh, f, 1.95, 2.76, 0.006);
  lathe(mesh, Surface::stone, f,
        {{0.46, 2.4},
         {0.46, 2.95},
         {0.34, 3.05},
         {0.26, 3.2},
         {0.32, 3.42},
         {0.34, 3.52},
         {0.24, 3.62},
         {0.30, 3.68},
         {0.60, 3.74},
         {0.92, 3.90},
         {1.06, 4.02},
         {1.10, 4.08},
         {1.04, 4.13},
         {0.96, 4.10},
         {0.70, 3.96},
         {0.2, 3.92}},
        around);
  water(mesh, f, 0.97, 4.06, 0.004);
  lathe(mesh, Surface::bronze, f, {{0.32, 3.9}, {0.32, 4.3}, {0.24, 4.38}, {0.2, 4.5}, {0.3, 4.58}, {0, 4.6}},
        divisions(mesh.detail, 16, 6));
}

// Bronze children on rocks, who spout toward the rim.
void tritons(Mesh& mesh, const Frame& f) {
  for (int i = 0; i < 4; ++i) {
    const Frame at = moved(turned(f, 90.0 * i + 45), {0, 0, 2.9});
    lathe(mesh, Surface::stone, at, {{0.75, 0.26}, {0.70, 0.7}, {0.55, 0.95}, {0.38, 1.1}, {0, 1.12}}, 7,
          Shading::faceted);
    Figure child;
    child.height = 1.35;
    child.cloth = child.skin = child.hair = Surface::bronze;
    child.left_arm = child.right_arm = 45;
    child.left_fore = child.right_fore = 80;
    figure(mesh, moved(at, {0, 1.08, 0}), child);
    jet(mesh, at, {0, 2.25, 0.14}, {0, kLevel + 0.01, 1.55}, 0.45, 0.022);
  }
}

}  // namespace

void fountain(Mesh& mesh, const Frame& f) {
  begin_group(mesh, "fountain");
  basin(mesh, f);
  bowls(mesh, f);
  if (!is_bare(mesh.detail)) tritons(mesh, f);
  Figure nymph;
  nymph.height = 1.55;
  nymph.cloth = nymph.skin = nymph.hair = Surface::bronze;
  nymph.left_arm = 150;
  nymph.left_fore = 10;
  nymph.right_arm = 25;
  nymph.right_fore = 60;
  figure(mesh, moved(f, {0, 4.58, 0}), nymph);
  // Water falls from bowl to bowl and from the masks of the lower lip.
  for (int i = 0; i < 8; ++i) {
    const Frame at = turned(f, 45.0 * i + 22.5);
    jet(mesh, at, {0, 4.09, 1.06}, {0, 2.78, 1.55}, 0.16, 0.015);
  }
  for (int i = 0; i < 16; ++i) {
    const Frame at = turned(f, 22.5 * i + 11.25);
    jet(mesh, at, {0, 2.8, 2.1}, {0, kLevel, 2.75}, 0.22, 0.020);
  }
  if (is_bare(mesh.detail)) return;
  for (int i = 0; i < 16; ++i) {
    const Frame at = turned(f, 22.5 * i);
    lathe(mesh, Surface::brass, moved(at, {0, kLevel - 0.05, 4.55}), {{0.05, 0}, {0.035, 0.14}, {0, 0.14}},
          divisions(mesh.detail, 8, 5));
    jet(mesh, at, {0, kLevel + 0.1, 4.53}, {0, kLevel, 3.5}, 0.75, 0.018);
  }
}

}  // namespace plaza
