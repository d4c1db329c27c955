// Texture lookup: repeated, decoded to linear.
#pragma once
#include "kernels/footprint.h"
#include "kernels/points.h"
#include "render/hit_triangles.h"
#include "render/mip_map.h"
#include "render/surface.h"
#include "vitral/scene.h"

namespace vitral {

// What a ray sees around the texture coordinates `center`: the mean of a row of `count` equal probes
// (math/footprint.h), each bilinear in the two mip levels whose texels are next to its width, mixed linearly
// by width. Where width and count are 1 the texture is magnified, and this is the bilinear lookup in its
// finest level.
//
// After McCormack, Perry, Farkas and Jouppi, "Feline: Fast Elliptical Lines for Anisotropic Texture
// Mapping", SIGGRAPH 1999; but all probes weigh the same, as the pixel is a box.
Vec3 sample_color(const MipMap& map, const Vec2& center, const Vec2& step, float width, float count);

// 0..1, bilinear in the texture itself, whoever asks: what is cut out is one shape for rasterizer, camera,
// shadows and ambient occlusion, at any distance.
float sample_alpha(const Texture& texture, Vec2 uv);

// Multiplies the albedo of the live lanes whose materials have a texture by what the rays see of it. Does
// nothing where no mip maps were made. The hits and surfaces are on these triangles, or on the scene's mesh.
void apply_textures(const FrameContext& frame, const HitPacket& hits, const RayWidths& widths,
                    SurfacePacket& surfaces, const HitTriangles* triangles);

}  // namespace vitral
