// The auxiliary pictures of a frame.
#pragma once
#include "render/frame.h"
#include "vitral/render.h"

#include <array>
#include <cstddef>

namespace vitral {

// In the order of kAovNames.
enum class AovKind {
  position,
  normal,
  geometric_normal,
  depth,
  albedo,
  material,
  primitive,
  shadow,
  ao,
  reflection,
  refraction,
  cost
};

// Those that were asked for; null where not.
struct AovTargets {
  std::array<Aov*, std::size(kAovNames)> pictures{};
  bool any = false;
};

// Makes the pictures that the settings name, in out.aovs.
AovTargets make_aovs(const Settings& settings, int width, int height, Frame& out);

// Adds what a sample saw to a picture, if it is wanted; `pixel` counts in the crop. Numbers, positions and
// depths have no mean: those are the first sample's. `cost` is the sum, the others are weighted as the
// colours are.
void put(const FrameContext& frame, const AovTargets& targets, AovKind kind, size_t pixel, const Vec3& value);

// All that is known of the surface that a pixel sees.
void write_aovs(const FrameContext& frame, const AovTargets& targets, const SurfacePacket& surfaces,
                const LightDetail& light, int lane, size_t pixel);

}  // namespace vitral
