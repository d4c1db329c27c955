// What the passes ask of a material at every point, found out once.
#pragma once
#include "vitral/scene.h"

#include <cstdint>
#include <vector>

namespace vitral {

enum MaterialTraits : uint8_t {
  kSendsRays = 1,  // reflected or refracted ones start at it
  kPatterned = 2,
  kEmits = 4,
  kAbsorbs = 8,  // light on its way through it
};

static inline bool is_black(const Vec3& c) {
  return c == Vec3{0, 0, 0};
}

static inline uint8_t traits_of(const Material& m) {
  uint8_t traits = 0;
  if (m.optics != Optics::opaque || !is_black(m.reflectivity)) traits |= kSendsRays;
  if (m.pattern.kind != Pattern::Kind::none) traits |= kPatterned;
  if (!is_black(m.emission)) traits |= kEmits;
  if (m.optics == Optics::solid && !is_black(m.absorption)) traits |= kAbsorbs;
  return traits;
}

// Of each material, and what any of them has.
struct TraitTable {
  std::vector<uint8_t> of;
  uint8_t any = 0;
};
inline TraitTable make_traits(const std::vector<Material>& materials) {
  TraitTable table;
  for (const Material& m : materials) {
    table.of.push_back(traits_of(m));
    table.any |= table.of.back();
  }
  return table;
}

}  // namespace vitral
