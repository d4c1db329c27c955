// Triangles as surfaces and the normals of their points, written once for a number and for a register of
// them.
#pragma once
#include "math/scalar.h"
#include "vitral/vec.h"

namespace vitral {

// Of the front, unit. It is computed in double, so that tiny triangles have one, too.
template <class F>
static inline Vec3T<F> facet_normal(const Vec3T<F>& a, const Vec3T<F>& b, const Vec3T<F>& c) {
  using D = decltype(widen(a.x));
  const Vec3T<D> wa{widen(a.x), widen(a.y), widen(a.z)}, wb{widen(b.x), widen(b.y), widen(b.z)},
      wc{widen(c.x), widen(c.y), widen(c.z)};
  const Vec3T<D> n = normalize(cross(wb - wa, wc - wa));
  return {narrow(n.x), narrow(n.y), narrow(n.z)};
}

template <class F, class M>
static inline Vec3T<F> select3(const M& mask, const Vec3T<F>& yes, const Vec3T<F>& no) {
  return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}
template <class F, class M>
static inline Vec3T<F> flip_where(const M& mask, const Vec3T<F>& v) {
  return select3(mask, -v, v);
}

// The sum of the corners' normals na, nb and nc by a point's weights, and whether it has a direction: not
// where the triangle is not `smooth`, or where they cancel out.
template <class F, class M>
struct NormalSum {
  Vec3T<F> sum;
  F squared;  // its length
  M usable;
};
template <class F, class M>
static inline NormalSum<F, M> sum_normals(const Vec3T<F>& na, const Vec3T<F>& nb, const Vec3T<F>& nc,
                                          const F& u, const F& v, const M& smooth) {
  const Vec3T<F> sum = (na * ((F(1.0f) - u) - v) + nb * u) + nc * v;
  const F squared = dot(sum, sum);
  return {sum, squared, both(smooth, squared > F(1e-12f))};
}

// The unit normal that way, turned to the side of `geometric`; that one where the sum has no direction.
template <class F, class M>
static inline Vec3T<F> interpolated_normal(const NormalSum<F, M>& s, const Vec3T<F>& geometric) {
  const Vec3T<F> n = s.sum * (F(1.0f) / square_root(select(s.usable, s.squared, F(1.0f))));
  return select3(s.usable, flip_where(dot(n, geometric) < F(0.0f), n), geometric);
}
// The same of any length.
template <class F, class M>
static inline Vec3T<F> interpolated_direction(const NormalSum<F, M>& s, const Vec3T<F>& geometric) {
  return select3(s.usable, flip_where(dot(s.sum, geometric) < F(0.0f), s.sum), geometric);
}

// F and M: float and bool for one triangle, Float and Mask for one in each lane.
template <class F, class M>
struct Facet {
  Vec3T<F> a, ab, ac;         // corner a, and from there to b and c
  Vec3T<F> from_eye[3];       // from the camera to the corners
  Vec3T<F> normal;            // geometric, of the front
  F magnitude;                // of the largest coordinate
  Vec3T<F> corner_normal[3];  // they mean nothing unless
  M smooth;                   // the corners have normals
};

template <class F>
static inline F largest(const Vec3T<F>& v) {
  return greatest(absolute(v.x), greatest(absolute(v.y), absolute(v.z)));
}

template <class F, class M>
[[gnu::always_inline]] static inline void set_corners(const Vec3T<F>& a, const Vec3T<F>& b, const Vec3T<F>& c,
                                                      const Vec3T<F>& eye, Facet<F, M>& out) {
  out.a = a, out.ab = b - a, out.ac = c - a;
  out.from_eye[0] = a - eye, out.from_eye[1] = b - eye, out.from_eye[2] = c - eye;
  out.normal = facet_normal(a, b, c);
  out.magnitude = greatest(largest(a), greatest(largest(b), largest(c)));
}

}  // namespace vitral
