// Four floats at once, in the compiler's own vectors: 16 bytes are in every machine's baseline. Every
// operation means the same as its scalar form, lane by lane.
#pragma once
#include <cstdint>
#include <cstring>

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace vitral {

using Float4 = float __attribute__((vector_size(16)));
using Int4 = int32_t __attribute__((vector_size(16)));

static inline Float4 splat(float x) {
  return Float4{x, x, x, x};
}
static inline Float4 load4(const float* p) {
  Float4 v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
static inline void store4(float* p, const Float4& v) {
  std::memcpy(p, &v, sizeof v);
}

static inline Int4 bits_of(const Float4& v) {
  Int4 i;
  std::memcpy(&i, &v, sizeof i);
  return i;
}
static inline Float4 floats_of(const Int4& i) {
  Float4 v;
  std::memcpy(&v, &i, sizeof v);
  return v;
}

// a < b ? a : b and a > b ? a : b, as in vitral/box.h; one instruction where there is one for it.
static inline Float4 least(const Float4& a, const Float4& b) {
#if defined(__SSE__)
  return _mm_min_ps(a, b);
#else
  return a < b ? a : b;
#endif
}
static inline Float4 greatest(const Float4& a, const Float4& b) {
#if defined(__SSE__)
  return _mm_max_ps(a, b);
#else
  return a > b ? a : b;
#endif
}

// Masks are all ones or all zeros in each lane.
static inline Float4 select(const Int4& mask, const Float4& yes, const Float4& no) {
  return floats_of((mask & bits_of(yes)) | (~mask & bits_of(no)));
}
static inline Float4 keep(const Int4& mask, const Float4& v) {
  return floats_of(mask & bits_of(v));
}
static inline Float4 absolute(const Float4& v) {
  return keep(Int4{0x7fffffff, 0x7fffffff, 0x7fffffff, 0x7fffffff}, v);
}

static inline Float4 to_float(const Int4& v) {
  return __builtin_convertvector(v, Float4);
}
static inline Int4 truncate(const Float4& v) {  // |v| < 2^31
  return __builtin_convertvector(v, Int4);
}

}  // namespace vitral
