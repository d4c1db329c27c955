// Models of trees: a trunk, and leaves that stand for themselves.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "vitral/vec.h"

namespace forest {

using vitral::Vec3d;

// Wellons' lowbias32 (2018): the same numbers on every machine.
struct Random {
  uint32_t seed, count;
};
static inline double between(Random& r, double low, double high) {
  uint32_t x = (r.seed << 24) + r.count++;
  x = (x ^ x >> 16) * 0x7feb352du;
  x = (x ^ x >> 15) * 0x846ca68bu;
  return low + (high - low) * ((x ^ x >> 16) * (1.0 / 4294967296.0));
}

enum class Stuff { bark, needles, young_needles, leaves, young_leaves };

// Metres, y up, its foot in the origin. A triangle has one shading normal: that of the crown where it is.
struct Triangle {
  Vec3d corner[3];
  Vec3d normal;
  Stuff stuff;
};
using Tree = std::vector<Triangle>;

// About that many triangles, but always the same amount of leaf.
Tree fir(int triangles);
Tree oak(int triangles);

// As OBJ, coordinates rounded to 1 mm, so that the last bits of a compiler's mathematics do not show. Returns
// how many triangles were left by that. Throws on failure.
size_t write_tree(const Tree& tree, const std::string& library, const std::filesystem::path& file);

}  // namespace forest
