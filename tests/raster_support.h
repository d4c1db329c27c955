// What the rasterizer's tests share: cameras, a random source, and whole pictures of triangle numbers.
#pragma once
#include "kdtree/kdtree.h"
#include "kernels/kernels.h"
#include "parallel/parallel_for.h"
#include "raster/frame.h"
#include "render/kernel_choice.h"
#include "support.h"
#include "vitral/scene.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace vitral {

namespace raster_test {

using test::Random;

// A whole number in [low, high].
inline int between(Random& random, int low, int high) {
  return low + static_cast<int>(random.below(static_cast<uint32_t>(high - low + 1)));
}

// Looks along -z from the world's origin; the pixel of the point (x, -y, -1) is (x, y) exactly.
inline Pinhole pixel_camera(float near = 0.125f, float far = 1e6f) {
  return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}, 1, 0, 0, near, far, 1};
}
// The point seen at (x, y) pixels by the camera above, at the given depth.
inline Vec3 at_pixel(float x, float y, float depth) {
  return {x * depth, -y * depth, -depth};
}

// An ordinary camera; `view` must have unit length and not be vertical.
inline Pinhole make_camera(const Vec3& eye, const Vec3& view, int width, int height, float half_height,
                           float near, float far) {
  const Vec3 right = normalize(cross(view, Vec3{0, 1, 0}));
  const Vec3 up = cross(right, view);
  const float step = 2 * half_height / static_cast<float>(height);
  return {eye, right, up, view, step, step * static_cast<float>(width) * 0.5f, half_height, near, far, step};
}

inline void in_order(size_t count, const std::function<void(size_t)>& body) {
  for (size_t i = 0; i < count; ++i) body(i);
}

inline void add_triangle(Mesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c) {
  const uint32_t n = static_cast<uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {a, b, c});
  mesh.triangles.push_back({n, n + 1, n + 2});
}

// Triangles of all sizes in front of, around and behind pixel_camera().
inline Mesh soup(Random& random, int count, float depth_from, float depth_to) {
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const float size = std::array{0.5f, 3.0f, 20.0f, 200.0f, 5000.0f, 300000.0f}[random.below(6)];
    const float x = random.between(-20, 120), y = random.between(-20, 120);
    Vec3 p[3];
    for (Vec3& v : p) {
      const float dx = random.between(-size, size), dy = random.between(-size, size);
      v = at_pixel(x + dx, y + dy, random.between(depth_from, depth_to));
    }
    add_triangle(mesh, p[0], p[1], p[2]);
  }
  return mesh;
}

inline std::vector<KdTriangle> kd_triangles(const Mesh& mesh, uint32_t flags = 0) {
  std::vector<KdTriangle> out;
  for (const Corners& c : mesh.triangles) {
    KdTriangle t{};
    for (size_t k = 0; k < 3; ++k) {
      const Vec3& p = mesh.positions[c[k]];
      t.corner[k][0] = p.x, t.corner[k][1] = p.y, t.corner[k][2] = p.z;
    }
    t.flags = flags;
    out.push_back(t);
  }
  return out;
}

// What every pixel sees, row by row.
struct Picture {
  int width = 0, height = 0;
  std::vector<uint32_t> triangle;
  std::vector<float> inverse_depth;

  uint32_t at(int x, int y) const { return triangle[static_cast<size_t>(y * width + x)]; }
  float depth_at(int x, int y) const { return inverse_depth[static_cast<size_t>(y * width + x)]; }
  size_t covered() const {
    return triangle.size() - static_cast<size_t>(std::count(triangle.begin(), triangle.end(), kNoTriangle));
  }
};
inline bool operator==(const Picture& a, const Picture& b) {
  return a.width == b.width && a.triangle == b.triangle && a.inverse_depth == b.inverse_depth;
}

struct Options {
  Rectangle crop{};
  const KdTriangle* triangles = nullptr;
  const CutOuts* cut_outs = nullptr;
};

// All stages before the tiles.
inline void setup_frame(const FrontEnd& kernels, const Pinhole& camera, int width, int height,
                        const Rectangle& crop, const Mesh& mesh, const KdTriangle* flags_of,
                        const ForEach& for_each, RasterFrame& frame) {
  transform_vertices(kernels.project_vertices, camera, width, height, crop, mesh, for_each, frame);
  setup_triangles(kernels.setup_triangles, mesh, flags_of, for_each, frame);
  bin_triangles(for_each, frame);
}

// Fills the tiles of a frame that is set up, as far as they touch its window.
inline Picture fill_frame(const Kernels& kernels, const Pinhole& camera, int width, int height,
                          const RasterFrame& frame, const Options& options = {}) {
  const RasterView view = make_view(frame, camera, options.triangles, options.cut_outs);
  Picture picture{width, height, {}, {}};
  picture.triangle.assign(static_cast<size_t>(width * height), kNoTriangle);
  picture.inverse_depth.assign(picture.triangle.size(), 0.0f);
  const auto tile = std::make_unique<TileVisibility>();
  const PixelBox& window = view.window;
  for (int ty = window.y0 / kTileSide; ty * kTileSide < window.y1; ++ty) {
    for (int tx = window.x0 / kTileSide; tx * kTileSide < window.x1; ++tx) {
      kernels.fill_tile(view, tx, ty, *tile);
      for (int y = 0; y < kTileSide; ++y) {
        for (int x = 0; x < kTileSide; ++x) {
          const int px = tx * kTileSide + x, py = ty * kTileSide + y;
          const size_t i =
              static_cast<size_t>(((y / 8) * kTileBlocksAcross + x / 8) * kPacketSize + (y % 8) * 8 + x % 8);
          if (px >= width || py >= height) continue;
          const size_t p = static_cast<size_t>(py * width + px);
          picture.triangle[p] = tile->triangle[i];
          picture.inverse_depth[p] = tile->inverse_depth[i];
        }
      }
    }
  }
  return picture;
}

inline Picture rasterize(const Kernels& kernels, const Pinhole& camera, int width, int height,
                         const Mesh& mesh, const Options& options = {}) {
  RasterFrame frame;
  setup_frame(kernels.front_end, camera, width, height, options.crop, mesh, options.triangles, in_order,
              frame);
  return fill_frame(kernels, camera, width, height, frame, options);
}

// How many triangles cover each pixel, hidden or not: 0, 1, or 2 for several. Of any two triangles one has a
// bit set in its number that the other has not: so it is enough to fill, for every bit, those that have it
// and those that have not.
inline std::vector<int> count_coverage(const Kernels& kernels, const Pinhole& camera, int width, int height,
                                       const Mesh& mesh) {
  std::vector<int> count(static_cast<size_t>(width * height), 0);
  Mesh half;
  half.positions = mesh.positions;
  for (uint32_t bit = 0; bit == 0 || mesh.triangles.size() > size_t{1} << bit; ++bit) {
    std::vector<int> covered(count.size(), 0);
    for (uint32_t value = 0; value < 2; ++value) {
      half.triangles.clear();
      for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        if ((i >> bit & 1) == value) half.triangles.push_back(mesh.triangles[i]);
      }
      const Picture p = rasterize(kernels, camera, width, height, half);
      for (size_t i = 0; i < count.size(); ++i) covered[i] += p.triangle[i] != kNoTriangle;
    }
    for (size_t i = 0; i < count.size(); ++i) count[i] = std::max(count[i], covered[i]);
  }
  return count;
}

// How many triangles went which way through setup: their pixels were found at once; they are filled cell by
// cell, set up by the kernel, or too large for it; they were clipped.
struct Paths {
  size_t small = 0, cells = 0, large = 0, clipped = 0;
  bool all() const { return small > 0 && cells > 0 && large > 0 && clipped > 0; }
};
inline void add(Paths& sum, const Paths& p) {
  sum.small += p.small, sum.cells += p.cells, sum.large += p.large, sum.clipped += p.clipped;
}
inline Paths paths_taken(const RasterFrame& frame, const Mesh& mesh) {
  Paths paths;
  for (const SetupChunk& chunk : frame.chunks) {
    std::vector<uint32_t> small;
    for (const Fragment& f : chunk.fragments) small.push_back(f.triangle);
    std::sort(small.begin(), small.end());
    paths.small += static_cast<size_t>(std::unique(small.begin(), small.end()) - small.begin());
    uint32_t last = kNoTriangle;
    for (const SetupTriangle& t : chunk.triangles) {
      if (t.triangle == last) continue;  // another part of a clipped one
      last = t.triangle;
      const Corners& c = mesh.triangles[t.triangle];
      const auto [x0, x1] = std::minmax({t.x[0], t.x[1], t.x[2]});
      const auto [y0, y1] = std::minmax({t.y[0], t.y[1], t.y[2]});
      if ((frame.vertices[c[0]].outside | frame.vertices[c[1]].outside | frame.vertices[c[2]].outside) != 0)
        ++paths.clipped;
      else if (std::max(x1 - x0, y1 - y0) > 128 * kSubpixels)
        ++paths.large;
      else
        ++paths.cells;
    }
  }
  return paths;
}

}  // namespace raster_test
}  // namespace vitral
