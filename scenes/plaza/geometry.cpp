#include "geometry.h"

#include <algorithm>
#include <cmath>

namespace plaza {

Vec3d direction(const Frame& f, const Vec3d& v) {
  return f.x * v.x + f.y * v.y + f.z * v.z;
}
Vec3d point(const Frame& f, const Vec3d& p) {
  return f.origin + direction(f, p);
}

Frame moved(const Frame& f, const Vec3d& p) {
  return {point(f, p), f.x, f.y, f.z};
}
Frame turned(const Frame& f, double degrees) {
  const double c = std::cos(degrees * kPi / 180), s = std::sin(degrees * kPi / 180);
  return {f.origin, f.x * c - f.z * s, f.y, f.z * c + f.x * s};
}
Frame leaned(const Frame& f, double degrees) {
  const double c = std::cos(degrees * kPi / 180), s = std::sin(degrees * kPi / 180);
  return {f.origin, f.x, f.y * c + f.z * s, f.z * c - f.y * s};
}
Frame tilted(const Frame& f, double degrees) {
  const double c = std::cos(degrees * kPi / 180), s = std::sin(degrees * kPi / 180);
  return {f.origin, f.x * c + f.y * s, f.y * c - f.x * s, f.z};
}

bool is_bare(const Detail& detail) {
  return detail.level < 0.08;
}
bool is_coarse(const Detail& detail) {
  return detail.level < 0.2;
}
int many(const Detail& detail, double base, int least) {
  return std::max(least, static_cast<int>(std::lround(base * detail.level)));
}
int divisions(const Detail& detail, double base, int least) {
  return std::max(least, static_cast<int>(std::lround(base * std::sqrt(detail.level))));
}

void begin_group(Mesh& mesh, const std::string& name) {
  mesh.groups.push_back(name);
}

// Normals are few and often equal: they are shared when their first three decimals are.
uint32_t add_normal(Mesh& mesh, const Vec3d& n) {
  const auto key = [](double c) { return static_cast<uint64_t>(std::llround(c * 1000) + 2048); };
  const uint64_t k = key(n.x) | key(n.y) << 16 | key(n.z) << 32;
  const auto [entry, is_new] = mesh.normal_index.try_emplace(k, static_cast<uint32_t>(mesh.normals.size()));
  if (is_new) mesh.normals.push_back(n);
  return entry->second;
}

namespace {

// World metres on the plane of the face: u runs level, v runs up the slope.
Vec2d planar(const Vec3d& p, const Vec3d& n, double tile) {
  Vec3d level{1, 0, 0}, slope{0, 0, -1};
  if (std::fabs(n.y) < 0.999) {
    level = normalize(cross(Vec3d{0, 1, 0}, n));
    slope = cross(n, level);
  }
  return {dot(p, level) / tile, dot(p, slope) / tile};
}

template <size_t N>
void flat_face(Mesh& mesh, Surface surface, const std::array<Vec3d, N>& corners) {
  const Vec3d area = cross(corners[1] - corners[0], corners[2] - corners[0]) +
                     cross(corners[2] - corners[0], corners[N - 1] - corners[0]);
  if (length(area) < 1e-8) return;
  const Vec3d n = normalize(area);
  Face face;
  face.corners = static_cast<uint8_t>(N);
  face.surface = surface;
  face.group = static_cast<uint16_t>(mesh.groups.size() - 1);
  for (size_t i = 0; i < N; ++i) {
    face.positions[i] = static_cast<uint32_t>(mesh.positions.size());
    face.texcoords[i] = static_cast<uint32_t>(mesh.texcoords.size());
    mesh.positions.push_back(corners[i]);
    mesh.texcoords.push_back(planar(corners[i], n, tile_size(surface)));
    face.normals[i] = add_normal(mesh, n);
  }
  mesh.faces.push_back(face);
}

}  // namespace

void triangle(Mesh& mesh, Surface surface, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  flat_face<3>(mesh, surface, {a, b, c});
}
void quad(Mesh& mesh, Surface surface, const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  // Two corners that fall together leave a triangle.
  constexpr double same = 2e-4;
  if (length(b - a) < same || length(c - b) < same) return triangle(mesh, surface, a, c, d);
  if (length(d - c) < same || length(a - d) < same) return triangle(mesh, surface, a, b, c);
  flat_face<4>(mesh, surface, {a, b, c, d});
}

void quad_uv(Mesh& mesh, Surface surface, const std::array<Vec3d, 4>& corners,
             const std::array<Vec2d, 4>& texcoords, const Vec3d& normal) {
  Face face;
  face.corners = 4;
  face.surface = surface;
  face.group = static_cast<uint16_t>(mesh.groups.size() - 1);
  for (size_t i = 0; i < 4; ++i) {
    face.positions[i] = static_cast<uint32_t>(mesh.positions.size());
    face.texcoords[i] = static_cast<uint32_t>(mesh.texcoords.size());
    mesh.positions.push_back(corners[i]);
    mesh.texcoords.push_back(texcoords[i]);
    face.normals[i] = add_normal(mesh, normal);
  }
  mesh.faces.push_back(face);
}

namespace {

// Corner i of a box: bit 0 is x, bit 1 is y, bit 2 is z.
Vec3d box_corner(const Frame& f, const Vec3d& min, const Vec3d& max, unsigned i) {
  return point(f, {i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z});
}

struct BoxSide {
  unsigned side;
  std::array<unsigned, 4> corners;
};
constexpr BoxSide kBoxSides[] = {{kLeft, {0, 4, 6, 2}}, {kRight, {5, 1, 3, 7}}, {kBottom, {0, 1, 5, 4}},
                                 {kTop, {6, 7, 3, 2}},  {kBack, {1, 0, 2, 3}},  {kFront, {4, 5, 7, 6}}};

}  // namespace

void box(Mesh& mesh, Surface surface, const Frame& frame, const Vec3d& min, const Vec3d& max,
         unsigned sides) {
  for (const auto& [side, c] : kBoxSides) {
    if (!(sides & side)) continue;
    quad(mesh, surface, box_corner(frame, min, max, c[0]), box_corner(frame, min, max, c[1]),
         box_corner(frame, min, max, c[2]), box_corner(frame, min, max, c[3]));
  }
}

void room(Mesh& mesh, Surface walls, Surface floor, const Frame& frame, const Vec3d& min, const Vec3d& max,
          unsigned sides) {
  for (const auto& [side, c] : kBoxSides) {
    if (!(sides & side)) continue;
    quad(mesh, side == kBottom ? floor : walls, box_corner(frame, min, max, c[3]),
         box_corner(frame, min, max, c[2]), box_corner(frame, min, max, c[1]),
         box_corner(frame, min, max, c[0]));
  }
}

void extrude(Mesh& mesh, Surface surface, const Frame& frame, const std::vector<Vec2d>& outline, double z0,
             double z1) {
  const auto at = [&](size_t i, double z) {
    const Vec2d& p = outline[i % outline.size()];
    return point(frame, {p.x, p.y, z});
  };
  for (size_t i = 0; i < outline.size(); ++i) {
    quad(mesh, surface, at(i, z1), at(i, z0), at(i + 1, z0), at(i + 1, z1));
  }
  for (size_t i = 1; i + 1 < outline.size(); ++i) {
    triangle(mesh, surface, at(0, z1), at(i, z1), at(i + 1, z1));
    triangle(mesh, surface, at(0, z0), at(i + 1, z0), at(i, z0));
  }
}

void moulding(Mesh& mesh, Surface surface, const Frame& frame, const std::vector<Vec2d>& profile, double x0,
              double x1) {
  const auto at = [&](const Vec2d& p, double x) { return point(frame, {x, p.y, p.x}); };
  for (size_t i = 0; i + 1 < profile.size(); ++i) {
    const Vec2d &p = profile[i], &q = profile[i + 1];
    quad(mesh, surface, at(p, x0), at(p, x1), at(q, x1), at(q, x0));
    // The ends: trapezia between the profile and the wall.
    if (std::fabs(q.y - p.y) < 1e-6) continue;
    const Vec2d p0{0, p.y}, q0{0, q.y};
    quad(mesh, surface, at(p0, x0), at(p, x0), at(q, x0), at(q0, x0));
    quad(mesh, surface, at(p, x1), at(p0, x1), at(q0, x1), at(q, x1));
  }
}

}  // namespace plaza
