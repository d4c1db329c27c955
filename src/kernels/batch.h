// Triangles as the rays of one point see them, kBatch at a time, and where in the plane of the rays they are.
//
// Rays that run fastest along the same axis, in the same sense, are points (sx, sy) of a plane: the shear of
// the triangle test (kdtree/triangle.h). Their common origin makes a triangle's corners the same for all of
// them, and each edge value of the test a linear function of the point. Depth is measured along that axis, so
// that t is depth / |dz|.
#pragma once
#include "kdtree/kdtree.h"
#include "kdtree/triangle.h"
#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {

// The rays at hand: their origin, permuted so that they run fastest along z, and which way they do.
struct View {
  int k[3];
  float o[3];
  float forward;             // +1 or -1
  float tmin;                // of all rays
  float before_all, in_all;  // depths below the first are before every ray's tmin, above the second none is
};

// Triangles as the rays see them, side by side.
inline constexpr int kBatch = 16;
struct alignas(64) Line {
  float x[kBatch], y[kBatch], c[kBatch];
};
struct alignas(64) Batch {
  float corner[9][kBatch];                               // relative to the origin, permuted: exact
  float x0[kBatch], x1[kBatch], y0[kBatch], y1[kBatch];  // no ray outside this meets it
  float nearest[kBatch];                                 // nor at a lower depth
  Line edge[3];                                          // the test's edge values, in any order, up to
  float doubt[kBatch];                                   // so much
  float spread[kBatch], rounding[kBatch];  // the error of a computed depth: spread / area + rounding
  uint32_t id[kBatch], flags[kBatch];
  int count;
};

static inline Vec3T<Float> load_corner(const Batch& batch, int k, int g) {
  return {load(batch.corner[3 * k] + g), load(batch.corner[3 * k + 1] + g),
          load(batch.corner[3 * k + 2] + g)};
}

// Bounds the triangles from g on.
//
// Where a corner lies at (s, r) z, the exact test sees it at s z - sx z, off by 2^-24 (2 + |s|) z; s itself
// is computed with two roundings. A ray farther than 2^-20 outside in s finds all three corners on one side.
// A triangle that comes too near the origin's plane, or crosses it, has no bounds.
//
// With no coordinate beyond R, the exact test has corners that are off by 3 2^-24 R, and so edge values, of
// numbers up to 2 R, by 1.5 2^-20 R^2. Those of a linear function computed here are off by less than 2^-20
// R^2. Together they doubt all edge values below 2^-18 R^2.
static void bound_triangles(const View& view, int g, Batch& batch) {
  Vec3T<Float> p[3];
  Vec3T<Float> low{Float(kInfinity), Float(kInfinity), Float(kInfinity)}, high = -low;
  Float x0 = Float(kInfinity), y0 = x0, x1 = Float(-kInfinity), y1 = x1;
  for (int k = 0; k < 3; ++k) {
    const Vec3T<Float> c = load_corner(batch, k, g);
    p[k] = {c.x - Float(view.o[0]), c.y - Float(view.o[1]), c.z - Float(view.o[2])};
    store(batch.corner[3 * k] + g, p[k].x), store(batch.corner[3 * k + 1] + g, p[k].y);
    store(batch.corner[3 * k + 2] + g, p[k].z);
    low = {least(p[k].x, low.x), least(p[k].y, low.y), least(p[k].z, low.z)};
    high = {greatest(p[k].x, high.x), greatest(p[k].y, high.y), greatest(p[k].z, high.z)};
    const Float r = Float(1.0f) / p[k].z, sx = p[k].x * r, sy = p[k].y * r;
    x0 = least(sx, x0), x1 = greatest(sx, x1), y0 = least(sy, y0), y1 = greatest(sy, y1);
  }
  const Float nearest = view.forward > 0 ? low.z : -high.z, farthest = view.forward > 0 ? high.z : -low.z;
  const Float magnitude = greatest(absolute(nearest), absolute(farthest));
  const Float reach = greatest_of(greatest(absolute(low.x), absolute(high.x)),
                                  greatest(absolute(low.y), absolute(high.y)), magnitude);
  const Float depth = farthest - nearest;
  const Float extent = (greatest(high.x - low.x, high.y - low.y) + depth) + reach * Float(0x1p-20f);
  const Float rounding = magnitude * Float(0x1p-20f) + Float(1e-36f), margin = Float(0x1p-20f);
  const Mask ahead = nearest > Float(0x1p-120f);
  const Mask behind = farthest + rounding < Float(view.before_all);
  const Float all = Float(kInfinity);
  store(batch.x0 + g, select(ahead, x0 - margin, -all)), store(batch.x1 + g, select(ahead, x1 + margin, all));
  store(batch.y0 + g, select(ahead, y0 - margin, -all)), store(batch.y1 + g, select(ahead, y1 + margin, all));
  store(batch.nearest + g, select(behind, all, nearest - rounding));
  store(batch.spread + g, extent * extent * depth * Float(0x1p-20f));
  store(batch.rounding + g, rounding);
  for (int k = 0; k < 3; ++k) {
    const Vec3T<Float> e = cross(p[k], p[(k + 1) % 3]);
    store(batch.edge[k].x + g, e.x), store(batch.edge[k].y + g, e.y), store(batch.edge[k].c + g, e.z);
  }
  store(batch.doubt + g, reach * reach * Float(0x1p-18f) + Float(1e-36f));
}

static inline void fetch(const KdView& tree, const View& view, const uint32_t* ids, int count, Batch& batch) {
  batch.count = count;
  for (int i = 0; i < kBatch; ++i) {
    const uint32_t id = ids[i < count ? i : 0];
    const KdTriangle& t = tree.triangles[id];
    batch.id[i] = id, batch.flags[i] = t.flags;
    for (int k = 0; k < 3; ++k) {
      for (int a = 0; a < 3; ++a) batch.corner[3 * k + a][i] = t.corner[k][view.k[a]];
    }
  }
  for (int g = 0; g < count; g += kLanes) bound_triangles(view, g, batch);
}

static inline Vec3T<Float> corner_at(const Batch& batch, int i, int k) {
  return {Float(batch.corner[3 * k][i]), Float(batch.corner[3 * k + 1][i]),
          Float(batch.corner[3 * k + 2][i])};
}

}  // namespace VITRAL_ISA
}  // namespace vitral
