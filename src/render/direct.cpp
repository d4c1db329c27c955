// Direct light: ambient * Kd + sum over lights of V * (Kd max(N.L, 0) + Ks max(N.H, 0)^Ns) * Lc, with
// Blinn's halfway vector H.
#include "math/elementary.h"
#include "render/frame.h"

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

}  // namespace

void light_surfaces(const FrameContext& frame, const SurfacePacket& s, PassTally& tally, ColorPacket& out,
                    LightDetail& detail) {
  const Scene& scene = frame.scene;
  const bool report = frame.settings.compositing == Compositing::report;
  ambient_visibility(frame, s.points, tally, detail.ao);
  for (int lane = 0; lane < kPacketSize; ++lane) {
    detail.shadow[lane] = 1;
    if (!(s.points.live >> lane & 1)) continue;
    const float ao = report ? 1.0f : detail.ao[lane];
    out.color[lane] = scene.ambient * Vec3{s.r[lane], s.g[lane], s.b[lane]} * ao;
  }

  // The report darkens the finished colour instead: by one half where a light is blocked.
  ColorPacket darkening;
  for (Vec3& d : darkening.color) d = {1, 1, 1};
  ColorPacket visibility;
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    light_visibility(frame, light, s.points, tally, visibility);
    const PassTimer timer(tally, Pass::shade);
    for (int lane = 0; lane < kPacketSize; ++lane) {
      if (!(s.points.live >> lane & 1)) continue;
      const Vec3 v = visibility.color[lane];
      if (i == 0) detail.shadow[lane] = luminance(v);
      const Vec3 light_here = unblocked(light, scene.materials[s.material[lane]], s, lane);
      if (report) {
        darkening.color[lane] *= luminance(v) > 0 ? v : Vec3{0.5f, 0.5f, 0.5f};
        out.color[lane] += light_here;
      } else {
        out.color[lane] += v * light_here;
      }
    }
  }

  for (int lane = 0; lane < kPacketSize; ++lane) {
    if (!(s.points.live >> lane & 1)) continue;
    if (report) out.color[lane] *= darkening.color[lane] * detail.ao[lane];
    out.color[lane] = out.color[lane] * own_share(frame, scene.materials[s.material[lane]]);
  }
}

}  // namespace vitral
