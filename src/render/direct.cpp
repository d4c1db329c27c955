// Direct light: ambient * Kd + sum over lights of V * (Kd max(N.L, 0) + Ks max(N.H, 0)^Ns) * Lc, with
// Blinn's halfway vector H; and what the surface emits, Ke, whatever light, shadow and occlusion are.
#include "math/light.h"
#include "render/frame.h"
#include "render/light_sample.h"

#include <algorithm>

namespace vitral {
namespace {

// What one light without a size adds at a lane were it not blocked.
Vec3 unblocked(const Light& light, const SpotCone& cone, const Material& material, const SurfacePacket& s,
               int lane) {
  const Vec3 n = get(s.points.nx, s.points.ny, s.points.nz, lane);
  Vec3 to_light = -light.direction;
  Vec3 color = light.color;
  if (light.kind != Light::Kind::directional) {
    const Vec3 way = light.position - get(s.points.px, s.points.py, s.points.pz, lane);
    const float squared = dot(way, way);
    if (!(squared > 0)) return {0, 0, 0};
    to_light = way * (1.0f / square_root(squared));
    color = color * (1.0f / squared);
    if (light.kind == Light::Kind::spot) color = color * spot_share(cone, light.direction, to_light);
  }
  const float cosine = dot(n, to_light);
  if (!(cosine > 0)) return {0, 0, 0};
  Vec3 sum = Vec3{s.r[lane], s.g[lane], s.b[lane]} * cosine;
  if (material.shininess > 0 && luminance(material.specular) > 0) {
    const Vec3 to_viewer = get(s.points.vx, s.points.vy, s.points.vz, lane);
    sum += material.specular * blinn_highlight(n, to_light, to_viewer, material.shininess);
  }
  return sum * color;
}

// The part of the surface's own colour that shows: glass with d < 1 fades while light passes it.
float own_share(const FrameContext& frame, const Material& m) {
  return frame.settings.effects.refraction && is_glass(m) ? m.opacity : 1.0f;
}

// Adds what one light sends to a packet; or, as the report has it, darkens the finished colour by one half
// where the light is blocked.
void add_light(const FrameContext& frame, const Light& light, const SurfacePacket& s,
               const ColorPacket& visibility, ColorPacket& out, ColorPacket& darkening) {
  const bool report = frame.settings.compositing == Compositing::report;
  const SpotCone cone = light.kind == Light::Kind::spot ? spot_cone(light) : SpotCone{0, 0};
  for (uint64_t left = s.points.live; left != 0; left &= left - 1) {
    const int lane = __builtin_ctzll(left);
    const Vec3 v = visibility.color[lane];
    const Vec3 light_here = unblocked(light, cone, frame.scene.materials[s.material[lane]], s, lane);
    if (report) {
      darkening.color[lane] *= luminance(v) > 0 ? v : Vec3{0.5f, 0.5f, 0.5f};
      out.color[lane] += light_here;
    } else {
      out.color[lane] += v * light_here;
    }
  }
}

// The same of a light with a size: the darkening is the mean of its samples'.
void add_sampled(const SampledLight& sampled, uint64_t live, ColorPacket& out, ColorPacket& darkening) {
  for (uint64_t left = live; left != 0; left &= left - 1) {
    const int lane = __builtin_ctzll(left);
    darkening.color[lane] *= sampled.visibility.color[lane] + Vec3{0.5f, 0.5f, 0.5f} * sampled.blocked[lane];
    out.color[lane] += sampled.light.color[lane];
  }
}

// What one light comes to in a tile's packets.
void add_packets(const FrameContext& frame, const Light& light, const SurfacePacket* const* surfaces,
                 const PointPacket* const* points, int count, PassTally& tally, Lit* out,
                 ColorPacket* darkening, LaneWork* work) {
  const bool first = &light == &frame.scene.lights.front();
  ShadowAnswer shadows[kTileBlocks];
  if (!has_size(light)) find_shadows(frame, light, points, count, tally, shadows, work);
  for (int i = 0; i < count; ++i) {
    SampledLight sampled;
    ColorPacket& visibility = sampled.visibility;
    if (has_size(light))
      sample_light(frame, light, *surfaces[i], *points[i], tally, sampled, work + i);
    else
      light_visibility(frame, light, *points[i], shadows[i], tally, visibility, work + i);
    const PassTimer timer(tally, Pass::shade);
    for (int lane = 0; first && lane < kPacketSize; ++lane)
      out[i].detail.shadow[lane] = luminance(visibility.color[lane]);
    if (has_size(light))
      add_sampled(sampled, surfaces[i]->points.live, out[i].light, darkening[i]);
    else
      add_light(frame, light, *surfaces[i], visibility, out[i].light, darkening[i]);
  }
}

}  // namespace

void light_surfaces(const FrameContext& frame, const SurfacePacket* const* surfaces, int count,
                    PassTally& tally, Lit* out) {
  const Scene& scene = frame.scene;
  const bool report = frame.settings.compositing == Compositing::report;
  const PointPacket* points[kTileBlocks] = {};
  for (int i = 0; i < count; ++i) points[i] = &surfaces[i]->points;
  const PointPacket* starts[kTileBlocks] = {};  // of shadow rays
  std::vector<PointPacket> lifted;
  find_shadow_starts(frame, surfaces, count, lifted, starts);
  FreeRays free_rays[kTileBlocks];
  LaneWork work[kTileBlocks];
  if (frame.count == Count::pixels) std::fill_n(work, count, LaneWork{});
  const bool occlusion = frame.settings.effects.ambient_occlusion;
  if (occlusion) count_free_rays(frame, points, count, tally, free_rays, work);
  ColorPacket darkening[kTileBlocks];
  for (int i = 0; i < count; ++i) {
    const SurfacePacket& s = *surfaces[i];
    if (occlusion) ambient_visibility(frame, s.points, free_rays[i], out[i].detail.ao);
    for (int lane = 0; lane < kPacketSize; ++lane) {
      if (!occlusion) out[i].detail.ao[lane] = 1;
      out[i].detail.shadow[lane] = 1;
      darkening[i].color[lane] = {1, 1, 1};
      if (!(s.points.live >> lane & 1)) continue;
      const float ao = report ? 1.0f : out[i].detail.ao[lane];
      out[i].light.color[lane] = scene.ambient * Vec3{s.r[lane], s.g[lane], s.b[lane]} * ao;
    }
  }

  for (const Light& light : scene.lights)
    add_packets(frame, light, surfaces, starts, count, tally, out, darkening, work);

  for (int i = 0; i < count; ++i) {
    const SurfacePacket& s = *surfaces[i];
    ColorPacket& light = out[i].light;
    if (frame.count == Count::pixels) out[i].detail.work = work[i];
    for (uint64_t left = s.points.live; left != 0; left &= left - 1) {
      const int lane = __builtin_ctzll(left);
      if (report) light.color[lane] *= darkening[i].color[lane] * out[i].detail.ao[lane];
      light.color[lane] = light.color[lane] * own_share(frame, scene.materials[s.material[lane]]);
      if (frame.accelerator.traits.any & kEmits)
        light.color[lane] += scene.materials[s.material[lane]].emission;
    }
  }
}

}  // namespace vitral
