// Direct light of a light with a size, by Monte Carlo: the mean over N samples of
// V * (Kd N.L + Ks (N.H)^Ns) * what arrives of the sample.
#include "render/light_sample.h"

#include "math/light.h"

namespace vitral {
namespace {

// Branches of a point's key: 1 and 2 are its reflection and refraction.
constexpr uint32_t kFirstBranch = 0x100;

LightDraw draw_of(const FrameContext& frame, const Light& light) {
  const auto number = static_cast<uint32_t>(&light - frame.scene.lights.data());
  return {static_cast<uint32_t>(frame.sample), static_cast<uint32_t>(frame.settings.samples),
          static_cast<uint32_t>(samples_of(frame, light)), kFirstBranch + number};
}

// One sample of the light for all points of a packet: which of them it could reach, and which it does not.
struct Sample {
  RayPacket rays;
  LightSamples light;
  ShadowAnswer answer;
};
void take_sample(const FrameContext& frame, const LightShape& shape, const LightDraw& draw, uint32_t k,
                 const PointPacket& points, PassTally& tally, Sample& out, LaneWork* work) {
  const PassTimer timer(tally, Pass::shadows);
  frame.kernels.light_rays(shape, draw, k, points, out.rays, out.light);
  out.answer = {out.rays.live, 0};
  if (!frame.settings.effects.shadows || out.rays.live == 0) return;
  count_rays(tally, Pass::shadows, out.rays.live);
  out.answer.blocked = run_any(frame, Pass::shadows, out.rays, GlassRule::passes, tally, work);
}

// Sums over the samples, lane by lane.
struct Sums {
  Vec3 diffuse[kPacketSize], highlight[kPacketSize], visible[kPacketSize];
  int facing[kPacketSize], blocked[kPacketSize];
};

void add_visibility(const ShadowAnswer& answer, const ColorPacket& visibility, Sums& sums) {
  for (uint64_t left = answer.facing; left != 0; left &= left - 1) {
    const int lane = __builtin_ctzll(left);
    const Vec3& v = visibility.color[lane];
    sums.visible[lane] += v;
    sums.facing[lane] += 1;
    sums.blocked[lane] += luminance(v) > 0 ? 0 : 1;
  }
}

// The lanes whose materials have a highlight.
uint64_t shiny_lanes(const FrameContext& frame, const SurfacePacket& s) {
  uint64_t shiny = 0;
  for (uint64_t left = s.points.live; left != 0; left &= left - 1) {
    const int lane = __builtin_ctzll(left);
    const Material& m = frame.scene.materials[s.material[lane]];
    if (m.shininess > 0 && luminance(m.specular) > 0) shiny |= 1ull << lane;
  }
  return shiny;
}

void add_light(const FrameContext& frame, const SurfacePacket& s, const LightSamples& in, uint64_t lit,
               const ColorPacket& visibility, uint64_t shiny, Sums& sums) {
  const bool report = frame.settings.compositing == Compositing::report;
  for (uint64_t left = lit; left != 0; left &= left - 1) {
    const int lane = __builtin_ctzll(left);
    const Vec3 v = report ? Vec3{1, 1, 1} : visibility.color[lane];
    sums.diffuse[lane] += v * in.irradiance[lane];
    if (!(shiny >> lane & 1)) continue;
    const float highlight = blinn_highlight(
        get(s.points.nx, s.points.ny, s.points.nz, lane), get(in.x, in.y, in.z, lane),
        get(s.points.vx, s.points.vy, s.points.vz, lane), frame.scene.materials[s.material[lane]].shininess);
    sums.highlight[lane] += v * (in.strength[lane] * highlight);
  }
}

void take_means(const FrameContext& frame, const Light& light, const SurfacePacket& s, const Sums& sums,
                SampledLight& out) {
  const float share = 1.0f / static_cast<float>(samples_of(frame, light));
  for (int lane = 0; lane < kPacketSize; ++lane) {
    out.light.color[lane] = {0, 0, 0};
    out.visibility.color[lane] = {1, 1, 1};
    out.blocked[lane] = 0;
    if (!(s.points.live >> lane & 1) || sums.facing[lane] == 0) continue;
    const Material& m = frame.scene.materials[s.material[lane]];
    const Vec3 sum =
        Vec3{s.r[lane], s.g[lane], s.b[lane]} * sums.diffuse[lane] + m.specular * sums.highlight[lane];
    const float rays = static_cast<float>(sums.facing[lane]);
    out.light.color[lane] = sum * share * light.color;
    out.visibility.color[lane] = sums.visible[lane] * (1.0f / rays);
    out.blocked[lane] = static_cast<float>(sums.blocked[lane]) / rays;
  }
}

}  // namespace

int samples_of(const FrameContext& frame, const Light& light) {
  return frame.settings.light_samples > 0 ? frame.settings.light_samples : light.samples;
}

void sample_light(const FrameContext& frame, const Light& light, const SurfacePacket& surfaces,
                  const PointPacket& starts, PassTally& tally, SampledLight& out, LaneWork* work) {
  const LightShape shape = shape_of(light);
  const LightDraw draw = draw_of(frame, light);
  const bool report = frame.settings.compositing == Compositing::report;
  const uint64_t shiny = shiny_lanes(frame, surfaces);
  Sums sums{};
  Sample sample;
  ColorPacket visibility;
  for (uint32_t k = 0; k < draw.samples; ++k) {
    take_sample(frame, shape, draw, k, starts, tally, sample, work);
    const ShadowAnswer& answer = sample.answer;
    if (answer.facing == 0) continue;
    ray_visibility(frame, sample.rays, answer, tally, visibility, work);
    const PassTimer timer(tally, Pass::shade);
    add_visibility(answer, visibility, sums);
    add_light(frame, surfaces, sample.light, report ? answer.facing : answer.facing & ~answer.blocked,
              visibility, shiny, sums);
  }
  take_means(frame, light, surfaces, sums, out);
}

uint64_t trace_samples(const FrameContext& frame, const Light& light, const PointPacket& points,
                       PassTally& tally, LaneWork* work) {
  const LightShape shape = shape_of(light);
  const LightDraw draw = draw_of(frame, light);
  uint64_t facing = 0, lit = 0;
  Sample sample;
  for (uint32_t k = 0; k < draw.samples; ++k) {
    take_sample(frame, shape, draw, k, points, tally, sample, work);
    facing |= sample.answer.facing, lit |= sample.answer.facing & ~sample.answer.blocked;
    if (!frame.accelerator.has_glass) continue;
    ColorPacket visibility;
    ray_visibility(frame, sample.rays, sample.answer, tally, visibility, work);
  }
  return facing & ~lit;
}

}  // namespace vitral
