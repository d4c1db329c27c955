// The table of entry points that every instruction set exports, and what they take.
#pragma once
#include "kdtree/kdtree.h"
#include "kernels/packet.h"
#include "math/pinhole.h"
#include "raster/raster.h"

#include <cstdint>

namespace vitral {

struct Kernels {
  const char* isa;
  int lanes;

  // Camera rays through the 64 pixel centres of the block whose corner is (x, y); sets all but live.
  void (*primary_rays)(const Pinhole& camera, int x, int y, RayPacket& rays);

  // The closest hit of every live ray, cut-outs respected; lanes that are not live get no triangle.
  void (*trace_closest)(const KdView& tree, const RayPacket& rays, HitPacket& hits);

  // The live rays that meet anything in (tmin, tmax).
  uint64_t (*trace_any)(const KdView& tree, const RayPacket& rays, GlassRule glass);
};

}  // namespace vitral
