// Triangles as surfaces and the normals of their points, written once for a number and for a register of
// them.
#pragma once
#include "kernels/ray_offset.h"
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
  F offset;                   // secondary rays start this far off
  Vec3T<F> corner_normal[3];  // they mean nothing unless
  M smooth;                   // the corners have normals
};

template <class F, class M>
[[gnu::always_inline]] static inline void set_corners(const Vec3T<F>& a, const Vec3T<F>& b, const Vec3T<F>& c,
                                                      const Vec3T<F>& eye, const F& more_offset,
                                                      Facet<F, M>& out) {
  out.a = a, out.ab = b - a, out.ac = c - a;
  out.from_eye[0] = a - eye, out.from_eye[1] = b - eye, out.from_eye[2] = c - eye;
  out.normal = facet_normal(a, b, c);
  out.offset = ray_offset(a, b, c, out.normal) + more_offset;
}

// Where shadow rays from a point p of a smooth triangle start so that coarse facets do not show in the shadow
// that a round body casts on itself: p is projected along each corner's normal onto the plane that touches
// the smooth surface there, unless it lies above, and the three projections are weighted as the corners are
// (Hanika, "Hacking the Shadow Terminator", Ray Tracing Gems II, chapter 4, 2021). Corners whose plane p lies
// above, as all in a hollow, lift nothing; seen from the back, normals are turned to that side. `geometric`
// is the unit normal of the side that is seen.
template <class F, class M>
static inline Vec3T<F> lifted_position(const Facet<F, M>& f, const Vec3T<F>& p, const F& u, const F& v,
                                       const NormalSum<F, M>& s, const Vec3T<F>& geometric) {
  const F zero = F(0.0f);
  const auto turned = dot(s.sum, geometric) < zero;
  const Vec3T<F> from_a = p - f.a;
  const Vec3T<F> from_corner[3] = {from_a, from_a - f.ab, from_a - f.ac};
  const F weight[3] = {greatest((F(1.0f) - u) - v, zero), u, v};
  Vec3T<F> lift{zero, zero, zero};
  for (int k = 0; k < 3; ++k) {
    const Vec3T<F> n = flip_where(turned, f.corner_normal[k]);
    const F below = greatest(-dot(from_corner[k], n), zero);
    const auto upwards = both(s.usable, dot(n, geometric) > zero);
    lift = lift + select3(upwards, n * (below * weight[k]), Vec3T<F>{zero, zero, zero});
  }
  return p + lift;
}

}  // namespace vitral
