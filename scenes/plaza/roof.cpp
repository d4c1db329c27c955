// Tiled roofs with dormers and chimneys.
#include <algorithm>
#include <cmath>

#include "parts.h"
#include "random.h"

namespace plaza {
namespace {

constexpr double kOverhang = 0.35;

// Rows of round tiles: a wave across the slope. From the eaves (y = 0, z = out) to (y = rise, z = -run).
void slope(Mesh& mesh, const Frame& f, double x0, double x1, double out, double run, double rise,
           Finish finish) {
  const double length = std::sqrt((run + out) * (run + out) + rise * rise);
  const double tile = tile_size(Surface::roof) / 16;
  const int channels = std::max(1, static_cast<int>(std::lround((x1 - x0) / tile)));
  const int each = finish == Finish::plain || mesh.detail.level < 0.5 ? 1 : divisions(mesh.detail, 4, 4);
  const int courses = mesh.detail.level > 3 ? static_cast<int>(length / 0.5) * 3 : 1;
  const double nx = 0, ny = (run + out) / length, nz = rise / length;
  surface_grid(
      mesh, Surface::roof, each == 1 ? 1 : channels * each, courses,
      [&](double u, double v) {
        const double wave = each == 1 ? 0 : 0.045 * std::cos(u * channels * 2 * kPi);
        // With many rows each course overlaps the next by a small step.
        const double course = v * length / 0.5,
                     step = courses == 1 ? 0 : 0.025 * (std::ceil(course) - course);
        const double h = wave + step;
        return point(f, {x0 + (x1 - x0) * u + nx * h, rise * v + ny * h, out - (run + out) * v + nz * h});
      },
      Ends::open, {channels / 16.0, length / tile_size(Surface::roof)});
}

void chimney(Mesh& mesh, const Frame& f, Surface wall, double height) {
  box(mesh, wall, f, {-0.45, -1.6, -0.35}, {0.45, height, 0.35}, kOnGround);
  box(mesh, Surface::stone, f, {-0.55, height, -0.45}, {0.55, height + 0.14, 0.45});
  if (is_bare(mesh.detail)) return;
  for (const double x : {-0.2, 0.2}) {
    lathe(mesh, Surface::far_roof, moved(f, {x, height + 0.14, 0}),
          {{0.13, 0}, {0.11, 0.35}, {0.16, 0.38}, {0.16, 0.45}, {0, 0.5}}, divisions(mesh.detail, 8, 5));
  }
}

// A window in a small gabled house that stands in the slope. The origin is where its front meets the
// tiles.
void dormer(Mesh& mesh, const Frame& f, const Roof& roof, double pitch, uint32_t id) {
  const double half = 0.8, height = 1.75, gable = 0.5, deep = (height + gable) / pitch + 0.3;
  const Hole hole{-0.5, 0.5, 0.25, 1.6};
  const std::array<double, 4> xs{-half, hole.x0, hole.x1, half}, ys{-0.2, hole.y0, hole.y1, height};
  for (size_t r = 0; r < 3; ++r) {
    for (size_t c = 0; c < 3; ++c) {
      if (r == 1 && c == 1) continue;
      box(mesh, roof.wall, f, {xs[c], ys[r], -0.1}, {xs[c + 1], ys[r + 1], 0}, kFront);
    }
  }
  triangle(mesh, roof.wall, point(f, {-half, height, 0}), point(f, {half, height, 0}),
           point(f, {0, height + gable, 0}));
  box(mesh, roof.wall, f, {-half, -0.2, -deep}, {half, height, 0}, kLeft | kRight);
  fill_hole(mesh, f, hole, {Filling::casement, Surface::paint_white, roof.finish, id});
  if (roof.finish == Finish::fine) surround(mesh, f, hole, Surround::plain);
  const double eave = half + 0.2, drop = gable * 0.2 / half;
  for (const double side : {-1.0, 1.0}) {
    const auto at = [&](double x, double y, double z) { return point(f, {x * side, y, z}); };
    const double y = height - drop, top = height + gable, front = 0.25, thick = 0.07;
    if (side > 0) {
      quad(mesh, Surface::roof, at(eave, y + thick, front), at(eave, y + thick, -deep),
           at(0, top + thick, -deep), at(0, top + thick, front));
      quad(mesh, Surface::stone, at(0, top, front), at(eave, y, front), at(eave, y + thick, front),
           at(0, top + thick, front));
      quad(mesh, Surface::stone, at(eave, y, front), at(eave, y, -deep), at(eave, y + thick, -deep),
           at(eave, y + thick, front));
      quad(mesh, Surface::stone, at(0, top, front), at(0, top, -deep), at(eave, y, -deep),
           at(eave, y, front));
    } else {
      quad(mesh, Surface::roof, at(eave, y + thick, -deep), at(eave, y + thick, front),
           at(0, top + thick, front), at(0, top + thick, -deep));
      quad(mesh, Surface::stone, at(eave, y, front), at(0, top, front), at(0, top + thick, front),
           at(eave, y + thick, front));
      quad(mesh, Surface::stone, at(eave, y, -deep), at(eave, y, front), at(eave, y + thick, front),
           at(eave, y + thick, -deep));
      quad(mesh, Surface::stone, at(0, top, -deep), at(0, top, front), at(eave, y, front),
           at(eave, y, -deep));
    }
  }
}

}  // namespace

void tiled_roof(Mesh& mesh, const Frame& f, const Roof& roof) {
  const double run = roof.depth / 2, pitch = 0.62, rise = run * pitch;
  const double eave_drop = kOverhang * pitch;
  // Front: from the overhang to the ridge.
  slope(mesh, moved(f, {0, -eave_drop + 0.22, 0}), -0.1, roof.width + 0.1, kOverhang, run, rise + eave_drop,
        roof.finish);
  const Frame back{point(f, {roof.width, -eave_drop + 0.22, -roof.depth}), f.x * -1, f.y, f.z * -1};
  slope(mesh, back, -0.1, roof.width + 0.1, kOverhang, run, rise + eave_drop, Finish::plain);
  // The underside of the overhang and the gables.
  const double under = 0.22 - eave_drop - 0.05;
  quad(mesh, Surface::stone, point(f, {-0.1, 0.16, 0}), point(f, {roof.width + 0.1, 0.16, 0}),
       point(f, {roof.width + 0.1, under, kOverhang}), point(f, {-0.1, under, kOverhang}));
  for (const double x : {0.0, roof.width}) {
    const Vec3d front = point(f, {x, -0.2, 0}), rear = point(f, {x, -0.2, -roof.depth});
    const Vec3d front_top = point(f, {x, 0.1, 0}), rear_top = point(f, {x, 0.1, -roof.depth});
    const Vec3d ridge = point(f, {x, rise + 0.15, -run});
    if (x > 0) {
      quad(mesh, roof.wall, front, rear, rear_top, front_top);
      triangle(mesh, roof.wall, front_top, rear_top, ridge);
    } else {
      quad(mesh, roof.wall, rear, front, front_top, rear_top);
      triangle(mesh, roof.wall, rear_top, front_top, ridge);
    }
  }
  // Ridge tiles.
  bar(mesh, Surface::roof, f, {-0.15, rise + 0.2, -run}, {roof.width + 0.15, rise + 0.2, -run}, 0.14, 8);

  if (is_bare(mesh.detail) && roof.finish == Finish::plain) return;
  const int bays = static_cast<int>(std::lround(roof.width / roof.bay));
  for (int i = 0; i < bays; ++i) {
    if (i % 2 == 1 && i + 1 < bays + bays % 2) {
      const double z = -0.9;
      dormer(mesh, moved(f, {(i + 0.5) * roof.bay, 0.22 - z * pitch, z}), roof, pitch,
             hash(roof.seed, 400u + static_cast<uint32_t>(i)));
    }
  }
  for (int i = 0; i < 1 + bays / 4; ++i) {
    const double x = roof.width * (i + 0.3 + 0.4 * unit(hash(roof.seed, 500u + static_cast<uint32_t>(i)))) /
                     (1 + bays / 4);
    chimney(mesh, moved(f, {x, rise, -run - 0.9}), roof.wall, 1.4);
  }
}

}  // namespace plaza
