// The round half of the toolkit: lathes, grids, tubes, ellipsoids.
#include "geometry.h"

#include <algorithm>
#include <cmath>

namespace plaza {
namespace {

// Points that coincide once written with four decimals.
bool coincide(const Vec3d& a, const Vec3d& b) {
  return std::fabs(a.x - b.x) < 2e-4 && std::fabs(a.y - b.y) < 2e-4 && std::fabs(a.z - b.z) < 2e-4;
}

struct Corner {
  uint32_t position, texcoord, normal;
};

void round_triangle(Mesh& mesh, Surface surface, const Corner& a, const Corner& b, const Corner& c) {
  const Vec3d &p = mesh.positions[a.position], &q = mesh.positions[b.position],
              &r = mesh.positions[c.position];
  if (coincide(p, q) || coincide(q, r) || coincide(r, p)) return;
  Face face;
  face.surface = surface;
  face.group = static_cast<uint16_t>(mesh.groups.size() - 1);
  const std::array<Corner, 3> corners{a, b, c};
  for (size_t i = 0; i < 3; ++i) {
    face.positions[i] = corners[i].position;
    face.texcoords[i] = corners[i].texcoord;
    face.normals[i] = corners[i].normal;
  }
  mesh.faces.push_back(face);
}

void round_quad(Mesh& mesh, Surface surface, const Corner& a, const Corner& b, const Corner& c,
                const Corner& d) {
  round_triangle(mesh, surface, a, b, c);
  round_triangle(mesh, surface, a, c, d);
}

}  // namespace

namespace {

// A coarse mesh keeps the ends of a long profile and every third point between.
std::vector<Vec2d> thinned(const std::vector<Vec2d>& profile) {
  if (profile.size() < 6) return profile;
  std::vector<Vec2d> kept;
  for (size_t i = 0; i < profile.size(); ++i) {
    if (i % 3 == 0 || i + 1 == profile.size()) kept.push_back(profile[i]);
  }
  return kept;
}

}  // namespace

void lathe(Mesh& mesh, Surface surface, const Frame& frame, const std::vector<Vec2d>& whole, int segments,
           Shading shading, double phase) {
  const std::vector<Vec2d> profile =
      is_coarse(mesh.detail) && shading == Shading::smooth ? thinned(whole) : whole;
  const size_t rings = profile.size();
  if (rings < 2) return;
  const auto at = [&](size_t i, double angle) {
    return point(frame, {profile[i].x * std::sin(angle), profile[i].y, profile[i].x * std::cos(angle)});
  };
  const double step = 2 * kPi / segments;
  if (shading == Shading::faceted) {
    for (size_t i = 0; i + 1 < rings; ++i) {
      for (int k = 0; k < segments; ++k) {
        const double a = phase + k * step, b = phase + (k + 1) * step;
        if (profile[i].x < 1e-6) {
          triangle(mesh, surface, at(i, a), at(i + 1, b), at(i + 1, a));
        } else if (profile[i + 1].x < 1e-6) {
          triangle(mesh, surface, at(i, a), at(i, b), at(i + 1, a));
        } else {
          quad(mesh, surface, at(i, a), at(i, b), at(i + 1, b), at(i + 1, a));
        }
      }
    }
    return;
  }

  // A segment's own normal in the (radius, y) plane, and the mean with its neighbour across a soft edge.
  const auto segment_normal = [&](size_t i) {
    const double dr = profile[i + 1].x - profile[i].x, dy = profile[i + 1].y - profile[i].y;
    const double l = std::max(1e-9, std::sqrt(dr * dr + dy * dy));
    return Vec2d{dy / l, -dr / l};
  };
  const auto softened = [](const Vec2d& own, const Vec2d& other) {
    if (own.x * other.x + own.y * other.y < 0.766) return own;
    const double x = own.x + other.x, y = own.y + other.y, l = std::sqrt(x * x + y * y);
    return Vec2d{x / l, y / l};
  };
  double widest = 0;
  for (const Vec2d& p : profile) widest = std::max(widest, p.x);
  const double tile = tile_size(surface);
  const double repeats = std::max(1.0, std::round(2 * kPi * widest / tile));

  double along = 0;
  for (size_t i = 0; i + 1 < rings; ++i) {
    const Vec2d own = segment_normal(i);
    const Vec2d low = i > 0 ? softened(own, segment_normal(i - 1)) : own;
    const Vec2d high = i + 2 < rings ? softened(own, segment_normal(i + 1)) : own;
    const double dr = profile[i + 1].x - profile[i].x, dy = profile[i + 1].y - profile[i].y;
    const double next = along + std::sqrt(dr * dr + dy * dy) / tile;
    std::array<Corner, 2> previous{};
    for (int k = 0; k <= segments; ++k) {
      const double angle = phase + (k % segments) * step;
      const double u = repeats * k / segments;
      const auto corner = [&](size_t ring, const Vec2d& n, double v) {
        mesh.positions.push_back(at(ring, angle));
        mesh.texcoords.push_back({u, v});
        const Vec3d world = direction(frame, {n.x * std::sin(angle), n.y, n.x * std::cos(angle)});
        return Corner{static_cast<uint32_t>(mesh.positions.size() - 1),
                      static_cast<uint32_t>(mesh.texcoords.size() - 1), add_normal(mesh, world)};
      };
      const std::array<Corner, 2> current{corner(i, low, along), corner(i + 1, high, next)};
      if (k > 0) round_quad(mesh, surface, previous[0], current[0], current[1], previous[1]);
      previous = current;
    }
    along = next;
  }
}

void surface_grid(Mesh& mesh, Surface surface, int nu, int nv, const std::function<Vec3d(double, double)>& p,
                  Ends ends_u, const Vec2d& repeats) {
  const size_t columns = static_cast<size_t>(nu) + 1, rows = static_cast<size_t>(nv) + 1;
  std::vector<Vec3d> points(columns * rows), normals(columns * rows, Vec3d{0, 0, 0});
  for (size_t j = 0; j < rows; ++j) {
    for (size_t i = 0; i < columns; ++i) {
      const bool seam = ends_u == Ends::closed && i + 1 == columns;
      points[j * columns + i] =
          seam ? points[j * columns] : p(static_cast<double>(i) / nu, static_cast<double>(j) / nv);
    }
  }
  // Vertex normals: the areas of the cells around, summed.
  const auto add = [&](size_t i, size_t j, const Vec3d& n) { normals[j * columns + i] += n; };
  for (size_t j = 0; j + 1 < rows; ++j) {
    for (size_t i = 0; i + 1 < columns; ++i) {
      const Vec3d n = cross(points[(j + 1) * columns + i + 1] - points[j * columns + i],
                            points[(j + 1) * columns + i] - points[j * columns + i + 1]);
      add(i, j, n);
      add(i + 1, j, n);
      add(i, j + 1, n);
      add(i + 1, j + 1, n);
    }
  }
  std::vector<Corner> corners(columns * rows);
  for (size_t j = 0; j < rows; ++j) {
    if (ends_u == Ends::closed) {
      const Vec3d seam = normals[j * columns] + normals[j * columns + columns - 1];
      normals[j * columns] = normals[j * columns + columns - 1] = seam;
    }
    for (size_t i = 0; i < columns; ++i) {
      const size_t k = j * columns + i;
      const double l = length(normals[k]);
      const Vec3d n = l > 1e-12 ? normals[k] * (1 / l) : Vec3d{0, 1, 0};
      mesh.positions.push_back(points[k]);
      mesh.texcoords.push_back(
          {repeats.x * static_cast<double>(i) / nu, repeats.y * static_cast<double>(j) / nv});
      corners[k] = {static_cast<uint32_t>(mesh.positions.size() - 1),
                    static_cast<uint32_t>(mesh.texcoords.size() - 1), add_normal(mesh, n)};
    }
  }
  for (size_t j = 0; j + 1 < rows; ++j) {
    for (size_t i = 0; i + 1 < columns; ++i) {
      const size_t k = j * columns + i;
      round_quad(mesh, surface, corners[k], corners[k + 1], corners[k + columns + 1], corners[k + columns]);
    }
  }
}

void tube(Mesh& mesh, Surface surface, const std::vector<Vec3d>& path, const std::vector<double>& radii,
          int sides) {
  const size_t n = path.size();
  if (n < 2) return;
  // A frame carried along the path: its side is made perpendicular again at every point.
  std::vector<Vec3d> side(n), across(n);
  double total = 0;
  Vec3d carried{1, 0, 0};
  for (size_t i = 0; i < n; ++i) {
    const Vec3d t = normalize(path[std::min(i + 1, n - 1)] - path[i > 0 ? i - 1 : 0]);
    if (i == 0 && std::fabs(t.x) > 0.9) carried = {0, 0, 1};
    carried = normalize(carried - t * dot(carried, t));
    side[i] = carried;
    across[i] = cross(t, carried);
    if (i > 0) total += length(path[i] - path[i - 1]);
  }
  const double tile = tile_size(surface);
  const double around = std::max(1.0, std::round(2 * kPi * radii[0] / tile));
  surface_grid(mesh, surface, sides, static_cast<int>(n) - 1,
               [&](double u, double v) {
                 const size_t i = static_cast<size_t>(std::lround(v * static_cast<double>(n - 1)));
                 const double a = u * 2 * kPi;
                 return path[i] + (side[i] * std::cos(a) + across[i] * std::sin(a)) * radii[i];
               },
               Ends::closed, {around, total / tile});
}

void ellipsoid(Mesh& mesh, Surface surface, const Frame& frame, const Vec3d& r, int around) {
  surface_grid(mesh, surface, around, std::max(3, around / 2),
               [&](double u, double v) {
                 const double a = u * 2 * kPi, b = v * kPi;
                 return point(frame, {r.x * std::sin(a) * std::sin(b), -r.y * std::cos(b),
                                      r.z * std::cos(a) * std::sin(b)});
               },
               Ends::closed, {1, 1});
}

void bar(Mesh& mesh, Surface surface, const Frame& frame, const Vec3d& from, const Vec3d& to, double radius,
         int sides) {
  const Vec3d a = point(frame, from), b = point(frame, to);
  const Vec3d t = normalize(b - a);
  const Vec3d helper = std::fabs(t.y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0};
  const Frame along{a, normalize(cross(t, helper)), t, normalize(cross(cross(t, helper), t))};
  const double l = length(b - a);
  lathe(mesh, surface, along, {{0, 0}, {radius, 0}, {radius, l}, {0, l}}, sides,
        sides <= 5 ? Shading::faceted : Shading::smooth, kPi / sides);
}

}  // namespace plaza
