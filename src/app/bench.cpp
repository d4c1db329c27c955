// Times whole frames and, by the workers' clocks, every pass in them.
#include "app/commands.h"
#include "app/interrupt.h"
#include "app/json.h"
#include "app/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

namespace vitral {
namespace {

// The times of one pass, one for every frame; rays are the same in all of them.
struct Timing {
  std::string name;
  std::vector<double> ms;
  uint64_t rays = 0;
  uint64_t bytes = 0;  // of the tree, for `build`
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

double least(const std::vector<double>& values) {
  return *std::min_element(values.begin(), values.end());
}

double mrays_per_s(const Timing& timing) {
  const double ms = median(timing.ms);
  return ms > 0 ? static_cast<double>(timing.rays) / ms * 1e-3 : 0;
}

Timing& timing_of(std::vector<Timing>& timings, const std::string& name) {
  for (Timing& timing : timings) {
    if (timing.name == name) return timing;
  }
  return timings.emplace_back(Timing{name, {}, 0, 0});
}

// A pass's share of the wall clock: what the workers spent in it, divided by their number.
void add_frame(const Stats& stats, std::vector<Timing>& timings) {
  Timing& build = timing_of(timings, "build");
  build.ms.push_back(stats.build_seconds * 1e3);
  build.bytes = stats.tree_bytes;
  uint64_t rays = 0;
  for (const PassStats& pass : stats.passes) {
    Timing& timing = timing_of(timings, pass.name);
    timing.ms.push_back(pass.seconds / std::max(stats.threads, 1) * 1e3);
    timing.rays = pass.rays;
    rays += pass.rays;
  }
  Timing& frame = timing_of(timings, "frame");
  frame.ms.push_back(stats.frame_seconds * 1e3);
  frame.rays = rays;
}

std::string as_json(const Job& job, const Stats& stats, const std::vector<Timing>& timings) {
  JsonWriter json;
  json.begin_object()
      .add("input", job.input)
      .add("triangles", uint64_t{stats.triangles})
      .add("width", job.pipeline.settings.width)
      .add("height", job.pipeline.settings.height)
      .add("threads", stats.threads)
      .add("isa", stats.isa)
      .begin_array("passes");
  for (const Timing& timing : timings) {
    json.begin_object()
        .add("name", timing.name)
        .add("ms_median", median(timing.ms))
        .add("ms_min", least(timing.ms))
        .add("rays", timing.rays)
        .add("mrays_per_s", mrays_per_s(timing));
    if (timing.bytes > 0) json.add("bytes", timing.bytes);
    json.end_object();
  }
  json.end_array().begin_object("checks").add("covered_pixels", stats.covered_pixels).end_object();
  return json.end_object().text();
}

std::string as_table(const Job& job, const Stats& stats, const std::vector<Timing>& timings, int frames) {
  char line[160];
  std::string text = job.input + ": " + std::to_string(stats.triangles) + " triangles, " +
                     std::to_string(job.pipeline.settings.width) + "x" +
                     std::to_string(job.pipeline.settings.height) + ", " + std::to_string(stats.threads) +
                     " threads, " + stats.isa + ", " + std::to_string(frames) + " frames\n";
  std::snprintf(line, sizeof line, "%-12s %12s %12s %12s %12s\n", "pass", "median ms", "least ms", "rays",
                "Mrays/s");
  text += line;
  for (const Timing& timing : timings) {
    std::snprintf(line, sizeof line, "%-12s %12.2f %12.2f %12llu %12.1f\n", timing.name.c_str(),
                  median(timing.ms), least(timing.ms), static_cast<unsigned long long>(timing.rays),
                  mrays_per_s(timing));
    text += line;
  }
  return text + "covered pixels: " + std::to_string(stats.covered_pixels) + "\n";
}

}  // namespace

int run_bench(const Options& options) {
  Job job = plan_job(options);
  load_job(job, options);
  report_warnings(job.warnings, options);

  std::vector<Timing> timings{{"load", {job.load_seconds * 1e3}, 0, 0}};
  Stats stats;
  Control control;
  const InterruptGuard guard(control.stop);
  const bool talks = is_terminal(STDERR_FILENO) && !options.quiet;
  for (int i = 0; i < options.repeat; ++i) {
    if (talks) std::fprintf(stderr, "\rframe %d of %d\x1b[K", i + 1, options.repeat);
    stats = render(job.project.scene, job.camera, job.pipeline.settings, control).stats;
    add_frame(stats, timings);
  }
  if (talks) std::fputs("\r\x1b[K", stderr);
  // The whole frame stands last, whatever passes it has.
  std::stable_partition(timings.begin(), timings.end(),
                        [](const Timing& timing) { return timing.name != "frame"; });
  print(options.json ? as_json(job, stats, timings) : as_table(job, stats, timings, options.repeat));
  return kDone;
}

}  // namespace vitral
