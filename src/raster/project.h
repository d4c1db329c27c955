// From the world to the screen: points to pixels, triangles to planes of inverse depth. Generic in width.
#pragma once
#include "math/scalar.h"
#include "raster/raster.h"

namespace vitral {

// (X, Y, W) of a point, W as z.
template <class D>
static inline Vec3T<D> project(const Projection& p, const Vec3T<D>& point) {
  const auto same = [](const Vec3d& v) { return Vec3T<D>{D(v.x), D(v.y), D(v.z)}; };
  const Vec3T<D> d = point - same(p.origin);
  return {dot(same(p.row_x), d), dot(same(p.row_y), d), dot(same(p.row_w), d)};
}

// The clip planes: the near plane W = near, and the four sides of the guard band.
inline constexpr int kClipPlanes = 5;

// Not negative inside; `v` as from project().
template <class D>
static inline D plane_distance(const Vec3T<D>& v, int plane, double near) {
  const D guard = D(static_cast<double>(kGuardBand)) * v.z;
  return plane == 0   ? v.z - D(near)
         : plane == 1 ? v.x + guard
         : plane == 2 ? guard - v.x
         : plane == 3 ? v.y + guard
                      : guard - v.y;
}

// A bit for every plane that the vertex is outside of; NaN is outside.
template <class U, class D>
static inline U outside_planes(const Vec3T<D>& v, double near) {
  U outside = U(0);
  for (int plane = 0; plane < kClipPlanes; ++plane)
    outside = outside | select(plane_distance(v, plane, near) >= D(0.0), U(0), U(1u << plane));
  return outside;
}

// To 2^-kFineBits pixel, rounded down. Clipped vertices may overshoot the guard band by a rounding.
template <class I, class D>
static inline I fine_place(const D& pixels) {
  const D limit = D(static_cast<double>(kGuardBand + 1));
  const D raised = select(pixels < -limit, -limit, pixels);
  const D scaled = select(raised > limit, limit, raised) * D(static_cast<double>(1 << kFineBits));
  const I whole = to_int(scaled);
  return whole - select(to_double(whole) > scaled, I(1), I(0));
}

// From 2^-kFineBits to the nearest 1/256 pixel, halves up. As the fine place is rounded down, this is the
// same as if the exact one were rounded.
template <class I>
static inline I snapped(const I& fine) {
  constexpr int drop = kFineBits - kSubpixelBits;
  return (fine + I(1 << (drop - 1))) >> drop;
}

// Inverse depth over the screen in pixels: across * x + down * y + at_0.
template <class D>
struct InverseDepth {
  D across, down, at_0;
};

// That of the plane through three points (X, Y, W), seen or not: with (a, b, c) . (X, Y, W) = 1 at the
// corners, 1 / W = a X / W + b Y / W + c (Olano and Greer, "Triangle Scan Conversion using 2D Homogeneous
// Coordinates", 1997). A triangle seen exactly from the side has no such plane: it is given `otherwise`.
template <class D>
static inline InverseDepth<D> inverse_depth_plane(const Vec3T<D>& a, const Vec3T<D>& b, const Vec3T<D>& c,
                                                  const D& otherwise) {
  const Vec3T<D> n = cross(b - a, c - a);
  const D det = dot(a, n);
  const InverseDepth<D> plane{n.x / det, n.y / det, n.z / det};
  // Within these bounds the fill's sums are finite in float; NaN fails the test, too.
  const D steepest = D(1e30), farthest = D(1e36), zero = D(0.0);
  const auto usable = both(both(absolute(plane.across) <= steepest, absolute(plane.down) <= steepest),
                           absolute(plane.at_0) <= farthest);
  return {select(usable, plane.across, zero), select(usable, plane.down, zero),
          select(usable, plane.at_0, otherwise)};
}

// The inverse depth at the centre of a pixel.
template <class D>
static inline D at_center(const InverseDepth<D>& plane, const D& x, const D& y) {
  return (plane.at_0 + plane.across * (x + D(0.5))) + plane.down * (y + D(0.5));
}

}  // namespace vitral
