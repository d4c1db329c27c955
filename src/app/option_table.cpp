#include "app/option_table.h"

#include "io/values.h"

#include <algorithm>
#include <charconv>

namespace vitral {
namespace {

[[noreturn]] void reject(const OptionRow& row, const std::string& value, const std::string& expected) {
  throw UsageError(std::string(row.name) + " '" + value + "': expected " + expected);
}

float number(const OptionRow& row, const std::string& value, Range range) {
  if (const auto parsed = parse_number(value, range)) return *parsed;
  reject(row, value, "a number " + in_words(range));
}

int integer(const OptionRow& row, const std::string& value, int least, int most) {
  if (const auto parsed = parse_integer(value, least, most)) return static_cast<int>(*parsed);
  reject(row, value, "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
}

Vec3 vector(const OptionRow& row, const std::string& value) {
  if (const auto parsed = parse_vector(value, kCoordinates)) return *parsed;
  reject(row, value, "three numbers, X,Y,Z");
}

Vec3 color(const OptionRow& row, const std::string& value) {
  if (const auto parsed = parse_color(value, kRadiances)) return *parsed;
  reject(row, value, "one or three numbers, R,G,B, from 0 to 1000000");
}

Vec3 direction(const OptionRow& row, const std::string& value) {
  const Vec3 parsed = vector(row, value);
  if (!(length(parsed) > 0)) reject(row, value, "a direction, not zero");
  return parsed;
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  for (;;) {
    const size_t end = text.find(separator);
    parts.emplace_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

std::string listed(const std::vector<std::string>& names) {
  std::string line;
  for (const std::string& name : names) line += (line.empty() ? "" : ", ") + name;
  return line;
}

[[noreturn]] void reject_name(const OptionRow& row, const std::string& value,
                              const std::vector<std::string>& names) {
  const std::string nearest = nearest_name(value, names);
  throw UsageError(std::string(row.name) + " '" + value + "': expected " + listed(names) +
                   (nearest.empty() ? "" : "; did you mean " + nearest + "?"));
}

// One of an enumeration's names.
template <class T>
T one_of(const OptionRow& row, const std::string& value, std::initializer_list<T> values) {
  std::vector<std::string> names;
  for (const T candidate : values) {
    names.emplace_back(name_of(candidate));
    if (value == names.back()) return candidate;
  }
  reject_name(row, value, names);
}

Size size(const OptionRow& row, const std::string& value) {
  const std::vector<std::string> sides = split(value, 'x');
  if (sides.size() == 2) {
    const auto width = parse_integer(sides[0], 1, kMaxImageSide),
               height = parse_integer(sides[1], 1, kMaxImageSide);
    if (width && height) return {static_cast<int>(*width), static_cast<int>(*height)};
  }
  reject(row, value, "WxH, each side from 1 to " + std::to_string(kMaxImageSide));
}

Shutter shutter(const OptionRow& row, const std::string& value) {
  const std::vector<std::string> parts = split(value, ',');
  if (parts.size() == 2) {
    const auto open = parse_number(parts[0], kTimes), close = parse_number(parts[1], kTimes);
    if (open && close && *open <= *close) return {*open, *close};
  }
  reject(row, value, "two times, OPEN,CLOSE, the later one second");
}

Rectangle crop(const OptionRow& row, const std::string& value) {
  const std::vector<std::string> parts = split(value, ',');
  if (parts.size() == 3) {
    const auto x = parse_integer(parts[0], 0, kMaxImageSide), y = parse_integer(parts[1], 0, kMaxImageSide);
    if (x && y) {
      const Size extent = size(row, parts[2]);
      return {static_cast<int>(*x), static_cast<int>(*y), extent.width, extent.height};
    }
  }
  reject(row, value, "X,Y,WxH in pixels");
}

Effects effects(const OptionRow& row, const std::string& value) {
  if (value == "all") return {true, true, true, true};
  Effects result{false, false, false, false};
  if (value == "none") return result;
  const std::pair<std::string, bool*> names[] = {{"shadows", &result.shadows},
                                                 {"reflection", &result.reflection},
                                                 {"refraction", &result.refraction},
                                                 {"ao", &result.ambient_occlusion}};
  for (const std::string& word : split(value, ',')) {
    const auto found =
        std::find_if(std::begin(names), std::end(names), [&](const auto& n) { return n.first == word; });
    if (found == std::end(names))
      reject_name(row, word, {"shadows", "reflection", "refraction", "ao", "none", "all"});
    *found->second = true;
  }
  return result;
}

std::vector<std::string> aovs(const OptionRow& row, const std::string& value) {
  std::vector<std::string> chosen;
  const std::vector<std::string> names(std::begin(kAovNames), std::end(kAovNames));
  for (const std::string& word : split(value, ',')) {
    if (std::find(names.begin(), names.end(), word) == names.end()) reject_name(row, word, names);
    if (std::find(chosen.begin(), chosen.end(), word) == chosen.end()) chosen.push_back(word);
  }
  return chosen;
}

int samples(const OptionRow& row, const std::string& value) {
  if (const auto parsed = parse_samples(value)) return static_cast<int>(*parsed);
  reject(row, value, "a square number from 1 to " + std::to_string(kMostSamples));
}

uint32_t seed(const OptionRow& row, const std::string& value) {
  constexpr long kMost = 0xffffffffL;
  if (const auto parsed = parse_integer(value, 0, kMost)) return static_cast<uint32_t>(*parsed);
  reject(row, value, "a whole number from 0 to " + std::to_string(kMost));
}

std::string name(const OptionRow& row, const std::string& value) {
  if (value.empty()) reject(row, value, "a name");
  return value;
}

constexpr unsigned kRender = bit(Command::render);
constexpr unsigned kBench = bit(Command::bench);
constexpr unsigned kDiff = bit(Command::diff);
constexpr unsigned kInfo = bit(Command::info);
constexpr unsigned kFrame = kRender | kBench;
constexpr unsigned kAll = kFrame | kDiff | kInfo;

constexpr std::string_view kInOut = "Input and output";
constexpr std::string_view kView = "Picture and camera";
constexpr std::string_view kLight = "Light and effects";
constexpr std::string_view kWork = "How the work is done";
constexpr std::string_view kTalk = "What is reported";

using O = Options;
using R = OptionRow;
using S = std::string;

constexpr OptionRow kTable[] = {
    {kInOut, "--output", "-o", "FILE", kRender | kDiff,
     "where the PNG goes, - is standard output (render: NAME.png here)",
     [](O& o, const R& r, const S& v) { o.output = name(r, v); }},
    {kInOut, "--pipeline", "", "NAME", kFrame, "which pipeline of the project (its default one)",
     [](O& o, const R& r, const S& v) { o.pipeline = name(r, v); }},
    {kInOut, "--camera", "", "NAME", kFrame, "which camera of the project (the pipeline's)",
     [](O& o, const R& r, const S& v) { o.camera = name(r, v); }},
    {kInOut, "--aov", "", "LIST", kRender,
     "also write NAME.AOV.pfm beside the output, for each AOV of:\n"
     "position,normal,geometric-normal,depth,albedo,material,primitive,\n"
     "shadow,ao,reflection,refraction,cost; cost is how many nodes and\n"
     "triangles all rays of the pixel came to",
     [](O& o, const R& r, const S& v) { o.aovs = aovs(r, v); }},

    {kView, "--size", "", "WxH", kFrame, "pixels (the project's; 1024x1024 for a mesh)",
     [](O& o, const R& r, const S& v) { o.size = size(r, v); }},
    {kView, "--crop", "", "X,Y,WxH", kFrame, "only this part of the picture; the same pixels as in the whole",
     [](O& o, const R& r, const S& v) { o.crop = crop(r, v); }},
    {kView, "--eye", "", "X,Y,Z", kFrame, "where the camera stands",
     [](O& o, const R& r, const S& v) { o.eye = vector(r, v); }},
    {kView, "--view", "", "X,Y,Z", kFrame, "the direction it looks (a mesh: towards its middle)",
     [](O& o, const R& r, const S& v) { o.view = direction(r, v); }},
    {kView, "--up", "", "X,Y,Z", kFrame, "the direction that is up in the picture (0,1,0)",
     [](O& o, const R& r, const S& v) { o.up = direction(r, v); }},
    {kView, "--fov", "", "DEG", kFrame, "vertical angle of view in degrees (a mesh: 40)",
     [](O& o, const R& r, const S& v) { o.fov = number(r, v, kFovDegrees); }},
    {kView, "--near", "", "D", kFrame, "nearest visible distance along the view (a mesh: from its bounds)",
     [](O& o, const R& r, const S& v) { o.near = number(r, v, kDistances); }},
    {kView, "--far", "", "D", kFrame, "furthest visible distance (likewise)",
     [](O& o, const R& r, const S& v) { o.far = number(r, v, kDistances); }},

    {kView, "--samples", "", "N", kFrame, "samples a pixel, 1 to 65536 (1: its middle)",
     [](O& o, const R& r, const S& v) { o.samples = integer(r, v, 1, kMostPixelSamples); }},
    {kView, "--filter", "", "NAME", kFrame, "how they become a colour: box, tent or mitchell (box)",
     [](O& o, const R& r, const S& v) {
       o.filter = one_of(r, v, {Filter::box, Filter::tent, Filter::mitchell});
     }},
    {kView, "--aperture", "", "D", kFrame,
     "diameter of the lens: what is not in focus blurs, given --samples\n(0: a pinhole)",
     [](O& o, const R& r, const S& v) { o.aperture = number(r, v, kApertures); }},
    {kView, "--focus", "", "D", kFrame, "distance, along the view, of what is sharp (a mesh: its middle)",
     [](O& o, const R& r, const S& v) { o.focus = number(r, v, kDistances); }},
    {kView, "--shutter", "", "A,B", kFrame, "the times at which it opens and closes: what moves blurs",
     [](O& o, const R& r, const S& v) { o.shutter = shutter(r, v); }},

    {kLight, "--sun", "", "X,Y,Z", kFrame, "the way the sun's light travels",
     [](O& o, const R& r, const S& v) { o.sun = direction(r, v); }},
    {kLight, "--background", "", "COLOR", kFrame,
     "what rays see that meet nothing: R,G,B, linear, or one number (the\n"
     "project's; 0.8 for a mesh)",
     [](O& o, const R& r, const S& v) { o.background = color(r, v); }},
    {kLight, "--effects", "", "LIST", kFrame,
     "out of shadows,reflection,refraction,ao; or none; or all (the\n"
     "project's; all for a mesh)",
     [](O& o, const R& r, const S& v) { o.effects = effects(r, v); }},
    {kLight, "--light-samples", "", "N", kFrame,
     "shadow rays from a point to every light with a size, 1 to 1024 (the\nproject's; each light's)",
     [](O& o, const R& r, const S& v) { o.light_samples = integer(r, v, 1, kMostLightSamples); }},
    {kLight, "--ao-samples", "", "N", kFrame, "ambient rays a point: a square number up to 1024 (16)",
     [](O& o, const R& r, const S& v) { o.ao_samples = samples(r, v); }},
    {kLight, "--ao-distance", "", "D", kFrame, "how far they reach (0.5; a mesh: 8 % of its diagonal)",
     [](O& o, const R& r, const S& v) { o.ao_distance = number(r, v, kDistances); }},
    {kLight, "--ao-exponent", "", "E", kFrame, "the free share is raised to this (1)",
     [](O& o, const R& r, const S& v) { o.ao_exponent = number(r, v, kExponents); }},
    {kLight, "--max-depth", "", "N", kFrame, "generations of reflected and refracted rays, 0 to 100 (5)",
     [](O& o, const R& r, const S& v) { o.max_depth = integer(r, v, 0, kMostDepth); }},
    {kLight, "--min-importance", "", "X", kFrame,
     "a path that weighs less is cut, 0 to 1 (0.005); what is below\n1/4096 counts as 1/4096",
     [](O& o, const R& r, const S& v) { o.min_importance = number(r, v, kImportances); }},
    {kLight, "--fresnel", "", "MODEL", kFrame, "exact, schlick or report (exact)",
     [](O& o, const R& r, const S& v) {
       o.fresnel = one_of(r, v, {Fresnel::exact, Fresnel::schlick, Fresnel::report});
     }},
    {kLight, "--terminator", "", "HOW", kFrame,
     "where shadow rays leave smooth meshes: facet, or smooth so that\n"
     "coarse facets do not show at the edge of the night side (facet)",
     [](O& o, const R& r, const S& v) {
       o.terminator = one_of(r, v, {Terminator::facet, Terminator::smooth});
     }},
    {kLight, "--seed", "", "N", kFrame, "another number, another noise (1)",
     [](O& o, const R& r, const S& v) { o.seed = seed(r, v); }},

    {kWork, "--threads", "", "N", kFrame, "workers, 1 to 1024 (one per processor); never changes a pixel",
     [](O& o, const R& r, const S& v) { o.threads = integer(r, v, 1, 1024); }},
    {kWork, "--isa", "", "NAME", kFrame,
     "auto, scalar, v2, avx2 or avx512 (auto: the widest); never changes\n"
     "a pixel",
     [](O& o, const R& r, const S& v) {
       o.isa = one_of(r, v, {Isa::automatic, Isa::scalar, Isa::v2, Isa::avx2, Isa::avx512});
     }},
    {kWork, "--primary", "", "HOW", kFrame, "what finds the visible surfaces: raster or trace (raster)",
     [](O& o, const R& r, const S& v) {
       o.primary = one_of(r, v, {Primary::raster, Primary::trace});
     }},
    {kWork, "--repeat", "", "R", kBench,
     "how often each pass is timed, after a run to warm up, 1 to 1000 (5)",
     [](O& o, const R& r, const S& v) { o.repeat = integer(r, v, 1, 1000); }},
    {kWork, "--layout", "", "NAME", kBench,
     "what the raster pass writes for each pixel: full (position, normal,\n"
     "flat albedo, material, triangle, depth) or min (packed normal,\n"
     "material, depth), with cut-outs taken as whole, so that another\n"
     "rasterizer can be asked for the same (full, with their holes)",
     [](O& o, const R& r, const S& v) {
       o.layout = one_of(r, v, {Layout::full, Layout::min});
     }},
    {kWork, "--mirror-all", "", "", kBench, "every surface is a perfect mirror",
     [](O& o, const R&, const S&) { o.mirror_all = true; }},
    {kWork, "--anchor", "", "", kBench,
     "rays that another tracer can repeat: opaque surfaces, geometric\n"
     "normals, a fixed offset, one mirrored ray from every surface",
     [](O& o, const R&, const S&) { o.anchor = true; }},
    {kWork, "--report", "", "", kBench,
     "instead of the passes: what each effect costs at every camera, and\n"
     "ambient occlusion with 1 to 100 samples",
     [](O& o, const R&, const S&) { o.report = true; }},

    {kTalk, "--stats", "", "FILE", kRender, "write times, rays and counts as JSON; - is standard output",
     [](O& o, const R& r, const S& v) { o.stats = name(r, v); }},
    {kTalk, "--json", "", "", kBench | kInfo, "print JSON", [](O& o, const R&, const S&) { o.json = true; }},
    {kTalk, "--quiet", "-q", "", kAll, "errors only: no progress, no summary, no warnings",
     [](O& o, const R&, const S&) { o.quiet = true; }},
    {kTalk, "--help", "-h", "", kAll, "this page", [](O&, const R&, const S&) {}},
    {kTalk, "--version", "", "", kAll, "print the version", [](O&, const R&, const S&) {}},
};

}  // namespace

std::span<const OptionRow> option_table() {
  return kTable;
}

const char* name_of(Isa isa) {
  switch (isa) {
    case Isa::automatic:
      return "auto";
    case Isa::scalar:
      return "scalar";
    case Isa::v2:
      return "v2";
    case Isa::avx2:
      return "avx2";
    case Isa::avx512:
      return "avx512";
  }
  return "";
}

const char* name_of(Fresnel fresnel) {
  switch (fresnel) {
    case Fresnel::exact:
      return "exact";
    case Fresnel::schlick:
      return "schlick";
    case Fresnel::report:
      return "report";
  }
  return "";
}

const char* name_of(Compositing compositing) {
  return compositing == Compositing::physical ? "physical" : "report";
}

const char* name_of(Layout layout) {
  return layout == Layout::full ? "full" : "min";
}

const char* name_of(Filter filter) {
  switch (filter) {
    case Filter::box:
      return "box";
    case Filter::tent:
      return "tent";
    case Filter::mitchell:
      return "mitchell";
  }
  return "";
}

const char* name_of(Primary primary) {
  return primary == Primary::raster ? "raster" : "trace";
}

const char* name_of(Terminator terminator) {
  return terminator == Terminator::facet ? "facet" : "smooth";
}

}  // namespace vitral
