// Trees: a forking trunk and a crown of cut-out sprigs on several round masses of leaves.
#include <algorithm>
#include <cmath>

#include "parts.h"
#include "random.h"

namespace plaza {
namespace {

Vec3d random_direction(Random& random) {
  const double y = between(random, -1, 1), a = 2 * kPi * uniform(random), r = std::sqrt(1 - y * y);
  return {r * std::cos(a), y, r * std::sin(a)};
}

struct Mass {
  Vec3d center;
  double radius;
};

// One branch, bent a little, from `from` to `to`.
void branch(Mesh& mesh, const Vec3d& from, const Vec3d& to, double thick, double thin, Random& random) {
  const double l = length(to - from);
  const Vec3d bend = random_direction(random) * (0.08 * l);
  const int steps = divisions(mesh.detail, 4, 2);
  std::vector<Vec3d> path;
  std::vector<double> radii;
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    path.push_back(from + (to - from) * t + bend * (4 * t * (1 - t)));
    radii.push_back(thick + (thin - thick) * t);
  }
  tube(mesh, Surface::bark, path, radii, divisions(mesh.detail, thick > 0.1 ? 9 : 5, 4));
}

// Sprigs near the surface of a mass. Their shading normals point out of the crown, so that it is lit
// as a whole and not card by card.
void sprigs(Mesh& mesh, Surface surface, const Mass& mass, const Vec3d& heart, Random& random) {
  const double level = std::clamp(mesh.detail.level, 0.1, 40.0);
  const double size = 0.95 * std::pow(level, -0.33);
  const int count = many(mesh.detail, 52.0 * mass.radius * mass.radius / 1.3, 4);
  for (int i = 0; i < count; ++i) {
    const Vec3d out = random_direction(random);
    const Vec3d center = mass.center + out * (mass.radius * std::pow(uniform(random), 0.25));
    const Vec3d facing = normalize(out * 0.9 + random_direction(random));
    const Vec3d helper = random_direction(random);
    const Vec3d across = normalize(cross(facing, helper)), along = cross(facing, across);
    const double half = 0.5 * size * between(random, 0.8, 1.2);
    const Vec3d a = across * half, b = along * half;
    const Vec3d shade = normalize(normalize(center - heart) * 0.7 + facing * 0.5 + Vec3d{0, 0.15, 0});
    quad_uv(mesh, surface, {center - a - b, center + a - b, center + a + b, center - a + b},
            {Vec2d{0, 0}, {1, 0}, {1, 1}, {0, 1}}, dot(shade, facing) > 0.1 ? shade : facing);
  }
}

void tree_pit(Mesh& mesh, const Frame& f) {
  const double half = 0.75, rim = 0.14;
  lathe(mesh, Surface::kerb, f,
        {{(half + rim) * std::sqrt(2.0), 0},
         {(half + rim) * std::sqrt(2.0), 0.08},
         {half * std::sqrt(2.0), 0.08},
         {half * std::sqrt(2.0), 0.03}},
        4, Shading::faceted, kPi / 4);
  box(mesh, Surface::soil, f, {-half, 0, -half}, {half, 0.035, half}, kTop);
}

}  // namespace

void tree(Mesh& mesh, const Frame& f, Species species, double height, uint32_t seed) {
  Random random{seed, 0};
  tree_pit(mesh, f);
  const double spread = height * (species == Species::plane ? 0.30 : 0.34);
  const double fork = height * between(random, 0.30, 0.36), thick = 0.026 * height;
  const Vec3d foot = point(f, {0, 0, 0});
  const Vec3d crotch = point(f, {between(random, -0.2, 0.2), fork, between(random, -0.2, 0.2)});
  const Vec3d heart = foot + Vec3d{0, height * 0.62, 0};
  // The butt widens into the ground.
  tube(mesh, Surface::bark,
       {foot - Vec3d{0, 0.05, 0}, foot + Vec3d{0, 0.25, 0}, foot + (crotch - foot) * 0.4, crotch},
       {thick * 1.7, thick * 1.2, thick, thick * 0.9}, divisions(mesh.detail, 10, 5));

  std::vector<Mass> masses;
  const int limbs = is_bare(mesh.detail) ? 5 : 7;
  for (int i = 0; i < limbs; ++i) {
    const double a = 2 * kPi * (i + between(random, -0.25, 0.25)) / limbs;
    const bool leader = i == 0;
    const double reach = leader ? 0.2 * spread : spread * between(random, 0.65, 0.9);
    const double top = leader ? height * 0.84 : height * between(random, 0.54, 0.76);
    const Vec3d tip = foot + Vec3d{reach * std::cos(a), top, reach * std::sin(a)};
    if (!is_bare(mesh.detail)) branch(mesh, crotch, tip, thick * 0.6, 0.035, random);
    masses.push_back({tip, spread * (leader ? 0.55 : between(random, 0.42, 0.56))});
    for (int k = 0; k < 2; ++k) {
      const Vec3d from = crotch + (tip - crotch) * between(random, 0.5, 0.75);
      const Vec3d twig = from + normalize(random_direction(random) + Vec3d{0, 0.7, 0}) * (0.16 * height);
      if (!is_coarse(mesh.detail)) branch(mesh, from, twig, 0.05, 0.02, random);
      masses.push_back({twig, spread * between(random, 0.26, 0.38)});
    }
  }
  const Surface surface = species == Species::plane ? Surface::leaves : Surface::blossom;
  for (size_t i = 0; i < masses.size(); ++i) {
    // A jacaranda in bloom still shows some green.
    const bool green = species == Species::jacaranda && i % 6 == 5;
    sprigs(mesh, green ? Surface::leaves : surface, masses[i], heart, random);
  }
}

}  // namespace plaza
