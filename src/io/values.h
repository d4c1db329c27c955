// Values as they are written in project files and on the command line. Every function returns
// nothing when the text, taken whole, is not such a value or lies out of its range.
#pragma once
#include "vitral/render.h"
#include "vitral/vec.h"

#include <optional>
#include <string>
#include <string_view>

namespace vitral {

// Inclusive at both ends.
struct Range {
  float least, most;
};
std::string in_words(Range range);  // "from 0.01 to 179"
inline constexpr Range kCoordinates{-1e9f, 1e9f};
inline constexpr Range kDistances{1e-9f, 1e9f};
inline constexpr Range kFovDegrees{0.01f, 179};
inline constexpr Range kConeDegrees{0, 180};       // from the axis
inline constexpr Range kDiskDegrees{0.001f, 180};  // from edge to edge
inline constexpr Range kExponents{0.01f, 100};
inline constexpr Range kImportances{0, 1};
inline constexpr Range kIndices{1, 10};
inline constexpr Range kRadiances{0, 1e6f};
inline constexpr Range kTints{0, 1};
inline constexpr Range kAbsorptions{0, 1e6f};
inline constexpr Range kShininesses{0, 1e6f};
inline constexpr long kMostDepth = 100;
inline constexpr long kMostSamples = 1024;
inline constexpr Range kApertures{0, 1e6f};
inline constexpr Range kTimes{-1e6f, 1e6f};

// A finite decimal number.
std::optional<float> parse_number(std::string_view text, Range range);
std::optional<long> parse_integer(std::string_view text, long least, long most);

// Three numbers with commas or spaces between them; `parse_color` also takes one, for grey.
std::optional<Vec3> parse_vector(std::string_view text, Range range);
std::optional<Vec3> parse_color(std::string_view text, Range range);

// A square number in 1..kMostSamples: the side of the square is the number of strata.
std::optional<long> parse_samples(std::string_view text);

// Where a value was given it goes before what there is.
template <class T>
void override_with(const std::optional<T>& given, T& value) {
  if (given) value = *given;
}

std::optional<Fresnel> parse_fresnel(std::string_view text);          // exact, schlick, report
std::optional<Compositing> parse_compositing(std::string_view text);  // physical, report
std::optional<Filter> parse_filter(std::string_view text);            // box, tent, mitchell
std::optional<Primary> parse_primary(std::string_view text);          // raster, trace
std::optional<Terminator> parse_terminator(std::string_view text);    // facet, smooth

}  // namespace vitral
