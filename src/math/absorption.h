// Light on its way through coloured glass.
#pragma once
#include "math/elementary.h"
#include "vitral/vec.h"

namespace vitral {

// exp(-absorption * length), the part of light that is left (Beer and Lambert); 1 where nothing absorbs,
// however long the way. Neither is negative.
static inline float transmittance(float absorption, float length) {
  if (!(absorption > 0)) return 1;
  constexpr double kLog2OfE = 1.4426950408889634;
  return static_cast<float>(
      exp2_of(-kLog2OfE * (static_cast<double>(absorption) * static_cast<double>(length))));
}
static inline Vec3 transmittance(const Vec3& absorption, float length) {
  return {transmittance(absorption.x, length), transmittance(absorption.y, length),
          transmittance(absorption.z, length)};
}

}  // namespace vitral
