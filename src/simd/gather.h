// Rows of three numbers from all over a table, a row a lane, as three registers. The rows are loaded whole
// and turned in registers, which takes a quarter of the loads that lane by lane would.
#pragma once
#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {

#if LANES == 1

static inline void gather3(const float* table, size_t stride, const uint32_t* rows, Float& x, Float& y,
                           Float& z) {
  const float* row = table + rows[0] * stride;
  x = row[0], y = row[1], z = row[2];
}

#else

typedef float QuadVector __attribute__((vector_size(16)));

// Three numbers and one that means nothing; does not touch the fourth in memory.
static inline QuadVector load_row(const float* p) {
#if LANES == 16
  return QuadVector(_mm_maskz_loadu_ps(7, p));
#elif LANES == 8
  return QuadVector(_mm_maskload_ps(p, _mm_setr_epi32(-1, -1, -1, 0)));
#else
  return QuadVector{p[0], p[1], p[2], 0};
#endif
}

// The rows of lanes j, j + 4, j + 8, ... side by side.
static inline FloatVector load_rows(const float* table, size_t stride, const uint32_t* rows, int j) {
  const auto row = [&](int lane) { return load_row(table + rows[lane] * stride); };
#if LANES == 16
  const auto low = __builtin_shufflevector(row(j), row(j + 4), 0, 1, 2, 3, 4, 5, 6, 7);
  const auto high = __builtin_shufflevector(row(j + 8), row(j + 12), 0, 1, 2, 3, 4, 5, 6, 7);
  return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
#elif LANES == 8
  return __builtin_shufflevector(row(j), row(j + 4), 0, 1, 2, 3, 4, 5, 6, 7);
#else
  return row(j);
#endif
}

// From every quarter of four lanes: a0 b0 a1 b1, a2 b2 a3 b3, a0 a1 b0 b1, a2 a3 b2 b3.
#if LANES == 16
#define VITRAL_QUARTERS(a, b, i, j, k, l)                                                                   \
  __builtin_shufflevector(a, b, i, j, k, l, i + 4, j + 4, k + 4, l + 4, i + 8, j + 8, k + 8, l + 8, i + 12, \
                          j + 12, k + 12, l + 12)
#elif LANES == 8
#define VITRAL_QUARTERS(a, b, i, j, k, l) \
  __builtin_shufflevector(a, b, i, j, k, l, i + 4, j + 4, k + 4, l + 4)
#else
#define VITRAL_QUARTERS(a, b, i, j, k, l) __builtin_shufflevector(a, b, i, j, k, l)
#endif
static inline FloatVector low_pairs(FloatVector a, FloatVector b) {
  return VITRAL_QUARTERS(a, b, 0, LANES, 1, LANES + 1);
}
static inline FloatVector high_pairs(FloatVector a, FloatVector b) {
  return VITRAL_QUARTERS(a, b, 2, LANES + 2, 3, LANES + 3);
}
static inline FloatVector low_halves(FloatVector a, FloatVector b) {
  return VITRAL_QUARTERS(a, b, 0, 1, LANES, LANES + 1);
}
static inline FloatVector high_halves(FloatVector a, FloatVector b) {
  return VITRAL_QUARTERS(a, b, 2, 3, LANES + 2, LANES + 3);
}
#undef VITRAL_QUARTERS

// Lane i of x, y and z gets table[rows[i] * stride + 0, 1 and 2].
static inline void gather3(const float* table, size_t stride, const uint32_t* rows, Float& x, Float& y,
                           Float& z) {
  const FloatVector r0 = load_rows(table, stride, rows, 0), r1 = load_rows(table, stride, rows, 1);
  const FloatVector r2 = load_rows(table, stride, rows, 2), r3 = load_rows(table, stride, rows, 3);
  const FloatVector xy01 = low_pairs(r0, r1), xy23 = low_pairs(r2, r3);
  const FloatVector z01 = high_pairs(r0, r1), z23 = high_pairs(r2, r3);
  x = low_halves(xy01, xy23);
  y = high_halves(xy01, xy23);
  z = low_halves(z01, z23);
}

#endif

// Lane i gets table[i's index], an index below LANES.
#if LANES == 1
static inline Float pick(Float table, Uint) {
  return table;
}
#else
static inline Float pick(Float table, Uint index) {
#if LANES == 16
  return FloatVector(_mm512_maskz_permutexvar_ps(0xffff, __m512i(index.v), __m512(table.v)));
#elif LANES == 8
  return FloatVector(_mm256_permutevar8x32_ps(__m256(table.v), __m256i(index.v)));
#else
  const UintVector i = index.v;
  return FloatVector{table.v[i[0]], table.v[i[1]], table.v[i[2]], table.v[i[3]]};
#endif
}
#endif
static inline Uint pick(Uint table, Uint index) {
  return as_bits(pick(from_bits(table), index));
}

}  // namespace VITRAL_ISA
}  // namespace vitral
