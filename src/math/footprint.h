// What a pixel sees of a texture: the image of its square, or of a cone's section, in the triangle's
// plane and from there in the texture; and how much of that a lookup has to cover.
//
// The square's two sides, sheared along the ray into the plane, are the derivatives of the hit by the pixel:
// exact for the pinhole camera (Igehy, "Tracing Ray Differentials", SIGGRAPH 1999, section 3.1). As conjugate
// diameters they span an ellipse; its axes are the singular values of the matrix they make in the texture
// (Heckbert, "Fundamentals of Texture Mapping and Image Warping", 1989).
#pragma once
#include "math/scalar.h"
#include "vitral/vec.h"

namespace vitral {

// How the point where a ray of direction d (any length) meets the plane of normal n moves when the ray is
// shifted by e. Not finite where the ray lies in the plane.
template <class F>
static inline Vec3T<F> slide(const Vec3T<F>& e, const Vec3T<F>& d, const Vec3T<F>& n) {
  return e - d * (dot(n, e) / dot(n, d));
}

// The gradients of the barycentrics of corners b and c over the triangle's plane; to_b and to_c lead there
// from corner a, n is the unit normal of either side.
template <class F>
struct BarycentricSlopes {
  Vec3T<F> b, c;
};
template <class F>
static inline BarycentricSlopes<F> barycentric_slopes(const Vec3T<F>& to_b, const Vec3T<F>& to_c,
                                                      const Vec3T<F>& n) {
  const F inverse = F(1.0f) / dot(cross(to_b, to_c), n);
  return {cross(to_c, n) * inverse, cross(n, to_b) * inverse};
}

// A corner's value of something that is linear over the triangle, and the others'.
template <class F>
static inline F at_barycentrics(const F& a, const F& b, const F& c, const F& u, const F& v) {
  const F w = (F(1.0f) - u) - v;
  return (a * w + b * u) + c * v;
}

// A row of equal probes along the footprint's longer axis: what the lookup averages.
template <class F>
struct Footprint {
  Vec2T<F> step;  // from probe to probe, in texture coordinates
  F width;        // of a probe, in texels; at least 1
  F count;        // of probes, whole; 1 to kMaxAnisotropy
};

// Up to this many times as long as wide is a footprint covered in full; a longer one gets wider probes and
// is blurred rather than left with gaps.
inline constexpr float kMaxAnisotropy = 16;

// A probe reads texels with a tent of two probe widths: so much of the footprint's length, in widths, is
// covered without another one.
inline constexpr float kProbeOverlap = 0.5f;

// A footprint that has no bounds, as a plane's that is seen from its side, is as wide as this: wider than any
// texture.
inline constexpr float kBoundlessWidth = 65536;

// From the conjugate diameters in texture coordinates. All results are finite.
//
// n probes at a distance d have the variance d^2 (n^2 - 1) / 12. With d as below it is that of a box of the
// length wanted less that of one probe, for any n: where another probe is added no seam shows.
template <class F>
static inline Footprint<F> make_footprint(const Vec2T<F>& first, const Vec2T<F>& second, const F& columns,
                                          const F& rows) {
  const F one = F(1.0f), zero = F(0.0f), half = F(0.5f);
  const F ax = first.x * columns, ay = first.y * rows, bx = second.x * columns, by = second.y * rows;
  // The matrix M = A A^T + B B^T, whose eigenvalues are the squares of the axes.
  const F xx = ax * ax + bx * bx, xy = ax * ay + bx * by, yy = ay * ay + by * by;
  const F mean = (xx + yy) * half, difference = (xx - yy) * half;
  const F root = square_root(difference * difference + xy * xy);
  const F squared = mean + root;
  const auto bounded = squared < F(1e16f);
  const F major = square_root(select(squared > one, select(bounded, squared, one), one));
  const F minor = absolute(ax * by - ay * bx) / major;

  const F width =
      greatest(greatest(select(bounded, minor, F(kBoundlessWidth)), major * F(1 / kMaxAnisotropy)), one);
  const F length = greatest(major / width - F(kProbeOverlap), one);
  const F whole = to_float(to_int(length)), count = select(whole < length, whole + one, whole);
  const F distance = square_root((length * length - one) / greatest(count * count - one, one));
  // The eigenvector, by the row of M - minor^2 that is farther from zero; none where all directions are
  // equal.
  const auto flat = difference >= zero;
  const F ex = select(flat, difference + root, xy), ey = select(flat, xy, root - difference);
  const F norm = square_root(ex * ex + ey * ey);
  const auto directed = both(bounded, norm > zero);
  const F scale = select(directed, width * distance / select(directed, norm, one), zero);
  return {{select(directed, ex, zero) * scale / columns, select(directed, ey, zero) * scale / rows},
          width,
          count};
}

}  // namespace vitral
