// What the passes of one frame share, and what each worker keeps to itself.
#pragma once
#include "kernels/kernels.h"
#include "parallel/parallel_for.h"
#include "raster/frame.h"
#include "render/accelerator.h"
#include "render/surface.h"
#include "vitral/render.h"

#include <array>
#include <chrono>
#include <cstdint>
#include <vector>

namespace vitral {

// What is counted of the tracer's work: nothing, sums over the frame, or also how much of it each pixel
// asked for.
enum class Count { nothing, totals, pixels };

// Read-only while tiles are rendered.
struct FrameContext {
  const Scene& scene;
  const Settings& settings;
  const Accelerator& accelerator;
  const Kernels& kernels;
  Pinhole camera;
  OffsetRule offset;                   // where secondary rays start
  uint32_t sample_step;                // of the ambient rays' jitter
  const RasterView* raster;            // null: primary rays are traced
  float least_importance;              // settings.min_importance, at least 1/4096: what a surface sends
                                       // on weighs no more than what came, so no pixel has more paths
  int ao_strata;                       // n of n x n samples
  std::vector<float> ao_of_free_rays;  // (k / N)^exponent for k = 0..N
  Count count = Count::nothing;
  int sample = 0;     // of settings.samples: which one this frame is rendered for
  double weight = 1;  // of the sample in the picture
  Lens lens;          // of traced camera rays
};

// Throws UsageError when the instruction set is not there. Refers to its arguments; `raster` is null.
FrameContext make_context(const Scene& scene, const Accelerator& accelerator, const Camera& camera,
                          const Settings& settings);

enum class Pass { raster, shadows, reflection, refraction, ao, shade, resolve };
inline constexpr size_t kPasses = 7;
inline constexpr std::array<const char*, kPasses> kPassNames = {
    "raster", "shadows", "reflection", "refraction", "ao", "shade", "resolve"};

struct PassTally {
  std::array<double, kPasses> seconds{};
  std::array<uint64_t, kPasses> rays{};
  std::array<uint64_t, kPasses> rays_saved{};        // not begun for want of importance
  std::array<TraversalCounts, kPasses> traversal{};  // but rays_culled
};

using Clock = std::chrono::steady_clock;
inline double seconds_between(Clock::time_point start, Clock::time_point end) {
  return std::chrono::duration<double>(end - start).count();
}

// Adds the time from its making to its end to a pass.
class PassTimer {
 public:
  PassTimer(PassTally& tally, Pass pass)
      : seconds_(tally.seconds[static_cast<size_t>(pass)]), start_(Clock::now()) {}
  ~PassTimer() { seconds_ += seconds_between(start_, Clock::now()); }
  PassTimer(const PassTimer&) = delete;
  PassTimer& operator=(const PassTimer&) = delete;

 private:
  double& seconds_;
  Clock::time_point start_;
};

inline void count_rays(PassTally& tally, Pass pass, uint64_t lanes) {
  tally.rays[static_cast<size_t>(pass)] += static_cast<uint64_t>(__builtin_popcountll(lanes));
}

inline Vec3 get(const float* x, const float* y, const float* z, int lane) {
  return {x[lane], y[lane], z[lane]};
}

enum class Side { front, back };  // of a surface

// Colours of 64 points.
struct ColorPacket {
  Vec3 color[kPacketSize];
};

// What light and its absence came to at 64 points, besides the colour.
struct LightDetail {
  float shadow[kPacketSize];  // luminance of the first light's visibility: 1 lit, 0 blocked
  float ao[kPacketSize];      // 0..1
  LaneWork work;              // of the tracer; only with Count::pixels
};

// count.cpp: what the settings ask to be counted.
Count what_to_count(const Settings& settings);

// count.cpp: the kernels that trace, counting or not. With Count::pixels what each lane asked for is added
// to `work`, one entry a packet, which is not looked at otherwise.
void run_closest(const FrameContext& frame, Pass pass, const RayPacket& rays, PassTally& tally,
                 HitPacket& hits, LaneWork* work);
void run_closest_blocks(const FrameContext& frame, Pass pass, const RayPacket* rays, int count,
                        PassTally& tally, HitPacket* hits, LaneWork* work);
uint64_t run_any(const FrameContext& frame, Pass pass, const RayPacket& rays, GlassRule glass,
                 PassTally& tally, LaneWork* work);
uint64_t run_any_glass(const FrameContext& frame, Pass pass, const RayPacket& rays, PassTally& tally,
                       LaneWork* work);  // of rays that run_any was asked for
void run_shadows(const FrameContext& frame, const Light& light, const PointPacket* const* points, int count,
                 PassTally& tally, ShadowAnswer* out, LaneWork* work);
void run_ambient(const FrameContext& frame, const PointPacket* const* points, int count,
                 const AmbientSettings& settings, PassTally& tally, FreeRays* out, LaneWork* work);

// primary.cpp: the scene's triangles on the screen, in bins, and its objects. Throws Interrupted.
struct SetupTimes {
  double transform = 0, setup = 0, bin = 0;  // seconds by the clock, on all threads
  double fill = 0;                           // only with objects: then tiles are filled here
};
RasterView setup_raster(const FrameContext& frame, const Rectangle& crop, ThreadPool& pool,
                        const Control& control, RasterFrame& raster, SetupTimes& times);

// The blocks of a tile so that every four and every sixteen of them make a square.
inline constexpr int kBlocksInOrder[kTileBlocks] = {0, 1, 4, 5, 2, 3, 6, 7, 8, 9, 12, 13, 10, 11, 14, 15};

// What the camera sees in a tile: the rasterizer's triangles; or rays and hits, the i-th block of
// kBlocksInOrder in entry i, where that bit of `has_hits` is set: all that are traced, and of rasterized
// blocks those that see objects.
struct TileHits {
  TileVisibility visibility;
  uint32_t has_hits;
  std::array<RayPacket, kTileBlocks> rays;
  std::array<HitPacket, kTileBlocks> hits;
  std::array<LaneWork, kTileBlocks> work;  // of the tracer; only with Count::pixels
};

// primary.cpp: finds it, for the pixels in `lanes`, which has an entry for each of kBlocksInOrder.
void find_primary_hits(const FrameContext& frame, int tile_x, int tile_y, const uint64_t* lanes,
                       PassTally& tally, TileHits& out);

// primary.cpp: the surfaces of the i-th block of kBlocksInOrder, whose corner is (x, y). False where nothing
// is seen: then `out` is left as it is, but for points.live, which is 0.
bool see_surfaces(const FrameContext& frame, const TileHits& tile, size_t i, int x, int y,
                  SurfacePacket& out);

// resolve.cpp: encodes linear colours, those that are the same as the one before only once; counts and
// paints red those that are not finite.
void encode_row(Vec3* colors, size_t count, Rgb8* pixels, uint64_t& not_finite);

// shadow.cpp: the points that shadow rays start from: the surfaces' own, or with Lift::smooth copies of them
// in `lifted`, moved to where the smooth surface is.
void find_shadow_starts(const FrameContext& frame, const SurfacePacket* const* surfaces, int count,
                        std::vector<PointPacket>& lifted, const PointPacket** starts);

// shadow.cpp: which of the points face a light without a size and are kept from it by something opaque, for
// up to kTileBlocks packets that lie near each other; and then how much of it arrives at each point, per
// colour channel: 1 lit (or facing away), 0 blocked, between for glass.
void find_shadows(const FrameContext& frame, const Light& light, const PointPacket* const* points, int count,
                  PassTally& tally, ShadowAnswer* out, LaneWork* work);
void light_visibility(const FrameContext& frame, const Light& light, const PointPacket& points,
                      const ShadowAnswer& answer, PassTally& tally, ColorPacket& visibility, LaneWork* work);

// shadow.cpp: the latter for rays that have been traced.
void ray_visibility(const FrameContext& frame, const RayPacket& rays, const ShadowAnswer& answer,
                    PassTally& tally, ColorPacket& visibility, LaneWork* work);

// ambient.cpp: how many of the N ambient rays of each live point are free, for up to kTileBlocks packets
// that lie near each other; and (free/N)^exponent, 1 at lanes that are not live.
void count_free_rays(const FrameContext& frame, const PointPacket* const* points, int count, PassTally& tally,
                     FreeRays* out, LaneWork* work);
void ambient_visibility(const FrameContext& frame, const PointPacket& points, const FreeRays& free_rays,
                        float* visibility);

// direct.cpp: the light that the live points of up to kTileBlocks packets send to their viewers by
// themselves; reflection and refraction come on top.
struct Lit {
  ColorPacket light;
  LightDetail detail;
};
void light_surfaces(const FrameContext& frame, const SurfacePacket* const* surfaces, int count,
                    PassTally& tally, Lit* out);

// The bundle of rays that a pixel stands for: its diameter where the ray starts, and how much that grows with
// distance. Either may be negative: the bundle runs together, or has run through a focus. After
// Akenine-Moller, Crassin, Boksansky, Belcour, Panteleev and Wright, "Improved Shader and Texture Level of
// Detail Using Ray Cones", JCGT 10(1), 2021.
struct Cone {
  float diameter = 0, spread = 0;
};
static inline float diameter_at(const Cone& c, float distance) {
  return c.diameter + c.spread * distance;
}

// A secondary ray on its way, and what its light will be multiplied with.
enum class PathKind : uint8_t { reflection, refraction };
struct Path {
  Vec3 origin, direction, weight;
  Cone cone;
  uint32_t key;     // seeds its random numbers
  uint32_t inside;  // the material, solid glass, that it runs through; kNoIndex: none is known
  uint16_t pixel;   // in the tile
  uint8_t depth;    // 1: spawned at the camera's hit
  PathKind kind;
  PathKind root;  // of the first generation
};

// glass.cpp: the camera's rays to the points of a block whose corner is (x, y) in its tile, as paths.
void begin_paths(const FrameContext& frame, const PointPacket& points, int x, int y, Path* paths);

// glass.cpp: weakens `count` paths by what the glass that they came through absorbed on the way to these
// surfaces, or to the background. Of a path that is in no glass that it knows of, like the camera's, it is
// the glass whose back it sees. Lane i belongs to paths[i].
void absorb_paths(const FrameContext& frame, const SurfacePacket& surfaces, Path* paths, int count);

// glass.cpp: the reflected and refracted rays that start at a surface. Lane i belongs to parents[i]. Counts
// those that are not worth it in the tally.
void spawn_paths(const FrameContext& frame, const SurfacePacket& surfaces, const Path* parents,
                 PassTally& tally, std::vector<Path>& out);

// glass.cpp: follows paths until none is left and adds weight * light to the pixels. Returns how many of
// them met something.
struct PathSums {
  Vec3* pixels;      // of the tile; reflection and refraction together
  Vec3* reflection;  // the part whose first ray was a reflection; may be null
  Vec3* refraction;  // may be null
  float* cost;       // nodes and tests; null unless Count::pixels
};
struct PathScratch {
  std::vector<Path> current, next, sorted;
};
uint64_t trace_paths(const FrameContext& frame, PathScratch& scratch, PassTally& tally, const PathSums& sums);

}  // namespace vitral
