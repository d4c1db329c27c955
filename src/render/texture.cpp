#include "render/texture.h"

#include "math/scalar.h"
#include "math/srgb.h"
#include "render/frame.h"

namespace vitral {
namespace {

// The four texels around a point, as offsets into the texels, and their weights.
struct Quad {
  uint32_t texel[4];
  float weight[4];
};

// The part of x above the largest integer not above it, in [0, 1); 0 where x is not finite or too large to
// have one.
float fraction_of(float x) {
  if (!(x > -8388608.0f && x < 8388608.0f)) return 0;
  const float whole = static_cast<float>(static_cast<int>(x));
  const float f = x - (whole > x ? whole - 1 : whole);
  return f < 1 ? f : 0;
}

// The texel whose centre is at or before x >= -0.5 texels, its neighbour, and how far between them x lies.
struct Pair {
  uint32_t first, second;
  float between;
};
Pair pair_around(float x, int size) {
  const int whole = static_cast<int>(x);
  const int first = x < 0 ? size - 1 : whole;
  const int second = first + 1 == size ? 0 : first + 1;
  return {static_cast<uint32_t>(first), static_cast<uint32_t>(second),
          x < 0 ? x + 1 : x - static_cast<float>(whole)};
}

// Texel centres are at (i + 0.5) / n; the first row is at v = 1.
Quad quad_around(int width, int height, const Vec2& uv) {
  const Pair column = pair_around(fraction_of(uv.x) * static_cast<float>(width) - 0.5f, width);
  const Pair row = pair_around((1 - fraction_of(uv.y)) * static_cast<float>(height) - 0.5f, height);
  const uint32_t top = row.first * static_cast<uint32_t>(width),
                 below = row.second * static_cast<uint32_t>(width);
  const float x = column.between, y = row.between;
  return {{4 * (top + column.first), 4 * (top + column.second), 4 * (below + column.first),
           4 * (below + column.second)},
          {(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y}};
}

Vec3 sample_level(const MipLevel& level, const Vec2& uv) {
  const Quad q = quad_around(level.width, level.height, uv);
  Vec3 sum{0, 0, 0};
  for (int i = 0; i < 4; ++i) {
    const uint8_t* t = level.texels + q.texel[i];
    sum += Vec3{kLinearOfSrgb[t[0]], kLinearOfSrgb[t[1]], kLinearOfSrgb[t[2]]} * q.weight[i];
  }
  return sum;
}

// The probes of a row: where the first one lies and how far the next is, in 2^-32 of the picture's sides from
// its upper left corner, so that repeating the picture is what integers do by themselves.
struct Row {
  uint32_t x, y, step_x, step_y;
  int count;
};

int64_t fixed(float x) {
  return static_cast<int64_t>(x * 4294967296.0f);
}

Row make_row(const Vec2& center, const Vec2& step, float count) {
  const int64_t n = static_cast<int64_t>(count), step_x = fixed(step.x), step_y = -fixed(step.y);
  return {static_cast<uint32_t>(fixed(fraction_of(center.x)) - ((n - 1) * step_x >> 1)),
          static_cast<uint32_t>(-fixed(fraction_of(center.y)) - ((n - 1) * step_y >> 1)),
          static_cast<uint32_t>(step_x), static_cast<uint32_t>(step_y), static_cast<int>(n)};
}

// The mean of a row's probes in one level.
Vec3 sample_row(const MipLevel& level, const Row& row) {
  const auto width = static_cast<uint32_t>(level.width), height = static_cast<uint32_t>(level.height);
  // From texels' corners to their centres.
  uint32_t x = row.x - 0x80000000u / width, y = row.y - 0x80000000u / height;
  float r = 0, g = 0, b = 0;
  for (int i = 0; i < row.count; ++i, x += row.step_x, y += row.step_y) {
    const uint64_t column = static_cast<uint64_t>(x) * width, line = static_cast<uint64_t>(y) * height;
    const auto left = static_cast<uint32_t>(column >> 32), top = static_cast<uint32_t>(line >> 32);
    const uint32_t right = left + 1 == width ? 0 : left + 1, bottom = top + 1 == height ? 0 : top + 1;
    const float fx = static_cast<float>(static_cast<int32_t>(static_cast<uint32_t>(column) >> 8)) * 0x1p-24f;
    const float fy = static_cast<float>(static_cast<int32_t>(static_cast<uint32_t>(line) >> 8)) * 0x1p-24f;
    const auto add = [&](uint32_t texel, float share) {
      const uint8_t* t = level.texels + 4 * static_cast<size_t>(texel);
      r += kLinearOfSrgb[t[0]] * share, g += kLinearOfSrgb[t[1]] * share, b += kLinearOfSrgb[t[2]] * share;
    };
    const float upper = 1 - fy, upper_right = fx * upper, lower_right = fx * fy;
    add(top * width + left, upper - upper_right);
    add(top * width + right, upper_right);
    add(bottom * width + left, fy - lower_right);
    add(bottom * width + right, lower_right);
  }
  return Vec3{r, g, b} * (1 / static_cast<float>(row.count));
}

}  // namespace

Vec3 sample_color(const MipMap& map, const Vec2& center, const Vec2& step, float width, float count) {
  if (width == 1 && count == 1) return sample_level(map.levels[0], center);
  // width = 2^level * (1 + above)
  const uint32_t bits = as_bits(width);
  const size_t level = (bits >> 23) - 127, last = map.levels.size() - 1;
  if (level >= last) return sample_level(map.levels[last], center);
  const float above = from_bits((bits & 0x7fffffu) | 0x3f800000u) - 1;
  const Row row = make_row(center, step, count);
  const Vec3 fine = sample_row(map.levels[level], row);
  if (above == 0) return fine;
  return fine * (1 - above) + sample_row(map.levels[level + 1], row) * above;
}

float sample_alpha(const Texture& texture, Vec2 uv) {
  const Quad q = quad_around(texture.width, texture.height, uv);
  float sum = 0;
  for (int i = 0; i < 4; ++i) sum += static_cast<float>(texture.texels[q.texel[i] + 3]) * q.weight[i];
  return sum * (1.0f / 255);
}

void apply_textures(const FrameContext& frame, const HitPacket& hits, const RayWidths& widths,
                    SurfacePacket& s, const HitTriangles* triangles) {
  const Scene& scene = frame.scene;
  if (frame.accelerator.mip_maps.empty()) return;
  TexturedLanes lanes;
  uint64_t textured = 0;
  for (uint64_t left = s.points.live; left != 0; left &= left - 1) {
    const int lane = __builtin_ctzll(left);
    const int map = scene.materials[s.material[lane]].diffuse_map;
    if (map == kNoTexture) continue;
    textured |= 1ull << lane;
    const Texture& texture = scene.textures[static_cast<size_t>(map)];
    lanes.columns[lane] = static_cast<float>(texture.width);
    lanes.rows[lane] = static_cast<float>(texture.height);
    const CornerTexcoords corners =
        triangles ? triangles->texcoords[lane] : corner_texcoords(scene.mesh, s.triangle[lane]);
    for (size_t k = 0; k < 3; ++k) lanes.u[k][lane] = corners[k].x, lanes.v[k][lane] = corners[k].y;
  }
  if (textured == 0) return;
  Footprints f;
  const KdTriangle* const own = triangles ? triangles->triangles : frame.accelerator.triangles.data();
  frame.kernels.texture_footprints(own, hits, s.points, widths, lanes, textured, f);
  for (uint64_t left = textured; left != 0; left &= left - 1) {
    const int lane = __builtin_ctzll(left);
    const auto map = static_cast<size_t>(scene.materials[s.material[lane]].diffuse_map);
    const Vec3 seen = sample_color(frame.accelerator.mip_maps[map], {f.u[lane], f.v[lane]},
                                   {f.step_u[lane], f.step_v[lane]}, f.width[lane], f.count[lane]);
    s.r[lane] *= seen.x, s.g[lane] *= seen.y, s.b[lane] *= seen.z;
  }
}

}  // namespace vitral
