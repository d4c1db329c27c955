// Records of three or four numbers from all over memory, one a lane, as registers of their components; and
// back. The records are loaded whole and turned in registers, which takes a quarter of the loads that lane by
// lane would.
#pragma once
#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {

#if LANES == 1

template <class Address>
static inline void load_records(const Address& address, Float out[4]) {
  std::memcpy(out, address(0), 4 * sizeof(float));
}
template <class Address>
static inline void store_records(const Address& address, const Float in[4]) {
  std::memcpy(address(0), in, 4 * sizeof(float));
}
static inline void gather3(const float* table, size_t stride, const uint32_t* rows, Float& x, Float& y,
                           Float& z) {
  const float* row = table + rows[0] * stride;
  x = row[0], y = row[1], z = row[2];
}
static inline Float pick(Float table, Uint) {
  return table;
}

#else

typedef float QuadVector __attribute__((vector_size(16)));

// The quads of lanes j, j + 4, j + 8, ... side by side.
template <class Quad>
static inline FloatVector join_quads(const Quad& quad, int j) {
#if LANES == 16
  const auto low = __builtin_shufflevector(quad(j), quad(j + 4), 0, 1, 2, 3, 4, 5, 6, 7);
  const auto high = __builtin_shufflevector(quad(j + 8), quad(j + 12), 0, 1, 2, 3, 4, 5, 6, 7);
  return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
#elif LANES == 8
  return __builtin_shufflevector(quad(j), quad(j + 4), 0, 1, 2, 3, 4, 5, 6, 7);
#else
  return quad(j);
#endif
}

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
// Four registers of joined quads to four of components, or the other way round: within every quarter of
// four lanes a 4x4 matrix is transposed.
static inline void transpose(FloatVector r[4]) {
  const FloatVector a = VITRAL_QUARTERS(r[0], r[1], 0, LANES, 1, LANES + 1);
  const FloatVector b = VITRAL_QUARTERS(r[0], r[1], 2, LANES + 2, 3, LANES + 3);
  const FloatVector c = VITRAL_QUARTERS(r[2], r[3], 0, LANES, 1, LANES + 1);
  const FloatVector d = VITRAL_QUARTERS(r[2], r[3], 2, LANES + 2, 3, LANES + 3);
  r[0] = VITRAL_QUARTERS(a, c, 0, 1, LANES, LANES + 1);
  r[1] = VITRAL_QUARTERS(a, c, 2, 3, LANES + 2, LANES + 3);
  r[2] = VITRAL_QUARTERS(b, d, 0, 1, LANES, LANES + 1);
  r[3] = VITRAL_QUARTERS(b, d, 2, 3, LANES + 2, LANES + 3);
}
#undef VITRAL_QUARTERS

// Four numbers from address(lane) on.
template <class Address>
static inline void load_records(const Address& address, Float out[4]) {
  const auto quad = [&](int lane) { return load_vector<QuadVector>(address(lane)); };
  FloatVector r[4];
  for (int j = 0; j < 4; ++j) r[j] = join_quads(quad, j);
  transpose(r);
  for (int i = 0; i < 4; ++i) out[i] = r[i];
}
template <class Address>
static inline void store_records(const Address& address, const Float in[4]) {
  FloatVector r[4] = {in[0].v, in[1].v, in[2].v, in[3].v};
  transpose(r);
  for (int lane = 0; lane < LANES; ++lane) {
    const float* joined = reinterpret_cast<const float*>(&r[lane % 4]);
    std::memcpy(address(lane), joined + lane / 4 * 4, 4 * sizeof(float));
  }
}

// Lane i of x, y and z gets table[rows[i] * stride + 0, 1 and 2]; nothing behind these is touched.
static inline void gather3(const float* table, size_t stride, const uint32_t* rows, Float& x, Float& y,
                           Float& z) {
  const auto quad = [&](int lane) {
    const float* p = table + rows[lane] * stride;
#if LANES == 16
    return QuadVector(_mm_maskz_loadu_ps(7, p));
#elif LANES == 8
    return QuadVector(_mm_maskload_ps(p, _mm_setr_epi32(-1, -1, -1, 0)));
#else
    return QuadVector{p[0], p[1], p[2], 0};
#endif
  };
  FloatVector r[4];
  for (int j = 0; j < 4; ++j) r[j] = join_quads(quad, j);
  transpose(r);
  x = r[0], y = r[1], z = r[2];
}

// Lane i gets table[i's index], an index below LANES.
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
