// Forms the rays of the passes, block by block.
#include "kernels/lanes.h"
#include "kernels/points.h"
#include "kernels/tables.h"
#include "math/fresnel.h"

namespace vitral {
namespace VITRAL_ISA {
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

}  // namespace VITRAL_ISA
}  // namespace vitral
