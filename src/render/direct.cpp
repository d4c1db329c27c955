// Direct light: ambient * Kd + sum over lights of V * (Kd max(N.L, 0) + Ks max(N.H, 0)^Ns) * Lc, with
// Blinn's halfway vector H.
#include "math/elementary.h"
#include "render/frame.h"

#include <algorithm>

namespace vitral {
namespace {

// What one light adds at a lane were it not blocked.
Vec3 unblocked(const Light& light, const Material& material, const SurfacePacket& s, int lane) {
  const Vec3 n = get(s.points.nx, s.points.ny, s.points.nz, lane);
  Vec3 to_light = -light.direction;
  Vec3 color = light.color;
  if (light.kind == Light::Kind::point) {
    const Vec3 way = light.position - get(s.points.px, s.points.py, s.points.pz, lane);
    const float squared = dot(way, way);
    if (!(squared > 0)) return {0, 0, 0};
    to_light = way * (1.0f / square_root(squared));
    color = color * (1.0f / squared);
  }
  const float cosine = dot(n, to_light);
  if (!(cosine > 0)) return {0, 0, 0};
  Vec3 sum = Vec3{s.r[lane], s.g[lane], s.b[lane]} * cosine;
  if (material.shininess > 0 && luminance(material.specular) > 0) {
    const Vec3 halfway = to_light + get(s.points.vx, s.points.vy, s.points.vz, lane);
    const float squared = dot(halfway, halfway);
    const float highlight = squared > 0 ? dot(n, halfway) / square_root(squared) : 0.0f;
    if (highlight > 0) sum += material.specular * power(least(highlight, 1.0f), material.shininess);
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
  for (uint64_t left = s.points.live; left != 0; left &= left - 1) {
    const int lane = __builtin_ctzll(left);
    const Vec3 v = visibility.color[lane];
    const Vec3 light_here = unblocked(light, frame.scene.materials[s.material[lane]], s, lane);
    if (report) {
      darkening.color[lane] *= luminance(v) > 0 ? v : Vec3{0.5f, 0.5f, 0.5f};
      out.color[lane] += light_here;
    } else {
      out.color[lane] += v * light_here;
    }
  }
}

}  // namespace

void light_surfaces(const FrameContext& frame, const SurfacePacket* const* surfaces, int count,
                    PassTally& tally, Lit* out) {
  const Scene& scene = frame.scene;
  const bool report = frame.settings.compositing == Compositing::report;
  const PointPacket* points[kTileBlocks] = {};
  for (int i = 0; i < count; ++i) points[i] = &surfaces[i]->points;
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

  for (const Light& light : scene.lights) {
    ShadowAnswer shadows[kTileBlocks];
    find_shadows(frame, light, points, count, tally, shadows, work);
    for (int i = 0; i < count; ++i) {
      ColorPacket visibility;
      light_visibility(frame, light, *points[i], shadows[i], tally, visibility, work + i);
      const PassTimer timer(tally, Pass::shade);
      if (&light == &scene.lights.front()) {
        for (int lane = 0; lane < kPacketSize; ++lane)
          out[i].detail.shadow[lane] = luminance(visibility.color[lane]);
      }
      add_light(frame, light, *surfaces[i], visibility, out[i].light, darkening[i]);
    }
  }

  for (int i = 0; i < count; ++i) {
    const SurfacePacket& s = *surfaces[i];
    ColorPacket& light = out[i].light;
    if (frame.count == Count::pixels) out[i].detail.work = work[i];
    for (uint64_t left = s.points.live; left != 0; left &= left - 1) {
      const int lane = __builtin_ctzll(left);
      if (report) light.color[lane] *= darkening[i].color[lane] * out[i].detail.ao[lane];
      light.color[lane] = light.color[lane] * own_share(frame, scene.materials[s.material[lane]]);
    }
  }
}

}  // namespace vitral
