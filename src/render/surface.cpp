#include "render/surface.h"

#include "render/accelerator.h"
#include "render/texture.h"

namespace vitral {
namespace {

// The normal of the triangle's plane, unit; in double, so that tiny triangles have one, too.
Vec3 geometric_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  return to_float(normalize(cross(to_double(b) - to_double(a), to_double(c) - to_double(a))));
}

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

void make_surfaces(const Scene& scene, const RayPacket& rays, const HitPacket& hits, uint64_t lanes,
                   SurfacePacket& out) {
  const Mesh& mesh = scene.mesh;
  PointPacket& p = out.points;
  p.live = 0;
  out.back = 0;
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const uint32_t triangle = hits.triangle[lane];
    if (!(lanes >> lane & 1) || triangle == kNoTriangle) {
      // Dead lanes hold harmless numbers, for the kernels compute on them all the same.
      p.px[lane] = p.py[lane] = p.pz[lane] = 0;
      p.gx[lane] = p.gy[lane] = p.nx[lane] = p.ny[lane] = 0;
      p.gz[lane] = p.nz[lane] = 1;
      p.offset[lane] = 0;
      continue;
    }
    p.live |= 1ull << lane;
    const Corners& corner = mesh.triangles[triangle];
    const Vec3 a = mesh.positions[corner[0]], b = mesh.positions[corner[1]], c = mesh.positions[corner[2]];
    const float u = hits.u[lane], v = hits.v[lane];
    const Vec3 position = (a + (b - a) * u) + (c - a) * v;
    const Vec3 viewer = -normalize(Vec3{rays.dx[lane], rays.dy[lane], rays.dz[lane]});
    Vec3 geometric = geometric_normal(a, b, c);
    if (dot(geometric, viewer) < 0) {
      geometric = -geometric;
      out.back |= 1ull << lane;
    }
    const Vec3 shading = shading_normal(mesh, triangle, u, v, geometric);
    p.px[lane] = position.x, p.py[lane] = position.y, p.pz[lane] = position.z;
    p.gx[lane] = geometric.x, p.gy[lane] = geometric.y, p.gz[lane] = geometric.z;
    p.nx[lane] = shading.x, p.ny[lane] = shading.y, p.nz[lane] = shading.z;
    p.offset[lane] =
        ray_offset(greatest(largest_component(a), greatest(largest_component(b), largest_component(c))));
    out.vx[lane] = viewer.x, out.vy[lane] = viewer.y, out.vz[lane] = viewer.z;
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
