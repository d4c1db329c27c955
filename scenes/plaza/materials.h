// Every material of the plaza. The order is that of the table in materials.cpp.
#pragma once
#include <cstdint>
#include <filesystem>

namespace plaza {

enum class Surface : uint8_t {
  calcada_wave,
  calcada_plain,
  calcada_frieze,
  rosette,
  setts,
  kerb,
  steel,
  stone,
  ashlar,
  marble,
  bronze,
  brass,
  iron,
  plaster_ochre,
  plaster_rose,
  plaster_white,
  plaster_green,
  plaster_blue,
  azulejo,
  roof,
  paint_white,
  paint_green,
  paint_red,
  door,
  glass,
  interior,
  floorboards,
  curtain,
  curtain_warm,
  mirror,
  globe,
  water,
  foam,
  basin,
  bark,
  leaves,
  blossom,
  soil,
  bench,
  awning,
  canvas,
  tram_yellow,
  tram_cream,
  tyre,
  cloth_blue,
  cloth_red,
  cloth_grey,
  lilac,
  rose,
  skin,
  hair,
  far_wall,
  far_warm,
  far_roof,
  far_hill,
  far_stone,
  count
};

// Metres that one repeat of the surface's texture covers.
double tile_size(Surface surface);
const char* material_name(Surface surface);

void write_materials(const std::filesystem::path& file);

}  // namespace plaza
