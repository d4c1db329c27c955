// Where rays met their triangles: the points at which secondary rays start, and what light needs to know
// of them.
#include "kernels/facet.h"
#include "kernels/lanes.h"
#include "kernels/tables.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

inline void store3(float* x, float* y, float* z, int g, const Vec3T<Float>& v, Mask keep, float other) {
  store(x + g, select(keep, v.x, Float(0.0f)));
  store(y + g, select(keep, v.y, Float(0.0f)));
  store(z + g, select(keep, v.z, Float(other)));
}

void store_nothing(int g, PointPacket& out) {
  const Mask none = mask_of_bits(0);
  const Vec3T<Float> any_vector = broadcast(Vec3{0, 0, 0});
  store3(out.px, out.py, out.pz, g, any_vector, none, 0);
  store3(out.gx, out.gy, out.gz, g, any_vector, none, 1);
  store3(out.nx, out.ny, out.nz, g, any_vector, none, 1);
  store3(out.vx, out.vy, out.vz, g, any_vector, none, 1);
  store(out.offset + g, Float(0.0f));
}

// Sets the register's points but their keys, and with Lift::smooth where `lifted` has its
// shadow rays start; returns the lanes that see the back.
[[gnu::always_inline]] inline uint64_t store_points(const Facet<Float, Mask>& f, Float u, Float v,
                                                    const Vec3T<Float>& direction, Mask live,
                                                    const OffsetRule& offset, int g, PointPacket& out,
                                                    SurfacePacket* lifted) {
  const Vec3T<Float> viewer = -normalize(direction);
  const Mask away = looks_away(f.normal, viewer);
  const Vec3T<Float> normal = flip_where(away, f.normal);
  const NormalSum<Float, Mask> sum = normal_sum_at(f, u, v);
  const Vec3T<Float> shading = interpolated_normal(sum, normal), position = position_at(f, u, v);
  store3(out.px, out.py, out.pz, g, position, live, 0);
  store3(out.gx, out.gy, out.gz, g, normal, live, 1);
  store3(out.nx, out.ny, out.nz, g, shading, live, 1);
  store3(out.vx, out.vy, out.vz, g, viewer, live, 1);
  if (lifted != nullptr && offset.lift == Lift::smooth)
    store3(lifted->lx, lifted->ly, lifted->lz, g, lifted_position(f, position, u, v, sum, normal), live, 0);
  const Float own = offset.fixed > 0 ? Float(offset.fixed) : f.offset;
  store(out.offset + g, select(live, own, Float(0.0f)));
  return static_cast<uint64_t>(bits(both(away, live))) << g;
}

// The rest of a surface, without its texture. `number` is the triangle of all lanes, or kNoTriangle.
void store_colors(const SurfaceView& scene, const uint32_t* numbers, uint32_t number, uint32_t live, int g,
                  SurfacePacket& out) {
  store(out.triangle + g, load(numbers));
  if (number != kNoTriangle) {
    const uint32_t material = scene.materials[number];
    const Vec3& color = scene.colors[material].diffuse;
    store(out.material + g, Uint(material));
    vitral::VITRAL_ISA::store3(out.r, out.g, out.b, g, broadcast(color));
    return;
  }
  for (uint32_t left = live; left != 0; left &= left - 1) {
    const int lane = __builtin_ctz(left);
    const uint32_t material = scene.materials[numbers[lane]];
    const Vec3& color = scene.colors[material].diffuse;
    out.material[g + lane] = material;
    out.r[g + lane] = color.x, out.g[g + lane] = color.y, out.b[g + lane] = color.z;
  }
}

// Calls body(g, met, facet, number) for the registers of hits that any live ray has.
template <class Body>
[[gnu::always_inline]] inline void for_each_hit(const SurfaceView& scene, const RayPacket& rays,
                                                const HitPacket& hits, PointPacket& out, const Body& body) {
  OneFacet one;
  FacetTable table;
  out.live = 0;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Mask met = both(invert(load(hits.triangle + g) == Uint(kNoTriangle)), mask_of_bits(rays.live >> g));
    out.live |= static_cast<uint64_t>(bits(met)) << g;
    if (!any(met)) {
      store_nothing(g, out);
      continue;
    }
    with_facets(scene, Vec3{0, 0, 0}, hits.triangle, g, met, one, table,
                [&](const Facet<Float, Mask>& facet, uint32_t number)
                    VITRAL_INLINED { body(g, met, facet, number); });
  }
}

}  // namespace

uint64_t surface_points(const KdTriangle* triangles, const RayPacket& rays, const HitPacket& hits,
                        const OffsetRule& offset, PointPacket& out) {
  const SurfaceView scene{triangles, nullptr, nullptr, nullptr, nullptr};
  uint64_t back = 0;
  for_each_hit(scene, rays, hits, out,
               [&](int g, Mask met, const Facet<Float, Mask>& facet, uint32_t) VITRAL_INLINED {
                 back |= store_points(facet, load(hits.u + g), load(hits.v + g),
                                      load3(rays.dx, rays.dy, rays.dz, g), met, offset, g, out, nullptr);
               });
  return back;
}

void hit_surfaces(const SurfaceView& scene, const RayPacket& rays, const HitPacket& hits,
                  const OffsetRule& offset, SurfacePacket& out) {
  out.back = 0;
  for_each_hit(scene, rays, hits, out.points,
               [&](int g, Mask met, const Facet<Float, Mask>& facet, uint32_t number) VITRAL_INLINED {
                 out.back |=
                     store_points(facet, load(hits.u + g), load(hits.v + g),
                                  load3(rays.dx, rays.dy, rays.dz, g), met, offset, g, out.points, &out);
                 store(out.t + g, load(hits.t + g));
                 store_colors(scene, hits.triangle + g, number, bits(met), g, out);
               });
}

void visible_surfaces(const SurfaceView& scene, const Pinhole& camera, int x, int y, const uint32_t* numbers,
                      const OffsetRule& offset, HitPacket& hits, SurfacePacket& out) {
  out.back = 0;
  out.points.live = 0;
  for_each_visible(
      {scene, camera, x, y, numbers}, [&](int g) { store_nothing(g, out.points); },
      [&](int g, Mask seen, const Facet<Float, Mask>& facet, const VisiblePoint& point,
          const Vec3T<Float>& direction, uint32_t number) VITRAL_INLINED {
        store(hits.triangle + g, load(numbers + g));
        store(hits.t + g, point.t), store(hits.u + g, point.u), store(hits.v + g, point.v);
        store(out.t + g, point.t);
        out.points.live |= static_cast<uint64_t>(bits(seen)) << g;
        out.back |= store_points(facet, point.u, point.v, direction, seen, offset, g, out.points, &out);
        store_colors(scene, numbers + g, number, bits(seen), g, out);
      });
}

}  // namespace VITRAL_ISA
}  // namespace vitral
