// The passes of a frame, each run over the whole picture and timed alone.
#pragma once
#include "vitral/render.h"

#include <string>
#include <vector>

namespace vitral {

// The rays of the frame as it is rendered; or those that another ray tracer can be asked for, too:
// every surface opaque, geometric normals, all secondary rays starting 10^-4 of the scene's diagonal
// off the surface, ambient sample s of pixel (x, y) jittered by hash32((y * width + x) * samples + s),
// and one mirrored ray from every visible point with one shadow ray from where it arrives.
enum class RayRules { scene, anchor };

// What the anchor's rules make of a scene and a camera: all materials opaque, corners without normals,
// directional lights only, everything in view.
void simplify(Scene& scene, Camera& camera);

// Makes every surface a perfect mirror.
void make_mirrors(Scene& scene);

struct PassTimes {
  std::string name;
  std::vector<double> ms;  // wall clock, one for every run
  uint64_t rays = 0;       // of one run
  uint64_t bytes = 0;      // of the tree, for `build`
};

struct Measurement {
  std::string isa;
  int threads = 0;
  std::vector<PassTimes> passes;  // build, raster or primary, the effects that are on, resolve, frame
  // Counts by which another renderer can show that it did the same work.
  uint64_t covered_pixels = 0;
  uint64_t shadowed_pixels = 0;  // facing the first light, and blocked from it
  uint64_t reflection_hits = 0;  // reflected rays that met something
  double ao_mean = 0;            // free share of all ambient rays
};

// Runs every pass once to warm up and then `repeat` times. `reflection` and `refraction` are the paths
// of that kind from every visible surface, lit with shadows but without ambient occlusion. Throws as
// render() does.
Measurement measure_passes(const Scene& scene, const Camera& camera, const Settings& settings, RayRules rules,
                           int repeat, const Control& control);

}  // namespace vitral
