// The table of this instruction set.
#include "kernels/tables.h"
#include "simd/simd.h"

#define VITRAL_TEXT(x) #x
#define VITRAL_NAME(x) VITRAL_TEXT(x)

namespace vitral {
namespace VITRAL_ISA {

const Kernels kTable = {
    VITRAL_NAME(VITRAL_ISA),
    kLanes,
    primary_rays,
    lens_rays,
    trace_closest,
    closest_blocks,
    trace_any,
    surface_points,
    hit_surfaces,
    texture_footprints,
    mirror_rays,
    shadow_rays,
    trace_shadows,
    light_rays,
    ambient_occlusion,
    ambient_blocks,
    {project_vertices, setup_triangles},
    fill_tile,
    fill_over,
    intersect_placed,
    closest_shape,
    intersect_visible,
    visible_surfaces,
    write_full,
    write_min,
    pack_full,
    pack_min,
    count_closest,
    count_closest_blocks,
    count_any,
    count_shadows,
    count_ambient,
    closest_objects,
    any_objects,
    ambient_objects,
    count_closest_objects,
    count_any_objects,
    count_ambient_objects,
};

}  // namespace VITRAL_ISA
}  // namespace vitral
