// Gradient noise (Perlin, "An Image Synthesizer", SIGGRAPH 1985; blending polynomial and the twelve gradients
// after his "Improving Noise", SIGGRAPH 2002). The lattice is hashed, so that it never repeats.
#pragma once
#include "math/random.h"
#include "vitral/vec.h"

#include <cstdint>

namespace vitral {

// The largest integer not above x, and the rest in [0, 1]. Where floats are coarser than integers: 0 and 0.
struct LatticePart {
  int32_t whole;
  float rest;
};
static inline LatticePart split_at_integer(float x) {
  if (!(x > -8388608.0f && x < 8388608.0f)) return {0, 0};
  const int32_t cut = static_cast<int32_t>(x);
  const int32_t whole = static_cast<float>(cut) > x ? cut - 1 : cut;
  return {whole, x - static_cast<float>(whole)};
}

static inline uint32_t lattice_hash(int32_t x, int32_t y, int32_t z) {
  return hash32(hash32(hash32(static_cast<uint32_t>(x)) + static_cast<uint32_t>(y)) +
                static_cast<uint32_t>(z));
}

// The lattice point's gradient, towards the middle of one of a cube's twelve edges, times the way from there.
static inline float gradient_part(uint32_t hash, float x, float y, float z) {
  const uint32_t left_out = (hash >> 16) % 3;
  const float a = left_out == 0 ? y : x, b = left_out == 2 ? y : z;
  return ((hash & 1) != 0 ? -a : a) + ((hash & 2) != 0 ? -b : b);
}

// In [-1, 1], 0 at the integers, with continuous second derivatives; neighbouring bumps are about 1 apart.
static inline float gradient_noise(const Vec3& p) {
  const LatticePart x = split_at_integer(p.x), y = split_at_integer(p.y), z = split_at_integer(p.z);
  const auto fade = [](float t) { return t * t * t * (t * (t * 6 - 15) + 10); };
  const auto mix = [](float a, float b, float t) { return a + (b - a) * t; };
  const auto corner = [&](int32_t i, int32_t j, int32_t k) {
    return gradient_part(lattice_hash(x.whole + i, y.whole + j, z.whole + k), x.rest - static_cast<float>(i),
                         y.rest - static_cast<float>(j), z.rest - static_cast<float>(k));
  };
  const float fx = fade(x.rest), fy = fade(y.rest), fz = fade(z.rest);
  const auto edge = [&](int32_t j, int32_t k) { return mix(corner(0, j, k), corner(1, j, k), fx); };
  const auto face = [&](int32_t k) { return mix(edge(0, k), edge(1, k), fy); };
  return mix(face(0), face(1), fz);
}

}  // namespace vitral
