#include "render/surface.h"

#include "render/frame.h"
#include "render/texture.h"

namespace vitral {
namespace {

// The normal interpolated from the corners, on the side of `geometric`.
Vec3 shading_normal(const Mesh& mesh, uint32_t triangle, float u, float v, const Vec3& geometric) {
  if (mesh.triangle_normals.empty()) return geometric;
  const Corners& index = mesh.triangle_normals[triangle];
  if (index[0] == kNoIndex || index[1] == kNoIndex || index[2] == kNoIndex) return geometric;
  const Vec3 sum =
      (mesh.normals[index[0]] * ((1 - u) - v) + mesh.normals[index[1]] * u) + mesh.normals[index[2]] * v;
  const float squared = dot(sum, sum);
  if (!(squared > 1e-12f)) return geometric;
  const Vec3 n = sum * (1.0f / square_root(squared));
  return dot(n, geometric) < 0 ? -n : n;
}

}  // namespace

void make_surfaces(const FrameContext& frame, const RayPacket& rays, const HitPacket& hits,
                   SurfacePacket& out) {
  const Scene& scene = frame.scene;
  const Mesh& mesh = scene.mesh;
  PointPacket& p = out.points;
  out.back = frame.kernels.surface_points(frame.accelerator.triangles.data(), rays, hits, frame.offset, p);
  for (int lane = 0; lane < kPacketSize; ++lane) {
    if (!(p.live >> lane & 1)) continue;
    const uint32_t triangle = hits.triangle[lane];
    const float u = hits.u[lane], v = hits.v[lane];
    const Vec3 shading = shading_normal(mesh, triangle, u, v, get(p.gx, p.gy, p.gz, lane));
    p.nx[lane] = shading.x, p.ny[lane] = shading.y, p.nz[lane] = shading.z;
    out.t[lane] = hits.t[lane];
    out.triangle[lane] = triangle;
    out.material[lane] = mesh.triangle_material[triangle];

    const Material& m = scene.materials[out.material[lane]];
    Vec3 albedo = m.diffuse;
    if (m.diffuse_map != kNoTexture) {
      albedo *=
          sample_color(scene.textures[static_cast<size_t>(m.diffuse_map)], texcoord_at(mesh, triangle, u, v));
    }
    out.r[lane] = albedo.x, out.g[lane] = albedo.y, out.b[lane] = albedo.z;
  }
}

}  // namespace vitral
