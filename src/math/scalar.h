// The one-lane meaning of every operation that the SIMD types have, so that a formula written once as
// a template serves one ray or a register of them. A mask of one lane is a bool.
#pragma once
#include "vitral/box.h"
#include "vitral/vec.h"

#include <cstdint>
#include <cstring>

namespace vitral {

static inline float select(bool mask, float yes, float no) {
  return mask ? yes : no;
}
static inline double select(bool mask, double yes, double no) {
  return mask ? yes : no;
}
static inline int32_t select(bool mask, int32_t yes, int32_t no) {
  return mask ? yes : no;
}
static inline uint32_t select(bool mask, uint32_t yes, uint32_t no) {
  return mask ? yes : no;
}

static inline bool any(bool mask) {
  return mask;
}
static inline bool both(bool a, bool b) {
  return a && b;
}
static inline bool either(bool a, bool b) {
  return a || b;
}
static inline bool invert(bool a) {
  return !a;
}

static inline int32_t least(int32_t a, int32_t b) {
  return a < b ? a : b;
}
static inline int32_t greatest(int32_t a, int32_t b) {
  return a > b ? a : b;
}

static inline double widen(float x) {
  return static_cast<double>(x);
}
static inline float narrow(double x) {
  return static_cast<float>(x);
}

static inline float absolute(float x) {
  return __builtin_fabsf(x);
}
static inline double absolute(double x) {
  return __builtin_fabs(x);
}

// As for float (vitral/box.h).
static inline double least(double a, double b) {
  return a < b ? a : b;
}
static inline double greatest(double a, double b) {
  return a > b ? a : b;
}

// |magnitude| with the sign bit of `sign`.
static inline float copy_sign(float magnitude, float sign) {
  return __builtin_copysignf(magnitude, sign);
}

static inline float to_float(int32_t x) {
  return static_cast<float>(x);
}
static inline float to_float(uint32_t x) {
  return static_cast<float>(x);
}
static inline int32_t to_int(float x) {
  return static_cast<int32_t>(x);
}  // towards zero; |x| < 2^31
static inline int32_t to_int(double x) {
  return static_cast<int32_t>(x);
}
static inline double to_double(int32_t x) {
  return x;
}

static inline uint32_t as_bits(float x) {
  uint32_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  return bits;
}
static inline int32_t as_int(float x) {
  return static_cast<int32_t>(as_bits(x));
}
static inline float from_bits(uint32_t bits) {
  float x;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}
static inline float from_bits(int32_t bits) {
  return from_bits(static_cast<uint32_t>(bits));
}

}  // namespace vitral
