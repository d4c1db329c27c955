// The fill rule, once. A pixel is covered when its centre lies inside the snapped triangle, or on an
// edge that is a left or a top one: of two triangles that share an edge exactly one gets its pixels.
//
// Edge functions after Pineda, "A Parallel Algorithm for Polygon Rasterization", SIGGRAPH 1988.
#pragma once
#include "math/scalar.h"
#include "raster/raster.h"

#include <cstdint>

namespace vitral {

// A pixel (i, j) to the right of and below the one the edge was made for is on the inner side when
// value + i * across + j * down >= 0.
//
// The exact edge function at centres grows by 256 * across and 256 * down a pixel. As these are
// multiples of 256, E + 256 k >= 0 holds exactly when floor(E / 256) + k >= 0: no bit that matters
// is lost by the shift.
struct Edge {
  int64_t value;
  int32_t across, down;
};

// With y down and the inside positive, a left edge runs up and a top edge runs to the right; the others
// give up their zeros.
template <class I>
static inline auto is_left_or_top(const I& across, const I& down) {
  const I zero = I(0);
  return either(across > zero, both(across == zero, down > zero));
}

// The edge from (px, py) to (qx, qy), seen from the centre of pixel (x, y).
static inline Edge make_edge(int32_t px, int32_t py, int32_t qx, int32_t qy, int x, int y) {
  const int32_t across = py - qy, down = qx - px;
  const bool left_or_top = is_left_or_top(across, down);
  const int64_t dx = static_cast<int64_t>(x) * kSubpixels + kSubpixels / 2 - px;
  const int64_t dy = static_cast<int64_t>(y) * kSubpixels + kSubpixels / 2 - py;
  const int64_t exact = across * dx + down * dy;
  return {(exact - (left_or_top ? 0 : 1)) >> kSubpixelBits, across, down};
}

// Twice the area, positive when the edges 0-1, 1-2, 2-0 have the inside on their positive side. W holds
// the products.
template <class W, class I>
static inline W doubled_area(const I x[3], const I y[3]) {
  return W(x[1] - x[0]) * W(y[2] - y[0]) - W(y[1] - y[0]) * W(x[2] - x[0]);
}

// The pixels whose centres lie in the bounding box of three snapped points.
template <class I>
static inline PixelBoxT<I> centers_within(const I x[3], const I y[3]) {
  const I x0 = least(least(x[0], x[1]), x[2]), x1 = greatest(greatest(x[0], x[1]), x[2]);
  const I y0 = least(least(y[0], y[1]), y[2]), y1 = greatest(greatest(y[0], y[1]), y[2]);
  const I half = I(kSubpixels / 2), one = I(1);
  return {(x0 + (half - one)) >> kSubpixelBits, (y0 + (half - one)) >> kSubpixelBits,
          ((x1 - half) >> kSubpixelBits) + one, ((y1 - half) >> kSubpixelBits) + one};
}

// Whether the triangle covers the pixel (x, y); its area must be positive.
static inline bool covers(const int32_t px[3], const int32_t py[3], int x, int y) {
  return make_edge(px[0], py[0], px[1], py[1], x, y).value >= 0 &&
         make_edge(px[1], py[1], px[2], py[2], x, y).value >= 0 &&
         make_edge(px[2], py[2], px[0], py[0], x, y).value >= 0;
}

static inline PixelBox intersection(const PixelBox& a, const PixelBox& b) {
  return {a.x0 > b.x0 ? a.x0 : b.x0, a.y0 > b.y0 ? a.y0 : b.y0, a.x1 < b.x1 ? a.x1 : b.x1,
          a.y1 < b.y1 ? a.y1 : b.y1};
}
static inline bool is_empty(const PixelBox& b) {
  return b.x0 >= b.x1 || b.y0 >= b.y1;
}

}  // namespace vitral
