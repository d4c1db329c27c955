// What is interpolated over rasterized triangles is perspective-correct: colours of a plane seen at a slant
// against the same in double, and the depths that decide what is seen against the triangles' true planes.
#include "raster_support.h"

#include <gtest/gtest.h>

#include <cmath>

namespace vitral {
namespace {

using namespace raster_test;

constexpr int kWidth = 320, kHeight = 240;

// Where the ray through a pixel's centre meets the plane y = -1, from the camera's own numbers in double.
struct GroundPoint {
  double x, z, t;  // t: the depth
};
GroundPoint ground_at(const Pinhole& c, int px, int py) {
  const double a = (px + 0.5) * widen(c.step) - widen(c.center_x),
               b = widen(c.center_y) - (py + 0.5) * widen(c.step);
  const Vec3d d = to_double(c.forward) + to_double(c.right) * a + to_double(c.up) * b;
  const double t = (-1 - widen(c.origin.y)) / d.y;
  return {widen(c.origin.x) + d.x * t, widen(c.origin.z) + d.z * t, t};
}

// A board of squares with sides of 1, black and white at their centres and linear between.
double board(double x, double z) {
  const auto ramp = [](double v) { return 2 * std::abs(v / 2 - std::floor(v / 2) - 0.5); };
  const double a = ramp(x), b = ramp(z);
  return a * (1 - b) + b * (1 - a);
}

// The ground as n x n quads of the given side around (0, -1, 0).
Mesh ground(int n, float side) {
  Mesh mesh;
  const auto corner = [&](int i, int j) {
    return Vec3{(static_cast<float>(i) - static_cast<float>(n) / 2) * side, -1,
                (static_cast<float>(j) - static_cast<float>(n) / 2) * side};
  };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      add_triangle(mesh, corner(i, j), corner(i + 1, j), corner(i + 1, j + 1));
      add_triangle(mesh, corner(i, j), corner(i + 1, j + 1), corner(i, j + 1));
    }
  }
  return mesh;
}

TEST(RasterAttributes, ABoardInPerspectiveHasTheColorsOfTheReference) {
  const Pinhole camera =
      make_camera({0.3f, 0.4f, 1}, normalize(Vec3{0.2f, -0.5f, -1}), kWidth, kHeight, 0.7f, 0.05f, 1000);
  Paths paths;
  size_t compared = 0;
  double total = 0;
  for (const auto& [n, side] : {std::pair{1, 400.0f}, std::pair{10, 20.0f}, std::pair{200, 0.4f}}) {
    const Mesh mesh = ground(n, side);
    const std::vector<KdTriangle> triangles = kd_triangles(mesh);
    for (const Kernels* kernels : available_kernels()) {
      RasterFrame frame;
      setup_frame(kernels->front_end, camera, kWidth, kHeight, {}, mesh, nullptr, in_order, frame);
      add(paths, paths_taken(frame, mesh));
      const Picture picture = fill_frame(*kernels, camera, kWidth, kHeight, frame);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; x += kBlockSide) {
          if (y % kBlockSide != 0) continue;
          uint32_t numbers[kPacketSize];
          for (int i = 0; i < kPacketSize; ++i) numbers[i] = picture.at(x + i % 8, y + i / 8);
          HitPacket hits;
          kernels->intersect_visible(camera, triangles.data(), x, y, numbers, hits);
          for (int i = 0; i < kPacketSize; ++i) {
            const GroundPoint point = ground_at(camera, x + i % 8, y + i / 8);
            const Hit hit = hit_of(hits, i);
            // Farther away the 1/256 pixel of an edge's snapping is more than 1/255 of a square.
            if (!(point.t > 0 && point.t < 12)) continue;
            ASSERT_NE(hit.triangle, kNoTriangle) << x + i % 8 << "," << y + i / 8;
            const Corners& c = mesh.triangles[hit.triangle];
            const double u = widen(hit.u), v = widen(hit.v);
            const Vec3d p = to_double(mesh.positions[c[0]]) * (1 - u - v) +
                            to_double(mesh.positions[c[1]]) * u + to_double(mesh.positions[c[2]]) * v;
            const double expected = board(point.x, point.z);
            ASSERT_NEAR(board(p.x, p.z), expected, 1.0 / 255) << x + i % 8 << "," << y + i / 8;
            total += expected;
            ++compared;
          }
        }
      }
    }
  }
  EXPECT_GT(compared, 500000u);
  EXPECT_NEAR(total / static_cast<double>(compared), 0.5, 0.1);  // neither black nor white all over
  EXPECT_TRUE(paths.small > 0 && paths.cells > 0 && paths.clipped > 0);
}

double linear(uint8_t srgb) {
  const double c = srgb / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

// The same by render(): a texture, each texel of which covers several pixels.
TEST(RasterAttributes, AMagnifiedTextureHasTheColorsOfTheReference) {
  constexpr int texels = 16;
  Scene scene;
  Material m;
  m.diffuse = {1, 1, 1};
  m.diffuse_map = 0;
  Texture texture{"noise", texels, texels, std::vector<uint8_t>(4 * texels * texels, 255)};
  test::Random random(82);
  for (size_t i = 0; i < texture.texels.size(); ++i) {
    if (i % 4 != 3) texture.texels[i] = static_cast<uint8_t>(random.below(256));
  }
  scene.textures.push_back(texture);
  // x runs along u, -z along v: one texel a unit.
  test::add_quad(scene, test::add_material(scene, m), {-8, -1, 8}, {16, 0, 0}, {0, 0, -16});
  const Camera camera = test::camera_at({0.3f, 1.5f, 2}, {0.2f, -0.9f, -1}, 45);
  const Pinhole pinhole = make_pinhole(camera, kWidth, kHeight);
  Settings settings;
  settings.width = kWidth, settings.height = kHeight;
  settings.threads = 1;
  settings.effects = test::kNoEffects;
  settings.aovs = {"albedo"};
  const Frame frame = test::render_scene(scene, camera, settings);
  const auto texel = [&](int column, int row, size_t channel) {
    const size_t i = static_cast<size_t>((row & (texels - 1)) * texels + (column & (texels - 1)));
    return linear(texture.texels[4 * i + channel]);
  };
  size_t compared = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const GroundPoint p = ground_at(pinhole, x, y);
      if (!(p.t > 0) || std::abs(p.x) > 7.9 || std::abs(p.z) > 7.9) continue;
      const double s = p.x + 8 - 0.5, t = 8 + p.z - 0.5;  // from the texel centre at the upper left
      const double s0 = std::floor(s), t0 = std::floor(t), fs = s - s0, ft = t - t0;
      const int column = static_cast<int>(s0), row = static_cast<int>(t0);
      const Vec3 got = frame.aovs[0].pixels.row(y)[x];
      for (size_t channel = 0; channel < 3; ++channel) {
        const double above = texel(column, row, channel) * (1 - fs) + texel(column + 1, row, channel) * fs;
        const double below =
            texel(column, row + 1, channel) * (1 - fs) + texel(column + 1, row + 1, channel) * fs;
        ASSERT_NEAR(component(got, static_cast<int>(channel)), above * (1 - ft) + below * ft, 1.0 / 255)
            << x << "," << y;
      }
      ++compared;
    }
  }
  EXPECT_GT(compared, 60000u);
}

// The depth of a small triangle is computed in float from places that are off by up to 2^-14 pixel; that of
// the others is the plane's. Neither ever leaves the range of the corners.
TEST(RasterAttributes, DepthsAreThoseOfTheTruePlanes) {
  Random random(83);
  Mesh mesh;
  for (int i = 0; i < 20000; ++i) {
    const bool small = i % 8 != 0;
    const float size = small ? 2.0f : 40.0f;
    const float x = random.between(0, 320), y = random.between(0, 240),
                depth = random.between(2, 20) * (small ? 1.0f : 3.0f);
    Vec3 p[3];
    for (Vec3& v : p) {
      const float dx = random.between(-size, size), dy = random.between(-size, size);
      v = at_pixel(x + dx, y + dy, depth * random.between(0.8f, 1.2f));
    }
    add_triangle(mesh, p[0], p[1], p[2]);
  }
  const Projection projection = make_projection(pixel_camera(), kWidth, kHeight, {});
  RasterFrame frame;
  const Kernels& kernels = *available_kernels().back();
  setup_frame(kernels.front_end, pixel_camera(), kWidth, kHeight, {}, mesh, nullptr, in_order, frame);
  std::vector<bool> is_small(mesh.triangles.size());
  for (const SetupChunk& chunk : frame.chunks) {
    for (const Fragment& f : chunk.fragments) is_small[f.triangle] = true;
  }
  const Picture picture = fill_frame(kernels, pixel_camera(), kWidth, kHeight, frame);
  size_t covered[2] = {}, close[2] = {};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const uint32_t number = picture.at(x, y);
      if (number == kNoTriangle) continue;
      Vec3d v[3];
      double low = 1e30, high = 0;
      for (size_t k = 0; k < 3; ++k) {
        v[k] = project(projection, to_double(mesh.positions[mesh.triangles[number][k]]));
        low = std::min(low, 1 / v[k].z), high = std::max(high, 1 / v[k].z);
      }
      const Vec3d n = cross(v[1] - v[0], v[2] - v[0]);
      const double det = dot(v[0], n), across = n.x / det, down = n.y / det;
      const double expected = std::clamp(n.z / det + across * (x + 0.5) + down * (y + 0.5), low, high);
      const double got = widen(picture.depth_at(x, y)), ulp = expected * 0x1p-23;
      ASSERT_TRUE(got >= low - ulp && got <= high + ulp) << x << "," << y;
      const double places = is_small[number] ? std::hypot(across, down) * 0x1p-13 : 0.0;
      ++covered[is_small[number]];
      close[is_small[number]] += std::abs(got - expected) <= places + 4 * ulp;
    }
  }
  for (const size_t kind : {size_t{0}, size_t{1}}) {
    EXPECT_GT(covered[kind], 5000u) << kind;
    // But for slivers, whose plane no float can hold.
    EXPECT_GT(static_cast<double>(close[kind]), 0.998 * static_cast<double>(covered[kind])) << kind;
  }
}

}  // namespace
}  // namespace vitral
