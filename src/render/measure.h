// The passes of a frame, each run over the whole picture and timed alone; and whole frames.
#pragma once
#include "vitral/render.h"

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace vitral {

// The rays of the frame as it is rendered; or those that another ray tracer can be asked for, too:
// every surface opaque, geometric normals, all secondary rays starting 10^-4 of the scene's diagonal
// off the surface, ambient sample s of pixel (x, y) jittered by hash32((y * width + x) * samples + s),
// and one mirrored ray from every visible point with, if shadows are on, one shadow ray from where it
// arrives.
enum class RayRules { scene, anchor };

// What the anchor's rules make of a scene and a camera: all materials opaque, corners without normals,
// directional lights only, the sun among them, everything in view.
void simplify(Scene& scene, Camera& camera);

// Makes cut-outs whole: other rasterizers' G-buffers know no holes.
void fill_cut_outs(Scene& scene);

// Makes every surface a perfect mirror.
void make_mirrors(Scene& scene);

// How often something is run by the clock. Before that it runs to warm up, once or for 30 ms.
// No further run is begun after `enough_seconds`; a warm-up that took as long is counted as a run.
struct Runs {
  int repeat = 5;  // >= 1
  double enough_seconds = std::numeric_limits<double>::infinity();
  std::function<void(const Progress&)> on_progress;  // before every run, off the clock
};

// What the rasterizer writes for each pixel of the picture (kernels/layout.h).
//   full  position, shading normal, albedo, material, triangle and depth: 40 bytes a pixel
//   min   octahedral shading normal, material and depth: 10 bytes a pixel
// The albedo is that of the material, Kd: textures are not looked up.
enum class Layout { full, min };

// Where the time of a raster pass goes, in milliseconds. The first three stages run one after the other, on
// all threads, and are timed by the wall clock. Then each thread takes tile after tile, fills it and writes
// its pixels: the threads' time in either, divided by the number of threads. What is missing in the sum is
// the start of the threads and the wait for the last one.
struct RasterTimes {
  double transform = 0, setup = 0, bin = 0, fill = 0, attributes = 0;
};

struct PassTimes {
  std::string name;
  std::vector<double> ms;            // wall clock, one for every run
  uint64_t rays = 0;                 // of one run
  uint64_t bytes = 0;                // of the trees, for `build`
  std::vector<RasterTimes> parts{};  // of each run, for `raster`
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

// Times every pass alone:
//   build         the trees; without anything to be traced only the triangles side by side
//   raster        what each pixel sees, written in the layout; or, named `primary`, traced, as position and
//                 geometric normal
//   shadows, ao   the rays of every visible surface
//   reflection,   the paths of that kind from every visible surface, lit with shadows but without ambient
//   refraction    occlusion; by the anchor's rules the mirrored rays, and no refraction
//   resolve       the encoding of a picture that has no effects
//   frame         everything after the build, tile by tile. By the scene's rules that is render_frame. By
//                 the anchor's rules it is the passes named above with exactly their rays, so that it can
//                 be held against their sum in another tracer, which does not shade and encode either.
// control.on_progress is called from within frames: leave it empty. Throws as render() does.
Measurement measure_passes(const Scene& scene, const Camera& camera, const Settings& settings, RayRules rules,
                           Layout layout, const Runs& runs, Control& control);

// Bytes that measure_passes uses at most, besides scene, trees and frame.
size_t measurement_bytes(const Settings& settings, Layout layout);

// A frame to be timed, and its name for runs.on_progress.
struct FrameJob {
  std::string name;
  Camera camera;
  Settings settings;
};

struct FrameTimes {
  std::vector<double> ms;   // wall clock, one for every run
  double tracer_share = 0;  // of all runs' time on all threads: what went into passes that trace rays, 0..1
  uint64_t rays = 0;        // of one run
};

// Whole frames over trees that are built once; in the order of the jobs. The jobs' threads must agree.
// control as above. Throws as render() does.
struct FramesMeasured {
  std::string isa;
  int threads = 0;
  std::vector<FrameTimes> frames;
};
FramesMeasured measure_frames(const Scene& scene, const std::vector<FrameJob>& jobs, const Runs& runs,
                              Control& control);

}  // namespace vitral
