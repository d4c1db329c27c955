// Reads MTL material libraries.
#pragma once
#include "vitral/error.h"
#include "vitral/scene.h"

#include "io/textures.h"

#include <string>
#include <string_view>
#include <vector>

namespace vitral {

// A material as its library describes it. The maps are not loaded.
struct MtlMaterial {
  Material material;
  std::string diffuse_map, opacity_map;  // names of files; empty: none
  size_t diffuse_line = 0, opacity_line = 0;
};

// Understands Kd Ks Ke Ns Ni d Tr Tf illum map_Kd map_d; what else MTL knows is skipped. Values are
// brought into their ranges; one that is no finite number is a warning and the default is kept.
// illum decides the optics as scene.h says; any other model with d < 1 and without map_d dissolves.
// d goes before Tr (= 1 - d). A map_Kd replaces a black Kd, which exporters write beside it, by
// white. `text` is the library's whole text, `path` its name for warnings.
std::vector<MtlMaterial> parse_mtl(std::string_view text, const std::string& path, Warnings& warnings);

// Reads a library, at most 64 MiB. Throws InputError.
std::vector<MtlMaterial> load_mtl(const std::string& path, Warnings& warnings);

}  // namespace vitral
