#include "render/surface.h"

#include "render/frame.h"
#include "render/texture.h"

namespace vitral {

void make_surfaces(const FrameContext& frame, const RayPacket& rays, const HitPacket& hits,
                   SurfacePacket& out, const float* cone_diameters) {
  frame.kernels.hit_surfaces(frame.accelerator.surfaces, rays, hits, frame.offset, out);
  apply_textures(frame, hits, {cone_diameters ? nullptr : &frame.camera, cone_diameters}, out);
}

void make_visible_surfaces(const FrameContext& frame, int x, int y, const uint32_t* triangles,
                           SurfacePacket& out) {
  HitPacket hits;
  frame.kernels.visible_surfaces(frame.accelerator.surfaces, frame.camera, x, y, triangles, frame.offset,
                                 hits, out);
  apply_textures(frame, hits, {&frame.camera, nullptr}, out);
}

}  // namespace vitral
