// Pictures for textures: square, tileable, 8-bit sRGB.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

namespace plaza {

// sRGB-encoded, 0..1, with an opacity that only cut-outs use.
struct Color {
  double r = 0, g = 0, b = 0, a = 1;
};
Color mix(const Color& a, const Color& b, double t);
Color scaled(const Color& c, double brightness);
double smooth_step(double low, double high, double x);
double wrapped(double x);  // into [0, 1)

// Value noise in 0..1 on a lattice of `period` cells over the unit square; tileable.
double noise(double u, double v, int period, uint32_t seed);
// `octaves` of it, each twice as fine and half as strong.
double fractal(double u, double v, int period, int octaves, uint32_t seed);

// The cell of a jittered grid of `cells` x `cells` stones that (u, v) lies in; tileable.
struct Stone {
  double u = 0, v = 0;  // its centre, unwrapped
  double border = 0;    // 0 at the joint, in units of a cell
  uint32_t id = 0;
};
Stone stone_at(double u, double v, int cells, double jitter, uint32_t seed);

// A wall of blocks in running bond. `x` and `y` are 0..1 inside the block.
struct Block {
  double x = 0, y = 0;
  uint32_t id = 0;
};
Block block_at(double u, double v, int columns, int rows, uint32_t seed);
// 0 in the joint between blocks, 1 on their face; `aspect` is width over height of a block.
double block_face(const Block& block, double joint, double aspect);

enum class Alpha { none, straight };

// Paints every pixel and writes a PNG. v runs up, as texture coordinates do. Throws on failure.
void paint(const std::filesystem::path& file, int side, Alpha alpha,
           const std::function<Color(double u, double v)>& color);

}  // namespace plaza
