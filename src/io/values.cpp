#include "io/values.h"

#include <charconv>
#include <cmath>
#include <system_error>
#include <vector>

namespace vitral {
namespace {

// std::from_chars knows no leading plus sign.
std::string_view without_plus(std::string_view text) {
  return text.size() > 1 && text[0] == '+' && text[1] != '-' ? text.substr(1) : text;
}

std::optional<std::vector<float>> parse_list(std::string_view text, Range range) {
  constexpr std::string_view kSpaces = " \t\r\n";
  std::vector<float> numbers;
  bool comma = false;  // one separates two numbers, and none stands at the ends
  for (;;) {
    const size_t begin = text.find_first_not_of(kSpaces);
    if (begin == std::string_view::npos) break;
    text.remove_prefix(begin);
    if (text[0] == ',') {
      if (comma || numbers.empty()) return {};
      comma = true;
      text.remove_prefix(1);
      continue;
    }
    const std::string_view word = text.substr(0, text.find_first_of(" \t\r\n,"));
    const std::optional<float> number = parse_number(word, range);
    if (!number || numbers.size() == 3) return {};
    numbers.push_back(*number);
    comma = false;
    text.remove_prefix(word.size());
  }
  if (comma) return {};
  return numbers;
}

}  // namespace

std::optional<float> parse_number(std::string_view text, Range range) {
  text = without_plus(text);
  float value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return {};
  if (value < range.least || value > range.most) return {};
  return value;
}

std::optional<long> parse_integer(std::string_view text, long least, long most) {
  text = without_plus(text);
  long value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc{} || end != text.data() + text.size()) return {};
  if (value < least || value > most) return {};
  return value;
}

std::optional<Vec3> parse_vector(std::string_view text, Range range) {
  const auto numbers = parse_list(text, range);
  if (!numbers || numbers->size() != 3) return {};
  return Vec3{(*numbers)[0], (*numbers)[1], (*numbers)[2]};
}

std::optional<Vec3> parse_color(std::string_view text, Range range) {
  const auto numbers = parse_list(text, range);
  if (numbers && numbers->size() == 1) return Vec3{(*numbers)[0], (*numbers)[0], (*numbers)[0]};
  return parse_vector(text, range);
}

std::optional<long> parse_samples(std::string_view text) {
  const std::optional<long> samples = parse_integer(text, 1, kMostSamples);
  for (long side = 1; samples && side * side <= *samples; ++side) {
    if (side * side == *samples) return samples;
  }
  return {};
}

std::string in_words(Range range) {
  const auto written = [](float number) {
    // A million is easier to read than 1e+06.
    const bool plain =
        number >= -1e6f && number <= 1e6f && number == static_cast<float>(static_cast<long>(number));
    char digits[32];
    char* const end = digits + sizeof digits;
    const auto result =
        plain ? std::to_chars(digits, end, static_cast<long>(number)) : std::to_chars(digits, end, number);
    return std::string(digits, result.ptr);
  };
  return "from " + written(range.least) + " to " + written(range.most);
}

std::optional<Fresnel> parse_fresnel(std::string_view text) {
  if (text == "exact") return Fresnel::exact;
  if (text == "schlick") return Fresnel::schlick;
  if (text == "report") return Fresnel::report;
  return {};
}

std::optional<Compositing> parse_compositing(std::string_view text) {
  if (text == "physical") return Compositing::physical;
  if (text == "report") return Compositing::report;
  return {};
}

std::optional<Filter> parse_filter(std::string_view text) {
  if (text == "box") return Filter::box;
  if (text == "tent") return Filter::tent;
  if (text == "mitchell") return Filter::mitchell;
  return {};
}

std::optional<Primary> parse_primary(std::string_view text) {
  if (text == "raster") return Primary::raster;
  if (text == "trace") return Primary::trace;
  return {};
}

std::optional<Terminator> parse_terminator(std::string_view text) {
  if (text == "facet") return Terminator::facet;
  if (text == "smooth") return Terminator::smooth;
  return {};
}

}  // namespace vitral
