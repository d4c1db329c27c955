// Random numbers without state: a hash of where and what for. The same pixel gets the same numbers
// whatever is rendered around it and whoever renders it.
#pragma once
#include "math/scalar.h"

#include <cstdint>

namespace vitral {

// Chris Wellons' lowbias32 ("Prospecting for Hash Functions", 2018): a bijection of 32-bit integers.
template <class U>
static inline U hash32(U x) {
  x = x ^ (x >> 16);
  x = x * U(0x7feb352du);
  x = x ^ (x >> 15);
  x = x * U(0x846ca68bu);
  return x ^ (x >> 16);
}

// The key of a pixel; of a path that leaves it by branch `branch`; of sample s of a point with a key.
template <class U>
static inline U pixel_key_of(const U& x, const U& y, uint32_t seed) {
  return hash32(hash32(U(hash32(seed)) + x) + y);
}
static inline uint32_t pixel_key(int x, int y, uint32_t seed) {
  return pixel_key_of(static_cast<uint32_t>(x), static_cast<uint32_t>(y), seed);
}
template <class U>
static inline U branch_key(const U& key, uint32_t branch) {
  return hash32(key ^ U(branch * 0x9e3779b9u));
}
// Keys are hashes already: what is added per sample only has to be odd.
inline constexpr uint32_t kSampleStep = 0x9e3779b9u;
template <class U>
static inline U sample_hash(const U& key, uint32_t sample, uint32_t step = kSampleStep) {
  return hash32(key + U(sample * step));
}

}  // namespace vitral
