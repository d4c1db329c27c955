// Randomness from integer hashes: the same numbers on every machine.
#pragma once
#include <cstdint>

namespace plaza {

// Wellons' lowbias32 (2018): every input bit reaches every output bit.
static inline uint32_t hash(uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  x ^= x >> 16;
  return x;
}
static inline uint32_t hash(uint32_t x, uint32_t y) {
  return hash(x ^ hash(y + 0x9e3779b9u));
}
static inline uint32_t hash(uint32_t x, uint32_t y, uint32_t z) {
  return hash(hash(x, y), z);
}

// In [0, 1), a multiple of 2^-32.
static inline double unit(uint32_t bits) {
  return bits * (1.0 / 4294967296.0);
}

// A stream of numbers; equal seeds give equal streams.
struct Random {
  uint32_t seed = 0;
  uint32_t count = 0;
};
static inline double uniform(Random& r) {
  return unit(hash(r.seed, r.count++));
}
static inline double between(Random& r, double low, double high) {
  return low + (high - low) * uniform(r);
}

}  // namespace plaza
