// The samples of a pixel. One sample of all pixels is an ordinary frame: a pinhole camera, shifted by a part
// of a pixel and to a point of the lens, at one moment. So the rasterizer draws them one after the other
// (Haeberli and Akeley, "The Accumulation Buffer", SIGGRAPH 1990), whatever is traced from what it sees
// starts there, and the picture is their weighted mean, the same in every crop.
//
// Traced camera rays need no common point: there each pixel looks through points of the lens of its own
// (Cook, Porter and Carpenter, "Distributed Ray Tracing", SIGGRAPH 1984), which shows few samples as noise
// where the rasterizer shows them as overlaid pictures. The expectation is the same.
#pragma once
#include "math/pinhole.h"
#include "vitral/render.h"

#include <cstdint>
#include <vector>

namespace vitral {

struct PixelSample {
  float x = 0, y = 0;            // from the pixel's centre, in pixels, y down
  float lens_x = 0, lens_y = 0;  // on the unit disk, to the right and up
  uint32_t lens_index = 0;       // its number among the points of the lens
  float time = 0;
  double weight = 1;  // those of all samples add up to 1
};

// settings.samples of them. Places are spread as the filter weighs them, so that each sample counts alike,
// those under a negative lobe with a minus sign (Ernst, Stamminger and Greiner, "Filter Importance Sampling",
// RT 2006). Places, points of the lens and times are stratified each, and paired at random. One sample alone
// is the middle of all.
std::vector<PixelSample> pixel_samples(const Settings& settings, const Camera& camera);

// 0..count-1 in an order that the key decides, every one equally likely (Fisher and Yates).
std::vector<uint32_t> random_order(uint32_t count, uint32_t key);

float middle_of_shutter(const Camera& camera);

// The camera's position, view and up at a moment: between keys the position moves in a straight line, the
// directions turn together.
Camera camera_at(const Camera& camera, float time);

// How a sample is seen: through the pinhole at its point of the lens; or by traced rays through the lens in
// whose middle the pinhole is. The camera is the one of the sample's time.
struct SampleView {
  Pinhole pinhole;
  Lens lens;
};
SampleView sample_view(const Camera& camera, const Settings& settings, const PixelSample& sample);

}  // namespace vitral
