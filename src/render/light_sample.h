// Lights with a size: many samples of each, and soft shadows.
#pragma once
#include "render/frame.h"

namespace vitral {

// How often a light with a size is sampled at a point: the settings' figure, or its own.
int samples_of(const FrameContext& frame, const Light& light);

// What one light with a size sends to the live points of a packet.
struct SampledLight {
  ColorPacket light;           // what the surfaces send on of it
  ColorPacket visibility;      // mean over the rays to it: 1 lit (or facing away), 0 in the umbra
  float blocked[kPacketSize];  // the share of those rays that nothing of it comes through
};

// Traces a shadow ray from `starts` (find_shadow_starts) to every sample that a point faces. What arrives is
// summed up with its visibility; or, for the report's compositing, without.
void sample_light(const FrameContext& frame, const Light& light, const SurfacePacket& surfaces,
                  const PointPacket& starts, PassTally& tally, SampledLight& out, LaneWork* work);

// Only traces them. Returns the points that face the light and get nothing from it.
uint64_t trace_samples(const FrameContext& frame, const Light& light, const PointPacket& points,
                       PassTally& tally, LaneWork* work);

}  // namespace vitral
