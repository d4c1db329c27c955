// The poet on his pedestal: octagonal steps, a drum with plaques, eight smaller figures around a
// shaft, and a bronze on top, thirteen metres over the paving.
#include <cmath>

#include "parts.h"

namespace plaza {
namespace {

constexpr double kOctagon = kPi / 8;  // turns a flat side to the front
constexpr double kDrumTop = 3.0, kShaftTop = 8.7;

void steps(Mesh& mesh, const Frame& f) {
  std::vector<Vec2d> profile;
  const int count = 5;
  const double rise = 0.17, tread = 0.42, inner = 3.0;
  for (int i = 0; i < count; ++i) {
    const double r = inner + (count - i) * tread;
    profile.push_back({r, i * rise});
    profile.push_back({r, (i + 1) * rise - 0.03});
    profile.push_back({r - 0.03, (i + 1) * rise});  // a worn nose
  }
  profile.push_back({2.0, count * rise});
  lathe(mesh, Surface::stone, f, profile, 8, Shading::faceted, kOctagon);
}

// A garland: a ring of bronze that hangs on a face.
void wreath(Mesh& mesh, const Frame& f, double radius, double thick) {
  surface_grid(mesh, Surface::bronze, divisions(mesh.detail, 24, 8), divisions(mesh.detail, 7, 4),
               [&](double u, double v) {
                 const double a = u * 2 * kPi, b = v * 2 * kPi;
                 const double t = thick * (1 + 0.25 * std::cos(18 * a));
                 const double r = radius + t * std::cos(b);
                 return point(f, {r * std::cos(a), r * std::sin(a), t * std::sin(b)});
               },
               Ends::closed, {1, 1});
}

void pedestal(Mesh& mesh, const Frame& f) {
  const double base = 0.85;
  lathe(mesh, Surface::marble, f,
        {{2.9, base - 0.02},
         {2.9, 1.3},
         {2.82, 1.38},
         {2.66, 1.43},
         {2.6, 1.5},
         {2.6, 2.5},
         {2.66, 2.56},
         {2.66, 2.62},
         {2.82, 2.72},
         {2.92, 2.76},
         {2.92, 2.94},
         {2.86, kDrumTop},
         {1.5, kDrumTop}},
        8, Shading::faceted, kOctagon);
  lathe(mesh, Surface::marble, f,
        {{1.62, kDrumTop - 0.02},
         {1.62, 3.45},
         {1.54, 3.54},
         {1.40, 3.6},
         {1.36, 3.7},
         {1.16, 7.3},
         {1.22, 7.36},
         {1.22, 7.44},
         {1.34, 7.62},
         {1.56, 7.74},
         {1.60, 7.9},
         {1.60, 7.98},
         {1.28, 8.06},
         {1.10, 8.14},
         {1.06, 8.2},
         {1.06, 8.62},
         {1.0, kShaftTop},
         {0, kShaftTop}},
        8, Shading::faceted, kOctagon);
  const double flat = 2.6 * std::cos(kPi / 8), shaft_flat = 1.36 * std::cos(kPi / 8);
  for (int side = 0; side < 8; ++side) {
    const Frame face = moved(turned(f, 45.0 * side), {0, 2.0, flat});
    if (side % 2 == 0) {
      box(mesh, Surface::brass, face, {-0.62, -0.34, -0.01}, {0.62, 0.34, 0.035}, kOnWall);
      if (is_bare(mesh.detail)) continue;
      for (const double x : {-0.55, 0.55}) {
        for (const double y : {-0.27, 0.27}) {
          ellipsoid(mesh, Surface::bronze, moved(face, {x, y, 0.035}), {0.03, 0.03, 0.02},
                    divisions(mesh.detail, 6, 4));
        }
      }
    } else {
      wreath(mesh, moved(face, {0, 0, 0.05}), 0.33, 0.06);
    }
    const Frame high = leaned(moved(turned(f, 45.0 * side), {0, 4.4, shaft_flat - 0.02}), 0);
    if (side % 2 == 0) wreath(mesh, moved(high, {0, 0.9, -0.02}), 0.26, 0.045);
  }
}

void companions(Mesh& mesh, const Frame& f) {
  for (int i = 0; i < 8; ++i) {
    const Frame place = moved(turned(f, 45.0 * i + 22.5), {0, kDrumTop, 2.18});
    lathe(mesh, Surface::marble, place, {{0.5, -0.01}, {0.5, 0.14}, {0.44, 0.2}, {0, 0.2}}, 8,
          Shading::faceted, kOctagon);
    Figure companion;
    companion.height = 2.35;
    companion.cloth = companion.skin = companion.hair = Surface::marble;
    companion.left_arm = 18 + 9 * (i % 3);
    companion.left_fore = 100 - 17 * (i % 4);
    companion.right_arm = 14 + 7 * (i % 2);
    companion.right_fore = 25 + 30 * (i % 3);
    companion.dress = i % 3 == 0 ? Figure::Dress::trousers : Figure::Dress::robe;
    figure(mesh, turned(moved(place, {0, 0.2, 0}), 12.0 * (i % 3 - 1)), companion);
  }
}

void poet(Mesh& mesh, const Frame& f) {
  const double h = 4.4;
  Figure poet_figure;
  poet_figure.height = h;
  poet_figure.cloth = poet_figure.skin = poet_figure.hair = Surface::bronze;
  poet_figure.dress = Figure::Dress::trousers;
  poet_figure.left_arm = 22;
  poet_figure.left_fore = 95;
  poet_figure.right_arm = 38;
  poet_figure.right_fore = 30;
  poet_figure.stride = 9;
  lathe(mesh, Surface::bronze, f, {{0.85, -0.01}, {0.85, 0.08}, {0.78, 0.14}, {0, 0.14}}, 8, Shading::faceted,
        kOctagon);
  const Frame feet = moved(f, {0, 0.14, 0});
  figure(mesh, feet, poet_figure);
  // The cloak: from shoulder to shoulder behind, widening and falling in folds.
  surface_grid(mesh, Surface::bronze, divisions(mesh.detail, 26, 10), divisions(mesh.detail, 10, 4),
               [&](double u, double v) {
                 const double down = 1 - v, a = (0.62 + 0.76 * u) * 2 * kPi;  // behind the back
                 const double r = h * (0.115 + 0.10 * down) * (1 + 0.09 * down * std::cos(11 * a));
                 return point(feet, {-r * 1.05 * std::cos(a - kPi / 2), h * (0.12 + 0.70 * v),
                                     0.9 * r * std::sin(a - kPi / 2)});
               },
               Ends::open, {1, 1});
  // A ruff, a laurel crown, the book in the left hand and the sword at the right side.
  lathe(mesh, Surface::bronze, feet,
        {{0.03 * h, 0.855 * h}, {0.075 * h, 0.862 * h}, {0.075 * h, 0.872 * h}, {0.03 * h, 0.885 * h}},
        divisions(mesh.detail, 16, 8));
  lathe(mesh, Surface::bronze, feet, {{0.048 * h, 0.945 * h}, {0.062 * h, 0.952 * h}, {0.048 * h, 0.968 * h}},
        divisions(mesh.detail, 14, 8));
  box(mesh, Surface::bronze, turned(moved(feet, {0.19 * h, 0.60 * h, 0.16 * h}), -25),
      {-0.05 * h, 0, -0.015 * h}, {0.05 * h, 0.14 * h, 0.02 * h});
  bar(mesh, Surface::bronze, feet, {-0.235 * h, 0.60 * h, 0.12 * h}, {-0.21 * h, 0.01, 0.17 * h}, 0.035, 6);
  bar(mesh, Surface::bronze, feet, {-0.29 * h, 0.55 * h, 0.12 * h}, {-0.17 * h, 0.55 * h, 0.13 * h}, 0.03, 6);
}

// Iron posts and hanging chains keep the carriages off the steps.
void chains(Mesh& mesh, const Frame& f) {
  const int posts = 16;
  const double radius = 6.5, sag = 0.28, hook = 0.72;
  for (int i = 0; i < posts; ++i) {
    const Frame at = moved(turned(f, 360.0 * i / posts), {0, 0, radius});
    lathe(mesh, Surface::iron, at,
          {{0.13, 0},
           {0.13, 0.1},
           {0.08, 0.15},
           {0.065, 0.6},
           {0.09, 0.64},
           {0.09, 0.7},
           {0.06, 0.74},
           {0.1, 0.84},
           {0.06, 0.93},
           {0, 0.95}},
          divisions(mesh.detail, 10, 5));
    const Vec3d a =
        point(f, {radius * std::sin(2 * kPi * i / posts), hook, radius * std::cos(2 * kPi * i / posts)});
    const Vec3d b = point(f, {radius * std::sin(2 * kPi * (i + 1) / posts), hook,
                              radius * std::cos(2 * kPi * (i + 1) / posts)});
    std::vector<Vec3d> path;
    const int links = divisions(mesh.detail, 10, 4);
    for (int k = 0; k <= links; ++k) {
      const double t = static_cast<double>(k) / links;
      path.push_back(a + (b - a) * t + Vec3d{0, -4 * sag * t * (1 - t), 0});
    }
    tube(mesh, Surface::iron, path, std::vector<double>(path.size(), 0.025), 4);
  }
}

}  // namespace

void monument(Mesh& mesh, const Frame& f) {
  begin_group(mesh, "monument");
  steps(mesh, f);
  pedestal(mesh, f);
  if (!is_bare(mesh.detail)) companions(mesh, f);
  poet(mesh, moved(f, {0, kShaftTop, 0}));
  if (!is_bare(mesh.detail)) chains(mesh, f);
}

}  // namespace plaza
