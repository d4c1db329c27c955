// The table of contents: one frame from beginning to end.
//
//   build      triangles side by side, kd-tree                       accelerator.cpp
//   setup      triangles on the screen, sorted into bins              raster/frame.cpp
//   per tile of 32x32 pixels, on all threads, in any order:
//     primary    what each pixel sees                                primary.cpp
//     surface    position, normals, material there                   surface.cpp
//     direct     light, shadows, ambient occlusion                   direct.cpp shadow.cpp ambient.cpp
//     glass      reflections and refractions                         glass.cpp
//     resolve    linear light to sRGB                                resolve.cpp
#include "render/render.h"

#include "math/elementary.h"
#include "math/random.h"
#include "raster/frame.h"
#include "render/frame.h"
#include "render/kernel_choice.h"
#include "vitral/error.h"

#include <algorithm>
#include <cmath>
#include <mutex>

namespace vitral {
namespace {

constexpr size_t kTilePixels = static_cast<size_t>(kTileSide) * kTileSide;

// A worker's own memory.
struct Worker {
  PassTally tally;
  TileVisibility visibility;
  PathScratch paths;
  std::vector<Vec3> color, reflection, refraction;  // of the tile
  uint64_t covered = 0, not_finite = 0;
};

// The auxiliary pictures that were asked for; null where not.
struct AovTargets {
  std::array<Aov*, std::size(kAovNames)> by_index{};
  bool any = false;
};

void check_settings(const Settings& s) {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw UsageError(what);
  };
  require(s.width >= 1 && s.width <= kMaxImageSide && s.height >= 1 && s.height <= kMaxImageSide,
          "the picture's size must be 1x1 to 16384x16384");
  require(s.crop.width == 0 || (s.crop.x >= 0 && s.crop.y >= 0 && s.crop.width > 0 && s.crop.height > 0 &&
                                s.crop.x <= s.width - s.crop.width && s.crop.y <= s.height - s.crop.height),
          "the crop must lie inside the picture");
  const int n = static_cast<int>(square_root(static_cast<float>(s.ao_samples)) + 0.5f);
  require(s.ao_samples >= 1 && s.ao_samples <= 1024 && n * n == s.ao_samples,
          "the number of ambient samples must be a square from 1 to 1024");
  require(s.ao_distance > 0 && std::isfinite(s.ao_distance), "the ambient distance must be greater than 0");
  require(s.ao_exponent > 0 && std::isfinite(s.ao_exponent), "the ambient exponent must be greater than 0");
  require(s.max_depth >= 0 && s.max_depth <= 100, "the depth limit must be 0 to 100");
  require(s.min_importance >= 0 && s.min_importance <= 1, "the least importance must be 0 to 1");
  require(s.threads >= 0 && s.threads <= 1024, "the number of threads must be 0 to 1024");
  for (const std::string& name : s.aovs) {
    require(std::find(std::begin(kAovNames), std::end(kAovNames), name) != std::end(kAovNames),
            "unknown auxiliary picture");
  }
}

void check_camera(const Camera& c) {
  const auto finite = [](const Vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
  };
  if (!finite(c.position) || !finite(c.view) || !finite(c.up))
    throw UsageError("the camera's vectors must be finite");
  if (!(length(cross(normalize(to_double(c.view)), normalize(to_double(c.up)))) > 1e-6)) {
    throw UsageError("the camera's up vector must not be zero or along its view");
  }
  if (!(c.fov > 0 && c.fov < 180)) throw UsageError("the field of view must be between 0 and 180 degrees");
  if (!(c.near > 0 && c.far > c.near && std::isfinite(c.far)))
    throw UsageError("the camera needs 0 < near < far");
}

Rectangle crop_of(const Settings& s) {
  return s.crop.width == 0 ? Rectangle{0, 0, s.width, s.height} : s.crop;
}

// The lanes of the block at (x, y) that lie in the crop.
uint64_t lanes_inside(const Rectangle& crop, int x, int y) {
  if (x >= crop.x && y >= crop.y && x + kBlockSide <= crop.x + crop.width &&
      y + kBlockSide <= crop.y + crop.height)
    return ~0ull;
  uint64_t lanes = 0;
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const int px = x + lane % kBlockSide, py = y + lane / kBlockSide;
    if (px >= crop.x && px < crop.x + crop.width && py >= crop.y && py < crop.y + crop.height)
      lanes |= 1ull << lane;
  }
  return lanes;
}

// Where the frame's pixel (x, y) lies in the pictures of the crop.
size_t frame_pixel(const Rectangle& crop, int x, int y) {
  return static_cast<size_t>(y - crop.y) * static_cast<size_t>(crop.width) + static_cast<size_t>(x - crop.x);
}

void write_aovs(const AovTargets& targets, const SurfacePacket& s, const LightDetail& light, int lane,
                size_t pixel) {
  const auto put = [&](size_t index, const Vec3& value) {
    if (targets.by_index[index]) targets.by_index[index]->pixels.pixels[pixel] = value;
  };
  put(0, get(s.points.px, s.points.py, s.points.pz, lane));
  put(1, get(s.points.nx, s.points.ny, s.points.nz, lane));
  put(2, get(s.points.gx, s.points.gy, s.points.gz, lane));
  put(3, {s.t[lane], 0, 0});
  put(4, {s.r[lane], s.g[lane], s.b[lane]});
  put(5, {static_cast<float>(s.material[lane]), 0, 0});
  put(6, {static_cast<float>(s.triangle[lane]), 0, 0});
  put(7, {light.shadow[lane], 0, 0});
  put(8, {light.ao[lane], 0, 0});
}

// Moves the tile's colours to the frame. Neighbours are often of one colour, which is encoded once.
void resolve_tile(const Rectangle& crop, int tile_x, int tile_y, Worker& worker, Frame& out,
                  const AovTargets& targets) {
  const PassTimer timer(worker.tally, Pass::resolve);
  const int x0 = std::max(tile_x, crop.x), x1 = std::min(tile_x + kTileSide, crop.x + crop.width);
  const int y0 = std::max(tile_y, crop.y), y1 = std::min(tile_y + kTileSide, crop.y + crop.height);
  Vec3 last{0, 0, 0};
  Rgb8 code;
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      const size_t here = static_cast<size_t>((y - tile_y) * kTileSide + (x - tile_x));
      const size_t there = frame_pixel(crop, x, y);
      Vec3& color = worker.color[here];
      if (!(color == last)) {
        code = encode_pixel(color, worker.not_finite);
        last = color;
      }
      out.pixels.pixels[there] = code;
      if (!out.radiance.pixels.empty()) out.radiance.pixels[there] = color;
      if (targets.by_index[9]) targets.by_index[9]->pixels.pixels[there] = worker.reflection[here];
      if (targets.by_index[10]) targets.by_index[10]->pixels.pixels[there] = worker.refraction[here];
    }
  }
}

// Carries one tile through all passes while it is in cache.
void render_tile(const FrameContext& frame, const Rectangle& crop, int tile_x, int tile_y, Worker& worker,
                 Frame& out, const AovTargets& targets) {
  worker.color.assign(kTilePixels, frame.scene.background);
  PathSums sums{worker.color.data(), nullptr, nullptr};
  if (targets.any) {
    worker.reflection.assign(kTilePixels, Vec3{0, 0, 0});
    worker.refraction.assign(kTilePixels, Vec3{0, 0, 0});
    sums = {worker.color.data(), worker.reflection.data(), worker.refraction.data()};
  }
  worker.paths.current.clear();
  rasterize_tile(frame, tile_x, tile_y, worker.tally, worker.visibility);
  for (int block = 0; block < kTileBlocks; ++block) {
    const int x = tile_x + block % kTileBlocksAcross * kBlockSide,
              y = tile_y + block / kTileBlocksAcross * kBlockSide;
    const uint64_t lanes = lanes_inside(crop, x, y);
    if (lanes == 0 || is_background(frame, worker.visibility, block)) continue;
    RayPacket rays;
    HitPacket hits;
    SurfacePacket surfaces;
    primary_hits(frame, worker.visibility, block, x, y, lanes, worker.tally, rays, hits);
    {
      const PassTimer timer(worker.tally, Pass::shade);
      make_surfaces(frame.scene, rays, hits, lanes, surfaces);
    }
    if (surfaces.points.live == 0) continue;
    Path camera_paths[kPacketSize];
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const int px = x + lane % kBlockSide, py = y + lane / kBlockSide;
      surfaces.points.key[lane] = pixel_key(px, py, frame.settings.seed);
      camera_paths[lane] = {};
      camera_paths[lane].weight = {1, 1, 1};
      camera_paths[lane].key = surfaces.points.key[lane];
      camera_paths[lane].pixel = static_cast<uint16_t>((py - tile_y) * kTileSide + (px - tile_x));
    }
    ColorPacket light;
    LightDetail detail;
    light_surfaces(frame, surfaces, worker.tally, light, detail);
    for (int lane = 0; lane < kPacketSize; ++lane) {
      if (!(surfaces.points.live >> lane & 1)) continue;
      ++worker.covered;
      worker.color[camera_paths[lane].pixel] = light.color[lane];
      if (targets.any)
        write_aovs(targets, surfaces, detail, lane,
                   frame_pixel(crop, x + lane % kBlockSide, y + lane / kBlockSide));
    }
    spawn_paths(frame, surfaces, camera_paths, worker.paths.current);
  }
  trace_paths(frame, worker.paths, worker.tally, sums);

  resolve_tile(crop, tile_x, tile_y, worker, out, targets);
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void collect_stats(const std::vector<Worker>& workers, Stats& stats) {
  for (size_t p = 0; p < kPasses; ++p) {
    PassStats total{kPassNames[p], 0, 0};
    for (const Worker& w : workers) {
      total.seconds += w.tally.seconds[p];
      total.rays += w.tally.rays[p];
    }
    stats.passes.push_back(total);
  }
  for (const Worker& w : workers) {
    stats.covered_pixels += w.covered;
    stats.not_finite_pixels += w.not_finite;
  }
}

}  // namespace

Frame render_frame(const Scene& scene, const Accelerator& accelerator, const Camera& camera,
                   const Settings& settings, ThreadPool& pool, Control& control) {
  check_settings(settings);
  check_camera(camera);
  const auto start = std::chrono::steady_clock::now();
  const Rectangle crop = crop_of(settings);

  FrameContext frame{scene,
                     settings,
                     accelerator,
                     choose_kernels(settings.isa),
                     make_pinhole(camera, settings.width, settings.height),
                     nullptr,
                     0,
                     0,
                     {}};
  frame.least_importance = greatest(settings.min_importance, 1.0f / 4096);
  frame.ao_strata = static_cast<int>(square_root(static_cast<float>(settings.ao_samples)) + 0.5f);
  for (int k = 0; k <= settings.ao_samples; ++k) {
    frame.ao_of_free_rays.push_back(
        power(static_cast<float>(k) / static_cast<float>(settings.ao_samples), settings.ao_exponent));
  }

  Frame out;
  if (settings.keep_radiance) out.radiance = Image<Vec3>(crop.width, crop.height);
  out.pixels = Image<Rgb8>(crop.width, crop.height);
  AovTargets targets;
  out.aovs.reserve(settings.aovs.size());
  for (const std::string& name : settings.aovs) {
    const size_t index = static_cast<size_t>(std::find(std::begin(kAovNames), std::end(kAovNames), name) -
                                             std::begin(kAovNames));
    if (targets.by_index[index]) continue;
    const bool scalar = index == 3 || (index >= 5 && index <= 8);
    const float nothing =
        index == 5 || index == 6 ? -1.0f : 0.0f;  // 0 is a number of a material, of a triangle
    out.aovs.push_back(
        {name, scalar ? 1 : 3, Image<Vec3>(crop.width, crop.height, Vec3{nothing, nothing, nothing})});
    targets.by_index[index] = &out.aovs.back();
    targets.any = true;
  }

  PassTally setup_tally;
  RasterFrame raster;
  RasterView raster_view{};
  if (settings.primary == Primary::raster) {
    const PassTimer timer(setup_tally, Pass::raster);
    const ForEach for_each = [&](size_t count, const std::function<void(size_t)>& body) {
      pool.parallel_for(count, [&](size_t i, size_t) {
        if (control.stop.load(std::memory_order_relaxed)) throw Interrupted();
        body(i);
      });
    };
    setup_frame(frame.camera, settings.width, settings.height, crop, scene.mesh, for_each, raster);
    raster_view = make_view(raster, frame.camera, accelerator.triangles.data(), &accelerator.view.cut_outs);
    frame.raster = &raster_view;
  }

  // Tiles are anchored at the frame's corner, so that a crop's pixels see the same neighbours.
  const int first_x = crop.x / kTileSide, first_y = crop.y / kTileSide;
  const int tiles_x = (crop.x + crop.width - 1) / kTileSide - first_x + 1;
  const int tiles_y = (crop.y + crop.height - 1) / kTileSide - first_y + 1;
  const size_t tiles = static_cast<size_t>(tiles_x) * static_cast<size_t>(tiles_y);
  std::vector<Worker> workers(pool.workers());
  std::mutex progress_mutex;
  size_t done = 0;
  uint64_t rays = 0;
  pool.parallel_for(tiles, [&](size_t i, size_t w) {
    if (control.stop.load(std::memory_order_relaxed)) throw Interrupted();
    Worker& worker = workers[w];
    const auto before = worker.tally.rays;
    render_tile(frame, crop, (first_x + static_cast<int>(i) % tiles_x) * kTileSide,
                (first_y + static_cast<int>(i) / tiles_x) * kTileSide, worker, out, targets);
    if (!control.on_progress) return;
    const std::lock_guard<std::mutex> lock(progress_mutex);
    for (size_t p = 0; p < kPasses; ++p) rays += worker.tally.rays[p] - before[p];
    control.on_progress({"render", static_cast<double>(++done) / static_cast<double>(tiles), rays});
  });

  Stats& stats = out.stats;
  stats.isa = frame.kernels.isa;
  stats.threads = static_cast<int>(pool.workers());
  stats.triangles = scene.mesh.triangles.size();
  stats.dropped_triangles = scene.dropped_triangles;
  stats.tree_nodes = accelerator.all.nodes.size();
  stats.tree_bytes =
      accelerator.all.nodes.size() * sizeof(KdNode) + accelerator.all.references.size() * sizeof(uint32_t);
  workers[0].tally.seconds[static_cast<size_t>(Pass::raster)] +=
      setup_tally.seconds[static_cast<size_t>(Pass::raster)];
  collect_stats(workers, stats);
  stats.frame_seconds = seconds_since(start);
  return out;
}

// Without rays there is nothing to trace.
static bool needs_tree(const Scene& scene, const Settings& settings) {
  const Effects& on = settings.effects;
  if (settings.primary == Primary::trace || on.shadows || on.ambient_occlusion) return true;
  const bool bends = std::any_of(scene.materials.begin(), scene.materials.end(),
                                 [](const Material& m) { return m.optics != Optics::opaque; });
  return bends && (on.reflection || on.refraction);
}

Frame render(const Scene& scene, const Camera& camera, const Settings& settings, Control& control) {
  check_settings(settings);
  check_camera(camera);
  choose_kernels(settings.isa);
  ThreadPool pool(settings.threads);
  const auto start = std::chrono::steady_clock::now();
  if (control.on_progress) control.on_progress({"build", 0, 0});
  Accelerator accelerator;
  if (needs_tree(scene, settings)) {
    build_accelerator(scene, pool, control, accelerator);
  } else {
    gather_triangles(scene, pool, accelerator);
  }
  const double build_seconds = seconds_since(start);
  Frame frame = render_frame(scene, accelerator, camera, settings, pool, control);
  frame.stats.build_seconds = build_seconds;
  return frame;
}

}  // namespace vitral
