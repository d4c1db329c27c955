// What the secondary passes need to know of 64 surface points.
#pragma once
#include "kdtree/kdtree.h"
#include "kernels/packet.h"
#include "math/random.h"
#include "vitral/counts.h"

namespace vitral {

struct alignas(64) PointPacket {
  float px[kPacketSize], py[kPacketSize], pz[kPacketSize];  // position
  float gx[kPacketSize], gy[kPacketSize], gz[kPacketSize];  // geometric normal, unit, turned to the viewer
  float nx[kPacketSize], ny[kPacketSize], nz[kPacketSize];  // shading normal, unit, turned to the viewer
  float vx[kPacketSize], vy[kPacketSize], vz[kPacketSize];  // to the viewer, unit
  float offset[kPacketSize];                                // secondary rays start this far off
  uint32_t key[kPacketSize];                                // seeds the point's random numbers
  uint64_t live;
};

// What light needs to know of 64 surface points. The lanes that are not live mean nothing.
struct alignas(64) SurfacePacket {
  PointPacket points;
  float r[kPacketSize], g[kPacketSize], b[kPacketSize];  // albedo: Kd times map_Kd
  float t[kPacketSize];                                  // of the ray that came here
  uint32_t material[kPacketSize];
  uint32_t triangle[kPacketSize];
  float turning[kPacketSize];  // of points on objects: 1/radius, see curvature() in render/hit_triangles.h
  uint64_t back = 0;           // lanes that see the back of their triangle
  float lx[kPacketSize], ly[kPacketSize], lz[kPacketSize];  // lifted_position(); only with Lift::smooth
};

// A material's colour without its texture.
struct FlatColor {
  Vec3 diffuse;    // Kd
  uint32_t rgba8;  // Kd in 255ths, linear, red in the lowest byte; alpha 255
};

// The scene's triangles as surfaces, by triangle number: pointers only.
struct SurfaceView {
  const KdTriangle* triangles;
  const uint32_t* normal_indices;  // three a triangle, kNoIndex: flat corner; null: the mesh has no normals
  const Vec3* normals;
  const uint32_t* materials;  // of each triangle
  const FlatColor* colors;    // of each material
  // Of each triangle, how much its points' offset is greater than its corners say: dot(|n|,
  // placement_error()) where it stands for one in another space; null: nowhere.
  const float* more_offset = nullptr;
};

// Where shadow rays start: at the points, or lifted to the smooth surface that the corners' normals suggest.
enum class Lift { none, smooth };

// How far off the surface secondary rays start: as far as rounding asks for, or a fixed distance.
struct OffsetRule {
  float fixed;  // 0: ray_offset() of the point's own triangle
  Lift lift = Lift::none;
};

// Whether work is skipped that cannot change the answer. Tests compare the two.
enum class Shortcuts { taken, none };

// Of 64 points: those that face a light, and those of them that something keeps from it.
struct ShadowAnswer {
  uint64_t facing, blocked;
};

// Which samples of a light with a size are asked for: those of sample `frame` of `frames` of the picture's,
// `samples` of them, by random numbers of their own for every `branch`.
struct LightDraw {
  uint32_t frame, frames, samples, branch;
};

// One sample of a light for each of 64 points.
struct alignas(64) LightSamples {
  float x[kPacketSize], y[kPacketSize], z[kPacketSize];  // to the light, unit
  float strength[kPacketSize];                           // irradiance at normal incidence by its colour
  float irradiance[kPacketSize];                         // the same by the cosine at the point
};

// Of 64 points: how many of each one's ambient rays meet nothing opaque.
struct alignas(64) FreeRays {
  uint32_t count[kPacketSize];
};

// Of 64 rays or points: nodes visited and triangles tested for each.
struct alignas(64) LaneWork {
  float work[kPacketSize];
};

// Where a kernel that counts adds what it did. `work` has one entry for each packet, or is null.
struct WorkCounts {
  TraversalCounts* totals;
  LaneWork* work;
};

struct AmbientSettings {
  int strata;                          // n of n x n samples
  float distance;                      // rays end here
  uint32_t sample_step = kSampleStep;  // see sample_hash()
  Shortcuts shortcuts = Shortcuts::taken;
  uint32_t first_sample = 0;  // number of the first one: another one, other rays
};

}  // namespace vitral
