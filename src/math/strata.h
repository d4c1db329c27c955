// Stratified random numbers: sample `index` of `count` of a set that belongs to a key.
//
// The pairs of a set are a Hammersley set (Hammersley 1960) whose digits are scrambled at random and whose
// points are jittered within their finest cells: each number alone is uniform over [0, 1), in the first every
// count-th part holds one sample, and where count is a power of two so does every rectangle of the area
// 1/count whose sides are powers of two, the squares of an n x n grid among them (Kollig and Keller,
// "Efficient Multidimensional Sampling", 2002). Sets of different keys are independent.
#pragma once
#include "math/random.h"

#include <cstdint>

namespace vitral {

template <class F>
struct Pair {
  F u, v;  // [0, 1)
};

template <class U>
static inline U reverse_bits(U x) {
  x = ((x >> 1) & U(0x55555555u)) | ((x & U(0x55555555u)) << 1);
  x = ((x >> 2) & U(0x33333333u)) | ((x & U(0x33333333u)) << 2);
  x = ((x >> 4) & U(0x0f0f0f0fu)) | ((x & U(0x0f0f0f0fu)) << 4);
  x = ((x >> 8) & U(0x00ff00ffu)) | ((x & U(0x00ff00ffu)) << 8);
  return (x >> 16) | (x << 16);
}

// 32 random bits to [0, 1): 24 of them, so that no sum rounds up to 1.
template <class U>
static inline auto unit_of_bits(const U& bits) {
  using F = decltype(to_float(bits));
  return to_float(bits >> 8) * F(0x1p-24f);
}

// The digits of a set's second numbers are exchanged by these bits.
template <class U>
static inline U scrambled_bits(const U& key) {
  return hash32(key ^ U(0x3c6ef372u));
}

template <class U>
static inline auto stratified_pair(const U& index, uint32_t count, const U& key) {
  const U own = hash32(key + index * U(kSampleStep)), other = hash32(own ^ U(0x68bc21ebu));
  using F = decltype(to_float(key));
  // Digits above the finest cells are those of the set, scrambled; those below are the sample's own.
  const uint32_t fine = count <= 1 ? 0xffffffffu : 0xffffffffu >> (32 - __builtin_clz(count - 1));
  const U scrambled = reverse_bits(index) ^ scrambled_bits(key);
  const U digits = (scrambled & U(~fine)) | (other & U(fine));
  const F within = (unit_of_bits(own) + to_float(index)) * F(1.0f / static_cast<float>(count));
  return Pair<F>{least(within, F(0x1.fffffep-1f)), unit_of_bits(digits)};
}

// Which of a set's first n samples, n a power of two, lies in the k-th of n equal cells of the square: so
// sets of different keys are asked for samples that lie near each other. The cells differ from key to key
// only by what the set divides its first numbers into, if it has more than n samples.
template <class U>
static inline U sample_in_cell(uint32_t k, uint32_t n, const U& key) {
  const int columns = (31 - __builtin_clz(n)) / 2;  // cells side by side in the second number: 2^columns
  if (columns == 0) return U(k);
  const uint32_t column = k & ((1u << columns) - 1);
  const U low = reverse_bits(U(column) ^ (scrambled_bits(key) >> (32 - columns))) >> (32 - columns);
  return U(k - column) + low;
}

// A random order of 0..count-1: the place of `index`. Integers of as many bits as count needs are mixed, one
// to one, until the place falls below count.
template <class U>
static inline U shuffled(uint32_t index, uint32_t count, const U& key) {
  if (count <= 1) return U(0u);
  const int bits = 32 - __builtin_clz(count - 1);
  const U mask = U(0xffffffffu >> (32 - bits));
  U x = U(index), place = x;
  auto open = x == x;
  do {
    for (uint32_t round = 0; round < 4; ++round) {
      const U k = hash32(key + U(round * kSampleStep));
      x = (x ^ k) & mask;
      x = (x * ((k >> 16) | U(1u))) & mask;
      x = x ^ (x >> (bits > 1 ? bits / 2 : 1));
      x = (x + (k >> 24)) & mask;
      x = (x * ((k >> 20) | U(1u))) & mask;
      x = x ^ (x >> ((bits + 1) / 2));
    }
    place = select(open, x, place);
    open = both(open, place >= U(count));
  } while (any(open));
  return place;
}

}  // namespace vitral
