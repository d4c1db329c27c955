#include "app/commands.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "io/file.h"
#include "io/image_file.h"
#include "io/png.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <utility>

namespace vitral {
namespace {

namespace fs = std::filesystem;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Every file that a render writes.
struct Outputs {
  std::string png;
  std::vector<std::pair<std::string, std::string>> aovs;  // name and path
  std::string stats;
};

// NAME.png here by default; auxiliary pictures lie beside the output, NAME.depth.pfm and so on.
Outputs outputs_of(const Options& options) {
  Outputs outputs;
  const std::string stem = fs::path(options.inputs[0]).stem().string();
  outputs.png = options.output.empty() ? stem + ".png" : options.output;
  const fs::path base = outputs.png == "-" ? fs::path(stem) : fs::path(outputs.png).replace_extension();
  for (const std::string& name : options.aovs)
    outputs.aovs.emplace_back(name, base.string() + "." + name + ".pfm");
  outputs.stats = options.stats;
  return outputs;
}

// The paths of one file give one path, whether or not the file is there yet.
fs::path normal_form(const std::string& path) {
  if (path == "-") return path;
  const fs::path absolute = fs::absolute(path);
  std::error_code code;
  const fs::path canonical = fs::weakly_canonical(absolute, code);
  return code ? absolute.lexically_normal() : canonical;
}

// No two outputs may be the same file, and none an input.
void check_outputs(const Outputs& outputs, const Job& job) {
  std::vector<std::string> inputs{job.input};
  for (const MeshFile& mesh : job.project.meshes) inputs.push_back(mesh.path);
  std::vector<std::pair<std::string, std::string>> all{{"the picture", outputs.png}};  // what and path
  for (const auto& [name, path] : outputs.aovs) all.emplace_back("--aov " + name, path);
  if (!outputs.stats.empty()) all.emplace_back("--stats", outputs.stats);

  std::map<fs::path, std::string> taken;
  for (const auto& [what, path] : all) {
    const auto [first, is_new] = taken.try_emplace(normal_form(path), what);
    if (!is_new) throw UsageError(what + " and " + first->second + " go to the same place: " + path);
  }
  for (const auto& [what, path] : all) check_output(path, inputs);
}

void print_summary(const Outputs& outputs, const Frame& frame, const RunTimes& times) {
  uint64_t rays = 0, saved = 0;
  for (const PassStats& pass : frame.stats.passes) rays += pass.rays, saved += pass.rays_saved;
  std::fprintf(stderr,
               "%s: %dx%d, %zu triangles, %.1f Mrays (%.1f saved); load %s, build %s, frame %s, write %s (%d "
               "threads, %s)\n",
               outputs.png == "-" ? "standard output" : outputs.png.c_str(), frame.pixels.width,
               frame.pixels.height, frame.stats.triangles, static_cast<double>(rays) * 1e-6,
               static_cast<double>(saved) * 1e-6, in_words(times.load_seconds).c_str(),
               in_words(frame.stats.build_seconds).c_str(), in_words(frame.stats.frame_seconds).c_str(),
               in_words(times.write_seconds).c_str(), frame.stats.threads, frame.stats.isa.c_str());
}

void stop_if_asked(const Control& control) {
  if (control.stop) throw Interrupted();
}

// Writes one output by calling `write`. A regular file has a temporary name until it is whole, and an
// interruption waits for that; a pipe may never be read, and ends at once.
template <class Write>
void write_output(const std::string& path, Control& control, Write write) {
  std::error_code code;
  const fs::file_status status = fs::status(path, code);
  std::optional<InterruptGuard> guard;
  if (path != "-" && (!fs::exists(status) || fs::is_regular_file(status))) guard.emplace(control.stop);
  stop_if_asked(control);
  write();
}

// The auxiliary pictures and the statistics; afterwards times.write_seconds covers all but the
// writing of the picture, whose encoding took `encode_seconds`.
void write_companions(const Outputs& outputs, const Frame& frame, const Job& job, double encode_seconds,
                      RunTimes& times, Control& control) {
  const auto start = std::chrono::steady_clock::now();
  for (const auto& [name, path] : outputs.aovs) {
    const auto found = std::find_if(frame.aovs.begin(), frame.aovs.end(),
                                    [&, wanted = &name](const Aov& aov) { return aov.name == *wanted; });
    if (found == frame.aovs.end()) fail(path, "the renderer made no picture of this name");
    write_output(path, control, [&, file = &path] { write_pfm(*file, *found); });
  }
  times.write_seconds = encode_seconds + seconds_since(start);
  if (outputs.stats.empty()) return;
  write_output(outputs.stats, control,
               [&] { write_file(outputs.stats, stats_json(job, frame.stats, times)); });
}

// The picture comes last: when it is there, everything is.
void write_outputs(const Outputs& outputs, const Frame& frame, const Job& job, RunTimes& times,
                   Control& control) {
  const auto start = std::chrono::steady_clock::now();
  const std::string picture = encode_png(frame.pixels);
  write_companions(outputs, frame, job, seconds_since(start), times, control);
  write_output(outputs.png, control, [&] { write_file(outputs.png, picture); });
  times.write_seconds = seconds_since(start);
}

enum class Audience { nobody, terminal };

// Renders, with a progress bar on a terminal. An interruption waits until a worker notices it.
Frame render_guarded(const Job& job, Audience audience, Control& control) {
  const InterruptGuard guard(control.stop);
  const auto bar = std::make_unique<ProgressBar>();
  if (audience == Audience::terminal)
    control.on_progress = [&](const Progress& progress) { bar->update(progress); };
  Frame frame = render(job.project.scene, job.camera, job.pipeline.settings, control);
  control.on_progress = nullptr;
  bar->erase();
  stop_if_asked(control);
  return frame;
}

}  // namespace

int run_render(const Options& options) {
  // Everything that can be refused is refused before the meshes are loaded.
  Job job = plan_job(options);
  const Outputs outputs = outputs_of(options);
  Control control;
  {
    const InterruptGuard guard(control.stop);  // trying a folder makes a temporary file, too
    check_outputs(outputs, job);
  }
  stop_if_asked(control);
  report_warnings(job.warnings, options);

  load_job(job, options);
  report_warnings(job.warnings, options);

  const Audience audience =
      is_terminal(STDERR_FILENO) && !options.quiet ? Audience::terminal : Audience::nobody;
  const auto start = std::chrono::steady_clock::now();
  const Frame frame = render_guarded(job, audience, control);
  RunTimes times{job.load_seconds, seconds_since(start), 0};
  if (frame.stats.not_finite_pixels > 0) {
    job.warnings.push_back(std::to_string(frame.stats.not_finite_pixels) +
                           " pixels have no finite value and are painted red");
  }
  report_warnings(job.warnings, options);

  write_outputs(outputs, frame, job, times, control);
  if (audience == Audience::terminal) print_summary(outputs, frame, times);
  return kDone;
}

}  // namespace vitral
