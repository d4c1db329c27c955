// Triangles of a few pixels, one in each lane: what they cover, and how deep they are there.
#pragma once
#include "kdtree/triangle.h"
#include "raster/coverage.h"
#include "raster/project.h"
#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {

// As in ScreenVertex.
struct ScreenCorners {
  Int x[3], y[3];
  Float inverse_depth[3];
  Uint outside_any, outside_all;
};

// Which of the pixels in the box around each small triangle are covered: pixel (i, j) of the box in
// covered[j * kSmallSide + i]. All edge values are below 2^23.
struct Coverage {
  Int x0, y0;  // the box's corner
  Mask covered[kSmallSide * kSmallSide];
  bool any;
};
static inline Coverage find_coverage(const SetupInput& in, const ScreenCorners& c, Mask used) {
  Coverage coverage;
  const Int x[3] = {snapped(c.x[0]), snapped(c.x[1]), snapped(c.x[2])};
  const Int y[3] = {snapped(c.y[0]), snapped(c.y[1]), snapped(c.y[2])};
  const PixelBoxT<Int> box = centers_within(x, y);
  coverage.x0 = box.x0, coverage.y0 = box.y0;

  Int value[3], across[3], down[3];
  for (int k = 0; k < 3; ++k) {
    const int next = k == 2 ? 0 : k + 1;
    const Int right = y[k] - y[next], below = x[next] - x[k];
    const Int dx = box.x0 * Int(kSubpixels) + Int(kSubpixels / 2) - x[k];
    const Int dy = box.y0 * Int(kSubpixels) + Int(kSubpixels / 2) - y[k];
    value[k] = right * dx + below * dy - select(is_left_or_top(right, below), Int(0), Int(1));
    across[k] = right * Int(kSubpixels);
    down[k] = below * Int(kSubpixels);
  }

  const PixelBox& window = in.projection.window;
  coverage.any = false;
  for (int j = 0; j < kSmallSide; ++j) {
    const Int py = box.y0 + Int(j);
    const Mask row = both(used, both(py >= Int(window.y0), py < Int(window.y1)));
    Int v[3] = {value[0], value[1], value[2]};
    for (int i = 0; i < kSmallSide; ++i) {
      const Int px = box.x0 + Int(i);
      const Mask inside = (v[0] | v[1] | v[2]) >= Int(0);
      const Mask m = both(both(inside, row), both(px >= Int(window.x0), px < Int(window.x1)));
      coverage.covered[j * kSmallSide + i] = m;
      coverage.any |= any(m);
      for (int k = 0; k < 3; ++k) v[k] = v[k] + across[k];
    }
    for (int k = 0; k < 3; ++k) value[k] = value[k] + down[k];
  }
  return coverage;
}

// Inverse depth from pixel centre to pixel centre: the plane through the corners at their fine places. A
// place is off by less than 2^-kFineBits pixels, and the depth by as much as it changes over that.
struct SmallPlane {
  Float across, down, at_corner, least, greatest;
};
static inline SmallPlane small_plane(const ScreenCorners& c, Int x0, Int y0) {
  const Float unit = Float(1.0f / (1 << kFineBits));
  const auto from_0 = [&](Int to, Int from) { return to_float(to - from) * unit; };
  const Float x1 = from_0(c.x[1], c.x[0]), x2 = from_0(c.x[2], c.x[0]);
  const Float y1 = from_0(c.y[1], c.y[0]), y2 = from_0(c.y[2], c.y[0]);
  const Float z0 = c.inverse_depth[0], z1 = c.inverse_depth[1] - z0, z2 = c.inverse_depth[2] - z0;
  const Float area = x1 * y2 - y1 * x2;
  const Mask has_plane = absolute(area) > Float(0.0f);
  const Float inverse = Float(1.0f) / select(has_plane, area, Float(1.0f));
  const Float across = select(has_plane, (z1 * y2 - z2 * y1) * inverse, Float(0.0f));
  const Float down = select(has_plane, (z2 * x1 - z1 * x2) * inverse, Float(0.0f));
  constexpr int32_t half = 1 << (kFineBits - 1);
  const Float dx = from_0(x0 * Int(1 << kFineBits) + Int(half), c.x[0]);
  const Float dy = from_0(y0 * Int(1 << kFineBits) + Int(half), c.y[0]);
  return {across, down, (z0 + across * dx) + down * dy,
          least_of(c.inverse_depth[0], c.inverse_depth[1], c.inverse_depth[2]),
          greatest_of(c.inverse_depth[0], c.inverse_depth[1], c.inverse_depth[2])};
}

}  // namespace VITRAL_ISA
}  // namespace vitral
