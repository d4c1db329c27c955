// Triangles as a directional light sees them, kBatch at a time, and the rays of a tile to it.
#pragma once
#include "kdtree/kdtree.h"
#include "kdtree/triangle.h"
#include "kernels/batch.h"
#include "kernels/cells.h"
#include "kernels/linear.h"
#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {

// Sheared coordinates around a reference point: x and y are constant along a ray and z grows along it.
struct LightFrame {
  int kx, ky, kz;
  float sx, sy, forward;  // forward: +1 or -1, the sign of the direction's kz component
  Vec3 reference;
  float extent;  // largest distance of an origin from the reference, in any coordinate
};

template <class F>
static inline Vec3T<F> shear(const LightFrame& frame, const Vec3T<F>& p) {
  const F c[3] = {p.x - F(frame.reference.x), p.y - F(frame.reference.y), p.z - F(frame.reference.z)};
  return {c[frame.kx] - F(frame.sx) * c[frame.kz], c[frame.ky] - F(frame.sy) * c[frame.kz],
          F(frame.forward) * c[frame.kz]};
}

// Triangles in the light's frame, one array per number. `nearest` is negative depth, as is what cells compare
// it with: the light is where depth is greatest.
struct alignas(64) Casters {
  float x0[kBatch], x1[kBatch], y0[kBatch], y1[kBatch];  // no ray outside this meets it
  float nearest[kBatch];                                 // nor one that starts at minus a lower depth
  Line edge[3];                                          // inside: a x + b y + c > 0
  float nx[kBatch], ny[kBatch], nz[kBatch], n0[kBatch];
  float doubt[kBatch];   // edge values beyond this have their sign for sure
  float inside[kBatch];  // and when all are above this the ray surely runs through
  float gate[kBatch];    // but it misses only if one is above this, too
  float beyond[kBatch];  // the plane n x + n0 surely lies before (after) the ray beyond this
  uint32_t id[kBatch];
  int count;
};

// Where some rays start.
struct Starts {
  Rectangle4 bounds;
  float least_z, greatest_z;
};

struct alignas(64) CornerLanes {
  float x[3][kLanes], y[3][kLanes], z[3][kLanes];
  uint32_t flags[kLanes];
};

// Adds those of up to kLanes triangles that rays from these starts can meet. Returns Cover::all when one of
// them keeps all of the rays from the light.
enum class Cover { some, all };
static Cover add_casters(const KdView& tree, const LightFrame& frame, const Starts& starts, GlassRule glass,
                         const uint32_t* ids, int count, Casters& out) {
  const Rectangles bounds{Float(starts.bounds.x0), Float(starts.bounds.x1), Float(starts.bounds.y0),
                          Float(starts.bounds.y1)};
  CornerLanes corners;
  alignas(64) uint32_t id[kLanes];
  for (int i = 0; i < kLanes; ++i) {
    id[i] = ids[i < count ? i : 0];
    const KdTriangle& t = tree.triangles[id[i]];
    for (int k = 0; k < 3; ++k) {
      corners.x[k][i] = t.corner[k][0], corners.y[k][i] = t.corner[k][1], corners.z[k][i] = t.corner[k][2];
    }
    corners.flags[i] = t.flags;
  }
  Vec3T<Float> p[3];
  for (int k = 0; k < 3; ++k) {
    p[k] = shear(frame, Vec3T<Float>{load(corners.x[k]), load(corners.y[k]), load(corners.z[k])});
  }
  const Float x0 = least_of(p[0].x, p[1].x, p[2].x), x1 = greatest_of(p[0].x, p[1].x, p[2].x);
  const Float y0 = least_of(p[0].y, p[1].y, p[2].y), y1 = greatest_of(p[0].y, p[1].y, p[2].y);
  const Float z0 = least_of(p[0].z, p[1].z, p[2].z), z1 = greatest_of(p[0].z, p[1].z, p[2].z);

  // Every corner as the exact test sees it, and every origin, is within `error` of the one here: they have
  // come about by 15 roundings of numbers no larger than `reach`.
  const Float reach = (greatest(greatest(absolute(x0), absolute(x1)), greatest(absolute(y0), absolute(y1))) +
                       greatest(absolute(z0), absolute(z1))) +
                      Float(frame.extent);
  const Float error = reach * Float(1.0f / 1048576), tiny = Float(1e-35f);
  const Float size = (x1 - x0) + (y1 - y0);
  const Float starts_size =
      Float((starts.bounds.x1 - starts.bounds.x0) + (starts.bounds.y1 - starts.bounds.y0));
  const Float margin = error * ((size + starts_size) * Float(3.0f) + error * Float(4.0f)) + tiny;

  // Corners in counterclockwise order make all edge values positive inside.
  const Vec3T<Float> ab = p[1] - p[0], ac = p[2] - p[0];
  const Float area = ab.x * ac.y - ab.y * ac.x;
  const Float turn = copy_sign(Float(1.0f), area);
  const Mask sliver = invert(absolute(area) > margin * Float(2.0f));
  Float a[3], b[3], c[3];
  Mask apart = either(either(x1 + error<Float(starts.bounds.x0), x0 - error> Float(starts.bounds.x1)),
                      either(y1 + error<Float(starts.bounds.y0), y0 - error> Float(starts.bounds.y1)));
  apart = either(apart, z1 + error < Float(starts.least_z));
  Span edges{Float(kInfinity), Float(kInfinity)};
  Float clear = Float(-kInfinity);
  for (int k = 0; k < 3; ++k) {
    const Vec3T<Float>&from = p[k], &to = p[(k + 1) % 3];
    a[k] = (from.y - to.y) * turn, b[k] = (to.x - from.x) * turn;
    c[k] = -(a[k] * from.x + b[k] * from.y);
    const Span e = span_of(a[k], b[k], c[k], bounds);
    edges = {least(edges.least, e.least), least(edges.greatest, e.greatest)};
    clear = greatest(clear, e.least);
  }
  apart = either(apart, both(edges.greatest < -margin, either(invert(sliver), clear > margin)));

  // The plane: positive where the ray has the triangle before it.
  const Vec3T<Float> normal = cross(ab, ac) * (-turn);
  const Float n0 = -dot(normal, p[0]);
  const Float area_of_box = size * (z1 - z0) + (x1 - x0) * (y1 - y0);
  const Float beyond = error * (area_of_box * Float(11.0f)) + tiny;
  const Span plane =
      span_of(normal.x, normal.y, normal.z, n0, bounds, Float(starts.least_z), Float(starts.greatest_z));
  apart = either(apart, both(plane.greatest < -beyond, invert(sliver)));

  if (glass == GlassRule::passes)
    apart = either(apart, invert((load(corners.flags) & Uint(kGlassTriangle)) == Uint(0u)));
  const Mask wanted = both(invert(apart), mask_of_bits((1ull << count) - 1));
  if (!any(wanted)) return Cover::some;
  const Mask cut_out = invert((load(corners.flags) & Uint(kCutOutTriangle)) == Uint(0u));
  const Mask unsure = either(cut_out, sliver);
  if (any(both(both(wanted, invert(unsure)), both(edges.least > margin, plane.least > beyond))))
    return Cover::all;
  const int n = out.count;
  compress(out.x0 + n, x0 - error, wanted), compress(out.x1 + n, x1 + error, wanted);
  compress(out.y0 + n, y0 - error, wanted), compress(out.y1 + n, y1 + error, wanted);
  compress(out.nearest + n, -(z1 + error), wanted);
  for (int k = 0; k < 3; ++k) {
    compress(out.edge[k].x + n, a[k], wanted), compress(out.edge[k].y + n, b[k], wanted);
    compress(out.edge[k].c + n, c[k], wanted);
  }
  compress(out.nx + n, normal.x, wanted), compress(out.ny + n, normal.y, wanted);
  compress(out.nz + n, normal.z, wanted), compress(out.n0 + n, n0, wanted);
  compress(out.inside + n, select(unsure, Float(kInfinity), margin), wanted);
  compress(out.doubt + n, margin, wanted);
  compress(out.gate + n, select(sliver, margin, Float(-kInfinity)), wanted);
  compress(out.beyond + n, select(sliver, Float(kInfinity), beyond), wanted);
  compress(out.id + n, load(id), wanted);
  out.count += __builtin_popcount(bits(wanted));
  return Cover::some;
}

}  // namespace VITRAL_ISA
}  // namespace vitral
