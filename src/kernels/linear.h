// Linear functions over rectangles: how an outline, or a plane, lies to many points at once.
#pragma once
#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {

// Rectangles, a lane each.
struct Rectangles {
  Float x0, x1, y0, y1;
};

// The least and the greatest value of a x + b y + c over the rectangle. With products and sums each rounded
// once, both are off by at most 2^-22 of the greatest |a x| + |b y| + |c|.
struct Span {
  Float least, greatest;
};
static inline Span span_of(Float a, Float b, Float c, const Rectangles& r) {
  const Float ax0 = a * r.x0, ax1 = a * r.x1, by0 = b * r.y0, by1 = b * r.y1;
  return {(least(ax0, ax1) + least(by0, by1)) + c, (greatest(ax0, ax1) + greatest(by0, by1)) + c};
}

// The same of a x + b y + c z + d, for z from z0 to z1.
static inline Span span_of(Float a, Float b, Float c, Float d, const Rectangles& r, Float z0, Float z1) {
  const Span s = span_of(a, b, d, r);
  const Float cz0 = c * z0, cz1 = c * z1;
  return {s.least + least(cz0, cz1), s.greatest + greatest(cz0, cz1)};
}

// Do the rectangles have a point in common?
static inline Mask overlap(const Rectangles& a, const Rectangles& b) {
  return both(both(a.x0 <= b.x1, a.x1 >= b.x0), both(a.y0 <= b.y1, a.y1 >= b.y0));
}

}  // namespace VITRAL_ISA
}  // namespace vitral
