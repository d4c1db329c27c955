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

static inline Aov* target(const AovTargets& targets, AovKind kind) {
  return targets.pictures[static_cast<size_t>(kind)];
}

// Makes the pictures that the settings name, in out.aovs.
AovTargets make_aovs(const Settings& settings, int width, int height, Frame& out);

// Writes what is known of the surface that a pixel sees; `pixel` counts in the crop.
void write_aovs(const AovTargets& targets, const SurfacePacket& surfaces, const LightDetail& light, int lane,
                size_t pixel);

}  // namespace vitral
