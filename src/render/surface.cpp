#include "render/surface.h"

#include "render/frame.h"
#include "render/hit_triangles.h"
#include "render/texture.h"

namespace vitral {
namespace {

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
  apply_textures(frame, seen.hits, widths, out, &seen);
  for (uint64_t left = out.points.live; left != 0; left &= left - 1) {
    const int lane = __builtin_ctzll(left);
    out.triangle[lane] = hits.triangle[lane];
    out.turning[lane] = curvature(seen, lane, get(out.points.gx, out.points.gy, out.points.gz, lane),
                                  get(out.points.nx, out.points.ny, out.points.nz, lane));
    if (!(frame.offset.fixed > 0))
      out.points.offset[lane] = greatest(out.points.offset[lane], ray_offset(seen.reach[lane]));
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
  apply_textures(frame, hits, widths, out, nullptr);
}

void make_visible_surfaces(const FrameContext& frame, int x, int y, const uint32_t* triangles,
                           SurfacePacket& out) {
  HitPacket hits;
  frame.kernels.visible_surfaces(frame.accelerator.surfaces, frame.camera, x, y, triangles, frame.offset,
                                 hits, out);
  apply_textures(frame, hits, {&frame.camera, nullptr}, out, nullptr);
}

}  // namespace vitral
