// Forms the rays of the passes, block by block, and runs the ambient occlusion pass, whose rays are
// too many to be stored.
#include "kernels/candidates.h"
#include "kernels/points.h"
#include "kernels/tables.h"
#include "math/fresnel.h"
#include "math/random.h"
#include "math/sampling.h"
#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

inline Vec3T<Float> load3(const float* x, const float* y, const float* z, int g) {
  return {load(x + g), load(y + g), load(z + g)};
}
inline void store3(float* x, float* y, float* z, int g, const Vec3T<Float>& v) {
  store(x + g, v.x), store(y + g, v.y), store(z + g, v.z);
}

inline void set_origins(const PointPacket& points, RayPacket& rays) {
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Vec3T<Float> p = load3(points.px, points.py, points.pz, g);
    const Vec3T<Float> n = load3(points.gx, points.gy, points.gz, g);
    store3(rays.ox, rays.oy, rays.oz, g, p + n * load(points.offset + g));
  }
}

}  // namespace

void primary_rays(const Pinhole& camera, int x, int y, RayPacket& rays) {
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Uint lane = Uint(static_cast<uint32_t>(g)) + lane_numbers();
    const Float px = to_float(Uint(static_cast<uint32_t>(x)) + (lane & Uint(7u)));
    const Float py = to_float(Uint(static_cast<uint32_t>(y)) + (lane >> 3));
    store3(rays.ox, rays.oy, rays.oz, g,
           {Float(camera.origin.x), Float(camera.origin.y), Float(camera.origin.z)});
    store3(rays.dx, rays.dy, rays.dz, g, primary_direction(camera, px, py));
    store(rays.tmax + g, Float(camera.far));
  }
  rays.tmin = camera.near;
}

void mirror_rays(const PointPacket& points, RayPacket& rays) {
  set_origins(points, rays);
  rays.tmin = 0;
  rays.live = points.live;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Vec3T<Float> n = load3(points.gx, points.gy, points.gz, g);
    const Vec3T<Float> incoming = -load3(points.vx, points.vy, points.vz, g);
    store3(rays.dx, rays.dy, rays.dz, g, reflect(incoming, n));
    store(rays.tmax + g, Float(kInfinity));
  }
}

// One ray per point that faces the light. Towards a point light t = 1 is the light.
void shadow_rays(const Light& light, const PointPacket& points, RayPacket& rays) {
  set_origins(points, rays);
  rays.tmin = 0;
  rays.live = 0;
  const bool directional = light.kind == Light::Kind::directional;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Vec3T<Float> n = load3(points.nx, points.ny, points.nz, g);
    Vec3T<Float> d = {Float(-light.direction.x), Float(-light.direction.y), Float(-light.direction.z)};
    if (!directional) {
      d = Vec3T<Float>{Float(light.position.x), Float(light.position.y), Float(light.position.z)} -
          load3(rays.ox, rays.oy, rays.oz, g);
    }
    store3(rays.dx, rays.dy, rays.dz, g, d);
    store(rays.tmax + g, Float(directional ? __builtin_inff() : 1.0f));
    rays.live |= static_cast<uint64_t>(bits(dot(n, d) > Float(0.0f))) << g;
  }
  rays.live &= points.live;
}

// Stratum (sx, sy) of sample s = sy * strata + sx, jittered by a hash of the point's key and s. A
// direction that dips under the geometric surface, which a bent shading normal allows, is mirrored
// back above it.
void ambient_occlusion(const KdView& tree, const PointPacket& points, const AmbientSettings& settings,
                       uint32_t* free_rays) {
  Candidates candidates;
  find_candidates(tree, points, settings.distance, candidates);
  if (candidates.count == 0) {
    const uint32_t all = static_cast<uint32_t>(settings.strata * settings.strata);
    for (int g = 0; g < kPacketSize; g += kLanes) store(free_rays + g, Uint(all));
    return;
  }
  RayPacket rays;
  set_origins(points, rays);
  rays.tmin = 0;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    store(rays.tmax + g, Float(settings.distance));
    store(free_rays + g, Uint(0u));
  }
  const Float side = Float(1.0f / static_cast<float>(settings.strata)), unit = Float(1.0f / 65536);
  for (int s = 0; s < settings.strata * settings.strata; ++s) {
    const Float sx = Float(static_cast<float>(s % settings.strata)),
                sy = Float(static_cast<float>(s / settings.strata));
    for (int g = 0; g < kPacketSize; g += kLanes) {
      const Uint h = sample_hash(load(points.key + g), static_cast<uint32_t>(s), settings.sample_step);
      const Float u1 = (sx + to_float(h & Uint(0xffffu)) * unit) * side;
      const Float u2 = (sy + to_float(h >> 16) * unit) * side;
      const Vec3T<Float> normal = load3(points.gx, points.gy, points.gz, g);
      Vec3T<Float> d = cosine_hemisphere(load3(points.nx, points.ny, points.nz, g), u1, u2);
      const Float below = least(dot(d, normal), Float(0.0f));
      d = d - normal * (below + below);
      store3(rays.dx, rays.dy, rays.dz, g, d);
    }
    rays.live = points.live;
    const uint64_t met = candidates.count <= kMaxCandidates
                             ? test_any(tree, candidates, rays)
                             : trace_any_from(tree, candidates.node, rays, GlassRule::passes);
    const uint64_t free = points.live & ~met;
    for (int g = 0; g < kPacketSize; g += kLanes) {
      const Uint n = load(free_rays + g);
      store(free_rays + g, select(mask_of_bits(free >> g), n + Uint(1u), n));
    }
  }
}

}  // namespace VITRAL_ISA
}  // namespace vitral
