// Affine maps of space, and rigid motions given by keyframes.
#pragma once
#include "vitral/vec.h"

#include <vector>

namespace vitral {

// p -> x * p.x + y * p.y + z * p.z + origin: the images of the axes and of the origin.
template <class V>
struct AffineT {
  V x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  V origin{0, 0, 0};
};
using Affine = AffineT<Vec3>;
// The same in double. An inverse that were rounded to float would take the points of a squashed, turned body
// off its surface by as many times rounding as its length is larger than its width.
using PreciseAffine = AffineT<Vec3d>;

// Generic in width. The order of the sums is part of the contract: the rasterizer and the tracer take the
// same rays to the same objects, and must come to the same bits.
template <class V, class F>
static inline Vec3T<F> transform_vector(const AffineT<V>& a, const Vec3T<F>& v) {
  return {(F(a.x.x) * v.x + F(a.y.x) * v.y) + F(a.z.x) * v.z,
          (F(a.x.y) * v.x + F(a.y.y) * v.y) + F(a.z.y) * v.z,
          (F(a.x.z) * v.x + F(a.y.z) * v.y) + F(a.z.z) * v.z};
}
template <class V, class F>
static inline Vec3T<F> transform_point(const AffineT<V>& a, const Vec3T<F>& p) {
  return transform_vector(a, p) + Vec3T<F>{F(a.origin.x), F(a.origin.y), F(a.origin.z)};
}

// The normal of a transformed surface is along this, for `inverse` the inverse of the map that transforms it:
// the transpose of the inverse keeps normals upright on sheared and squashed surfaces.
template <class V, class F>
static inline Vec3T<F> transform_normal(const AffineT<V>& inverse, const Vec3T<F>& n) {
  return {(F(inverse.x.x) * n.x + F(inverse.x.y) * n.y) + F(inverse.x.z) * n.z,
          (F(inverse.y.x) * n.x + F(inverse.y.y) * n.y) + F(inverse.y.z) * n.z,
          (F(inverse.z.x) * n.x + F(inverse.z.y) * n.y) + F(inverse.z.z) * n.z};
}

// First b, then a. Computed in double, rounded once.
Affine operator*(const Affine& a, const Affine& b);

PreciseAffine to_double(const Affine& a);
PreciseAffine precise_inverse(const Affine& a);  // as inverse()

// Greater than 0: left stays left. Less: mirrored.
double determinant(const Affine& a);

// Throws nothing: a map that flattens space, or whose entries are not finite, has no inverse, and comes out
// with entries that are not finite.
Affine inverse(const Affine& a);
bool is_finite(const Affine& a);

// The rotation by `degrees`, counter-clockwise for who looks against the axis (of any length but 0).
Affine rotation(const Vec3& axis, float degrees);

// Unit quaternion: w + (x, y, z).
struct Quaternion {
  float x = 0, y = 0, z = 0, w = 1;
};
Quaternion quaternion(const Vec3& axis, float degrees);
// Of the frame whose axes are these orthonormal, right-handed vectors.
Quaternion quaternion_of_frame(const Vec3& x, const Vec3& y, const Vec3& z);
Vec3 rotate(const Quaternion& q, const Vec3& v);

// Where a rigid body is at a moment: turned about its own origin, then displaced.
struct RigidKey {
  float time = 0;
  Vec3 translation{0, 0, 0};
  Quaternion rotation;
};

// Between two keys the displacement is linear in time and the rotation turns at constant speed the shorter
// way round (Shoemake, "Animating rotation with quaternion curves", SIGGRAPH 1985); before the first and
// after the last key the body rests. `keys` are in order of time and not empty.
RigidKey pose_at(const std::vector<RigidKey>& keys, float time);
Affine affine_of(const RigidKey& pose);

}  // namespace vitral
