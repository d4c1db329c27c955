// Where rays met their triangles: the points at which secondary rays start.
#include "kernels/points.h"
#include "kernels/tables.h"
#include "math/scalar.h"
#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

// The corners of every lane's triangle, component by component.
struct alignas(64) Corners {
  float x[3][kPacketSize], y[3][kPacketSize], z[3][kPacketSize];
};

void gather(const KdTriangle* triangles, const uint32_t* numbers, uint64_t lanes, Corners& out) {
  for (int lane = 0; lane < kPacketSize; ++lane) {
    // Lanes that hit nothing look at some triangle: the numbers stay harmless.
    const KdTriangle& t = triangles[lanes >> lane & 1 ? numbers[lane] : 0];
    for (int k = 0; k < 3; ++k) {
      out.x[k][lane] = t.corner[k][0], out.y[k][lane] = t.corner[k][1], out.z[k][lane] = t.corner[k][2];
    }
  }
}

inline Vec3T<Float> corner(const Corners& c, int k, int g) {
  return {load(c.x[k] + g), load(c.y[k] + g), load(c.z[k] + g)};
}
inline Vec3T<Double> widen(const Vec3T<Float>& v) {
  using vitral::widen;
  return {widen(v.x), widen(v.y), widen(v.z)};
}
inline Float largest(const Vec3T<Float>& v) {
  return greatest(absolute(v.x), greatest(absolute(v.y), absolute(v.z)));
}
inline void store3(float* x, float* y, float* z, int g, const Vec3T<Float>& v, Mask keep, float other) {
  store(x + g, select(keep, v.x, Float(0.0f)));
  store(y + g, select(keep, v.y, Float(0.0f)));
  store(z + g, select(keep, v.z, Float(other)));
}

}  // namespace

// The geometric normal is computed in double, so that tiny triangles have one, too.
uint64_t surface_points(const KdTriangle* triangles, const RayPacket& rays, const HitPacket& hits,
                        const OffsetRule& offset, PointPacket& out) {
  out.live = 0;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Mask met = both(invert(load(hits.triangle + g) == Uint(kNoTriangle)), mask_of_bits(rays.live >> g));
    out.live |= static_cast<uint64_t>(bits(met)) << g;
  }
  if (out.live == 0) return 0;
  Corners corners;
  gather(triangles, hits.triangle, out.live, corners);
  uint64_t back = 0;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Mask live = mask_of_bits(out.live >> g);
    const Vec3T<Float> a = corner(corners, 0, g), b = corner(corners, 1, g), c = corner(corners, 2, g);
    const Vec3T<Float> position = (a + (b - a) * load(hits.u + g)) + (c - a) * load(hits.v + g);
    const Vec3T<Float> direction{load(rays.dx + g), load(rays.dy + g), load(rays.dz + g)};
    const Vec3T<Float> viewer = -normalize(direction);
    const Vec3T<Double> precise = normalize(cross(widen(b) - widen(a), widen(c) - widen(a)));
    Vec3T<Float> normal{narrow(precise.x), narrow(precise.y), narrow(precise.z)};
    const Mask away = dot(normal, viewer) < Float(0.0f);
    back |= static_cast<uint64_t>(bits(both(away, live))) << g;
    normal = {select(away, -normal.x, normal.x), select(away, -normal.y, normal.y),
              select(away, -normal.z, normal.z)};
    store3(out.px, out.py, out.pz, g, position, live, 0);
    store3(out.gx, out.gy, out.gz, g, normal, live, 1);
    store3(out.nx, out.ny, out.nz, g, normal, live, 1);
    store3(out.vx, out.vy, out.vz, g, viewer, live, 1);
    const Float magnitude = greatest(largest(a), greatest(largest(b), largest(c)));
    const Float own = offset.fixed > 0 ? Float(offset.fixed) : ray_offset(magnitude);
    store(out.offset + g, select(live, own, Float(0.0f)));
  }
  return back;
}

}  // namespace VITRAL_ISA
}  // namespace vitral
