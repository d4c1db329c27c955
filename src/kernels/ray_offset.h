// How far off their surfaces secondary rays start: as far as rounding can take them below, and no farther.
//
// Written with the unit roundoff e = 2^-24 and a running error analysis to the first order (Higham, "Accuracy
// and Stability of Numerical Algorithms", 2002, chapter 3; Pharr, Jakob and Humphreys, "Physically Based
// Rendering", 2023, section 6.8, for positions). For a triangle with unit normal n let, for each axis c,
//
//   m_c  be the largest |coordinate| of its corners, d_c how far they lie apart, and |n|.x mean sum |n_c|
//   x_c.
//
// 1. The point. P = (a + ab u) + ac v rounds ab and ac, two products, and two sums no larger than m:
//    each coordinate is off by e (2 d_c + 2 m_c). Whatever u and v are, they name a point of the plane: how
//    exact they are moves P along it, not off it.
// 2. The origin. P + n offset rounds to a float of size m: e m_c.
// 3. The test (kdtree/triangle.h) of the ray with the triangle. A corner relative to the origin is off by
//    e d_c. Sheared along the ray's dominant axis z, with a quotient of at most 1, it is off by another
//    e (d_c + 3 d_z) in the two other axes: quotient and product are rounded at size d_z, the difference at
//    size d_c + d_z. From there on all is exact but for roundings in double. The hit at t is thus a point of
//    the plane within these distances of the ray's, and if the ray starts higher over the plane than they
//    are along n, and does not descend, then t is negative: the sign of a rounded t is right.
// 4. The side. Kernels ask whether a rounded dot product with a rounded normal is positive, mirror at the
//    plane what is not, and normalize: a ray that counts as rising sinks by at most 8 e of its way, which
//    inside the triangle is no longer than |d|. (dot: 3 e, normal: e, mirrored: 2 e, normalized: 2 e.)
// 5. The view. sight.cpp wants to see in float that a triangle does not rise above the origin, so as not to
//    test it: n.(corner - P) is off by 5 e |n|.d.
//
// With the first two as e (3 |n|.m + 2 |n|.d) and the others as plane_error(), what a ray meets of its own
// triangle never has t > 0; nor has what it meets of triangles that share an edge or a corner with it and do
// not rise above its plane: near what is shared, the far corner of the neighbour, whose distance may be more
// than d, has a small weight in t.
//
// A neighbour that does rise, in a hollow fold, casts the shadow it has. P lies within its triangle only up
// to e (2 d + 2 m), and may be behind the neighbour if it is as near to the fold as that: in folds of up to
// some 20 degrees the offset along n clears that, too; in the corner of a room a point within a few units in
// the last place of the other wall may be behind it.
//
// Shading normals may send a shadow ray down through the facet that it starts from. It meets the facet: so
// far the geometry has its way, and coarse meshes show it (Terminator::smooth lifts such points off).
// Reflected, refracted and ambient rays are mirrored to the side where they belong.
//
// Triangles are taken to be thick enough for the normal, which is computed in double, to be right within
// 2^-10: those with corners on a grid of 2^24 points a side are.
#pragma once
#include "math/scalar.h"
#include "vitral/vec.h"

namespace vitral {

inline constexpr float kUnitRoundoff = 0x1p-24f;
// What is left out: products of errors, the rounding of the bound itself, and of the normal it is made with.
inline constexpr float kSecondOrder = 1 + 0x1p-10f;
// Among denormal numbers an operation is off by up to 2^-150, however small the numbers; there are under a
// thousand of them.
inline constexpr float kLeastOffset = 0x1p-140f;

// Steps 3 to 5, by which much a ray's height over a plane of normal n may be misjudged by who sees a triangle
// in it whose corners are, axis by axis, at most `d` away. `n` holds absolute values.
template <class F>
static inline F plane_error(const Vec3T<F>& n, const Vec3T<F>& d) {
  const F sheared = greatest(d.x * (n.y + n.z), greatest(d.y * (n.z + n.x), d.z * (n.x + n.y)));
  const F along = F(7.0f) * dot(n, d) + F(3.0f) * sheared;
  return (along + F(8.0f) * square_root(dot(d, d))) * F(kUnitRoundoff) + F(kLeastOffset);
}

template <class F>
static inline Vec3T<F> absolute(const Vec3T<F>& v) {
  return {absolute(v.x), absolute(v.y), absolute(v.z)};
}
template <class F>
static inline Vec3T<F> greatest(const Vec3T<F>& a, const Vec3T<F>& b) {
  return {greatest(a.x, b.x), greatest(a.y, b.y), greatest(a.z, b.z)};
}
template <class F>
static inline Vec3T<F> least(const Vec3T<F>& a, const Vec3T<F>& b) {
  return {least(a.x, b.x), least(a.y, b.y), least(a.z, b.z)};
}

// The offset for all points of a triangle, along its unit normal or against it. A triangle that stands for
// something in another space needs more: dot(|n|, placement_error()).
template <class F>
static inline F ray_offset(const Vec3T<F>& a, const Vec3T<F>& b, const Vec3T<F>& c, const Vec3T<F>& normal) {
  const Vec3T<F> n = absolute(normal);
  const Vec3T<F> m = greatest(absolute(a), greatest(absolute(b), absolute(c)));
  // A point may lie outside its triangle by as much as its coordinates are off.
  const Vec3T<F> d = (greatest(a, greatest(b, c)) - least(a, least(b, c))) + m * F(4 * kUnitRoundoff);
  const F moved = (F(3.0f) * dot(n, m) + F(2.0f) * dot(n, d)) * F(kUnitRoundoff);
  return (moved + plane_error(n, d)) * F(kSecondOrder);
}

// How far the plane of a triangle that `map` has moved to the world may be from that of the triangle it
// stands for, with rays tested in the latter's own space. There its corners are at most `m` large and `d`
// apart, axis by axis; the moved ones are at most `moved` large. Points and rays change spaces in double and
// are rounded once (kdtree/objects.h): the corners by e of their size in the world; a ray's origin, beside
// the triangle, by e m, its direction over a way of d by e d; step 3 adds e (2 d + 3 d_z) in that space.
template <class Map>
static inline Vec3 placement_error(const Map& map, const Vec3& m, const Vec3& d, const Vec3& moved) {
  const float most = 3 * greatest(d.x, greatest(d.y, d.z));
  const Vec3 own = m + d * 3.0f + Vec3{most, most, most};
  const auto row = [&](float x, float y, float z) {
    return (absolute(x) * own.x + absolute(y) * own.y) + absolute(z) * own.z;
  };
  const Vec3 there{row(map.x.x, map.y.x, map.z.x), row(map.x.y, map.y.y, map.z.y),
                   row(map.x.z, map.y.z, map.z.z)};
  return (there + moved) * (kUnitRoundoff * kSecondOrder);
}

}  // namespace vitral
