#include "kdtree/shapes.h"

#include "math/elementary.h"

namespace vitral {
namespace {

constexpr double kPi = 3.141592653589793;

// A flat piece: where its texture coordinates lead, and what they are at its middle.
ShapePoint on_flat(const Vec3d& position, const Vec3d& normal, const Vec3d& u, const Vec3d& v, double slope,
                   double middle) {
  return {position,
          normal,
          u,
          v,
          slope,
          slope,
          {narrow(middle + dot(position, u) * slope), narrow(middle + dot(position, v) * slope)},
          0,
          0};
}

ShapePoint on_top(const Vec3d& p, double slope, double middle) {
  return on_flat(p, {0, 1, 0}, {1, 0, 0}, {0, 0, -1}, slope, middle);
}
ShapePoint on_bottom(const Vec3d& p) {
  return on_flat(p, {0, -1, 0}, {1, 0, 0}, {0, 0, 1}, 0.5, 0.5);
}

double longitude(const Vec3d& p) {
  return 0.5 + arc_tangent(p.x, p.z) / (2 * kPi);
}

// Next to the poles the texture is pressed together without bounds: this is enough for any picture.
constexpr double kLeastCosine = 1e-6;

ShapePoint on_sphere(const Vec3d& p) {
  const Vec3d n = normalize(p);
  const double cosine = square_root(n.x * n.x + n.z * n.z);
  const bool pole = !(cosine > kLeastCosine);
  const Vec3d u = pole ? Vec3d{1, 0, 0} : Vec3d{n.z / cosine, 0, -n.x / cosine};
  const double latitude = arc_tangent(n.y, cosine);
  return {n,
          n,
          u,
          cross(n, u),
          1 / (2 * kPi * (pole ? kLeastCosine : cosine)),
          1 / kPi,
          {narrow(longitude(n)), narrow(0.5 + latitude / kPi)},
          1,
          1};
}

ShapePoint on_cylinder(const Vec3d& p) {
  const double radius = square_root(p.x * p.x + p.z * p.z);
  if (absolute(p.y) > radius)
    return p.y > 0 ? on_top({p.x, 1, p.z}, 0.5, 0.5) : on_bottom({p.x, -1, p.z});
  const Vec3d n{p.x / radius, 0, p.z / radius};
  return {{n.x, p.y, n.z},
          n,
          {n.z, 0, -n.x},
          {0, 1, 0},
          1 / (2 * kPi),
          0.5,
          {narrow(longitude(n)), narrow(0.5 + p.y * 0.5)},
          1,
          0};
}

ShapePoint on_box(const Vec3d& p) {
  const double x = absolute(p.x), y = absolute(p.y), z = absolute(p.z);
  if (y >= x && y >= z)
    return p.y > 0 ? on_top({p.x, 1, p.z}, 0.5, 0.5) : on_bottom({p.x, -1, p.z});
  if (x >= z) {
    const double side = p.x > 0 ? 1 : -1;
    return on_flat({side, p.y, p.z}, {side, 0, 0}, {0, 0, -side}, {0, 1, 0}, 0.5, 0.5);
  }
  const double side = p.z > 0 ? 1 : -1;
  return on_flat({p.x, p.y, side}, {0, 0, side}, {side, 0, 0}, {0, 1, 0}, 0.5, 0.5);
}

}  // namespace

ShapePoint shape_point(Shape shape, const Vec3d& origin, const Vec3d& direction, double t) {
  const Vec3d p = origin + direction * t;
  switch (shape) {
    case Shape::sphere:
      return on_sphere(p);
    case Shape::cylinder:
      return on_cylinder(p);
    case Shape::box:
      return on_box(p);
    case Shape::disk:
      return on_top({p.x, 0, p.z}, 0.5, 0.5);
    default:
      return on_top({p.x, 0, p.z}, 1, 0);
  }
}

double exact_end(const LineSpan<double>& span, float t) {
  return narrow(span.enter) == t ? span.enter : span.leave;
}

Box shape_bounds(Shape shape) {
  const float flat = shape == Shape::disk || shape == Shape::plane ? 0.0f : 1.0f;
  const float wide = shape == Shape::plane ? __builtin_inff() : 1.0f;
  return {{-wide, -flat, -wide}, {wide, flat, wide}};
}

}  // namespace vitral
