// The textures of the plaza, painted by formula.
#pragma once
#include <filesystem>

namespace plaza {

// Sides of 512 and 1024 pixels, divided by `divisor`. Each function writes its pictures into `folder`.
struct TextureJob {
  std::filesystem::path folder;
  int divisor = 1;
};
void paint_ground_textures(const TextureJob& job);  // calcada_*.png, rosette.png, setts.png
void paint_wall_textures(const TextureJob& job);    // stone, ashlar, plaster_*, azulejo, roof
void paint_wood_textures(const TextureJob& job);    // door, floorboards, bark, awning
void paint_leaf_textures(const TextureJob& job);    // leaves, blossom: RGBA

}  // namespace plaza
