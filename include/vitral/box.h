// Axis-aligned boxes. The empty box is inverted (min = +inf, max = -inf), so that extending it by a
// point gives that point.
#pragma once
#include "vitral/vec.h"

#include <limits>

namespace vitral {

struct Box {
  Vec3 min{std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
           std::numeric_limits<float>::infinity()};
  Vec3 max{-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
           -std::numeric_limits<float>::infinity()};
};

static inline float least(float a, float b) {
  return a < b ? a : b;
}
static inline float greatest(float a, float b) {
  return a > b ? a : b;
}

static inline bool is_empty(const Box& b) {
  return !(b.min.x <= b.max.x && b.min.y <= b.max.y && b.min.z <= b.max.z);
}

static inline void extend(Box& b, const Vec3& p) {
  b.min = {least(p.x, b.min.x), least(p.y, b.min.y), least(p.z, b.min.z)};
  b.max = {greatest(p.x, b.max.x), greatest(p.y, b.max.y), greatest(p.z, b.max.z)};
}
static inline void extend(Box& b, const Box& o) {
  extend(b, o.min);
  extend(b, o.max);
}
static inline Vec3 extent(const Box& b) {
  return b.max - b.min;
}
static inline Vec3 center(const Box& b) {
  return (b.min + b.max) * 0.5f;
}
static inline float diagonal(const Box& b) {
  return is_empty(b) ? 0.0f : length(extent(b));
}

// The largest absolute coordinate of the box: the scale of every rounding error inside it.
static inline float magnitude(const Box& b) {
  float m = 0;
  for (int axis = 0; axis < 3; ++axis) {
    m = greatest(m, greatest(-component(b.min, axis), component(b.max, axis)));
  }
  return m;
}

}  // namespace vitral
