// Mip maps (Williams, "Pyramidal Parametrics", SIGGRAPH 1983): textures at every size.
#pragma once
#include "parallel/parallel_for.h"
#include "vitral/scene.h"

#include <cstdint>
#include <vector>

namespace vitral {

// A picture as Texture has it: RGBA, row by row from the top.
struct MipLevel {
  const uint8_t* texels;
  int width, height;
};

// Level 0 is the texture itself, which must outlive the map; each further one has half the columns and rows,
// rounded down, and the last is one texel. Colours are stored in sRGB, as in the texture, which at 8 bits
// is finer in the darks than linear light would be. The alpha of the further levels is what the
// colours were weighted with.
struct MipMap {
  std::vector<MipLevel> levels;
  std::vector<uint8_t> texels;  // of levels 1 on

  MipMap() = default;
  MipMap(MipMap&&) = default;
  MipMap& operator=(MipMap&&) = default;
};

// Averages areas in linear light, each texel by its exact share of the area, whatever the texture's size.
// With a `coverage`, a texture of the same size, each texel also counts by the alpha it has there, so that
// what a cut-out hides does not bleed into what it shows; where it hides all, every texel counts.
MipMap make_mip_map(const Texture& texture, const Texture* coverage);

// One for every texture; without levels where no material has it as its colour. What a material cuts out by
// a map of the colour's size is the colour's coverage.
std::vector<MipMap> make_mip_maps(const Scene& scene, ThreadPool& pool);

}  // namespace vitral
