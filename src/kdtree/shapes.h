// Rays meet exact shapes, in their own space (vitral/scene.h) and in double.
//
// A convex body keeps one piece of the line of a ray: what lies between its two ends is inside. The planes
// and slabs give their ends by one division; sphere and cylinder by a quadratic that is solved from the point
// of the line that is nearest to their middle, which leaves nothing to cancel when the ray starts far away.
// Both ends are looked at, so that rays from inside meet the far one.
//
// Texture coordinates, upright and not mirrored for who sees the front:
//   sphere    u the longitude, 0..1, 1/2 towards +z; v the latitude, 0 at the south pole (-y), 1 at the north
//   cylinder  u the longitude, v = (y + 1) / 2; the caps as the disk, the lower one mirrored in z
//   box       every face 0..1 in both
//   plane     u = x, v = -z: repeats with every unit
//   disk      u = (x + 1) / 2, v = (1 - z) / 2
#pragma once
#include "math/scalar.h"
#include "vitral/scene.h"

namespace vitral {

// The piece of a line inside a body, by its parameter; enter > leave: none. Plane and disk have enter ==
// leave.
template <class D>
struct LineSpan {
  D enter, leave;
};

// Between the planes -1 and 1 of one axis. A line along them is inside for good or not at all.
template <class D>
static inline LineSpan<D> slab_span(const D& origin, const D& direction) {
  const D none = D(0.0), one = D(1.0), endless = D(__builtin_inf());
  const auto along = direction == none;
  const D d = select(along, one, direction);
  const D a = (-one - origin) / d, b = (one - origin) / d;
  const auto within = absolute(origin) <= one;
  return {select(along, select(within, -endless, endless), least(a, b)),
          select(along, select(within, endless, -endless), greatest(a, b))};
}

// Of the ball |p| <= 1, or of the disk |p| <= 1 where the third components are 0. A direction of length 0 is
// inside for good or not at all.
template <class D>
static inline LineSpan<D> round_span(const Vec3T<D>& origin, const Vec3T<D>& direction) {
  const D none = D(0.0), one = D(1.0), endless = D(__builtin_inf());
  const D squared = dot(direction, direction);
  const auto still = squared == none;
  const D over = one / select(still, one, squared);
  const D middle = -(dot(origin, direction) * over);
  const Vec3T<D> nearest = origin + direction * middle;
  const D room = one - dot(nearest, nearest);
  const auto meets = room >= none;
  const D half = square_root(select(meets, room, none) * over);
  const auto within = both(still, meets);
  return {select(within, -endless, select(both(meets, invert(still)), middle - half, endless)),
          select(within, endless, select(both(meets, invert(still)), middle + half, -endless))};
}

template <class D>
static inline LineSpan<D> plane_span(const Vec3T<D>& origin, const Vec3T<D>& direction) {
  const D none = D(0.0);
  const auto along = direction.y == none;
  const D t = -origin.y / select(along, D(1.0), direction.y);
  const D endless = D(__builtin_inf());
  return {select(along, endless, t), select(along, -endless, t)};
}

template <class D>
static inline LineSpan<D> intersection(const LineSpan<D>& a, const LineSpan<D>& b) {
  return {greatest(a.enter, b.enter), least(a.leave, b.leave)};
}

// `shape` is not a mesh.
template <class D>
static inline LineSpan<D> shape_span(Shape shape, const Vec3T<D>& o, const Vec3T<D>& d) {
  switch (shape) {
    case Shape::sphere:
      return round_span(o, d);
    case Shape::box:
      return intersection(slab_span(o.y, d.y), intersection(slab_span(o.x, d.x), slab_span(o.z, d.z)));
    case Shape::cylinder:
      return intersection(slab_span(o.y, d.y),
                          round_span(Vec3T<D>{o.x, D(0.0), o.z}, Vec3T<D>{d.x, D(0.0), d.z}));
    case Shape::disk: {
      const LineSpan<D> plane = plane_span(o, d);
      const D x = o.x + d.x * plane.enter, z = o.z + d.z * plane.enter;
      const auto inside = x * x + z * z <= D(1.0);
      return {plane.enter, select(inside, plane.leave, D(-__builtin_inf()))};
    }
    default:
      return plane_span(o, d);
  }
}

// The nearer end of the span that is in (tmin, tmax), as t of the hit.
template <class F, class M>
struct ShapeMeet {
  M hit;
  F t;
};
template <class F, class D>
static inline auto nearest_end(const LineSpan<D>& span, const F& tmin, const F& tmax) {
  const F enter = narrow(span.enter), leave = narrow(span.leave);
  const F t = select(enter > tmin, enter, leave);
  using M = decltype(t > tmin);
  return ShapeMeet<F, M>{both(span.enter <= span.leave, both(t > tmin, t < tmax)), t};
}

// What is at one end of a span: all in the shape's own space.
struct ShapePoint {
  Vec3d position;           // on the shape, as exact as doubles are
  Vec3d normal;             // unit, to the outside; of plane and disk (0, 1, 0)
  Vec3d along_u, along_v;   // unit tangents; along_u x along_v = normal
  double slope_u, slope_v;  // of u along along_u, of v along along_v
  Vec2 texcoord;
  double turn_u, turn_v;  // curvature, 1/radius: how fast the normal turns along along_u and along_v
};
ShapePoint shape_point(Shape shape, const Vec3d& origin, const Vec3d& direction, double t);

// The exact end of the span whose t, rounded, a hit has.
double exact_end(const LineSpan<double>& span, float t);

// In its own space; of the plane without end along x and z.
Box shape_bounds(Shape shape);

}  // namespace vitral
