#include "render/surface.h"

#include "render/frame.h"
#include "render/texture.h"

namespace vitral {
namespace {

// What the kernels do not know: the textures of the materials that have one.
void add_textures(const FrameContext& frame, const HitPacket& hits, SurfacePacket& out) {
  const Scene& scene = frame.scene;
  if (scene.textures.empty()) return;
  for (uint64_t left = out.points.live; left != 0; left &= left - 1) {
    const int lane = __builtin_ctzll(left);
    const Material& m = scene.materials[out.material[lane]];
    if (m.diffuse_map == kNoTexture) continue;
    const Vec2 texcoord = texcoord_at(scene.mesh, out.triangle[lane], hits.u[lane], hits.v[lane]);
    const Vec3 albedo =
        m.diffuse * sample_color(scene.textures[static_cast<size_t>(m.diffuse_map)], texcoord);
    out.r[lane] = albedo.x, out.g[lane] = albedo.y, out.b[lane] = albedo.z;
  }
}

}  // namespace

void make_surfaces(const FrameContext& frame, const RayPacket& rays, const HitPacket& hits,
                   SurfacePacket& out) {
  frame.kernels.hit_surfaces(frame.accelerator.surfaces, rays, hits, frame.offset, out);
  add_textures(frame, hits, out);
}

void make_visible_surfaces(const FrameContext& frame, int x, int y, const uint32_t* triangles,
                           SurfacePacket& out) {
  HitPacket hits;
  frame.kernels.visible_surfaces(frame.accelerator.surfaces, frame.camera, x, y, triangles, frame.offset,
                                 hits, out);
  add_textures(frame, hits, out);
}

}  // namespace vitral
