#include "render/texture.h"

#include "math/srgb.h"

namespace vitral {
namespace {

// The four texels around a point, as offsets into the texels, and their weights.
struct Footprint {
  size_t texel[4];
  float weight[4];
};

// The largest integer not above x; 0 where x is not finite or too large to have a fraction.
float floor_of(float x) {
  if (!(x > -8388608.0f && x < 8388608.0f)) return 0;
  const float whole = static_cast<float>(static_cast<int>(x));
  return whole > x ? whole - 1 : whole;
}

int wrap(int i, int n) {
  return i < 0 ? i + n : i >= n ? i - n : i;
}

Footprint footprint(const Texture& t, Vec2 uv) {
  // Reduced to [0, 1) first; texel centres are at (i + 0.5) / n; the first row is v = 1.
  float u = uv.x - floor_of(uv.x), v = uv.y - floor_of(uv.y);
  if (!(u >= 0 && u < 1)) u = 0;
  if (!(v >= 0 && v < 1)) v = 0;
  const float x = u * static_cast<float>(t.width) - 0.5f, y = (1 - v) * static_cast<float>(t.height) - 0.5f;
  const float x0 = floor_of(x), y0 = floor_of(y);
  const float fx = x - x0, fy = y - y0;
  const int left = wrap(static_cast<int>(x0), t.width), right = wrap(left + 1, t.width);
  const int top = wrap(static_cast<int>(y0), t.height), bottom = wrap(top + 1, t.height);
  const auto at = [&](int i, int j) {
    return (static_cast<size_t>(j) * static_cast<size_t>(t.width) + static_cast<size_t>(i)) * 4;
  };
  return {{at(left, top), at(right, top), at(left, bottom), at(right, bottom)},
          {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy}};
}

}  // namespace

Vec3 sample_color(const Texture& texture, Vec2 uv) {
  const Footprint f = footprint(texture, uv);
  Vec3 sum{0, 0, 0};
  for (int i = 0; i < 4; ++i) {
    const uint8_t* t = texture.texels.data() + f.texel[i];
    sum += Vec3{kLinearOfSrgb[t[0]], kLinearOfSrgb[t[1]], kLinearOfSrgb[t[2]]} * f.weight[i];
  }
  return sum;
}

float sample_alpha(const Texture& texture, Vec2 uv) {
  const Footprint f = footprint(texture, uv);
  float sum = 0;
  for (int i = 0; i < 4; ++i) sum += static_cast<float>(texture.texels[f.texel[i] + 3]) * f.weight[i];
  return sum * (1.0f / 255);
}

}  // namespace vitral
