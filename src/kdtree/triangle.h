// Ray meets triangle, watertight: no ray passes between two triangles that share an edge or a corner.
//
// After Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013: corners are
// taken relative to the ray's origin and sheared so that the ray becomes the z axis; the triangle is
// hit where its projection surrounds the origin. All triangles around a corner compute the same
// rounded projection of it, so that they tile the plane exactly as their exact images would, provided
// that the edge tests are exact for these rounded corners. They are: a product of two floats is exact
// in double, and the sign of the difference of two doubles is exact. The float test before it only
// discards: rounding is monotone, so a >= b implies round(a) >= round(b).
//
// The edge values in double also make t good for slivers seen edge-on: the hit computed lies within
// rounding of the triangle, which the traversal's slack relies on.
#pragma once
#include "math/scalar.h"
#include "vitral/vec.h"

namespace vitral {

// The axis along which the ray runs fastest is called z; x and y follow cyclically.
static inline int dominant_axis(const Vec3& d) {
  const float x = absolute(d.x), y = absolute(d.y), z = absolute(d.z);
  return x > y ? (x > z ? 0 : 2) : (y > z ? 1 : 2);
}

template <class F>
static inline Vec3T<F> permute(const Vec3T<F>& v, int z_axis) {
  return z_axis == 0 ? Vec3T<F>{v.y, v.z, v.x} : z_axis == 1 ? Vec3T<F>{v.z, v.x, v.y} : v;
}

// What a ray keeps of its direction: permuted x/z, y/z and z.
template <class F>
struct Shear {
  F x, y, z;
};
template <class F>
static inline Shear<F> make_shear(const Vec3T<F>& permuted_direction) {
  return {permuted_direction.x / permuted_direction.z, permuted_direction.y / permuted_direction.z,
          permuted_direction.z};
}

// A corner, relative to the origin and permuted, seen along the ray.
template <class F>
static inline Vec3T<F> project(const Vec3T<F>& corner, const Shear<F>& shear) {
  return {corner.x - shear.x * corner.z, corner.y - shear.y * corner.z, corner.z};
}

// Twice the signed areas that the origin makes with the edges, in float. Each is the difference of two
// products that are rounded once: its sign, where not zero, is that of the exact one or the exact one is 0.
template <class F>
static inline Vec3T<F> rounded_edge_values(const Vec3T<F>& a, const Vec3T<F>& b, const Vec3T<F>& c) {
  return {c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x};
}
template <class F>
static inline F least_of(const F& a, const F& b, const F& c) {
  return least(a, least(b, c));
}
template <class F>
static inline F greatest_of(const F& a, const F& b, const F& c) {
  return greatest(a, greatest(b, c));
}

// False where the origin is surely outside the projected triangle.
template <class F>
static inline auto may_surround_origin(const Vec3T<F>& a, const Vec3T<F>& b, const Vec3T<F>& c) {
  const Vec3T<F> e = rounded_edge_values(a, b, c);
  return either(least_of(e.x, e.y, e.z) >= F(0.0f), greatest_of(e.x, e.y, e.z) <= F(0.0f));
}

// True where a ray surely meets the triangle at t in (tmin, tmax), for tmin >= 0, without t being known.
// The edge values are off by less than 2^-23 of the largest product that goes into them, and t is a
// mean of the corners' own with weights that are all positive.
template <class F, class S>
static inline auto surely_meets(const Vec3T<F>& a, const Vec3T<F>& b, const Vec3T<F>& c, const S& shear,
                                const F& tmin, const F& tmax) {
  const Vec3T<F> e = rounded_edge_values(a, b, c);
  const F width = greatest_of(absolute(a.x), absolute(b.x), absolute(c.x));
  const F height = greatest_of(absolute(a.y), absolute(b.y), absolute(c.y));
  const F tiny = F(1e-35f);
  const F margin = width * height * F(1.0f / 2097152) + tiny;
  const auto inside = either(least_of(e.x, e.y, e.z) > margin, greatest_of(e.x, e.y, e.z) < -margin);
  const auto forward = shear.z > F(0.0f);
  const F near = select(forward, least_of(a.z, b.z, c.z), -greatest_of(a.z, b.z, c.z));
  const F far = select(forward, greatest_of(a.z, b.z, c.z), -least_of(a.z, b.z, c.z));
  const F length = absolute(shear.z);
  const auto in_range = both(near > tmin * length * F(1.000001f) + tiny, far < tmax * length * F(0.999999f));
  return both(inside, in_range);
}

template <class F, class M>
struct TriangleHit {
  M hit;
  F t, u, v;
};

// Twice the signed areas of the three triangles that the origin makes with the edges of the projected
// one, exact but for one rounding each, and their sum. u lies across from corner a, and so on.
template <class D>
struct EdgeValues {
  D u, v, w, det;
};
template <class F>
static inline auto edge_values(const Vec3T<F>& a, const Vec3T<F>& b, const Vec3T<F>& c) {
  const auto ax = widen(a.x), ay = widen(a.y), bx = widen(b.x), by = widen(b.y), cx = widen(c.x),
             cy = widen(c.y);
  using D = decltype(widen(a.x));
  const D u = cx * by - cy * bx;
  const D v = ax * cy - ay * cx;
  const D w = bx * ay - by * ax;
  return EdgeValues<D>{u, v, w, (u + v) + w};
}

// The exact test and, where it hits, t and the barycentrics: u belongs to corner b, v to c.
template <class F, class D>
static inline auto surround_origin(const Vec3T<F>& a, const Vec3T<F>& b, const Vec3T<F>& c,
                                   const Shear<F>& shear, const EdgeValues<D>& e) {
  // None is negative or none is positive; where both hold, all are 0 and the triangle is seen from the side.
  const D zero = D(0.0);
  const auto none_negative = least_of(e.u, e.v, e.w) >= zero,
             none_positive = greatest_of(e.u, e.v, e.w) <= zero;
  const auto inside =
      either(both(none_negative, invert(none_positive)), both(none_positive, invert(none_negative)));
  const D inverse = D(1.0) / select(inside, e.det, D(1.0));
  const D z = (e.u * widen(a.z) + e.v * widen(b.z)) + e.w * widen(c.z);
  using M = decltype(either(inside, inside));
  return TriangleHit<F, M>{inside, narrow(z * inverse / widen(shear.z)), narrow(e.v * inverse),
                           narrow(e.w * inverse)};
}
template <class F>
static inline auto surround_origin(const Vec3T<F>& a, const Vec3T<F>& b, const Vec3T<F>& c,
                                   const Shear<F>& shear) {
  return surround_origin(a, b, c, shear, edge_values(a, b, c));
}

// For a ray that just misses the triangle: the barycentrics of its point in the triangle's plane,
// each raised to 0 and then scaled so that u + v is at most 1, and t there, kept within [near, far].
// Seen exactly from the side the triangle has no such point: corner a stands in. A ray that has it
// behind its origin runs past the horizon of a large triangle: the corner farthest along stands in.
// All results are finite.
template <class F, class D>
static inline TriangleHit<F, bool> nearby_point(const Vec3T<F>& a, const Vec3T<F>& b, const Vec3T<F>& c,
                                                const Shear<F>& shear, const EdgeValues<D>& e, const F& near,
                                                const F& far) {
  const D zero = D(0.0), one = D(1.0);
  const auto from_the_side = e.det == zero;
  const D inverse = select(from_the_side, zero, one / select(from_the_side, one, e.det));
  D u = e.v * inverse, v = e.w * inverse;
  u = select(u > zero, u, zero);
  v = select(v > zero, v, zero);
  const D scale = one / select(u + v > one, u + v, one);
  u = u * scale;
  v = v * scale;

  const D ta = widen(a.z) / widen(shear.z), tb = widen(b.z) / widen(shear.z),
          tc = widen(c.z) / widen(shear.z);
  D t = (((one - u) - v) * ta + u * tb) + v * tc;
  const auto behind = t <= zero;
  const auto b_is_farthest = both(tb > ta, tb >= tc), c_is_farthest = both(tc > ta, tc > tb);
  u = select(behind, select(b_is_farthest, one, zero), u);
  v = select(behind, select(c_is_farthest, one, zero), v);
  t = select(behind, select(b_is_farthest, tb, select(c_is_farthest, tc, ta)), t);
  t = select(t > widen(near), t, widen(near));
  t = select(t < widen(far), t, widen(far));

  // Rounding must not undo u + v <= 1.
  const F u_out = narrow(u), v_out = narrow(v), room = F(1.0f) - u_out;
  return {false, narrow(t), u_out, select(v_out < room, v_out, room)};
}

}  // namespace vitral
