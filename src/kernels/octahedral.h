// Unit vectors in 32 bits: the octahedron |x| + |y| + |z| = 1 unfolded to a square (Meyer, Suessmuth,
// Sussner, Stamminger and Greiner, "On Floating-Point Normal Vectors", EGSR 2010).
#pragma once
#include "math/scalar.h"
#include "vitral/vec.h"

#include <cstdint>

namespace vitral {

// `n` may have any length but 0. x of the square in the lower 16 bits, y in the upper ones: -1 is 0 and 1 is
// 65535, rounded to the nearest.
template <class F>
static inline auto octahedral_normal(const Vec3T<F>& n) {
  const F one = F(1.0f);
  const F inverse = one / ((absolute(n.x) + absolute(n.y)) + absolute(n.z));
  const F x = n.x * inverse, y = n.y * inverse;
  const auto below = n.z < F(0.0f);
  const F sx = select(below, copy_sign(one - absolute(y), x), x);
  const F sy = select(below, copy_sign(one - absolute(x), y), y);
  using Bits = decltype(as_bits(x));
  // Numbers from 2^23 on are whole: the sum rounds, and its last bits are the code.
  const auto code = [](const F& s) {
    const auto bits = as_bits((s * F(32767.5f) + F(32767.5f)) + F(8388608.0f));
    return bits & Bits(0xffffu);
  };
  return code(sx) | (code(sy) << 16);
}

static inline Vec3 normal_of_octahedral(uint32_t packed) {
  const auto axis = [](uint32_t code) { return static_cast<float>(code) * (2.0f / 65535) - 1; };
  const float x = axis(packed & 0xffffu), y = axis(packed >> 16);
  const float z = 1 - absolute(x) - absolute(y);
  if (z >= 0) return normalize(Vec3{x, y, z});
  return normalize(Vec3{copy_sign(1 - absolute(y), x), copy_sign(1 - absolute(x), y), z});
}

}  // namespace vitral
