// Samples of lights with a size, and the shadow rays to them, for the 64 points of a block at a time.
#include "kernels/lanes.h"
#include "kernels/meet.h"
#include "kernels/points.h"
#include "kernels/tables.h"
#include "math/light.h"
#include "math/strata.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

// The pairs of random numbers of the lanes. The sets of a frame's samples are those of the pixel's whole set
// in a random order, so that nothing else of the pixel's samples goes along with them. Within a set every
// packet gets the samples of one cell of the light, where their number allows that.
Pair<Float> draw_pair(const LightDraw& draw, uint32_t k, const Uint& point_key) {
  const Uint key = branch_key(point_key, draw.branch);
  const bool cells = (draw.samples & (draw.samples - 1)) == 0;
  const Uint set = shuffled(draw.frame, draw.frames, hash32(key));
  const Uint index = set * Uint(draw.samples) + (cells ? sample_in_cell(k, draw.samples, key) : Uint(k));
  return stratified_pair(index, draw.frames * draw.samples, key);
}

template <class Sample>
void make_rays(const LightDraw& draw, uint32_t k, const PointPacket& points, float end, Sample sample,
               RayPacket& rays, LightSamples& out) {
  rays.live = 0;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(points.live, g)) {
      store3(rays.dx, rays.dy, rays.dz, g, {Float(0.0f), Float(0.0f), Float(0.0f)});
      store(rays.tmax + g, Float(0.0f));
      continue;
    }
    const Pair<Float> pair = draw_pair(draw, k, load(points.key + g));
    const LightSample<Float> s = sample(load3(points.px, points.py, points.pz, g), pair.u, pair.v);
    const Float cosine = dot(s.direction, load3(points.nx, points.ny, points.nz, g));
    rays.live |= static_cast<uint64_t>(bits(both(cosine > Float(0.0f), s.strength > Float(0.0f)))) << g;
    store3(out.x, out.y, out.z, g, s.direction);
    store(out.strength + g, s.strength);
    store(out.irradiance + g, s.strength * cosine);
    store3(rays.dx, rays.dy, rays.dz, g, s.target);
    store(rays.tmax + g, Float(end));
  }
  rays.live &= points.live;
}

// From targets to directions.
void aim(RayPacket& rays) {
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Vec3T<Float> target = load3(rays.dx, rays.dy, rays.dz, g);
    store3(rays.dx, rays.dy, rays.dz, g, target - load3(rays.ox, rays.oy, rays.oz, g));
  }
}

// Rays end this share of their way short of the light, so that a surface which shows the light where it is
// keeps nothing from it.
inline constexpr float kEnd = 1 - 1.0f / 1024;

}  // namespace

void light_rays(const LightShape& light, const LightDraw& draw, uint32_t k, const PointPacket& points,
                RayPacket& rays, LightSamples& out) {
  using P = Vec3T<Float>;
  set_origins(points, rays);
  rays.tmin = 0;
  if (light.kind == Light::Kind::sun) {
    make_rays(
        draw, k, points, kInfinity,
        [&](const P&, const Float& u, const Float& v) { return sample_sun(light, u, v); }, rays, out);
    return;
  }
  if (light.kind == Light::Kind::rectangle) {
    make_rays(
        draw, k, points, kEnd,
        [&](const P& p, const Float& u, const Float& v) { return sample_rectangle(light, p, u, v); }, rays,
        out);
  } else {
    make_rays(
        draw, k, points, kEnd,
        [&](const P& p, const Float& u, const Float& v) { return sample_sphere(light, p, u, v); }, rays, out);
  }
  aim(rays);
}

}  // namespace VITRAL_ISA
}  // namespace vitral
