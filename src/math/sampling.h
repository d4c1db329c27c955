// Directions for ambient occlusion; points of a disk.
#pragma once
#include "math/elementary.h"
#include "vitral/vec.h"

namespace vitral {

// Two tangents that make a right-handed orthonormal frame (t, b, n) with the unit vector n. After
// Duff, Burgess, Christensen, Hery, Kensler, Liani and Villemin, "Building an Orthonormal Basis,
// Revisited", JCGT 6(1), 2017.
template <class F>
static inline void tangent_frame(const Vec3T<F>& n, Vec3T<F>& t, Vec3T<F>& b) {
  const F sign = copy_sign(F(1.0f), n.z);
  const F a = F(-1.0f) / (sign + n.z);
  const F d = n.x * n.y * a;
  t = {F(1.0f) + sign * n.x * n.x * a, sign * d, -sign * n.x};
  b = {d, sign + n.y * n.y * a, -n.y};
}

// The square [0,1)^2 to the unit disk, areas kept: rings by radius sqrt(u1), around by u2.
template <class F>
static inline Vec2T<F> disk_point(const F& u1, const F& u2) {
  F sine, cosine;
  sin_cos_turn(u2, sine, cosine);
  const F r = square_root(u1);
  return {r * cosine, r * sine};
}

// The square [0,1)^2 to directions around n with density cos / pi: a disk of radius sqrt(u1) lifted to
// the hemisphere (Malley's method). Strata of the square stay strata of the hemisphere.
template <class F>
static inline Vec3T<F> cosine_hemisphere(const Vec3T<F>& t, const Vec3T<F>& b, const Vec3T<F>& n, const F& u1,
                                         const F& u2) {
  const Vec2T<F> d = disk_point(u1, u2);
  return (t * d.x + b * d.y) + n * square_root(F(1.0f) - u1);
}
template <class F>
static inline Vec3T<F> cosine_hemisphere(const Vec3T<F>& n, const F& u1, const F& u2) {
  Vec3T<F> t, b;
  tangent_frame(n, t, b);
  return cosine_hemisphere(t, b, n, u1, u2);
}

}  // namespace vitral
