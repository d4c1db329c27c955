// What 64 rays hit, as triangles of the world with all that shading asks of a mesh: whether they are the
// scene's own, a placed model's, or stand in for a shape at one point of it.
#pragma once
#include "kernels/points.h"
#include "render/accelerator.h"

namespace vitral {

struct FrameContext;

// Lane i of the hits lies on triangle i. The corners of a placed model's triangle are moved to the world;
// where the placement mirrors, two of them change places, so that a front stays a front. At a point of a
// shape the triangle is tangent to it: the point is its first corner, the normals of the others say how the
// surface bends, their texture coordinates how its texture runs; its size says nothing.
struct HitTriangles {
  KdTriangle triangles[kPacketSize];
  Vec3 normals[3 * kPacketSize];
  uint32_t normal_indices[3 * kPacketSize];
  uint32_t materials[kPacketSize];
  CornerTexcoords texcoords[kPacketSize];
  float more_offset[kPacketSize];  // as SurfaceView has it
  HitPacket hits;                  // `triangle` is the lane
};

// Of the live rays that hit something.
void gather_hits(const FrameContext& frame, const RayPacket& rays, const HitPacket& hits, HitTriangles& out);
SurfaceView view_of(const FrameContext& frame, const HitTriangles& hits);

// How fast the shading normal turns along the surface, 1/radius: half the divergence of the corners' normals
// over the triangle; greater than 0 where the side that is seen, that of `shading`, bulges out.
float curvature(const Vec3* corners, const Vec3* normals, const Vec3& geometric, const Vec3& shading);
// The same at a lane, 0 where it has no normals.
float curvature(const HitTriangles& hits, int lane, const Vec3& geometric, const Vec3& shading);

}  // namespace vitral
