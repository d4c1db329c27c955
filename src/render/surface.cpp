#include "render/surface.h"

#include "math/footprint.h"
#include "math/sampling.h"
#include "render/frame.h"
#include "render/hit_triangles.h"
#include "render/pattern.h"
#include "render/texture.h"

namespace vitral {
namespace {

// What a ray sees of the surface: its section, two sides of the pixel or two diameters of the cone, slid
// along the ray to where it lies in the surface.
PatternPlace place_in_world(const SurfacePacket& s, int lane, float t, const RayWidths& widths) {
  const Vec3 normal = get(s.points.gx, s.points.gy, s.points.gz, lane);
  const Vec3 direction = -get(s.points.vx, s.points.vy, s.points.vz, lane);
  Vec3 first, second;
  if (widths.camera) {
    const float side = t * widths.camera->footprint;
    first = widths.camera->right * side, second = widths.camera->up * -side;
  } else {
    tangent_frame(direction, first, second);
    first = first * widths.diameter[lane], second = second * widths.diameter[lane];
  }
  return {get(s.points.px, s.points.py, s.points.pz, lane), s.back >> lane & 1 ? -normal : normal,
          slide(first, direction, normal), slide(second, direction, normal)};
}

// Patterns stay with what moves: on a placed model they are in its own space; on a shape, whose own space has
// no measure, in the world as the shape was placed before it moved.
PatternPlace place_in_object(const FrameContext& frame, uint32_t number, const PatternPlace& world) {
  const ObjectsView& view = frame.accelerator.placed.view;
  const uint32_t index = object_of(view, number);
  const PreciseAffine& inverse = view.objects[index].to_object;
  Vec3d position = transform_point(inverse, to_double(world.position));
  Vec3d first = transform_vector(inverse, to_double(world.first));
  Vec3d second = transform_vector(inverse, to_double(world.second));
  // The normal goes the other way round: by the transpose of what brings back.
  Vec3d outward = transform_normal(to_double(view.objects[index].to_world), to_double(world.outward));
  const Object& object = frame.scene.objects[index];
  if (object.shape != Shape::mesh) {
    const PreciseAffine rest = to_double(object.placement);
    position = transform_point(rest, position);
    first = transform_vector(rest, first), second = transform_vector(rest, second);
    outward = transform_normal(precise_inverse(object.placement), outward);
  }
  return {to_float(position), to_float(normalize(outward)), to_float(first), to_float(second)};
}

// The colours of materials that have a pattern.
void apply_patterns(const FrameContext& frame, const HitPacket& hits, const RayWidths& widths,
                    SurfacePacket& s) {
  const TraitTable& traits = frame.accelerator.traits;
  if (!(traits.any & kPatterned)) return;
  for (uint64_t left = s.points.live; left != 0; left &= left - 1) {
    const int lane = __builtin_ctzll(left);
    if (!(traits.of[s.material[lane]] & kPatterned)) continue;
    PatternPlace place = place_in_world(s, lane, hits.t[lane], widths);
    if (is_object(frame.accelerator.placed.view, hits.triangle[lane]))
      place = place_in_object(frame, hits.triangle[lane], place);
    const Vec3 color = pattern_color(frame.scene.materials[s.material[lane]].pattern, place);
    s.r[lane] = color.x, s.g[lane] = color.y, s.b[lane] = color.z;
  }
}

bool meets_objects(const ObjectsView& view, const HitPacket& hits) {
  if (view.count == 0) return false;
  bool met = false;
  for (const uint32_t number : hits.triangle) met |= is_object(view, number);
  return met;
}

// The same steps as for a mesh, with triangles of the world that stand for what was hit.
void make_object_surfaces(const FrameContext& frame, const RayPacket& rays, const HitPacket& hits,
                          const RayWidths& widths, SurfacePacket& out) {
  HitTriangles seen;
  gather_hits(frame, rays, hits, seen);
  frame.kernels.hit_surfaces(view_of(frame, seen), rays, seen.hits, frame.offset, out);
  apply_patterns(frame, hits, widths, out);
  apply_textures(frame, seen.hits, widths, out, &seen);
  for (uint64_t left = out.points.live; left != 0; left &= left - 1) {
    const int lane = __builtin_ctzll(left);
    out.triangle[lane] = hits.triangle[lane];
    out.turning[lane] = curvature(seen, lane, get(out.points.gx, out.points.gy, out.points.gz, lane),
                                  get(out.points.nx, out.points.ny, out.points.nz, lane));
  }
}

}  // namespace

void make_surfaces(const FrameContext& frame, const RayPacket& rays, const HitPacket& hits,
                   SurfacePacket& out, const float* cone_diameters) {
  const RayWidths widths{cone_diameters ? nullptr : &frame.camera, cone_diameters};
  if (meets_objects(frame.accelerator.placed.view, hits)) {
    make_object_surfaces(frame, rays, hits, widths, out);
    return;
  }
  frame.kernels.hit_surfaces(frame.accelerator.surfaces, rays, hits, frame.offset, out);
  apply_patterns(frame, hits, widths, out);
  apply_textures(frame, hits, widths, out, nullptr);
}

void make_visible_surfaces(const FrameContext& frame, int x, int y, const uint32_t* triangles,
                           SurfacePacket& out) {
  HitPacket hits;
  frame.kernels.visible_surfaces(frame.accelerator.surfaces, frame.camera, x, y, triangles, frame.offset,
                                 hits, out);
  apply_patterns(frame, hits, {&frame.camera, nullptr}, out);
  apply_textures(frame, hits, {&frame.camera, nullptr}, out, nullptr);
}

}  // namespace vitral
