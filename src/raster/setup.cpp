// Triangle setup: project, clip, snap, cull, and find edges' corners and the plane of inverse depth.
#include "raster/setup.h"

#include "raster/bin.h"
#include "raster/coverage.h"

namespace vitral {
namespace {

ClipVertex project(const Projection& p, const Vec3& position) {
  const Vec3d d = to_double(position) - p.origin;
  return {dot(p.row_x, d), dot(p.row_y, d), dot(p.row_w, d)};
}

// To the nearest 1/256 pixel, halves up. Clipped vertices may overshoot the guard band by a rounding.
int32_t snap(double pixels) {
  constexpr double limit = kGuardBand + 1;
  const double inside = pixels < -limit ? -limit : pixels > limit ? limit : pixels;
  constexpr int32_t shift = (kGuardBand + 2) * kSubpixels;  // makes it positive: the cast rounds down
  return static_cast<int32_t>(inside * kSubpixels + (shift + 0.5)) - shift;
}

// The inverse depth over the screen of the plane through three points, seen or not: with
// (a, b, c) . (X, Y, W) = 1 at the corners, 1 / W = a X / W + b Y / W + c (Olano and Greer, "Triangle
// Scan Conversion using 2D Homogeneous Coordinates", 1997).
// A triangle seen exactly from the side has no such plane: it is given its least inverse depth.
void set_plane(const ClipVertex v[3], SetupTriangle& t) {
  const Vec3d a{v[0].x, v[0].y, v[0].w}, b{v[1].x, v[1].y, v[1].w}, c{v[2].x, v[2].y, v[2].w};
  const Vec3d n = cross(b - a, c - a);
  const double det = dot(a, n);
  t.across = n.x / det;
  t.down = n.y / det;
  t.at_0 = n.z / det;
  // Within these bounds the fill's sums are finite in float; NaN fails the test, too.
  constexpr double steepest = 1e30, farthest = 1e36;
  const bool usable = t.across >= -steepest && t.across <= steepest && t.down >= -steepest &&
                      t.down <= steepest && t.at_0 >= -farthest && t.at_0 <= farthest;
  if (!usable) t.across = t.down = 0, t.at_0 = static_cast<double>(t.least);
}

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
  SnappedPolygon snapped{};
  const ClipPolygon clipped = clip_triangle(triangle, projection.near);
  if (clipped.corners < 3) return snapped;
  for (int i = 0; i < clipped.corners; ++i) {
    const ClipVertex& v = clipped.corner[i];
    const double inverse_w = 1 / v.w;
    const double x = v.x * inverse_w, y = v.y * inverse_w;
    const bool finite = x - x == 0 && y - y == 0 && inverse_w - inverse_w == 0;
    if (!finite) return SnappedPolygon{};
    add_corner(snap(x), snap(y), narrow(inverse_w), snapped);
  }
  return snapped;
}

// Polygon to triangles around its first corner. All have the plane of the whole.
void emit(const Projection& projection, const BinGrid& grid, const Mesh& mesh, uint32_t number,
          const SnappedPolygon& polygon, SetupChunk& out) {
  if (!(polygon.greatest >= projection.least_inverse_depth)) return;
  SetupTriangle t;
  bool has_plane = false;
  for (int i = 1; i + 1 < polygon.corners; ++i) {
    const int order[3] = {0, i, i + 1};
    for (int k = 0; k < 3; ++k) t.x[k] = polygon.x[order[k]], t.y[k] = polygon.y[order[k]];
    const PixelBox box = intersection(centers_within(t.x, t.y), projection.window);
    if (is_empty(box)) continue;
    const int64_t area = doubled_area(t.x, t.y);
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
      ClipVertex corner[3];
      const Corners& c = mesh.triangles[number];
      for (size_t k = 0; k < 3; ++k) corner[k] = project(projection, mesh.positions[c[k]]);
      t.triangle = number;
      t.least = polygon.least;
      t.greatest = polygon.greatest;
      set_plane(corner, t);
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

void project_vertices(const Projection& projection, const Vec3* positions, size_t count, ScreenVertex* out) {
  for (size_t i = 0; i < count; ++i) {
    const ClipVertex v = project(projection, positions[i]);
    const uint32_t outside = outside_planes(v, projection.near);
    if (outside != 0) {
      out[i] = {0, 0, 0, outside};
      continue;
    }
    const double inverse_w = 1 / v.w;
    out[i] = {snap(v.x * inverse_w), snap(v.y * inverse_w), narrow(inverse_w), 0};
  }
}

void setup_chunk(const Projection& projection, const BinGrid& grid, const Mesh& mesh,
                 const ScreenVertex* vertices, size_t chunk, SetupChunk& out) {
  out.triangles.clear();
  out.entries.clear();
  const size_t begin = chunk * kChunkTriangles;
  const size_t end =
      begin + kChunkTriangles < mesh.triangles.size() ? begin + kChunkTriangles : mesh.triangles.size();
  for (size_t number = begin; number < end; ++number) {
    const Corners& c = mesh.triangles[number];
    const ScreenVertex &v0 = vertices[c[0]], &v1 = vertices[c[1]], &v2 = vertices[c[2]];
    if ((v0.outside & v1.outside & v2.outside) != 0) continue;
    SnappedPolygon polygon{};
    if ((v0.outside | v1.outside | v2.outside) == 0) {
      for (const ScreenVertex* v : {&v0, &v1, &v2}) add_corner(v->x, v->y, v->inverse_depth, polygon);
    } else {
      ClipVertex corner[3];
      for (size_t k = 0; k < 3; ++k) corner[k] = project(projection, mesh.positions[c[k]]);
      polygon = clip_and_snap(projection, corner);
    }
    emit(projection, grid, mesh, static_cast<uint32_t>(number), polygon, out);
  }
}

}  // namespace vitral
