// The table of entry points that every instruction set exports, and what they take.
#pragma once
#include "kdtree/kdtree.h"
#include "kdtree/objects.h"
#include "kernels/footprint.h"
#include "kernels/layout.h"
#include "kernels/packet.h"
#include "kernels/points.h"
#include "math/pinhole.h"
#include "raster/raster.h"
#include "simd/isa.h"

#include <cstdint>

namespace vitral {

struct LightShape;  // math/light.h

struct Kernels {
  const char* isa;
  int lanes;

  // Camera rays through the 64 pixel centres of the block whose corner is (x, y); sets all but live.
  void (*primary_rays)(const Pinhole& camera, int x, int y, RayPacket& rays);

  // The same through points of the lens in the pinhole's place.
  void (*lens_rays)(const Pinhole& camera, const Lens& lens, int x, int y, RayPacket& rays);

  // The closest hit of every live ray, cut-outs respected; lanes that are not live get no triangle.
  void (*trace_closest)(const KdView& tree, const RayPacket& rays, HitPacket& hits);

  // The same for up to 16 packets that lie near each other, every four and all sixteen in a square.
  // Rays that start in one point, as the camera's do, are traced together.
  void (*closest_blocks)(const KdView& tree, const RayPacket* rays, int count, Shortcuts shortcuts,
                         HitPacket* hits);

  // The live rays that meet anything in (tmin, tmax).
  uint64_t (*trace_any)(const KdView& tree, const RayPacket& rays, GlassRule glass);

  // Where the live rays met their triangles: sets all of the points but their keys, the shading normal to
  // the geometric one, and live to the rays that met any. Returns those that saw the back of their triangle.
  uint64_t (*surface_points)(const KdTriangle* triangles, const RayPacket& rays, const HitPacket& hits,
                             const OffsetRule& offset, PointPacket& out);

  // Where the live rays met their triangles, and the surface there without its texture: sets all but the
  // points' keys.
  void (*hit_surfaces)(const SurfaceView& scene, const RayPacket& rays, const HitPacket& hits,
                       const OffsetRule& offset, SurfacePacket& out);

  // What the rays see of textures around their hits, in `lanes`; `points` are those of surface_points.
  void (*texture_footprints)(const KdTriangle* triangles, const HitPacket& hits, const PointPacket& points,
                             const RayWidths& widths, const TexturedLanes& textures, uint64_t lanes,
                             Footprints& out);

  // One ray from every live point, mirrored about the geometric normal; sets rays.live.
  void (*mirror_rays)(const PointPacket& points, RayPacket& rays);

  // One ray from every live point that faces the light to the light; sets rays.live.
  void (*shadow_rays)(const Light& light, const PointPacket& points, RayPacket& rays);

  // The same rays, for up to 16 packets of points that lie near each other, and which of them meet
  // anything; the answers are those of trace_any.
  void (*trace_shadows)(const KdView& tree, const Light& light, GlassRule glass,
                        const PointPacket* const* points, int count, ShadowAnswer* out);

  // Sample `k` of a light with a size for every live point, and the ray to it; rays.live are those whose
  // points face it and get light from there.
  void (*light_rays)(const LightShape& light, const LightDraw& draw, uint32_t k, const PointPacket& points,
                     RayPacket& rays, LightSamples& out);

  // How many of the strata * strata ambient rays of each live point meet nothing opaque.
  void (*ambient_occlusion)(const KdView& tree, const PointPacket& points, const AmbientSettings& settings,
                            uint32_t* free_rays);

  // The same for up to 16 packets of points that lie near each other.
  void (*ambient_blocks)(const KdView& tree, const PointPacket* const* points, int count,
                         const AmbientSettings& settings, FreeRays* out);

  // Vertices to the screen; positions that are not finite come out as outside of every plane. And triangles
  // [begin, end) of the mesh, no more than kChunkTriangles, ready to be filled or filled already.
  FrontEnd front_end;

  // The nearest triangle at every pixel of the tile in that column and row, which must touch the view's
  // window; and the same together with what the tile shows already, from views of the same frame.
  FillKernel fill_tile, fill_over;

  // Where the camera rays through the block whose corner is (x, y) meet those of the 64 triangles that are
  // objects', as intersect_visible finds it for the scene's own: sets the hits of these lanes alone.
  void (*intersect_placed)(const ObjectsView& view, const Pinhole& camera, int x, int y,
                           const uint32_t* numbers, HitPacket& hits);

  // The hits hold what the live rays met so far; where the shape, an object's number, is closer, they become
  // its.
  void (*closest_shape)(const ObjectsView& view, uint32_t shape, const RayPacket& rays, HitPacket& hits);

  // Where the camera rays through the block whose corner is (x, y) meet the 64 triangles that
  // fill_tile found there: t is the depth, t, u and v are the tracer's where the ray hits. Pixels
  // without a triangle get the Hit of nothing.
  void (*intersect_visible)(const Pinhole& camera, const KdTriangle* triangles, int x, int y,
                            const uint32_t* numbers, HitPacket& hits);

  // The same and the surfaces there, as hit_surfaces gives them. Pixels without a triangle are not live, and
  // their t, u and v mean nothing.
  void (*visible_surfaces)(const SurfaceView& scene, const Pinhole& camera, int x, int y,
                           const uint32_t* numbers, const OffsetRule& offset, HitPacket& hits,
                           SurfacePacket& out);

  // The same points of the tile whose corner is (x, y), written as layout.h says: its i-th block to out[i],
  // where bit i of `wanted` is set.
  void (*write_full)(const SurfaceView& scene, const Pinhole& camera, int x, int y,
                     const TileVisibility& tile, uint32_t wanted, FullBlock* out);
  void (*write_min)(const SurfaceView& scene, const Pinhole& camera, int x, int y, const TileVisibility& tile,
                    uint32_t wanted, MinBlock* out);

  // The same of a block whose surfaces are known, a hit with a number for a triangle.
  void (*pack_full)(const SurfacePacket& surfaces, const FlatColor* colors, FullBlock& out);
  void (*pack_min)(const SurfacePacket& surfaces, MinBlock& out);

  // trace_closest, closest_blocks, trace_any, trace_shadows and ambient_blocks, with the same answers, which
  // also add up what they do.
  void (*count_closest)(const KdView& tree, const RayPacket& rays, HitPacket& hits, const WorkCounts& out);
  void (*count_closest_blocks)(const KdView& tree, const RayPacket* rays, int count, Shortcuts shortcuts,
                               HitPacket* hits, const WorkCounts& work);
  uint64_t (*count_any)(const KdView& tree, const RayPacket& rays, GlassRule glass, const WorkCounts& work);
  void (*count_shadows)(const KdView& tree, const Light& light, GlassRule glass,
                        const PointPacket* const* points, int count, ShadowAnswer* out,
                        const WorkCounts& work);
  void (*count_ambient)(const KdView& tree, const PointPacket* const* points, int count,
                        const AmbientSettings& settings, FreeRays* out, const WorkCounts& work);

  // Objects. The hits hold what the rays met so far and become the closest; the live rays that meet any
  // object; how many of the ambient rays of each live point meet nothing opaque, neither in the tree nor of
  // the objects. Each also as one that counts; it leaves rays_traced as it is.
  void (*closest_objects)(const ObjectsView& view, const RayPacket& rays, HitPacket& hits);
  uint64_t (*any_objects)(const ObjectsView& view, const RayPacket& rays, GlassRule glass);
  void (*ambient_objects)(const KdView& tree, const ObjectsView& view, const PointPacket& points,
                          const AmbientSettings& settings, FreeRays& free_rays);
  void (*count_closest_objects)(const ObjectsView& view, const RayPacket& rays, HitPacket& hits,
                                const WorkCounts& out);
  uint64_t (*count_any_objects)(const ObjectsView& view, const RayPacket& rays, GlassRule glass,
                                const WorkCounts& out);
  void (*count_ambient_objects)(const KdView& tree, const ObjectsView& view, const PointPacket& points,
                                const AmbientSettings& settings, FreeRays& free_rays, const WorkCounts& out);
};

// The table of every instruction set that was built.
#define VITRAL_DECLARE_TABLE(isa) \
  namespace isa {                 \
  extern const Kernels kTable;    \
  }
VITRAL_FOR_EACH_ISA(VITRAL_DECLARE_TABLE)
#undef VITRAL_DECLARE_TABLE

}  // namespace vitral
