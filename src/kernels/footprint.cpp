// Footprints of rays in textures, a register of rays at a time.
#include "kernels/footprint.h"

#include "kernels/lanes.h"
#include "kernels/meet.h"
#include "kernels/tables.h"
#include "math/footprint.h"
#include "math/sampling.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

// From corner a of each lane's triangle to the other two.
struct alignas(64) Sides {
  float b[3][kPacketSize], c[3][kPacketSize];
};

// Lanes without a texture look at a triangle without extent.
void gather(const KdTriangle* triangles, const uint32_t* numbers, uint64_t lanes, Sides& out) {
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const bool wanted = lanes >> lane & 1;
    for (int axis = 0; axis < 3; ++axis) {
      const auto side = [&](int k) {
        if (!wanted) return 0.0f;
        const KdTriangle& t = triangles[numbers[lane]];
        return t.corner[k][axis] - t.corner[0][axis];
      };
      out.b[axis][lane] = side(1), out.c[axis][lane] = side(2);
    }
  }
}

inline Vec3T<Float> same(const Vec3& v) {
  return {Float(v.x), Float(v.y), Float(v.z)};
}

// Two sides of the pixel, or two diameters of the cone, where the ray meets its triangle.
struct Sections {
  Vec3T<Float> first, second;
};
inline Sections sections(const RayWidths& widths, const Vec3T<Float>& direction, const Float& t, int g) {
  if (widths.camera) {
    const Float side = t * Float(widths.camera->footprint);
    return {same(widths.camera->right) * side, same(widths.camera->up) * -side};
  }
  Sections s;
  tangent_frame(direction, s.first, s.second);
  const Float diameter = load(widths.diameter + g);
  return {s.first * diameter, s.second * diameter};
}

}  // namespace

void texture_footprints(const KdTriangle* triangles, const HitPacket& hits, const PointPacket& points,
                        const RayWidths& widths, const TexturedLanes& textures, uint64_t lanes,
                        Footprints& out) {
  Sides triangle_sides;
  gather(triangles, hits.triangle, lanes, triangle_sides);
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(lanes, g)) continue;
    const auto& b = triangle_sides.b;
    const auto& c = triangle_sides.c;
    const Vec3T<Float> normal = load3(points.gx, points.gy, points.gz, g);
    const Vec3T<Float> direction = -load3(points.vx, points.vy, points.vz, g);
    const BarycentricSlopes<Float> slopes =
        barycentric_slopes(load3(b[0], b[1], b[2], g), load3(c[0], c[1], c[2], g), normal);
    const Sections section = sections(widths, direction, load(hits.t + g), g);

    const Float u0 = load(textures.u[0] + g), u1 = load(textures.u[1] + g), u2 = load(textures.u[2] + g);
    const Float v0 = load(textures.v[0] + g), v1 = load(textures.v[1] + g), v2 = load(textures.v[2] + g);
    const auto moved = [&](const Vec3T<Float>& shift) -> Vec2T<Float> {
      const Vec3T<Float> way = slide(shift, direction, normal);
      const Float to_b = dot(slopes.b, way), to_c = dot(slopes.c, way);
      return {(u1 - u0) * to_b + (u2 - u0) * to_c, (v1 - v0) * to_b + (v2 - v0) * to_c};
    };
    const Footprint<Float> f = make_footprint(moved(section.first), moved(section.second),
                                              load(textures.columns + g), load(textures.rows + g));
    const Float u = load(hits.u + g), v = load(hits.v + g);
    store(out.u + g, at_barycentrics(u0, u1, u2, u, v));
    store(out.v + g, at_barycentrics(v0, v1, v2, u, v));
    store(out.step_u + g, f.step.x), store(out.step_v + g, f.step.y);
    store(out.width + g, f.width), store(out.count + g, f.count);
  }
}

}  // namespace VITRAL_ISA
}  // namespace vitral
