// Float, Double, Int, Uint and Mask: LANES numbers at a time, LANES fixed by the build (1, 4, 8, 16).
//
// This header is compiled once per instruction set, inside namespace vitral::VITRAL_ISA, so that no
// two copies ever share a symbol. Only operations that IEEE 754 rounds exactly are here (+ - * / and
// square root): every instruction set gives the same bits. There is no fused multiply-add and no
// approximate reciprocal on purpose.
//
// With one lane the types are the plain float, double, int32_t, uint32_t and bool, and the functions
// are those of math/scalar.h. A wide Double is two registers, lanes 0..LANES/2-1 and the rest.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#if LANES > 1
#include <immintrin.h>
#endif

#if LANES == 16 && !defined(__AVX512VL__)
#error "16 lanes need -march=x86-64-v4"
#elif LANES == 8 && (!defined(__AVX2__) || defined(__AVX512F__))
#error "8 lanes need -march=x86-64-v3"
#elif LANES == 4 && (!defined(__SSE4_2__) || defined(__AVX__))
#error "4 lanes need -march=x86-64-v2"
#endif

namespace vitral {
namespace VITRAL_ISA {

inline constexpr int kLanes = LANES;

#if LANES == 1

using Float = float;
using Double = double;
using Int = int32_t;
using Uint = uint32_t;
using Mask = bool;

static inline Float load(const float* p) {
  return *p;
}
static inline Int load(const int32_t* p) {
  return *p;
}
static inline Uint load(const uint32_t* p) {
  return *p;
}
static inline void store(float* p, Float v) {
  *p = v;
}
static inline void store(int32_t* p, Int v) {
  *p = v;
}
static inline void store(uint32_t* p, Uint v) {
  *p = v;
}
static inline uint32_t bits(Mask m) {
  return m ? 1u : 0u;
}
static inline void compress(float* p, Float v, Mask m) {
  if (m) *p = v;
}
static inline void compress(uint32_t* p, Uint v, Mask m) {
  if (m) *p = v;
}
static inline void compress(int32_t* p, Int v, Mask m) {
  if (m) *p = v;
}
static inline float least_lane(Float v) {
  return v;
}
static inline float greatest_lane(Float v) {
  return v;
}
static inline float sum_of_lanes(Float v) {
  return v;
}
static inline Mask mask_of_bits(uint64_t b) {
  return (b & 1) != 0;
}
static inline Uint lane_numbers() {
  return 0;
}

#else

typedef float FloatVector __attribute__((vector_size(4 * LANES)));
typedef int32_t IntVector __attribute__((vector_size(4 * LANES)));
typedef uint32_t UintVector __attribute__((vector_size(4 * LANES)));
typedef float HalfFloatVector __attribute__((vector_size(2 * LANES)));
typedef int32_t HalfIntVector __attribute__((vector_size(2 * LANES)));
typedef double DoubleVector __attribute__((vector_size(4 * LANES)));
typedef int64_t LongVector __attribute__((vector_size(4 * LANES)));

struct Float {
  FloatVector v;
  Float() = default;
  Float(FloatVector x) : v(x) {}
  explicit Float(float x) : v(x - FloatVector{}) {}
};
struct Double {
  DoubleVector lo, hi;
  Double() = default;
  Double(DoubleVector l, DoubleVector h) : lo(l), hi(h) {}
  explicit Double(double x) : lo(x - DoubleVector{}), hi(x - DoubleVector{}) {}
};
struct Int {
  IntVector v;
  Int() = default;
  Int(IntVector x) : v(x) {}
  explicit Int(int32_t x) : v(x - IntVector{}) {}
};
struct Uint {
  UintVector v;
  Uint() = default;
  Uint(UintVector x) : v(x) {}
  explicit Uint(uint32_t x) : v(x - UintVector{}) {}
};

// --- masks: one bit a lane on AVX-512, all ones or all zeros in a lane elsewhere ----------------

#if LANES == 16
struct Mask {
  __mmask16 v;
};
static inline uint32_t bits(Mask m) {
  return m.v;
}
static inline Mask mask_of_bits(uint64_t b) {
  return {static_cast<__mmask16>(b)};
}
static inline Mask both(Mask a, Mask b) {
  return {static_cast<__mmask16>(a.v & b.v)};
}
static inline Mask either(Mask a, Mask b) {
  return {static_cast<__mmask16>(a.v | b.v)};
}
static inline Mask invert(Mask a) {
  return {static_cast<__mmask16>(~a.v)};
}
static inline Float select(Mask m, Float yes, Float no) {
  return FloatVector(_mm512_mask_blend_ps(m.v, __m512(no.v), __m512(yes.v)));
}
static inline Int select(Mask m, Int yes, Int no) {
  return IntVector(_mm512_mask_blend_epi32(m.v, __m512i(no.v), __m512i(yes.v)));
}
static inline Uint select(Mask m, Uint yes, Uint no) {
  return UintVector(_mm512_mask_blend_epi32(m.v, __m512i(no.v), __m512i(yes.v)));
}
static inline Double select(Mask m, const Double& yes, const Double& no) {
  return {
      DoubleVector(_mm512_mask_blend_pd(static_cast<__mmask8>(m.v), __m512d(no.lo), __m512d(yes.lo))),
      DoubleVector(_mm512_mask_blend_pd(static_cast<__mmask8>(m.v >> 8), __m512d(no.hi), __m512d(yes.hi)))};
}
#define VITRAL_COMPARE(op, predicate)                                                \
  static inline Mask operator op(Float a, Float b) {                                 \
    return {_mm512_cmp_ps_mask(__m512(a.v), __m512(b.v), predicate)};                \
  }                                                                                  \
  static inline Mask operator op(const Double& a, const Double& b) {                 \
    const unsigned lo = _mm512_cmp_pd_mask(__m512d(a.lo), __m512d(b.lo), predicate); \
    const unsigned hi = _mm512_cmp_pd_mask(__m512d(a.hi), __m512d(b.hi), predicate); \
    return {static_cast<__mmask16>(lo | hi << 8)};                                   \
  }
VITRAL_COMPARE(<, _CMP_LT_OQ)
VITRAL_COMPARE(<=, _CMP_LE_OQ)
VITRAL_COMPARE(>, _CMP_GT_OQ)
VITRAL_COMPARE(>=, _CMP_GE_OQ)
VITRAL_COMPARE(==, _CMP_EQ_OQ)
#undef VITRAL_COMPARE
#define VITRAL_COMPARE(op, predicate)                                      \
  static inline Mask operator op(Int a, Int b) {                           \
    return {_mm512_cmp_epi32_mask(__m512i(a.v), __m512i(b.v), predicate)}; \
  }                                                                        \
  static inline Mask operator op(Uint a, Uint b) {                         \
    return {_mm512_cmp_epu32_mask(__m512i(a.v), __m512i(b.v), predicate)}; \
  }
VITRAL_COMPARE(<, _MM_CMPINT_LT)
VITRAL_COMPARE(<=, _MM_CMPINT_LE)
VITRAL_COMPARE(>, _MM_CMPINT_NLE)
VITRAL_COMPARE(>=, _MM_CMPINT_NLT)
VITRAL_COMPARE(==, _MM_CMPINT_EQ)
#undef VITRAL_COMPARE

#else
struct Mask {
  IntVector v;
};
static inline uint32_t bits(Mask m) {
#if LANES == 8
  return static_cast<uint32_t>(_mm256_movemask_ps(__m256(m.v)));
#else
  return static_cast<uint32_t>(_mm_movemask_ps(__m128(m.v)));
#endif
}
static inline Mask mask_of_bits(uint64_t b) {
#if LANES == 8
  const UintVector lane = {1, 2, 4, 8, 16, 32, 64, 128};
#else
  const UintVector lane = {1, 2, 4, 8};
#endif
  return {IntVector(((Uint(static_cast<uint32_t>(b)).v & lane) != 0))};
}
static inline Mask both(Mask a, Mask b) {
  return {a.v & b.v};
}
static inline Mask either(Mask a, Mask b) {
  return {a.v | b.v};
}
static inline Mask invert(Mask a) {
  return {~a.v};
}
static inline Float select(Mask m, Float yes, Float no) {
  return m.v ? yes.v : no.v;
}
static inline Int select(Mask m, Int yes, Int no) {
  return m.v ? yes.v : no.v;
}
static inline Uint select(Mask m, Uint yes, Uint no) {
  return m.v ? yes.v : no.v;
}
static inline Double select(Mask m, const Double& yes, const Double& no) {
  HalfIntVector half[2];
  std::memcpy(half, &m.v, sizeof half);
  const LongVector lo = __builtin_convertvector(half[0], LongVector);
  const LongVector hi = __builtin_convertvector(half[1], LongVector);
  return {lo ? yes.lo : no.lo, hi ? yes.hi : no.hi};
}
static inline Mask join(LongVector lo, LongVector hi) {
  const HalfIntVector half[2] = {__builtin_convertvector(lo, HalfIntVector),
                                 __builtin_convertvector(hi, HalfIntVector)};
  Mask m;
  std::memcpy(&m.v, half, sizeof m.v);
  return m;
}
#define VITRAL_COMPARE(op)                                           \
  static inline Mask operator op(Float a, Float b) {                 \
    return {IntVector(a.v op b.v)};                                  \
  }                                                                  \
  static inline Mask operator op(Int a, Int b) {                     \
    return {IntVector(a.v op b.v)};                                  \
  }                                                                  \
  static inline Mask operator op(Uint a, Uint b) {                   \
    return {IntVector(a.v op b.v)};                                  \
  }                                                                  \
  static inline Mask operator op(const Double& a, const Double& b) { \
    return join(LongVector(a.lo op b.lo), LongVector(a.hi op b.hi)); \
  }
VITRAL_COMPARE(<)
VITRAL_COMPARE(<=)
VITRAL_COMPARE(>)
VITRAL_COMPARE(>=)
VITRAL_COMPARE(==)
#undef VITRAL_COMPARE
#endif

static inline bool any(Mask m) {
  return bits(m) != 0;
}

// --- arithmetic ----------------------------------------------------------------------------------

#define VITRAL_BINARY(type, op)                    \
  static inline type operator op(type a, type b) { \
    return a.v op b.v;                             \
  }
VITRAL_BINARY(Float, +)
VITRAL_BINARY(Float, -)
VITRAL_BINARY(Float, *)
VITRAL_BINARY(Float, /)
VITRAL_BINARY(Uint, +)
VITRAL_BINARY(Uint, -)
VITRAL_BINARY(Uint, *)
VITRAL_BINARY(Uint, &)
VITRAL_BINARY(Uint, |)
VITRAL_BINARY(Uint, ^)
VITRAL_BINARY(Int, &)
VITRAL_BINARY(Int, |)
VITRAL_BINARY(Int, ^)
#undef VITRAL_BINARY
#define VITRAL_BINARY(op)                                              \
  static inline Double operator op(const Double& a, const Double& b) { \
    return {a.lo op b.lo, a.hi op b.hi};                               \
  }
VITRAL_BINARY(+)
VITRAL_BINARY(-)
VITRAL_BINARY(*)
VITRAL_BINARY(/)
#undef VITRAL_BINARY

static inline Float operator-(Float a) {
  return -a.v;
}
static inline Double operator-(const Double& a) {
  return {-a.lo, -a.hi};
}

// Signed sums and products wrap around, as the unsigned ones do.
static inline Int operator+(Int a, Int b) {
  return IntVector(UintVector(a.v) + UintVector(b.v));
}
static inline Int operator-(Int a, Int b) {
  return IntVector(UintVector(a.v) - UintVector(b.v));
}
static inline Int operator*(Int a, Int b) {
  return IntVector(UintVector(a.v) * UintVector(b.v));
}
static inline Uint operator<<(Uint a, int n) {
  return a.v << n;
}
static inline Uint operator>>(Uint a, int n) {
  return a.v >> n;
}  // logical
static inline Int operator>>(Int a, int n) {
  return a.v >> n;
}  // arithmetic

// a < b ? a : b and a > b ? a : b: what the x86 instruction does, NaN included.
static inline Float least(Float a, Float b) {
#if LANES == 16
  return FloatVector(_mm512_maskz_min_ps(0xffff, __m512(a.v), __m512(b.v)));
#elif LANES == 8
  return FloatVector(_mm256_min_ps(__m256(a.v), __m256(b.v)));
#else
  return FloatVector(_mm_min_ps(__m128(a.v), __m128(b.v)));
#endif
}
static inline Float greatest(Float a, Float b) {
#if LANES == 16
  return FloatVector(_mm512_maskz_max_ps(0xffff, __m512(a.v), __m512(b.v)));
#elif LANES == 8
  return FloatVector(_mm256_max_ps(__m256(a.v), __m256(b.v)));
#else
  return FloatVector(_mm_max_ps(__m128(a.v), __m128(b.v)));
#endif
}
static inline Int least(Int a, Int b) {
  return select(a < b, a, b);
}
static inline Int greatest(Int a, Int b) {
  return select(a > b, a, b);
}
static inline Double least(const Double& a, const Double& b) {
#if LANES == 16
  return {DoubleVector(_mm512_maskz_min_pd(0xff, __m512d(a.lo), __m512d(b.lo))),
          DoubleVector(_mm512_maskz_min_pd(0xff, __m512d(a.hi), __m512d(b.hi)))};
#elif LANES == 8
  return {DoubleVector(_mm256_min_pd(__m256d(a.lo), __m256d(b.lo))),
          DoubleVector(_mm256_min_pd(__m256d(a.hi), __m256d(b.hi)))};
#else
  return {DoubleVector(_mm_min_pd(__m128d(a.lo), __m128d(b.lo))),
          DoubleVector(_mm_min_pd(__m128d(a.hi), __m128d(b.hi)))};
#endif
}
static inline Double greatest(const Double& a, const Double& b) {
#if LANES == 16
  return {DoubleVector(_mm512_maskz_max_pd(0xff, __m512d(a.lo), __m512d(b.lo))),
          DoubleVector(_mm512_maskz_max_pd(0xff, __m512d(a.hi), __m512d(b.hi)))};
#elif LANES == 8
  return {DoubleVector(_mm256_max_pd(__m256d(a.lo), __m256d(b.lo))),
          DoubleVector(_mm256_max_pd(__m256d(a.hi), __m256d(b.hi)))};
#else
  return {DoubleVector(_mm_max_pd(__m128d(a.lo), __m128d(b.lo))),
          DoubleVector(_mm_max_pd(__m128d(a.hi), __m128d(b.hi)))};
#endif
}
static inline Float square_root(Float a) {
#if LANES == 16
  return FloatVector(_mm512_maskz_sqrt_ps(0xffff, __m512(a.v)));
#elif LANES == 8
  return FloatVector(_mm256_sqrt_ps(__m256(a.v)));
#else
  return FloatVector(_mm_sqrt_ps(__m128(a.v)));
#endif
}
static inline Double square_root(const Double& a) {
#if LANES == 16
  return {DoubleVector(_mm512_maskz_sqrt_pd(0xff, __m512d(a.lo))),
          DoubleVector(_mm512_maskz_sqrt_pd(0xff, __m512d(a.hi)))};
#elif LANES == 8
  return {DoubleVector(_mm256_sqrt_pd(__m256d(a.lo))), DoubleVector(_mm256_sqrt_pd(__m256d(a.hi)))};
#else
  return {DoubleVector(_mm_sqrt_pd(__m128d(a.lo))), DoubleVector(_mm_sqrt_pd(__m128d(a.hi)))};
#endif
}

// --- conversions, memory -------------------------------------------------------------------------

static inline Uint as_bits(Float a) {
  return UintVector(a.v);
}
static inline Int as_int(Float a) {
  return IntVector(a.v);
}
static inline Float from_bits(Int a) {
  return FloatVector(a.v);
}
static inline Float from_bits(Uint a) {
  return FloatVector(a.v);
}
static inline Float absolute(Float a) {
  return from_bits(as_bits(a) & Uint(0x7fffffffu));
}
static inline Double absolute(const Double& a) {
  const LongVector magnitude = LongVector{} + 0x7fffffffffffffff;
  return {DoubleVector(LongVector(a.lo) & magnitude), DoubleVector(LongVector(a.hi) & magnitude)};
}
static inline Float copy_sign(Float magnitude, Float sign) {
  return from_bits((as_bits(magnitude) & Uint(0x7fffffffu)) | (as_bits(sign) & Uint(0x80000000u)));
}
static inline Float to_float(Int a) {
  return __builtin_convertvector(a.v, FloatVector);
}
// Exact below 2^31, which is all that is ever asked of it.
static inline Float to_float(Uint a) {
  return to_float(Int(IntVector(a.v)));
}
static inline Int to_int(Float a) {
  return __builtin_convertvector(a.v, IntVector);
}  // towards zero; |a| < 2^31

// g++ 12 converts half of a register at a time when it is not told how.
static inline Double widen(Float a) {
#if LANES == 16
  const auto lo = __builtin_shufflevector(a.v, a.v, 0, 1, 2, 3, 4, 5, 6, 7);
  const auto hi = __builtin_shufflevector(a.v, a.v, 8, 9, 10, 11, 12, 13, 14, 15);
  return {DoubleVector(_mm512_maskz_cvtps_pd(0xff, __m256(lo))),
          DoubleVector(_mm512_maskz_cvtps_pd(0xff, __m256(hi)))};
#elif LANES == 8
  const auto lo = __builtin_shufflevector(a.v, a.v, 0, 1, 2, 3);
  const auto hi = __builtin_shufflevector(a.v, a.v, 4, 5, 6, 7);
  return {DoubleVector(_mm256_cvtps_pd(__m128(lo))), DoubleVector(_mm256_cvtps_pd(__m128(hi)))};
#else
  return {DoubleVector(_mm_cvtps_pd(__m128(a.v))),
          DoubleVector(_mm_cvtps_pd(_mm_movehl_ps(__m128(a.v), __m128(a.v))))};
#endif
}
static inline Float narrow(const Double& a) {
#if LANES == 16
  const auto lo = HalfFloatVector(_mm512_maskz_cvtpd_ps(0xff, __m512d(a.lo)));
  const auto hi = HalfFloatVector(_mm512_maskz_cvtpd_ps(0xff, __m512d(a.hi)));
  return FloatVector(__builtin_shufflevector(lo, hi, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15));
#elif LANES == 8
  const auto lo = HalfFloatVector(_mm256_cvtpd_ps(__m256d(a.lo)));
  const auto hi = HalfFloatVector(_mm256_cvtpd_ps(__m256d(a.hi)));
  return FloatVector(__builtin_shufflevector(lo, hi, 0, 1, 2, 3, 4, 5, 6, 7));
#else
  return FloatVector(_mm_movelh_ps(_mm_cvtpd_ps(__m128d(a.lo)), _mm_cvtpd_ps(__m128d(a.hi))));
#endif
}

static inline Double to_double(Int a) {
  HalfIntVector half[2];
  std::memcpy(half, &a.v, sizeof half);
  return {__builtin_convertvector(half[0], DoubleVector), __builtin_convertvector(half[1], DoubleVector)};
}
// Towards zero; |a| < 2^31.
static inline Int to_int(const Double& a) {
  const HalfIntVector half[2] = {__builtin_convertvector(a.lo, HalfIntVector),
                                 __builtin_convertvector(a.hi, HalfIntVector)};
  IntVector v;
  std::memcpy(&v, half, sizeof v);
  return v;
}

template <class V, class T>
static inline V load_vector(const T* p) {
  V v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
static inline Float load(const float* p) {
  return load_vector<FloatVector>(p);
}
static inline Int load(const int32_t* p) {
  return load_vector<IntVector>(p);
}
static inline Uint load(const uint32_t* p) {
  return load_vector<UintVector>(p);
}
static inline void store(float* p, Float a) {
  std::memcpy(p, &a.v, sizeof a.v);
}
static inline void store(int32_t* p, Int a) {
  std::memcpy(p, &a.v, sizeof a.v);
}
static inline void store(uint32_t* p, Uint a) {
  std::memcpy(p, &a.v, sizeof a.v);
}

// Stores the lanes of the mask side by side from p on; up to LANES numbers there may be overwritten.
#if LANES == 16
static inline void compress(float* p, Float v, Mask m) {
  _mm512_storeu_ps(p, _mm512_maskz_compress_ps(m.v, __m512(v.v)));
}
static inline void compress(uint32_t* p, Uint v, Mask m) {
  _mm512_storeu_si512(p, _mm512_maskz_compress_epi32(m.v, __m512i(v.v)));
}
static inline void compress(int32_t* p, Int v, Mask m) {
  _mm512_storeu_si512(p, _mm512_maskz_compress_epi32(m.v, __m512i(v.v)));
}
#else
template <class T, class V>
static inline void compress_lanes(T* p, V v, Mask m) {
  T lane[LANES];
  store(lane, v);
  for (uint32_t left = bits(m); left != 0; left &= left - 1) *p++ = lane[__builtin_ctz(left)];
}
static inline void compress(float* p, Float v, Mask m) {
  compress_lanes(p, v, m);
}
static inline void compress(uint32_t* p, Uint v, Mask m) {
  compress_lanes(p, v, m);
}
static inline void compress(int32_t* p, Int v, Mask m) {
  compress_lanes(p, v, m);
}
#endif

// The smallest and the largest lane.
static inline float least_lane(Float v) {
#if LANES == 16
  const __m512 h = _mm512_maskz_min_ps(0xffff, __m512(v.v),
                                       _mm512_maskz_shuffle_f32x4(0xffff, __m512(v.v), __m512(v.v), 0x4e));
  const __m512 q = _mm512_maskz_min_ps(0xffff, h, _mm512_maskz_shuffle_f32x4(0xffff, h, h, 0xb1));
  __m128 lane4;  // all quarters are the same now
  std::memcpy(&lane4, &q, sizeof lane4);
  const __m128 lane2 = _mm_min_ps(lane4, _mm_movehl_ps(lane4, lane4));
  return _mm_cvtss_f32(_mm_min_ss(lane2, _mm_shuffle_ps(lane2, lane2, 1)));
#else
  float lane[LANES];
  store(lane, v);
  for (int half = LANES / 2; half > 0; half /= 2) {
    for (int i = 0; i < half; ++i) lane[i] = lane[i + half] < lane[i] ? lane[i + half] : lane[i];
  }
  return lane[0];
#endif
}
static inline float greatest_lane(Float v) {
  return -least_lane(-v);
}
// Their sum, in an order that depends on their number.
static inline float sum_of_lanes(Float v) {
  float lane[LANES];
  std::memcpy(lane, &v.v, sizeof lane);
  float sum = 0;
  for (int i = 0; i < LANES; ++i) sum += lane[i];
  return sum;
}

// 0, 1, 2, ... LANES-1
static inline Uint lane_numbers() {
#if LANES == 16
  return UintVector{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
#elif LANES == 8
  return UintVector{0, 1, 2, 3, 4, 5, 6, 7};
#else
  return UintVector{0, 1, 2, 3};
#endif
}
#endif

// Copies whole cache lines to memory that is not read soon: past the caches, and without reading what was
// there. `from` and `to` start cache lines; `bytes` is a multiple of 64. Only after finish_streams() does a
// thread that synchronizes with this one see them.
static inline void stream(void* to, const void* from, size_t bytes) {
#if LANES == 1
  std::memcpy(to, from, bytes);
#elif LANES == 16
  for (size_t i = 0; i < bytes; i += 64)
    _mm512_stream_si512(reinterpret_cast<__m512i*>(static_cast<char*>(to) + i),
                        _mm512_load_si512(static_cast<const char*>(from) + i));
#else
  for (size_t i = 0; i < bytes; i += 16)
    _mm_stream_si128(reinterpret_cast<__m128i*>(static_cast<char*>(to) + i),
                     _mm_load_si128(reinterpret_cast<const __m128i*>(static_cast<const char*>(from) + i)));
#endif
}

static inline void finish_streams() {
#if LANES > 1
  _mm_sfence();
#endif
}

}  // namespace VITRAL_ISA
}  // namespace vitral
