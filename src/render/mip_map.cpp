#include "render/mip_map.h"

#include "math/srgb.h"

#include <algorithm>
#include <array>

namespace vitral {
namespace {

// The texels of a row or column under one texel of the next level, and their shares. An odd number 2 m + 1 is
// shared out among m: each gets (2 m + 1) / m, which begins at 2 i + i / m.
struct Taps {
  int first, count;
  std::array<float, 3> weight;
};
Taps taps_of(int i, int size) {
  if (size == 1) return {0, 1, {1, 0, 0}};
  if (size % 2 == 0) return {2 * i, 2, {0.5f, 0.5f, 0}};
  const int m = size / 2;
  const float whole = static_cast<float>(size);
  return {
      2 * i,
      3,
      {static_cast<float>(m - i) / whole, static_cast<float>(m) / whole, static_cast<float>(i + 1) / whole}};
}

// Sums of the colours under a texel.
struct Sums {
  Vec3 plain{0, 0, 0}, covered{0, 0, 0};
  float coverage = 0;  // 0..255
};

void put_texel(const Sums& s, uint8_t* out) {
  const Vec3 c = s.coverage > 0 ? s.covered * (1 / s.coverage) : s.plain;
  out[0] = linear_to_srgb8(c.x), out[1] = linear_to_srgb8(c.y), out[2] = linear_to_srgb8(c.z);
  out[3] = static_cast<uint8_t>(s.coverage + 0.5f);
}

Vec3 linear(const uint8_t* texel) {
  return {kLinearOfSrgb[texel[0]], kLinearOfSrgb[texel[1]], kLinearOfSrgb[texel[2]]};
}

const uint8_t* texel_at(const MipLevel& level, int x, int y) {
  return level.texels +
         4 * (static_cast<size_t>(y) * static_cast<size_t>(level.width) + static_cast<size_t>(x));
}

// `alpha` holds the coverage of the level's texels; null: all count alike.
void shrink(const MipLevel& from, const uint8_t* alpha, const MipLevel& to, uint8_t* out) {
  std::vector<Taps> columns(static_cast<size_t>(to.width));
  for (int x = 0; x < to.width; ++x) columns[static_cast<size_t>(x)] = taps_of(x, from.width);
  for (int y = 0; y < to.height; ++y) {
    const Taps rows = taps_of(y, from.height);
    for (const Taps& column : columns) {
      Sums sums;
      for (int j = 0; j < rows.count; ++j) {
        const uint8_t* texel = texel_at(from, column.first, rows.first + j);
        const float row_weight = rows.weight[static_cast<size_t>(j)];
        for (int i = 0; i < column.count; ++i, texel += 4) {
          const float weight = column.weight[static_cast<size_t>(i)] * row_weight;
          const Vec3 color = linear(texel);
          sums.plain += color * weight;
          if (!alpha) continue;
          const float covered = weight * static_cast<float>(alpha[texel - from.texels]);
          sums.covered += color * covered;
          sums.coverage += covered;
        }
      }
      put_texel(sums, out);
      out += 4;
    }
  }
}

// The coverage of every texture that is some material's colour.
struct Use {
  bool used = false;
  const Texture* coverage = nullptr;
};
std::vector<Use> find_uses(const Scene& scene) {
  std::vector<Use> uses(scene.textures.size());
  for (const Material& m : scene.materials) {
    if (m.diffuse_map == kNoTexture) continue;
    Use& use = uses[static_cast<size_t>(m.diffuse_map)];
    use.used = true;
    if (m.opacity_map == kNoTexture || use.coverage) continue;
    const Texture& color = scene.textures[static_cast<size_t>(m.diffuse_map)];
    const Texture& map = scene.textures[static_cast<size_t>(m.opacity_map)];
    if (map.width == color.width && map.height == color.height) use.coverage = &map;
  }
  return uses;
}

}  // namespace

MipMap make_mip_map(const Texture& texture, const Texture* coverage) {
  MipMap map;
  map.levels.push_back({texture.texels.data(), texture.width, texture.height});
  size_t texels = 0;
  for (int w = texture.width, h = texture.height; w > 1 || h > 1;) {
    w = std::max(w / 2, 1), h = std::max(h / 2, 1);
    map.levels.push_back({nullptr, w, h});
    texels += static_cast<size_t>(w) * static_cast<size_t>(h);
  }
  map.texels.resize(4 * texels);
  uint8_t* out = map.texels.data();
  for (size_t k = 1; k < map.levels.size(); ++k) {
    const MipLevel& from = map.levels[k - 1];
    MipLevel& to = map.levels[k];
    const uint8_t* covering = k == 1 && coverage ? coverage->texels.data() : from.texels;
    shrink(from, coverage ? covering + 3 : nullptr, to, out);
    to.texels = out;
    out += 4 * static_cast<size_t>(to.width) * static_cast<size_t>(to.height);
  }
  return map;
}

std::vector<MipMap> make_mip_maps(const Scene& scene, ThreadPool& pool) {
  const std::vector<Use> uses = find_uses(scene);
  std::vector<MipMap> maps(uses.size());
  pool.parallel_for(uses.size(), [&](size_t i, size_t) {
    if (uses[i].used) maps[i] = make_mip_map(scene.textures[i], uses[i].coverage);
  });
  return maps;
}

}  // namespace vitral
