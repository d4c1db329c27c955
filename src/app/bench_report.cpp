// The two tables of the report whose renderer (a rasterizer with OptiX 3.0.1 on a GeForce GTX 780M) this
// one follows: what each effect costs, and what ambient occlusion costs by its number of samples.
#include "app/bench.h"

#include <cstdio>

namespace vitral {
namespace {

struct EffectRow {
  const char* name;
  Effects on;            // shadows, reflection, refraction, ambient occlusion
  const char* reported;  // milliseconds; two where the report tells its places Fonte and Vidro apart
};

// An empty trace pass hands the picture through. That cost the report a copy between two programming
// interfaces; here there is nothing to hand over, and the row repeats the one above it.
constexpr EffectRow kEffectRows[] = {
    {"no effects", {false, false, false, false}, "0.87"},
    {"pass-through", {false, false, false, false}, "5.33"},
    {"shadows", {true, false, false, false}, "11.77"},
    {"reflection", {false, true, false, false}, "7.16 / 15.61"},
    {"refraction", {false, false, true, false}, "9.4 / 23.42"},
    {"all but AO", {true, true, true, false}, "17.93"},
    {"all", {true, true, true, true}, "759.74"},
};

struct SampleRow {
  int samples;
  double reported_ms;
};

constexpr SampleRow kSampleRows[] = {{1, 11.68},   {4, 33.18},   {9, 66.05},   {16, 109.20}, {25, 165.37},
                                     {36, 231.86}, {49, 309.13}, {64, 397.88}, {81, 497.68}, {100, 607.87}};

std::string name_of(const Camera& camera) {
  return camera.name.empty() ? "camera" : camera.name;
}

template <class... Values>
std::string formatted(const char* format, Values... values) {
  std::string text(static_cast<size_t>(std::snprintf(nullptr, 0, format, values...)), '\0');
  std::snprintf(text.data(), text.size() + 1, format, values...);
  return text;
}

std::string effects_table(const std::vector<Camera>& cameras, const std::vector<FrameTimes>& frames) {
  std::string head = formatted("%-14s", ""), units = formatted("%-14s", "effects");
  for (const Camera& camera : cameras) {
    head += formatted("  %16.16s", name_of(camera).c_str());
    units += formatted("  %9s %6s", "ms", "tracer");
  }
  std::string text = head + formatted("  %20s", "report, GTX 780M") + "\n" + units +
                     formatted("  %20s", "ms (Fonte / Vidro)") + "\n";
  constexpr size_t kRows = std::size(kEffectRows);
  for (size_t row = 0; row < kRows; ++row) {
    text += formatted("%-14s", kEffectRows[row].name);
    for (size_t c = 0; c < cameras.size(); ++c) {
      const FrameTimes& frame = frames[c * kRows + row];
      text += formatted("  %9.2f %4.0f %%", median(frame.ms), frame.tracer_share * 100);
    }
    text += formatted("  %20s\n", kEffectRows[row].reported);
  }
  return text;
}

std::string samples_table(const FrameTimes* frames) {
  std::string text =
      formatted("%-14s  %9s %12s %10s  %20s\n", "samples", "ms", "rays", "Mrays/s", "report, GTX 780M, ms");
  for (const SampleRow& row : kSampleRows) {
    const FrameTimes& frame = *frames++;
    const double ms = median(frame.ms);
    text += formatted("%-14d  %9.2f %12llu %10.1f  %20.2f\n", row.samples, ms,
                      static_cast<unsigned long long>(frame.rays),
                      ms > 0 ? static_cast<double>(frame.rays) / ms * 1e-3 : 0.0, row.reported_ms);
  }
  return text;
}

}  // namespace

std::vector<FrameJob> report_jobs(const std::vector<Camera>& cameras, const Settings& settings) {
  std::vector<FrameJob> jobs;
  for (const Camera& camera : cameras) {
    for (const EffectRow& row : kEffectRows) {
      jobs.push_back({name_of(camera) + ", " + row.name, camera, settings});
      jobs.back().settings.effects = row.on;
    }
  }
  for (const SampleRow& row : kSampleRows) {
    jobs.push_back({"AO " + std::to_string(row.samples), cameras.front(), settings});
    jobs.back().settings.effects = {false, false, false, true};
    jobs.back().settings.ao_samples = row.samples;
  }
  return jobs;
}

std::string report_tables(const Job& job, const std::vector<Camera>& cameras, const Runs& runs,
                          const FramesMeasured& measured) {
  const Settings& s = job.pipeline.settings;
  std::string text = bench_title(job, measured.isa, measured.threads) + "\n";
  text += formatted(
      "Medians of up to %d whole frames after the build, fewer once a row has taken %.0f s.\n"
      "AO distance %g, exponent %g, %d samples in the row `all`; at most %d generations of secondary rays.\n"
      "The report's figures are of its own model of the place, on its own machine.\n",
      runs.repeat, runs.enough_seconds, static_cast<double>(s.ao_distance),
      static_cast<double>(s.ao_exponent), s.ao_samples, s.max_depth);
  text += "\nCost per effect; tracer: share of the threads' time in passes that trace rays\n" +
          effects_table(cameras, measured.frames);
  text += "\nAmbient occlusion alone, " + name_of(cameras.front()) + "\n" +
          samples_table(&measured.frames[cameras.size() * std::size(kEffectRows)]);
  return text;
}

}  // namespace vitral
