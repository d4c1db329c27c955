// Forms the rays of the passes, block by block.
#include "kernels/lanes.h"
#include "kernels/points.h"
#include "kernels/tables.h"
#include "math/fresnel.h"
#include "math/light.h"
#include "math/sampling.h"
#include "math/strata.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

// The points to which a spot sends light, by the very formula that lights them.
uint64_t inside_cone(const Light& spot, const PointPacket& points) {
  const SpotCone cone = spot_cone(spot);
  uint64_t inside = 0;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Vec3T<Float> way = broadcast<Float>(spot.position) - load3(points.px, points.py, points.pz, g);
    const Vec3T<Float> to_light = way * (Float(1.0f) / square_root(dot(way, way)));
    const Float share = spot_share(cone, spot.direction, to_light);
    inside |= static_cast<uint64_t>(bits(share > Float(0.0f))) << g;
  }
  return inside;
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

// From the point p of the lens, in its plane, to where the pixel's axis meets the plane in focus: over the
// depth 1 the direction changes by -p / focus.
void lens_rays(const Pinhole& camera, const Lens& lens, int x, int y, RayPacket& rays) {
  primary_rays(camera, x, y, rays);
  const Vec3T<Float> right{Float(camera.right.x), Float(camera.right.y), Float(camera.right.z)},
      up{Float(camera.up.x), Float(camera.up.y), Float(camera.up.z)};
  const Float radius = Float(lens.radius), bend = Float(-1.0f / lens.focus);
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Uint lane = Uint(static_cast<uint32_t>(g)) + lane_numbers();
    const Uint key = pixel_key_of(Uint(static_cast<uint32_t>(x)) + (lane & Uint(7u)),
                                  Uint(static_cast<uint32_t>(y)) + (lane >> 3), lens.seed);
    const auto pair = stratified_pair(Uint(lens.index), lens.count, key);
    const Vec2T<Float> point = disk_point(pair.u, pair.v);
    const Vec3T<Float> p = right * (radius * point.x) + up * (radius * point.y);
    store3(rays.ox, rays.oy, rays.oz, g, load3(rays.ox, rays.oy, rays.oz, g) + p);
    store3(rays.dx, rays.dy, rays.dz, g, load3(rays.dx, rays.dy, rays.dz, g) + p * bend);
  }
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

// One ray per point that faces the light. Towards a light with a position t = 1 is the light.
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
  if (light.kind == Light::Kind::spot && rays.live != 0) rays.live &= inside_cone(light, points);
}

}  // namespace VITRAL_ISA
}  // namespace vitral
