// The table of contents: one frame from beginning to end.
//
//   build      triangles side by side, kd-tree                       accelerator.cpp
//   per sample of the pixels                                        samples.cpp
//     setup      triangles on the screen, sorted into bins           raster/frame.cpp
//   per tile of 32x32 pixels, on all threads, in any order:           tile.cpp
//     primary    what each pixel sees                                primary.cpp
//     surface    position, normals, material there                   surface.cpp
//     direct     light, shadows, ambient occlusion                   direct.cpp shadow.cpp light_sample.cpp
//     ambient.cpp glass      reflections and refractions                         glass.cpp resolve    linear
//     light to sRGB                                resolve.cpp
#include "render/render.h"

#include "math/elementary.h"
#include "render/frame.h"
#include "render/kernel_choice.h"
#include "render/samples.h"
#include "render/tile.h"
#include "vitral/error.h"

#include <algorithm>
#include <mutex>
#include <vector>

namespace vitral {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void collect_stats(const FrameContext& frame, const std::vector<Worker>& workers, Stats& stats) {
  const KdTree& tree = frame.accelerator.all;
  stats.isa = frame.kernels.isa;
  stats.counted = frame.count != Count::nothing;
  stats.threads = static_cast<int>(workers.size());
  const PlacedObjects& placed = frame.accelerator.placed;
  stats.triangles = placed.view.end_number;  // those of instances, too; and shapes
  stats.dropped_triangles = frame.scene.dropped_triangles;
  stats.tree_nodes = tree.nodes.size();
  stats.tree_bytes = tree_bytes(tree) + placed.tree.nodes.size() * sizeof(ObjectNode);
  stats.tree_nodes += placed.tree.nodes.size();
  for (const KdTree& model : placed.trees) {
    stats.tree_nodes += model.nodes.size();
    stats.tree_bytes += tree_bytes(model);
  }
  for (size_t p = 0; p < kPasses; ++p) {
    PassStats total{kPassNames[p], 0, 0, {}, 0};
    for (const Worker& w : workers) {
      total.seconds += w.tally.seconds[p];
      total.rays += w.tally.rays[p];
      total.rays_saved += w.tally.rays_saved[p];
      add(total.traversal, w.tally.traversal[p]);
    }
    if (stats.counted) total.traversal.rays_culled = total.rays - total.traversal.rays_traced;
    add(stats.traversal, total.traversal);
    stats.passes.push_back(total);
  }
  for (const Worker& w : workers) {
    stats.covered_pixels += w.covered;
    stats.not_finite_pixels += w.not_finite;
  }
}

// What the caller's progress adds up.
struct ProgressSum {
  std::mutex mutex;
  size_t tiles = 0;
  uint64_t rays = 0;
};

// All tiles of one sample.
void render_sample(FrameContext& frame, ThreadPool& pool, Control& control, std::vector<Worker>& workers,
                   RasterFrame& raster, FrameTargets& targets, ProgressSum& progress) {
  const Settings& settings = frame.settings;
  const Rectangle crop = crop_of(settings);
  RasterView raster_view{};
  if (settings.primary == Primary::raster) {
    const PassTimer timer(workers[0].tally, Pass::raster);
    SetupTimes times;
    raster_view = setup_raster(frame, crop, pool, control, raster, times);
    frame.raster = &raster_view;
  }
  const Tiles tiles = tiles_of(crop);
  const size_t count = static_cast<size_t>(tiles.across) * static_cast<size_t>(tiles.down);
  const double all = static_cast<double>(count) * settings.samples;
  pool.parallel_for(count, [&](size_t i, size_t w) {
    if (control.stop.load(std::memory_order_relaxed)) throw Interrupted();
    Worker& worker = workers[w];
    const auto before = worker.tally.rays;
    render_tile(frame, crop, (tiles.x + static_cast<int>(i) % tiles.across) * kTileSide,
                (tiles.y + static_cast<int>(i) / tiles.across) * kTileSide, worker, targets);
    if (!control.on_progress) return;
    const std::lock_guard<std::mutex> lock(progress.mutex);
    for (size_t p = 0; p < kPasses; ++p) progress.rays += worker.tally.rays[p] - before[p];
    control.on_progress({"render", static_cast<double>(++progress.tiles) / all, progress.rays});
  });
  frame.raster = nullptr;
}

}  // namespace

Frame render_frame(const Scene& scene, Accelerator& accelerator, const Camera& camera,
                   const Settings& settings, ThreadPool& pool, Control& control) {
  check_settings(settings);
  check_camera(camera);
  check_lights(scene);
  const auto start = std::chrono::steady_clock::now();
  const Rectangle crop = crop_of(settings);

  FrameContext frame = make_context(scene, accelerator, camera, settings);
  Frame out;
  if (settings.keep_radiance) out.radiance = Image<Vec3>(crop.width, crop.height);
  out.pixels = Image<Rgb8>(crop.width, crop.height);
  FrameTargets targets{out, make_aovs(settings, crop.width, crop.height, out), {}};
  if (settings.samples > 1) targets.sums = Image<Vec3d>(crop.width, crop.height, {0, 0, 0});

  std::vector<Worker> workers(pool.workers());
  RasterFrame raster;
  ProgressSum progress;
  const bool moving = moves(scene);
  for (const PixelSample& sample : pixel_samples(settings, camera)) {
    if (moving) place_objects(scene, sample.time, accelerator);
    const SampleView view = sample_view(camera_at(camera, sample.time), settings, sample);
    frame.camera = view.pinhole, frame.lens = view.lens;
    frame.weight = sample.weight;
    render_sample(frame, pool, control, workers, raster, targets, progress);
    ++frame.sample;
  }
  collect_stats(frame, workers, out.stats);
  out.stats.frame_seconds = seconds_since(start);
  return out;
}

FrameContext make_context(const Scene& scene, const Accelerator& accelerator, const Camera& camera,
                          const Settings& settings) {
  FrameContext frame{scene,
                     settings,
                     accelerator,
                     choose_kernels(settings.isa),
                     make_pinhole(camera, settings.width, settings.height),
                     {0, settings.terminator == Terminator::smooth ? Lift::smooth : Lift::none},
                     kSampleStep,
                     nullptr,
                     0,
                     0,
                     {},
                     what_to_count(settings),
                     0,
                     1,
                     {}};
  frame.least_importance = greatest(settings.min_importance, 1.0f / 4096);
  frame.ao_strata = static_cast<int>(square_root(static_cast<float>(settings.ao_samples)) + 0.5f);
  for (int k = 0; k <= settings.ao_samples; ++k) {
    frame.ao_of_free_rays.push_back(
        power(static_cast<float>(k) / static_cast<float>(settings.ao_samples), settings.ao_exponent));
  }
  return frame;
}

// Without rays there is nothing to trace.
static bool needs_tree(const Scene& scene, const Settings& settings) {
  const Effects& on = settings.effects;
  if (settings.primary == Primary::trace || on.shadows || on.ambient_occlusion || !scene.objects.empty())
    return true;
  const bool bends = std::any_of(scene.materials.begin(), scene.materials.end(),
                                 [](const Material& m) { return (traits_of(m) & kSendsRays) != 0; });
  return bends && (on.reflection || on.refraction);
}

Frame render(const Scene& scene, const Camera& camera, const Settings& settings, Control& control) {
  check_settings(settings);
  check_camera(camera);
  check_lights(scene);
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
  accelerator.mip_maps = make_mip_maps(scene, pool);
  const double build_seconds = seconds_since(start);
  Frame frame = render_frame(scene, accelerator, camera, settings, pool, control);
  frame.stats.build_seconds = build_seconds;
  return frame;
}

}  // namespace vitral
