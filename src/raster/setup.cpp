// Triangle setup: project, clip, snap, cull, and find edges' corners and the plane of inverse depth. All
// but the triangles that are clipped or very large are left to the kernel.
#include "raster/setup.h"

#include "raster/bin.h"
#include "raster/coverage.h"
#include "raster/project.h"

#include <algorithm>
#include <bit>
#include <memory>

namespace vitral {
namespace {

struct SnappedPolygon {
  int32_t x[kMaxClippedCorners], y[kMaxClippedCorners];
  int corners;
  float least, greatest;  // inverse depth
};

void add_corner(int32_t x, int32_t y, float inverse_depth, SnappedPolygon& p) {
  p.least = p.corners == 0 ? inverse_depth : least(p.least, inverse_depth);
  p.greatest = p.corners == 0 ? inverse_depth : greatest(p.greatest, inverse_depth);
  p.x[p.corners] = x;
  p.y[p.corners] = y;
  ++p.corners;
}

SnappedPolygon clip_and_snap(const Projection& projection, const ClipVertex triangle[3]) {
  SnappedPolygon result{};
  const ClipPolygon clipped = clip_triangle(triangle, projection.near);
  if (clipped.corners < 3) return result;
  for (int i = 0; i < clipped.corners; ++i) {
    const ClipVertex& v = clipped.corner[i];
    const double inverse_w = 1 / v.z;
    const double x = v.x * inverse_w, y = v.y * inverse_w;
    const bool finite = x - x == 0 && y - y == 0 && inverse_w - inverse_w == 0;
    if (!finite) return SnappedPolygon{};
    add_corner(snapped(fine_place<int32_t>(x)), snapped(fine_place<int32_t>(y)), narrow(inverse_w), result);
  }
  return result;
}

void project_corners(const SetupInput& in, uint32_t number, Vec3d corner[3]) {
  for (size_t k = 0; k < 3; ++k)
    corner[k] = project(in.projection, to_double(in.positions[in.corners[size_t{3} * number + k]]));
}

// Polygon to triangles around its first corner. All have the plane of the whole.
void emit(const SetupInput& in, const BinGrid& grid, uint32_t number, const SnappedPolygon& polygon,
          SetupChunk& out) {
  if (!(polygon.greatest >= in.projection.least_inverse_depth)) return;
  SetupTriangle t;
  bool has_plane = false;
  for (int i = 1; i + 1 < polygon.corners; ++i) {
    const int order[3] = {0, i, i + 1};
    for (int k = 0; k < 3; ++k) t.x[k] = polygon.x[order[k]], t.y[k] = polygon.y[order[k]];
    const PixelBox box = intersection(centers_within(t.x, t.y), in.projection.window);
    if (is_empty(box)) continue;
    const int64_t area = doubled_area<int64_t>(t.x, t.y);
    if (area == 0) continue;
    if (area < 0) {
      const int32_t x = t.x[1], y = t.y[1];
      t.x[1] = t.x[2], t.y[1] = t.y[2];
      t.x[2] = x, t.y[2] = y;
    }
    // Of the triangles smaller than a pixel many fall between the centres.
    const bool one_pixel = box.x1 - box.x0 == 1 && box.y1 - box.y0 == 1;
    if (one_pixel && !covers(t.x, t.y, box.x0, box.y0)) continue;
    if (!has_plane) {
      Vec3d corner[3];
      project_corners(in, number, corner);
      const InverseDepth<double> plane =
          inverse_depth_plane(corner[0], corner[1], corner[2], widen(polygon.least));
      t.triangle = in.first_number + number;
      t.object = in.object;
      t.least = polygon.least;
      t.greatest = polygon.greatest;
      t.across = plane.across, t.down = plane.down, t.at_0 = plane.at_0;
      has_plane = true;
    }
    add_to_bins(grid, box, static_cast<uint32_t>(out.triangles.size()), out.entries);
    out.triangles.push_back(t);
  }
}

}  // namespace

Projection make_projection(const Pinhole& camera, int width, int height, const Rectangle& crop) {
  Projection p;
  p.origin = to_double(camera.origin);

  // The dual basis undoes what rounding left of `orthonormal`: direction = F + a R + b U has
  // a = R' . direction and so on.
  const Vec3d right = to_double(camera.right), up = to_double(camera.up), forward = to_double(camera.forward);
  const double inverse_det = 1 / dot(right, cross(up, forward));
  const Vec3d dual_right = cross(up, forward) * inverse_det;
  const Vec3d dual_up = cross(forward, right) * inverse_det;
  p.row_w = cross(right, up) * inverse_det;

  // a = pixel_x step - center_x and b = center_y - pixel_y step, solved for the pixel.
  const double pixels = 1 / widen(camera.step);
  p.row_x = (dual_right + p.row_w * widen(camera.center_x)) * pixels;
  p.row_y = (p.row_w * widen(camera.center_y) - dual_up) * pixels;

  constexpr double least_near = 1e-30;  // keeps 1 / near a float
  p.near = widen(camera.near) > least_near ? widen(camera.near) : least_near;
  p.least_inverse_depth = 1.0f / camera.far;
  p.window = {0, 0, width, height};
  if (crop.width > 0 && crop.height > 0) {
    p.window = intersection(p.window, {crop.x, crop.y, crop.x + crop.width, crop.y + crop.height});
  }
  return p;
}

namespace {

// A triangle that the kernel left to us.
void setup_other(const SetupInput& in, const BinGrid& grid, uint32_t number, SetupChunk& out) {
  const uint32_t* c = in.corners + size_t{3} * number;
  const ScreenVertex &v0 = in.vertices[c[0]], &v1 = in.vertices[c[1]], &v2 = in.vertices[c[2]];
  SnappedPolygon polygon{};
  if ((v0.outside | v1.outside | v2.outside) == 0) {
    for (const ScreenVertex* v : {&v0, &v1, &v2})
      add_corner(snapped(v->x), snapped(v->y), v->inverse_depth, polygon);
  } else {
    ClipVertex corner[3];
    project_corners(in, number, corner);
    polygon = clip_and_snap(in.projection, corner);
  }
  emit(in, grid, number, polygon, out);
}

void take_triangles(const SetupInput& in, const BinGrid& grid, const SetupOutput& output, SetupChunk& out) {
  const uint32_t first = static_cast<uint32_t>(out.triangles.size());
  out.triangles.insert(out.triangles.end(), output.triangles, output.triangles + output.triangle_count);
  for (uint32_t place = first; place < first + output.triangle_count; ++place) {
    SetupTriangle& t = out.triangles[place];
    t.triangle += in.first_number;
    t.object = in.object;
    add_to_bins(grid, intersection(centers_within(t.x, t.y), in.projection.window), place, out.entries);
  }
}

// Sorts the fragments by tile (counting sort over the tiles that the range's fragments lie in).
void take_fragments(const SetupInput& in, const BinGrid& grid, const SetupOutput& output, SetupChunk& out) {
  const uint32_t n = output.fragment_count;
  if (n == 0) return;
  uint32_t first = static_cast<uint32_t>(out.fragments.size());
  out.fragments.resize(first + n);
  constexpr int32_t shift = std::countr_zero(static_cast<uint32_t>(kTileSide));
  const auto column = [&](uint32_t i) { return (output.x_y[i] & 0xffff) >> shift; };
  const auto row = [&](uint32_t i) { return output.x_y[i] >> (16 + shift); };
  PixelBox tiles{column(0), row(0), column(0), row(0)};
  for (uint32_t i = 1; i < n; ++i) {
    tiles.x0 = least(tiles.x0, column(i)), tiles.x1 = greatest(tiles.x1, column(i));
    tiles.y0 = least(tiles.y0, row(i)), tiles.y1 = greatest(tiles.y1, row(i));
  }
  const int32_t across = tiles.x1 - tiles.x0 + 1;
  const auto tile = [&](uint32_t i) {
    return static_cast<size_t>((row(i) - tiles.y0) * across + column(i) - tiles.x0);
  };

  std::vector<uint32_t> next(static_cast<size_t>(across * (tiles.y1 - tiles.y0 + 1)), 0);
  for (uint32_t i = 0; i < n; ++i) ++next[tile(i)];
  for (size_t t = 0; t < next.size(); ++t) {
    const uint32_t count = next[t];
    next[t] = first;
    if (count == 0) continue;
    const int x = tiles.x0 + static_cast<int>(t) % across, y = tiles.y0 + static_cast<int>(t) / across;
    out.runs.push_back({static_cast<uint32_t>(y * grid.across[0] + x), first, count});
    first += count;
  }
  for (uint32_t i = 0; i < n; ++i)
    out.fragments[next[tile(i)]++] = {output.x_y[i], output.inverse_depth[i],
                                      in.first_number + output.triangle[i]};
}

}  // namespace

void setup_range(SetupKernel kernel, const SetupInput& in, const BinGrid& grid, uint32_t begin, uint32_t end,
                 SetupOutput& output, SetupChunk& out) {
  kernel(in, begin, end, output);
  take_triangles(in, grid, output, out);
  take_fragments(in, grid, output, out);
  for (uint32_t i = 0; i < output.other_count; ++i) setup_other(in, grid, output.others[i], out);
}

void clear(SetupChunk& chunk) {
  chunk.triangles.clear();
  chunk.entries.clear();
  chunk.fragments.clear();
  chunk.runs.clear();
}

void setup_chunk(SetupKernel kernel, const SetupInput& in, const BinGrid& grid, size_t triangles,
                 size_t chunk, SetupChunk& out) {
  const auto output = std::make_unique_for_overwrite<SetupOutput>();
  const size_t begin = chunk * kChunkTriangles, end = std::min(begin + kChunkTriangles, triangles);
  clear(out);
  setup_range(kernel, in, grid, static_cast<uint32_t>(begin), static_cast<uint32_t>(end), *output, out);
}

}  // namespace vitral
