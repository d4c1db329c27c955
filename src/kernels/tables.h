// Declares the entry points inside the namespace of the instruction set being compiled.
#pragma once
#include "kernels/kernels.h"

namespace vitral {
namespace VITRAL_ISA {

void primary_rays(const Pinhole& camera, int x, int y, RayPacket& rays);
void lens_rays(const Pinhole& camera, const Lens& lens, int x, int y, RayPacket& rays);
void trace_closest(const KdView& tree, const RayPacket& rays, HitPacket& hits);
void closest_blocks(const KdView& tree, const RayPacket* rays, int count, Shortcuts shortcuts,
                    HitPacket* hits);
uint64_t trace_any(const KdView& tree, const RayPacket& rays, GlassRule glass);
uint64_t surface_points(const KdTriangle* triangles, const RayPacket& rays, const HitPacket& hits,
                        const OffsetRule& offset, PointPacket& out);
void hit_surfaces(const SurfaceView& scene, const RayPacket& rays, const HitPacket& hits,
                  const OffsetRule& offset, SurfacePacket& out);
void texture_footprints(const KdTriangle* triangles, const HitPacket& hits, const PointPacket& points,
                        const RayWidths& widths, const TexturedLanes& textures, uint64_t lanes,
                        Footprints& out);
void mirror_rays(const PointPacket& points, RayPacket& rays);
void shadow_rays(const Light& light, const PointPacket& points, RayPacket& rays);
void trace_shadows(const KdView& tree, const Light& light, GlassRule glass, const PointPacket* const* points,
                   int count, ShadowAnswer* out);
void light_rays(const LightShape& light, const LightDraw& draw, uint32_t k, const PointPacket& points,
                RayPacket& rays, LightSamples& out);
void ambient_occlusion(const KdView& tree, const PointPacket& points, const AmbientSettings& settings,
                       uint32_t* free_rays);
void ambient_blocks(const KdView& tree, const PointPacket* const* points, int count,
                    const AmbientSettings& settings, FreeRays* out);
void count_closest(const KdView& tree, const RayPacket& rays, HitPacket& hits, const WorkCounts& out);
void count_closest_blocks(const KdView& tree, const RayPacket* rays, int count, Shortcuts shortcuts,
                          HitPacket* hits, const WorkCounts& work);
uint64_t count_any(const KdView& tree, const RayPacket& rays, GlassRule glass, const WorkCounts& work);
void count_shadows(const KdView& tree, const Light& light, GlassRule glass, const PointPacket* const* points,
                   int count, ShadowAnswer* out, const WorkCounts& work);
void count_ambient(const KdView& tree, const PointPacket* const* points, int count,
                   const AmbientSettings& settings, FreeRays* out, const WorkCounts& work);
void project_vertices(const Projection& projection, const Vec3* positions, size_t count, ScreenVertex* out);
void setup_triangles(const SetupInput& in, uint32_t begin, uint32_t end, SetupOutput& out);
void fill_tile(const RasterView& view, int tile_x, int tile_y, TileVisibility& out);
void fill_over(const RasterView& view, int tile_x, int tile_y, TileVisibility& seen);
void intersect_placed(const ObjectsView& view, const Pinhole& camera, int x, int y, const uint32_t* numbers,
                      HitPacket& hits);
void closest_shape(const ObjectsView& view, uint32_t shape, const RayPacket& rays, HitPacket& hits);
void intersect_visible(const Pinhole& camera, const KdTriangle* triangles, int x, int y,
                       const uint32_t* numbers, HitPacket& hits);
void visible_surfaces(const SurfaceView& scene, const Pinhole& camera, int x, int y, const uint32_t* numbers,
                      const OffsetRule& offset, HitPacket& hits, SurfacePacket& out);
void write_full(const SurfaceView& scene, const Pinhole& camera, int x, int y, const TileVisibility& tile,
                uint32_t wanted, FullBlock* out);
void write_min(const SurfaceView& scene, const Pinhole& camera, int x, int y, const TileVisibility& tile,
               uint32_t wanted, MinBlock* out);
void pack_full(const SurfacePacket& surfaces, const FlatColor* colors, FullBlock& out);
void pack_min(const SurfacePacket& surfaces, MinBlock& out);
void closest_objects(const ObjectsView& view, const RayPacket& rays, HitPacket& hits);
uint64_t any_objects(const ObjectsView& view, const RayPacket& rays, GlassRule glass);
void ambient_objects(const KdView& tree, const ObjectsView& view, const PointPacket& points,
                     const AmbientSettings& settings, FreeRays& free_rays);
void count_closest_objects(const ObjectsView& view, const RayPacket& rays, HitPacket& hits,
                           const WorkCounts& out);
uint64_t count_any_objects(const ObjectsView& view, const RayPacket& rays, GlassRule glass,
                           const WorkCounts& out);
void count_ambient_objects(const KdView& tree, const ObjectsView& view, const PointPacket& points,
                           const AmbientSettings& settings, FreeRays& free_rays, const WorkCounts& out);

}  // namespace VITRAL_ISA
}  // namespace vitral
