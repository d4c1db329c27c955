// The paving: a raised island of calcada inside a ring of roadway, and sidewalks along the walls.
#include <algorithm>
#include <cmath>

#include "parts.h"

namespace plaza {
namespace {

// A level rectangle, divided by the detail; every piece lies in the same plane.
void level_field(Mesh& mesh, Surface surface, double x0, double x1, double z0, double z1, double y) {
  const double metres = 8 / std::sqrt(std::max(0.25, mesh.detail.level));
  const int nx = std::max(1, static_cast<int>((x1 - x0) / metres)),
            nz = std::max(1, static_cast<int>((z1 - z0) / metres));
  const double tile = tile_size(surface);
  for (int j = 0; j < nz; ++j) {
    for (int i = 0; i < nx; ++i) {
      const double a = x0 + (x1 - x0) * i / nx, b = x0 + (x1 - x0) * (i + 1) / nx;
      const double c = z0 + (z1 - z0) * j / nz, d = z0 + (z1 - z0) * (j + 1) / nz;
      const auto uv = [&](double x, double z) { return Vec2d{x / tile, -z / tile}; };
      quad_uv(mesh, surface, {Vec3d{a, y, d}, {b, y, d}, {b, y, c}, {a, y, c}},
              {uv(a, d), uv(b, d), uv(b, c), uv(a, c)}, {0, 1, 0});
    }
  }
}

struct Rectangle {
  double x0, x1, z0, z1;
};
Rectangle shrunk(const Rectangle& r, double by) {
  return {r.x0 + by, r.x1 - by, r.z0 + by, r.z1 - by};
}

// Four strips with mitred corners between two rectangles; v of the texture runs across the strip.
void border(Mesh& mesh, Surface surface, const Rectangle& outer, double width, double y) {
  const Rectangle inner = shrunk(outer, width);
  const std::array<Vec3d, 4> o{Vec3d{outer.x0, y, outer.z1},
                               {outer.x1, y, outer.z1},
                               {outer.x1, y, outer.z0},
                               {outer.x0, y, outer.z0}};
  const std::array<Vec3d, 4> n{Vec3d{inner.x0, y, inner.z1},
                               {inner.x1, y, inner.z1},
                               {inner.x1, y, inner.z0},
                               {inner.x0, y, inner.z0}};
  for (size_t i = 0; i < 4; ++i) {
    const size_t k = (i + 1) % 4;
    const double length_outer = length(o[k] - o[i]);
    const double repeats = std::round(length_outer / width), inset = width / length_outer * repeats;
    quad_uv(mesh, surface, {o[i], o[k], n[k], n[i]},
            {Vec2d{0, 0}, {repeats, 0}, {repeats - inset, 1}, {inset, 1}}, {0, 1, 0});
  }
}

// A kerb of stone around a rectangle that stands `height` over the road; its top is a band.
enum class Facing { outward, inward };
void kerb(Mesh& mesh, const Rectangle& r, double y, Facing facing) {
  const double band = 0.3;
  const auto wall = [&](double x0, double z0, double x1, double z1) {
    quad(mesh, Surface::kerb, {x0, 0, z0}, {x1, 0, z1}, {x1, y, z1}, {x0, y, z0});
  };
  if (facing == Facing::outward) {
    wall(r.x0, r.z1, r.x1, r.z1);
    wall(r.x1, r.z1, r.x1, r.z0);
    wall(r.x1, r.z0, r.x0, r.z0);
    wall(r.x0, r.z0, r.x0, r.z1);
    border(mesh, Surface::kerb, r, band, y);
  } else {
    wall(r.x1, r.z1, r.x0, r.z1);
    wall(r.x1, r.z0, r.x1, r.z1);
    wall(r.x0, r.z0, r.x1, r.z0);
    wall(r.x0, r.z1, r.x0, r.z0);
    border(mesh, Surface::kerb, shrunk(r, -band), band, y);
  }
}

// Two polished rails that stand a finger's breadth out of the setts.
void rails(Mesh& mesh, double z, double x0, double x1) {
  const double gauge = 0.9;
  for (const double offset : {-gauge / 2, gauge / 2}) {
    const Frame f{{0, 0, z + offset}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    box(mesh, Surface::steel, f, {x0, -0.02, -0.035}, {x1, 0.012, 0.035}, kTop | kFront | kBack);
  }
}

}  // namespace

void ground(Mesh& mesh, const Plan& plan) {
  begin_group(mesh, "ground");
  const Rectangle walls{plan.west, plan.east, plan.south, plan.north};
  const Rectangle road = shrunk(walls, plan.sidewalk), island = shrunk(road, plan.road);
  const double y = plan.curb;

  // The roadway lies under everything, far beyond the houses.
  level_field(mesh, Surface::setts, walls.x0 - 60, walls.x1 + 60, walls.z0 - 60, walls.z1 + 90, 0);
  rails(mesh, road.z1 - 1.9, walls.x0 - 40, walls.x1 + 4);
  rails(mesh, road.z0 + 3.7, walls.x0 - 40, walls.x1 + 4);
  rails(mesh, island.z1 + 1.5, walls.x0 - 40, walls.x1 + 4);

  // The island: kerb, frieze, then the wide sea. The compass rose is laid on it, one stone high.
  kerb(mesh, island, y, Facing::outward);
  const Rectangle frieze = shrunk(island, 0.3), sea = shrunk(frieze, 1.6);
  border(mesh, Surface::calcada_frieze, frieze, 1.6, y);
  level_field(mesh, Surface::calcada_wave, sea.x0, sea.x1, sea.z0, sea.z1, y);
  const Vec3d& m = plan.monument;
  const double radius = 10.5;
  const int around = divisions(mesh.detail, 64, 16);
  for (int i = 0; i < around; ++i) {
    const auto rim = [&](int k, double r, double h) {
      const double a = 2 * kPi * (k % around) / around;
      return Vec3d{m.x + r * std::sin(a), h, m.z + r * std::cos(a)};
    };
    const auto uv = [&](const Vec3d& p) {
      return Vec2d{0.5 + (p.x - m.x) / (2 * radius), 0.5 - (p.z - m.z) / (2 * radius)};
    };
    const Vec3d a = rim(i, radius, y + 0.03), b = rim(i + 1, radius, y + 0.03), c = rim(i + 1, 2, y + 0.03),
                d = rim(i, 2, y + 0.03);
    quad_uv(mesh, Surface::rosette, {a, b, c, d}, {uv(a), uv(b), uv(c), uv(d)}, {0, 1, 0});
    quad(mesh, Surface::kerb, rim(i, radius + 0.12, y - 0.01), rim(i + 1, radius + 0.12, y - 0.01), b, a);
  }

  // Sidewalks: a frame between the walls and the road, reaching a little under the houses.
  kerb(mesh, road, y, Facing::inward);
  const double in = 0.3, out = 0.6;
  const Rectangle inner = shrunk(road, -in), outer = shrunk(walls, -out);
  level_field(mesh, Surface::calcada_plain, outer.x0, outer.x1, inner.z1, outer.z1, y);
  level_field(mesh, Surface::calcada_plain, outer.x0, outer.x1, outer.z0, inner.z0, y);
  level_field(mesh, Surface::calcada_plain, outer.x0, inner.x0, inner.z0, inner.z1, y);
  level_field(mesh, Surface::calcada_plain, inner.x1, outer.x1, inner.z0, inner.z1, y);
}

}  // namespace plaza
