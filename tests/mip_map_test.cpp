// Mip maps of pictures whose means are known.
#include "render/mip_map.h"

#include "math/srgb.h"
#include "support.h"
#include "texture_support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <utility>

namespace vitral::test {
namespace {

constexpr std::array<std::pair<int, int>, 8> kSizes = {
    {{1, 1}, {16, 16}, {7, 5}, {1, 9}, {12, 1}, {31, 17}, {6, 33}, {100, 75}}};

Texture plain(int width, int height, const std::array<uint8_t, 4>& texel) {
  Texture t{"plain", width, height, std::vector<uint8_t>(static_cast<size_t>(4 * width * height))};
  for (size_t i = 0; i < t.texels.size(); ++i) t.texels[i] = texel[i % 4];
  return t;
}

const uint8_t* texel(const MipMap& map, size_t level, int x, int y) {
  return map.levels[level].texels + 4 * (y * map.levels[level].width + x);
}

double mean(const MipLevel& level, size_t channel) {
  double sum = 0;
  const size_t texels = static_cast<size_t>(level.width) * static_cast<size_t>(level.height);
  for (size_t i = 0; i < texels; ++i)
    sum += static_cast<double>(kLinearOfSrgb[level.texels[4 * i + channel]]);
  return sum / static_cast<double>(texels);
}

TEST(MipMap, HalvesDownToOneTexel) {
  for (const auto& [width, height] : kSizes) {
    const Texture t = plain(width, height, {1, 2, 3, 255});
    const MipMap map = make_mip_map(t, nullptr);
    EXPECT_EQ(map.levels.front().texels, t.texels.data());
    for (size_t k = 1; k < map.levels.size(); ++k) {
      EXPECT_EQ(map.levels[k].width, std::max(map.levels[k - 1].width / 2, 1));
      EXPECT_EQ(map.levels[k].height, std::max(map.levels[k - 1].height / 2, 1));
    }
    EXPECT_EQ(map.levels.back().width * map.levels.back().height, 1);
  }
}

TEST(MipMap, OneColourStaysThatColour) {
  for (const auto& [width, height] : kSizes) {
    for (const int code : {0, 1, 50, 127, 200, 254, 255}) {
      const auto c = static_cast<uint8_t>(code);
      const Texture t = plain(width, height, {c, static_cast<uint8_t>(255 - c), 77, 255});
      const MipMap map = make_mip_map(t, nullptr);
      for (const MipLevel& level : map.levels) {
        for (int i = 0; i < level.width * level.height; ++i)
          ASSERT_TRUE(std::equal(t.texels.begin(), t.texels.begin() + 3, level.texels + 4 * i))
              << width << "x" << height;
      }
    }
  }
}

// Half the light of white is the code 188, not 128.
TEST(MipMap, BlackAndWhiteBecomeTheGreyOfHalfTheLight) {
  const Texture t = checkerboard(16, 8, 1);
  const MipMap map = make_mip_map(t, nullptr);
  ASSERT_EQ(map.levels.size(), 5u);
  for (size_t k = 1; k < map.levels.size(); ++k)
    for (int i = 0; i < map.levels[k].width * map.levels[k].height; ++i)
      ASSERT_EQ(texel(map, k, i, 0)[0], 188);
}

// Five columns over two texels of 2.5 columns each: the middle one counts half for both.
TEST(MipMap, OddSizesAreSharedOutByArea) {
  Texture t = plain(5, 1, {0, 0, 0, 255});
  t.texels[0] = 255;          // red: the first column
  t.texels[4 * 2 + 1] = 255;  // green: the middle one
  t.texels[4 * 3 + 2] = 255;  // blue: the one after it
  const MipMap map = make_mip_map(t, nullptr);
  EXPECT_EQ(texel(map, 1, 0, 0)[0], linear_to_srgb8(0.4f));
  EXPECT_EQ(texel(map, 1, 0, 0)[1], linear_to_srgb8(0.2f));
  EXPECT_EQ(texel(map, 1, 0, 0)[2], 0);
  EXPECT_EQ(texel(map, 1, 1, 0)[0], 0);
  EXPECT_EQ(texel(map, 1, 1, 0)[1], linear_to_srgb8(0.2f));
  EXPECT_EQ(texel(map, 1, 1, 0)[2], linear_to_srgb8(0.4f));
}

// A level's codes are off by half a step each, 1/220 at most where steps are widest; nothing else is lost.
TEST(MipMap, KeepsTheLight) {
  Random random(5);
  for (const auto& [width, height] : kSizes) {
    Texture t = plain(width, height, {0, 0, 0, 255});
    for (uint8_t& c : t.texels) c = static_cast<uint8_t>(random.below(256));
    const MipMap map = make_mip_map(t, nullptr);
    for (size_t channel = 0; channel < 3; ++channel)
      for (const MipLevel& level : map.levels)
        EXPECT_NEAR(mean(level, channel), mean(map.levels[0], channel), 1.0 / 220) << width << "x" << height;
  }
}

// A leaf is green; that its picture is red where nothing of it is there must never show.
TEST(MipMap, WhatIsCutOutDoesNotBleed) {
  Random random(6);
  Texture leaf = plain(24, 18, {200, 0, 0, 0}), other = leaf;
  for (size_t i = 0; i < leaf.texels.size(); i += 4) {
    if (i > 0 && random.below(3) != 0) continue;
    leaf.texels[i] = 0, leaf.texels[i + 1] = 150, leaf.texels[i + 3] = 255;
    other.texels[i + 3] = 255;
  }
  for (size_t i = 0; i < leaf.texels.size(); i += 4) ASSERT_EQ(leaf.texels[i + 3], other.texels[i + 3]);
  Texture colour = leaf;
  for (size_t i = 3; i < colour.texels.size(); i += 4) colour.texels[i] = 255;
  const MipMap own = make_mip_map(leaf, &leaf), others = make_mip_map(colour, &other);
  EXPECT_EQ(own.texels, others.texels);
  size_t green = 0;
  for (size_t i = 0; i < own.texels.size(); i += 4) {
    if (own.texels[i + 3] == 0) continue;
    ++green;
    ASSERT_EQ(own.texels[i], 0);
    ASSERT_EQ(own.texels[i + 1], 150);
  }
  EXPECT_GT(green, 100u);
}

TEST(MipMap, AreMadeOfColoursThatAreUsed) {
  Scene scene;
  scene.textures = {checkerboard(8, 8, 1), checkerboard(8, 8, 1), checkerboard(8, 8, 1)};
  Material m;
  m.diffuse_map = 2;
  m.opacity_map = 1;
  scene.materials = {m};
  for (const int threads : {1, 3}) {
    ThreadPool pool(threads);
    const std::vector<MipMap> maps = make_mip_maps(scene, pool);
    ASSERT_EQ(maps.size(), 3u);
    EXPECT_TRUE(maps[0].levels.empty());
    EXPECT_TRUE(maps[1].levels.empty());
    EXPECT_EQ(maps[2].levels.size(), 4u);
  }
}

}  // namespace
}  // namespace vitral::test
