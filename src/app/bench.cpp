// Times every pass of a frame, and the frame; or, for --report, frames of many settings.
#include "app/bench.h"

#include "app/commands.h"
#include "app/interrupt.h"
#include "app/progress.h"

#include <unistd.h>

namespace vitral {
namespace {

// A report's row is run until it has taken so long, or as often as --repeat says.
constexpr double kEnoughSeconds = 4;

void check_options(const Options& o) {
  if (o.layout && o.primary == Primary::trace)
    throw UsageError("--layout is what the rasterizer writes: it goes without --primary trace");
  if (!o.report) return;
  for (const auto& [given, name] :
       {std::pair{o.json, "--json"}, std::pair{o.anchor, "--anchor"},
        std::pair{o.layout.has_value(), "--layout"}, std::pair{o.effects.has_value(), "--effects"}}) {
    if (given)
      throw UsageError(std::string("--report chooses effects and prints tables: it goes without ") + name);
  }
}

Layout layout_of(const Options& o) {
  return o.layout.value_or(Layout::full);
}

// The passes keep what the camera sees, which is many times the picture.
void check_memory(const Job& job, Layout layout) {
  const Settings& settings = job.pipeline.settings;
  const size_t needed = frame_bytes(settings) + measurement_bytes(settings, layout), limit = memory_limit();
  if (needed <= limit) return;
  throw UsageError("timing the passes of " + std::to_string(settings.width) + "x" +
                   std::to_string(settings.height) + " pixels needs " + std::to_string(needed >> 20) +
                   " MiB, there are " + std::to_string(limit >> 20));
}

// All of the project's, the job's first; its alone when the user asked for one.
std::vector<Camera> report_cameras(const Job& job, const Options& o) {
  std::vector<Camera> cameras{job.camera};
  if (job.automatic || o.camera || o.eye || o.view || o.up || o.fov || o.near || o.far) return cameras;
  for (const Camera& camera : job.project.scene.cameras) {
    if (camera.name != job.camera.name) cameras.push_back(camera);
  }
  return cameras;
}

std::string measure_report(const Job& job, const Options& options, Runs& runs, Control& control) {
  runs.enough_seconds = kEnoughSeconds;
  const std::vector<Camera> cameras = report_cameras(job, options);
  const FramesMeasured measured =
      measure_frames(job.project.scene, report_jobs(cameras, job.pipeline.settings), runs, control);
  return report_tables(job, cameras, runs, measured);
}

std::string measure_each_pass(const Job& job, const Options& options, const Runs& runs, Control& control) {
  const RayRules rules = options.anchor ? RayRules::anchor : RayRules::scene;
  Measurement m = measure_passes(job.project.scene, job.camera, job.pipeline.settings, rules,
                                 layout_of(options), runs, control);
  m.passes.insert(m.passes.begin(), {"load", {job.load_seconds * 1e3}, 0, 0, {}});
  return options.json ? passes_json(job, m) : passes_table(job, m, options.repeat);
}

// With a bar on a terminal, which is redrawn between the runs: nobody draws while the clock runs.
std::string measure(const Job& job, const Options& options) {
  Control control;
  const InterruptGuard guard(control.stop);
  ProgressBar bar;
  Runs runs;
  runs.repeat = options.repeat;
  if (is_terminal(STDERR_FILENO) && !options.quiet)
    runs.on_progress = [&](const Progress& progress) { bar.update(progress); };
  return options.report ? measure_report(job, options, runs, control)
                        : measure_each_pass(job, options, runs, control);
}

}  // namespace

int run_bench(const Options& options) {
  check_options(options);
  Job job = plan_job(options);
  if (options.layout) job.pipeline.settings.primary = Primary::raster;  // whatever the project says
  if (!options.report) check_memory(job, layout_of(options));
  report_warnings(job.warnings, options);
  load_job(job, options);
  report_warnings(job.warnings, options);
  if (options.anchor) simplify(job.project.scene, job.camera);
  if (options.layout) fill_cut_outs(job.project.scene);
  if (options.mirror_all) make_mirrors(job.project.scene);
  print(measure(job, options));
  return kDone;
}

}  // namespace vitral
