// Times every pass of a frame, and the frame.
#include "app/commands.h"
#include "app/interrupt.h"
#include "app/json.h"
#include "render/measure.h"

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

namespace vitral {
namespace {

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

double least(const std::vector<double>& values) {
  return *std::min_element(values.begin(), values.end());
}

double mrays_per_s(const PassTimes& pass) {
  const double ms = median(pass.ms);
  return ms > 0 ? static_cast<double>(pass.rays) / ms * 1e-3 : 0;
}

std::string as_json(const Job& job, const Measurement& m) {
  JsonWriter json;
  json.begin_object()
      .add("input", job.input)
      .add("triangles", uint64_t{job.project.scene.mesh.triangles.size()})
      .add("width", job.pipeline.settings.width)
      .add("height", job.pipeline.settings.height)
      .add("threads", m.threads)
      .add("isa", m.isa)
      .begin_array("passes");
  for (const PassTimes& pass : m.passes) {
    json.begin_object()
        .add("name", pass.name)
        .add("ms_median", median(pass.ms))
        .add("ms_min", least(pass.ms))
        .add("rays", pass.rays)
        .add("mrays_per_s", mrays_per_s(pass));
    if (pass.bytes > 0) json.add("bytes", pass.bytes);
    json.end_object();
  }
  json.end_array()
      .begin_object("checks")
      .add("covered_pixels", m.covered_pixels)
      .add("shadowed_pixels", m.shadowed_pixels)
      .add("reflection_hits", m.reflection_hits)
      .add("ao_mean", m.ao_mean)
      .end_object();
  return json.end_object().text();
}

std::string as_table(const Job& job, const Measurement& m, int frames) {
  char line[200];
  std::string text = job.input + ": " + std::to_string(job.project.scene.mesh.triangles.size()) +
                     " triangles, " + std::to_string(job.pipeline.settings.width) + "x" +
                     std::to_string(job.pipeline.settings.height) + ", " + std::to_string(m.threads) +
                     " threads, " + m.isa + ", " + std::to_string(frames) + " frames\n";
  std::snprintf(line, sizeof line, "%-12s %12s %12s %12s %12s\n", "pass", "median ms", "least ms", "rays",
                "Mrays/s");
  text += line;
  for (const PassTimes& pass : m.passes) {
    std::snprintf(line, sizeof line, "%-12s %12.2f %12.2f %12llu %12.1f\n", pass.name.c_str(),
                  median(pass.ms), least(pass.ms), static_cast<unsigned long long>(pass.rays),
                  mrays_per_s(pass));
    text += line;
  }
  std::snprintf(line, sizeof line,
                "covered pixels %llu, shadowed %llu, reflected rays that met something %llu, mean ambient "
                "visibility %.6f\n",
                static_cast<unsigned long long>(m.covered_pixels),
                static_cast<unsigned long long>(m.shadowed_pixels),
                static_cast<unsigned long long>(m.reflection_hits), m.ao_mean);
  return text + line;
}

}  // namespace

int run_bench(const Options& options) {
  Job job = plan_job(options);
  load_job(job, options);
  report_warnings(job.warnings, options);
  Scene& scene = job.project.scene;
  const RayRules rules = options.anchor ? RayRules::anchor : RayRules::scene;
  if (options.anchor) simplify(scene, job.camera);
  if (options.mirror_all) make_mirrors(scene);

  Control control;
  const InterruptGuard guard(control.stop);
  Measurement m = measure_passes(scene, job.camera, job.pipeline.settings, rules, options.repeat, control);
  m.passes.insert(m.passes.begin(), {"load", {job.load_seconds * 1e3}, 0, 0});
  print(options.json ? as_json(job, m) : as_table(job, m, options.repeat));
  return kDone;
}

}  // namespace vitral
