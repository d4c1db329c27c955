// Vectors of two and three components, generic in the number type: `float` in scalar code, a SIMD
// register in kernels, so that one formula serves both. Every function is `static inline`: the
// kernels are compiled once per instruction set and must not share code with anybody.
#pragma once

namespace vitral {

template <class F>
struct Vec2T {
  F x, y;
};

template <class F>
struct Vec3T {
  F x, y, z;
};

using Vec2 = Vec2T<float>;
using Vec3 = Vec3T<float>;
using Vec3d = Vec3T<double>;

// Keeps a parameter out of template deduction, so that `v * 2.0f` finds F from v alone.
template <class F>
struct Same {
  using Type = F;
};

template <class F>
static inline Vec3T<F> operator+(const Vec3T<F>& a, const Vec3T<F>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class F>
static inline Vec3T<F> operator-(const Vec3T<F>& a, const Vec3T<F>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class F>
static inline Vec3T<F> operator-(const Vec3T<F>& a) {
  return {-a.x, -a.y, -a.z};
}
template <class F>
static inline Vec3T<F> operator*(const Vec3T<F>& a, const Vec3T<F>& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
template <class F>
static inline Vec3T<F> operator*(const Vec3T<F>& a, const typename Same<F>::Type& s) {
  return {a.x * s, a.y * s, a.z * s};
}
template <class F>
static inline Vec3T<F>& operator+=(Vec3T<F>& a, const Vec3T<F>& b) {
  a = a + b;
  return a;
}
template <class F>
static inline Vec3T<F>& operator*=(Vec3T<F>& a, const Vec3T<F>& b) {
  a = a * b;
  return a;
}
template <class F>
static inline bool operator==(const Vec3T<F>& a, const Vec3T<F>& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}

// Summed left to right: the order is part of the result.
template <class F>
static inline F dot(const Vec3T<F>& a, const Vec3T<F>& b) {
  return (a.x * b.x + a.y * b.y) + a.z * b.z;
}
template <class F>
static inline Vec3T<F> cross(const Vec3T<F>& a, const Vec3T<F>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline float component(const Vec3& v, int axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

static inline Vec3d to_double(const Vec3& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}
static inline Vec3 to_float(const Vec3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

// IEEE square root, correctly rounded on every machine. (The SIMD types bring their own.)
static inline float square_root(float x) {
  return __builtin_sqrtf(x);
}
static inline double square_root(double x) {
  return __builtin_sqrt(x);
}

template <class F>
static inline F length(const Vec3T<F>& v) {
  return square_root(dot(v, v));
}
// The zero vector has no direction: its components come back as NaN.
template <class F>
static inline Vec3T<F> normalize(const Vec3T<F>& v) {
  const F inverse = F(1.0f) / length(v);
  return v * inverse;
}

// Relative luminance of linear Rec. 709 / sRGB primaries.
static inline float luminance(const Vec3& c) {
  return (0.2126f * c.x + 0.7152f * c.y) + 0.0722f * c.z;
}

}  // namespace vitral
