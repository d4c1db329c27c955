// A ray is the set of points origin + t * direction with t in the open interval (tmin, tmax).
// Directions need not have unit length; their largest component must lie within [2^-32, 2^32].
#pragma once
#include "vitral/vec.h"

#include <cstdint>
#include <limits>

namespace vitral {

inline constexpr uint32_t kNoTriangle = 0xffffffffu;
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Ray {
  Vec3 origin;
  float tmin = 0;
  Vec3 direction;
  float tmax = kInfinity;
};

// The point is (1-u-v) A + u B + v C of triangle ABC. Of two hits at the same t the lower triangle
// number is the closer one, so that the closest hit does not depend on the order of the search.
struct Hit {
  float t = kInfinity;
  float u = 0, v = 0;
  uint32_t triangle = kNoTriangle;
};

}  // namespace vitral
