// The command line, as one table: what the parser accepts, what `--help` prints and what a misspelt
// option is compared with are the same list.
#pragma once
#include "render/measure.h"
#include "vitral/error.h"
#include "vitral/render.h"
#include "vitral/scene.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vitral {

enum class Command { render, bench, diff, info, help, version };

struct Size {
  int width = 0, height = 0;
};

struct Shutter {
  float open = 0, close = 0;  // times
};

// What was asked for. An option that was not given leaves the project's figure, or the default.
struct Options {
  Command command = Command::render;
  Command help_topic = Command::help;  // of Command::help: the command it is about, or help itself
  std::vector<std::string> inputs;     // one, and two of diff
  std::string output;                  // -o; empty: the default

  std::optional<std::string> pipeline, camera;
  std::optional<Size> size;
  std::optional<Rectangle> crop;
  std::optional<Vec3> eye, view, up, sun;
  std::optional<float> fov, near, far, aperture, focus;
  std::optional<Shutter> shutter;
  std::optional<int> samples;
  std::optional<Filter> filter;

  std::optional<Vec3> background;
  std::optional<Effects> effects;
  std::optional<int> light_samples, ao_samples, max_depth, threads;
  std::optional<float> ao_distance, ao_exponent, min_importance;
  std::optional<Fresnel> fresnel;
  std::optional<Isa> isa;
  std::optional<Primary> primary;
  std::optional<Terminator> terminator;
  std::optional<uint32_t> seed;
  std::vector<std::string> aovs;

  std::string stats;  // empty: none; "-": standard output
  int repeat = 5;
  std::optional<Layout> layout;  // bench: what the raster pass writes
  bool anchor = false;           // bench: another tracer's rays
  bool mirror_all = false;       // bench: every surface a perfect mirror
  bool report = false;           // bench: the tables of effects and of ambient samples
  bool json = false;
  bool quiet = false;
};

// The words after the program's name. Throws UsageError with one line that says what is wrong and,
// for a misspelt name, which one is nearest.
Options parse_options(const std::vector<std::string>& words);

// The page of one command, or of the program for Command::help.
std::string help_page(Command topic);

inline constexpr const char* kVersion = "vitral 0.1.0";

// The name of `names` that `word` was probably meant to be; empty when none is near.
std::string nearest_name(std::string_view word, const std::vector<std::string>& names);

const char* name_of(Isa isa);
const char* name_of(Fresnel fresnel);
const char* name_of(Compositing compositing);
const char* name_of(Primary primary);
const char* name_of(Filter filter);
const char* name_of(Terminator terminator);
const char* name_of(Layout layout);

}  // namespace vitral
