#include "render/background.h"

#include "math/elementary.h"
#include "math/srgb.h"

namespace vitral {
namespace {

constexpr double kPi = 3.141592653589793;

Vec3 texel(const Texture& t, int column, int row) {
  const size_t i =
      4 * (static_cast<size_t>(row) * static_cast<size_t>(t.width) + static_cast<size_t>(column));
  return {kLinearOfSrgb[t.texels[i]], kLinearOfSrgb[t.texels[i + 1]], kLinearOfSrgb[t.texels[i + 2]]};
}

Vec3 mean_of_row(const Texture& t, int row) {
  Vec3 sum{0, 0, 0};
  for (int column = 0; column < t.width; ++column) sum += texel(t, column, row);
  return sum * (1 / static_cast<float>(t.width));
}

Vec3 mixed(const Vec3& a, const Vec3& b, float share_of_b) {
  return a * (1 - share_of_b) + b * share_of_b;
}

// The integer at or below x >= -1, and the rest.
struct Neighbours {
  int first;
  float between;
};
Neighbours around(double x) {
  const int first = static_cast<int>(x + 1) - 1;
  return {first, static_cast<float>(x - first)};
}

Vec3 panorama_light(const Texture& t, const Sky& sky, const Vec3d& d) {
  const double azimuth = arc_tangent(d.x, -d.z) / (2 * kPi);  // -1/2..1/2
  const double elevation = arc_tangent(d.y, square_root(d.x * d.x + d.z * d.z)) / kPi;
  // From texels' corners to their centres: column -1/2 is the middle between the last and the first.
  const Neighbours across = around((azimuth + 0.5) * t.width - 0.5);
  const int left = across.first < 0 ? t.width - 1 : across.first >= t.width ? 0 : across.first;
  const int right = left + 1 == t.width ? 0 : left + 1;
  const auto in_row = [&](int row) {
    return mixed(texel(t, left, row), texel(t, right, row), across.between);
  };
  const double y = (0.5 - elevation) * t.height - 0.5;
  const Neighbours down = around(y);
  if (down.first < 0) return mixed(in_row(0), sky.zenith, static_cast<float>(least(-2 * y, 1.0)));
  const int last = t.height - 1;
  if (down.first >= last)
    return mixed(in_row(last), sky.nadir, static_cast<float>(least(2 * (y - last), 1.0)));
  return mixed(in_row(down.first), in_row(down.first + 1), down.between);
}

}  // namespace

Sky make_sky(const Scene& scene) {
  const Background& b = scene.background;
  if (b.kind != Background::Kind::panorama) return {};
  const Texture& t = scene.textures[static_cast<size_t>(b.panorama)];
  return {mean_of_row(t, 0), mean_of_row(t, t.height - 1)};
}

Vec3 background_light(const Scene& scene, const Sky& sky, const Vec3& direction) {
  const Background& b = scene.background;
  switch (b.kind) {
    case Background::Kind::gradient: {
      const float sine = direction.y / length(direction);
      return sine > 0 ? mixed(b.color, b.zenith, least(sine, 1.0f)) : b.color;
    }
    case Background::Kind::panorama:
      return panorama_light(scene.textures[static_cast<size_t>(b.panorama)], sky, to_double(direction)) *
             b.scale;
    case Background::Kind::constant:
      break;
  }
  return b.color;
}

}  // namespace vitral
