// People, of stone, bronze or flesh: drapery on an oval trunk, a head, tubes for limbs. Measures are
// parts of the figure's height.
#include <algorithm>
#include <cmath>

#include "parts.h"

namespace plaza {
namespace {

struct Section {
  double y, rx, rz;  // half axes of the body at this height
};

Section section_at(const std::vector<Section>& body, double t) {
  const double x = t * static_cast<double>(body.size() - 1);
  const size_t i = std::min(static_cast<size_t>(x), body.size() - 2);
  const double f = x - static_cast<double>(i);
  const Section &a = body[i], &b = body[i + 1];
  return {a.y + (b.y - a.y) * f, a.rx + (b.rx - a.rx) * f, a.rz + (b.rz - a.rz) * f};
}

// Drapery hangs in folds that die out toward the shoulders.
void trunk(Mesh& mesh, const Frame& f, const Figure& figure, const std::vector<Section>& body, double folds) {
  const double h = figure.height;
  surface_grid(mesh, figure.cloth, divisions(mesh.detail, 16, 7), divisions(mesh.detail, 11, 5),
               [&](double u, double v) {
                 const Section s = section_at(body, v);
                 const double a = u * 2 * kPi;
                 const double fold = 1 + folds * std::max(0.0, 0.75 - v) * std::cos(7 * a + 3 * v) +
                                     0.03 * std::cos(3 * a + 9 * v);
                 return point(f, {h * s.rx * fold * std::sin(a), h * s.y, h * s.rz * fold * std::cos(a)});
               },
               Ends::closed, {2, 2});
}

void limb(Mesh& mesh, Surface surface, const Frame& f, const std::vector<Vec3d>& joints,
          const std::vector<double>& radii) {
  std::vector<Vec3d> path;
  for (const Vec3d& j : joints) path.push_back(point(f, j));
  tube(mesh, surface, path, radii, divisions(mesh.detail, 7, 4));
}

void arm(Mesh& mesh, const Frame& f, const Figure& figure, double side, double lift, double bend) {
  const double h = figure.height, a = lift * kPi / 180, b = bend * kPi / 180;
  const Vec3d shoulder{side * 0.105 * h, 0.795 * h, 0};
  const Vec3d elbow = shoulder + Vec3d{side * std::sin(a), -std::cos(a), 0.05} * (0.17 * h);
  const Vec3d wrist =
      elbow + normalize(Vec3d{side * std::sin(a) * std::cos(b), -std::cos(a) * std::cos(b), std::sin(b)}) *
                  (0.15 * h);
  const Vec3d inside = shoulder - Vec3d{side * 0.045 * h, 0.01 * h, 0};
  limb(mesh, figure.cloth, f, {inside, (shoulder + elbow) * 0.5, elbow, wrist},
       {0.042 * h, 0.036 * h, 0.031 * h, 0.024 * h});
  ellipsoid(mesh, figure.skin, moved(f, wrist), {0.023 * h, 0.03 * h, 0.023 * h},
            divisions(mesh.detail, 7, 4));
}

void leg(Mesh& mesh, Surface cloth, Surface shoe, const Frame& f, double h, double side, double swing) {
  const double a = swing * kPi / 180;
  const Vec3d hip{side * 0.048 * h, 0.5 * h, 0};
  const Vec3d knee = hip + Vec3d{0, -std::cos(a), std::sin(a)} * (0.24 * h);
  const Vec3d foot{side * 0.05 * h, 0.03 * h, knee.z + std::sin(a * 0.6) * 0.2 * h};
  limb(mesh, cloth, f, {hip, knee, foot}, {0.062 * h, 0.046 * h, 0.034 * h});
  ellipsoid(mesh, shoe, moved(f, foot + Vec3d{0, -0.01 * h, 0.03 * h}), {0.028 * h, 0.02 * h, 0.065 * h},
            divisions(mesh.detail, 7, 4));
}

}  // namespace

void figure(Mesh& mesh, const Frame& f, const Figure& figure) {
  const double h = figure.height;
  const std::vector<Section> neck_up{{0.60, 0.092, 0.075},  {0.70, 0.118, 0.085}, {0.77, 0.125, 0.078},
                                     {0.815, 0.105, 0.062}, {0.835, 0.055, 0.05}, {0.87, 0.034, 0.036}};
  std::vector<Section> body;
  if (figure.dress == Figure::Dress::robe) {
    body = {{0, 0.148, 0.128}, {0.12, 0.138, 0.118}, {0.3, 0.122, 0.102}, {0.47, 0.108, 0.092}};
  } else {
    body = {{0.44, 0.108, 0.088}, {0.5, 0.105, 0.085}};
    const bool statue = figure.skin == figure.cloth;
    const Surface cloth = statue ? figure.cloth : Surface::cloth_grey;
    leg(mesh, cloth, figure.hair, f, h, 1, figure.stride);
    leg(mesh, cloth, figure.hair, f, h, -1, -figure.stride);
  }
  body.insert(body.end(), neck_up.begin(), neck_up.end());
  trunk(mesh, f, figure, body, figure.dress == Figure::Dress::robe ? 0.13 : 0.0);
  const int around = divisions(mesh.detail, 10, 5);
  ellipsoid(mesh, figure.skin, moved(f, {0, 0.925 * h, 0.006 * h}), {0.045 * h, 0.066 * h, 0.054 * h},
            around);
  ellipsoid(mesh, figure.hair, moved(f, {0, 0.945 * h, -0.012 * h}), {0.05 * h, 0.056 * h, 0.054 * h},
            around);
  arm(mesh, f, figure, 1, figure.left_arm, figure.left_fore);
  arm(mesh, f, figure, -1, figure.right_arm, figure.right_fore);
}

}  // namespace plaza
