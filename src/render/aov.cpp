#include "render/aov.h"

#include <algorithm>

namespace vitral {
namespace {

bool is_scalar(AovKind kind) {
  switch (kind) {
    case AovKind::depth:
    case AovKind::material:
    case AovKind::primitive:
    case AovKind::shadow:
    case AovKind::ao:
    case AovKind::cost:
      return true;
    default:
      return false;
  }
}

enum class Gathering { first, mean, sum };
Gathering gathering_of(AovKind kind) {
  switch (kind) {
    case AovKind::position:
    case AovKind::depth:
    case AovKind::material:
    case AovKind::primitive:
      return Gathering::first;
    case AovKind::cost:
      return Gathering::sum;
    default:
      return Gathering::mean;
  }
}

// What stands where nothing is seen: 0 is a material's and a triangle's number.
Vec3 nothing_in(AovKind kind) {
  const bool number = kind == AovKind::material || kind == AovKind::primitive;
  return number ? Vec3{-1, -1, -1} : Vec3{0, 0, 0};
}

}  // namespace

AovTargets make_aovs(const Settings& settings, int width, int height, Frame& out) {
  AovTargets targets;
  out.aovs.reserve(settings.aovs.size());
  for (const std::string& name : settings.aovs) {
    const auto index = static_cast<size_t>(std::find(std::begin(kAovNames), std::end(kAovNames), name) -
                                           std::begin(kAovNames));
    if (targets.pictures[index]) continue;
    const auto kind = static_cast<AovKind>(index);
    out.aovs.push_back({name, is_scalar(kind) ? 1 : 3, Image<Vec3>(width, height, nothing_in(kind))});
    targets.pictures[index] = &out.aovs.back();
    targets.any = true;
  }
  return targets;
}

void put(const FrameContext& frame, const AovTargets& targets, AovKind kind, size_t pixel,
         const Vec3& value) {
  Aov* aov = targets.pictures[static_cast<size_t>(kind)];
  if (!aov) return;
  Vec3& there = aov->pixels.pixels[pixel];
  const Gathering gathering = gathering_of(kind);
  if (frame.settings.samples == 1 || (gathering == Gathering::first && frame.sample == 0)) {
    there = value;
  } else if (gathering != Gathering::first) {
    there += gathering == Gathering::sum ? value : value * narrow(frame.weight);
  }
}

void write_aovs(const FrameContext& frame, const AovTargets& targets, const SurfacePacket& s,
                const LightDetail& light, int lane, size_t pixel) {
  const auto put = [&](AovKind kind, const Vec3& value) { vitral::put(frame, targets, kind, pixel, value); };
  put(AovKind::position, get(s.points.px, s.points.py, s.points.pz, lane));
  put(AovKind::normal, get(s.points.nx, s.points.ny, s.points.nz, lane));
  put(AovKind::geometric_normal, get(s.points.gx, s.points.gy, s.points.gz, lane));
  put(AovKind::depth, {s.t[lane], 0, 0});
  put(AovKind::albedo, {s.r[lane], s.g[lane], s.b[lane]});
  put(AovKind::material, {static_cast<float>(s.material[lane]), 0, 0});
  put(AovKind::primitive, {static_cast<float>(s.triangle[lane]), 0, 0});
  put(AovKind::shadow, {light.shadow[lane], 0, 0});
  put(AovKind::ao, {light.ao[lane], 0, 0});
}

}  // namespace vitral
