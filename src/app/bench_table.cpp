// The passes of a frame, printed.
#include "app/bench.h"
#include "app/json.h"

#include <algorithm>
#include <cstdio>

namespace vitral {
namespace {

double least(const std::vector<double>& values) {
  return *std::min_element(values.begin(), values.end());
}

struct Part {
  const char* name;
  double RasterTimes::*ms;
};
constexpr Part kParts[] = {{"transform", &RasterTimes::transform},
                           {"setup", &RasterTimes::setup},
                           {"bin", &RasterTimes::bin},
                           {"fill", &RasterTimes::fill},
                           {"attributes", &RasterTimes::attributes}};

std::vector<double> times_of(const Part& part, const std::vector<RasterTimes>& runs) {
  std::vector<double> ms;
  for (const RasterTimes& run : runs) ms.push_back(run.*part.ms);
  return ms;
}

// Millions a second of what a pass does `count` of.
double millions_per_s(size_t count, const PassTimes& pass) {
  const double ms = median(pass.ms);
  return ms > 0 ? static_cast<double>(count) / ms * 1e-3 : 0;
}

size_t pixels_of(const Settings& s) {
  return s.crop.width == 0 ? static_cast<size_t>(s.width) * static_cast<size_t>(s.height)
                           : static_cast<size_t>(s.crop.width) * static_cast<size_t>(s.crop.height);
}

void add_parts(JsonWriter& json, const Job& job, const PassTimes& pass) {
  for (const Part& part : kParts)
    json.add(std::string(part.name) + "_ms", median(times_of(part, pass.parts)));
  json.add("mpixels_per_s", millions_per_s(pixels_of(job.pipeline.settings), pass))
      .add("mtriangles_per_s", millions_per_s(job.project.scene.mesh.triangles.size(), pass));
}

std::string parts_table(const Job& job, const PassTimes& pass) {
  char line[200];
  std::snprintf(line, sizeof line, "%*.1f Mpixels/s, %.1f Mtriangles/s\n", 32,
                millions_per_s(pixels_of(job.pipeline.settings), pass),
                millions_per_s(job.project.scene.mesh.triangles.size(), pass));
  std::string text = line;
  for (const Part& part : kParts) {
    const std::vector<double> ms = times_of(part, pass.parts);
    std::snprintf(line, sizeof line, "  %-10s %12.2f %12.2f\n", part.name, median(ms), least(ms));
    text += line;
  }
  return text;
}

}  // namespace

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

std::string bench_title(const Job& job, const std::string& isa, int threads) {
  return job.input + ": " + std::to_string(job.project.scene.mesh.triangles.size()) + " triangles, " +
         std::to_string(job.pipeline.settings.width) + "x" + std::to_string(job.pipeline.settings.height) +
         ", " + std::to_string(threads) + " threads, " + isa;
}

std::string passes_json(const Job& job, const Measurement& m) {
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
        .add("mrays_per_s", millions_per_s(pass.rays, pass));
    if (pass.bytes > 0) json.add("bytes", pass.bytes);
    if (!pass.parts.empty()) add_parts(json, job, pass);
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

std::string passes_table(const Job& job, const Measurement& m, int repeat) {
  char line[200];
  std::string text = bench_title(job, m.isa, m.threads) + ", " + std::to_string(repeat) + " runs\n";
  std::snprintf(line, sizeof line, "%-12s %12s %12s %12s %12s\n", "pass", "median ms", "least ms", "rays",
                "Mrays/s");
  text += line;
  for (const PassTimes& pass : m.passes) {
    std::snprintf(line, sizeof line, "%-12s %12.2f %12.2f", pass.name.c_str(), median(pass.ms),
                  least(pass.ms));
    text += line;
    if (pass.rays > 0) {
      std::snprintf(line, sizeof line, " %12llu %12.1f", static_cast<unsigned long long>(pass.rays),
                    millions_per_s(pass.rays, pass));
      text += line;
    }
    text += pass.parts.empty() ? "\n" : parts_table(job, pass);
  }
  std::snprintf(line, sizeof line,
                "covered pixels %llu, shadowed %llu, reflected rays that met something %llu, mean ambient "
                "visibility %.6f\n",
                static_cast<unsigned long long>(m.covered_pixels),
                static_cast<unsigned long long>(m.shadowed_pixels),
                static_cast<unsigned long long>(m.reflection_hits), m.ao_mean);
  return text + line;
}

}  // namespace vitral
