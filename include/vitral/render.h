// One frame: settings in, pixels and figures out.
#pragma once
#include "vitral/counts.h"
#include "vitral/image.h"
#include "vitral/scene.h"

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace vitral {

enum class Fresnel { exact, schlick, report };
enum class Compositing { physical, report };
enum class Primary { raster, trace };
// How the samples of a pixel become its colour: by their distance from its centre, over 1, 2 and 4 pixels
// (Mitchell and Netravali, "Reconstruction Filters in Computer Graphics", SIGGRAPH 1988, B = C = 1/3).
enum class Filter { box, tent, mitchell };
// Where shadow rays start on a smooth mesh: on the triangle, or on the smooth surface that the corners'
// normals suggest (Hanika, "Hacking the Shadow Terminator", Ray Tracing Gems II, chapter 4, 2021).
enum class Terminator { facet, smooth };
enum class Isa { automatic, scalar, v2, avx2, avx512 };

struct Effects {
  bool shadows = true;
  bool reflection = true;
  bool refraction = true;
  bool ambient_occlusion = true;
};

// Pixels [x, x+width) x [y, y+height) of the frame.
struct Rectangle {
  int x = 0, y = 0, width = 0, height = 0;
};

inline constexpr int kMaxImageSide = 16384;
inline constexpr int kMostPixelSamples = 65536;
inline constexpr int kMostLightSamples = 1024;

struct Settings {
  int width = 1024, height = 1024;  // 1..kMaxImageSide
  Rectangle crop;                   // empty: the whole frame
  int samples = 1;  // per pixel, 1..kMostPixelSamples; one: the middle of pixel, lens and shutter
  Filter filter = Filter::box;
  Effects effects;
  int light_samples = 0;          // of lights with a size, 1..kMostLightSamples; 0: each light's own figure
  int ao_samples = 16;            // a square number, 1..1024
  float ao_distance = 0.5f;       // > 0
  float ao_exponent = 1;          // > 0
  int max_depth = 5;              // generations of secondary rays, 0..100
  float min_importance = 0.005f;  // a path is cut when the luminance of its weight falls under this;
                                  // below 1/4096 it counts as 1/4096
  Fresnel fresnel = Fresnel::exact;
  Compositing compositing = Compositing::physical;
  Primary primary = Primary::raster;
  Terminator terminator = Terminator::facet;
  Isa isa = Isa::automatic;
  int threads = 0;  // 0: one per processor
  uint32_t seed = 1;
  bool keep_radiance = true;      // Frame::radiance is filled; 12 bytes a pixel
  bool count_traversal = false;   // the counts in Stats; the AOV `cost` fills them, too
  std::vector<std::string> aovs;  // names out of kAovNames
};

inline constexpr const char* kAovNames[] = {"position", "normal",     "geometric-normal", "depth",
                                            "albedo",   "material",   "primitive",        "shadow",
                                            "ao",       "reflection", "refraction",       "cost"};

// An auxiliary picture: 1 or 3 floats a pixel. Where nothing is seen it holds 0; `material` and
// `primitive`, which are numbers from 0 on, hold -1. `cost` is how many nodes were visited and triangles
// tested for all rays of the pixel; work that many rays share counts in equal parts for each. Unlike the
// others it depends on the instruction set and the crop, which decide what is shared.
struct Aov {
  std::string name;
  int channels = 1;
  Image<Vec3> pixels;  // one-channel pictures use x
};

struct PassStats {
  std::string name;
  double seconds = 0;  // summed over the workers
  uint64_t rays = 0;
  TraversalCounts traversal{};  // zero unless counted
  uint64_t rays_saved = 0;      // not begun, because they weigh less than settings.min_importance
};

struct Stats {
  std::string isa;
  int threads = 0;
  size_t triangles = 0;  // of the mesh and of all instances; a shape counts as one
  size_t dropped_triangles = 0;
  size_t tree_nodes = 0, tree_bytes = 0;
  double build_seconds = 0, frame_seconds = 0;  // wall clock
  std::vector<PassStats> passes;                // raster, shadows, reflection, refraction, ao, shade, resolve
  uint64_t covered_pixels = 0, not_finite_pixels = 0;
  bool counted = false;         // settings.count_traversal, or the AOV `cost`
  TraversalCounts traversal{};  // of all passes
};

struct Frame {
  Image<Vec3> radiance;  // linear; the crop only; empty unless settings.keep_radiance
  Image<Rgb8> pixels;    // sRGB
  std::vector<Aov> aovs;
  Stats stats;
};

struct Progress {
  const char* pass = "";
  double fraction = 0;  // of this pass, 0..1
  uint64_t rays = 0;    // traced so far
};

// How the caller watches and stops a render. `stop` may be set from any thread or a signal handler;
// render() then throws Interrupted within a tile's time. `on_progress` is called from one thread at
// a time.
struct Control {
  std::atomic<bool> stop{false};
  std::function<void(const Progress&)> on_progress;
};

// Throws UsageError when a setting is out of its range or the instruction set is not there.
Frame render(const Scene& scene, const Camera& camera, const Settings& settings, Control& control);

}  // namespace vitral
