// The pinhole camera of one frame: pixels to rays, points to pixels. Plain data, shared by the
// rasterizer, the tracer and the shading.
#pragma once
#include "vitral/scene.h"
#include "vitral/vec.h"

#include <cstdint>

namespace vitral {

// The ray through pixel centre (x + 0.5, y + 0.5), y down, is
//   direction = forward + right * ((x + 0.5) * step - center_x) + up * (center_y - (y + 0.5) * step)
// with orthonormal right, up, forward: its parameter t is the depth, the distance along `forward`. Shifted
// centers look through other points of the pixels, or from another point of a lens.
struct Pinhole {
  Vec3 origin;
  Vec3 right, up, forward;   // orthonormal
  float step;                // side of a pixel on the plane at depth 1
  float center_x, center_y;  // where the axis meets that plane, from the picture's upper left corner
  float near, far;           // depths; only what lies between is seen
  float footprint;           // side, on that plane, of the part of a pixel that one sample stands for
};

// A thin lens in the pinhole's place: points at the depth `focus` are seen where the pinhole sees them,
// whatever point of the lens is looked through. Each pixel takes points of its own, number `index` of
// `count`.
struct Lens {
  float radius = 0;  // 0: the pinhole
  float focus = 1;
  uint32_t index = 0, count = 1;
  uint32_t seed = 0;
};

// The tangent of half the vertical field of view is found by own arithmetic, not by the C library.
Pinhole make_pinhole(const Camera& camera, int width, int height);

template <class F>
static inline Vec3T<F> primary_direction(const Pinhole& c, const F& x, const F& y) {
  const F a = (x + F(0.5f)) * F(c.step) - F(c.center_x);
  const F b = F(c.center_y) - (y + F(0.5f)) * F(c.step);
  return {(F(c.forward.x) + F(c.right.x) * a) + F(c.up.x) * b,
          (F(c.forward.y) + F(c.right.y) * a) + F(c.up.y) * b,
          (F(c.forward.z) + F(c.right.z) * a) + F(c.up.z) * b};
}

}  // namespace vitral
