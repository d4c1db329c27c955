// Sine, cosine, tangent, power: by fixed polynomials, because the C library's differ in the last bit
// from machine to machine. Errors stated are absolute unless said otherwise.
#pragma once
#include "math/scalar.h"

#include <bit>
#include <cstdint>

namespace vitral {

// sin and cos of 2 pi u for u in [0, 1), error below 1e-6: the quadrant's angle within +-pi/4, Taylor.
template <class F>
static inline void sin_cos_turn(const F& u, F& sine, F& cosine) {
  const F quarters = u * F(4.0f);
  const auto quadrant = to_int(quarters + F(0.5f));
  const F a = (quarters - to_float(quadrant)) * F(1.57079632679f), a2 = a * a;
  const F s = a * (F(1.0f) + a2 * (F(-1.0f / 6) + a2 * (F(1.0f / 120) + a2 * F(-1.0f / 5040))));
  const F c = F(1.0f) + a2 * (F(-0.5f) + a2 * (F(1.0f / 24) + a2 * (F(-1.0f / 720) + a2 * F(1.0f / 40320))));
  using I = decltype(to_int(u));
  const auto odd = (quadrant & I(1)) == I(1);
  const auto sine_negative = (quadrant & I(2)) == I(2);
  const auto cosine_negative = ((quadrant + I(1)) & I(2)) == I(2);
  const F rs = select(odd, c, s), rc = select(odd, s, c);
  sine = select(sine_negative, -rs, rs);
  cosine = select(cosine_negative, -rc, rc);
}

// tan(x) for x in [0, pi/2), relative error below 1e-11 up to 1.57: Taylor series on x / 8, then
// doubling of the angle three times.
static inline double tangent(double x) {
  const double a = x / 8, a2 = a * a;
  double s = a * (1 + a2 * (-1.0 / 6 + a2 * (1.0 / 120 + a2 * (-1.0 / 5040 + a2 * (1.0 / 362880)))));
  double c =
      1 + a2 * (-1.0 / 2 + a2 * (1.0 / 24 + a2 * (-1.0 / 720 + a2 * (1.0 / 40320 + a2 * (-1.0 / 3628800)))));
  for (int i = 0; i < 3; ++i) {
    const double s2 = 2 * s * c;
    c = c * c - s * s;
    s = s2;
  }
  return s / c;
}

// sin and cos of an angle in degrees, error below 1e-15 of a few turns: the quadrant's angle within +-45
// degrees, Taylor.
static inline void sin_cos_degrees(double degrees, double& sine, double& cosine) {
  const double turns = degrees / 90;
  const double whole = static_cast<double>(static_cast<int64_t>(turns < 0 ? turns - 0.5 : turns + 0.5));
  const double a = (turns - whole) * 1.5707963267948966, a2 = a * a;
  double s = 0, c = 0;
  for (int k = 18; k >= 2; k -= 2) {
    s = -a2 / (k * (k + 1)) * (1 + s);
    c = -a2 / (k * (k - 1)) * (1 + c);
  }
  s = a * (1 + s), c = 1 + c;
  const int64_t quadrant = static_cast<int64_t>(whole) & 3;
  sine = quadrant == 0 ? s : quadrant == 1 ? c : quadrant == 2 ? -s : -c;
  cosine = quadrant == 0 ? c : quadrant == 1 ? -s : quadrant == 2 ? -c : s;
}

// The angle of the point (x, y), in (-pi, pi], error below 1e-15; 0 for (0, 0). Halved twice, then Taylor.
static inline double arc_tangent(double y, double x) {
  const double ax = x < 0 ? -x : x, ay = y < 0 ? -y : y;
  if (!(ax > 0) && !(ay > 0)) return 0;
  double t = ax > ay ? ay / ax : ax / ay;
  for (int i = 0; i < 2; ++i) t = t / (1 + __builtin_sqrt(1 + t * t));
  const double t2 = t * t;
  double sum = 0;
  for (int k = 25; k >= 1; k -= 2) sum = 1.0 / k - t2 * sum;
  double angle = 4 * t * sum;
  if (ay >= ax) angle = 1.5707963267948966 - angle;
  if (x < 0) angle = 3.141592653589793 - angle;
  return y < 0 ? -angle : angle;
}

// log2(x) for x > 0, normal, error below 1e-15 relative to max(1, |log2 x|): atanh series.
static inline double log2_of(double x) {
  uint64_t b = std::bit_cast<uint64_t>(x);
  int exponent = static_cast<int>(b >> 52 & 0x7ff) - 1023;
  double m = std::bit_cast<double>((b & 0xfffffffffffffull) | 0x3ff0000000000000ull);
  if (m > 1.4142135623730951) {
    m *= 0.5;
    ++exponent;
  }
  const double s = (m - 1) / (m + 1), s2 = s * s;
  double sum = 0;
  for (int k = 21; k >= 1; k -= 2) sum = sum * s2 + 1.0 / k;
  return exponent + 2.885390081777927 * s * sum;
}

// 2^y, relative error below 1e-15; 0 below -1022, +inf from 1024.
static inline double exp2_of(double y) {
  if (!(y > -1022)) return 0;
  if (y >= 1024) return __builtin_inf();
  const int whole = static_cast<int>(y < 0 ? y - 0.5 : y + 0.5);
  const double f = (y - whole) * 0.6931471805599453;
  double sum = 1;
  for (int k = 14; k >= 1; --k) sum = 1 + sum * f / k;
  if (whole == 1024) return sum * 2 * std::bit_cast<double>(0x7feull << 52);
  return sum * std::bit_cast<double>(static_cast<uint64_t>(whole + 1023) << 52);
}

// base^exponent for base >= 0; 0^0 = 1.
static inline float power(float base, float exponent) {
  if (exponent == 0) return 1;
  if (!(base > 0)) return 0;
  return static_cast<float>(exp2_of(static_cast<double>(exponent) * log2_of(static_cast<double>(base))));
}

}  // namespace vitral
