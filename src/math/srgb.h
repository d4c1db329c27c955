// The sRGB transfer curve (IEC 61966-2-1), by tables made at compile time. The power comes
// from a fifth root: x^2.4 = x^2 * (x^2)^(1/5).
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace vitral {

// Newton's iteration for the fifth root of x in (0, 1].
constexpr double fifth_root(double x) {
  double r = 1;
  for (int i = 0; i < 200; ++i) {
    const double next = (4 * r + x / (r * r * r * r)) / 5;
    if (next >= r) break;
    r = next;
  }
  return r;
}

// Encoded value in [0, 1] to linear.
constexpr double srgb_to_linear(double s) {
  if (s <= 0.04045) return s / 12.92;
  const double y = (s + 0.055) / 1.055;
  return y * y * fifth_root(y * y);
}

// Linear value of each of the 256 codes.
inline constexpr std::array<float, 256> kLinearOfSrgb = [] {
  std::array<float, 256> table{};
  for (size_t i = 0; i < 256; ++i)
    table[i] = static_cast<float>(srgb_to_linear(static_cast<double>(i) / 255));
  return table;
}();

// Code i + 1 begins at this linear value, half way (in code) between its neighbours.
inline constexpr std::array<float, 255> kSrgbThresholds = [] {
  std::array<float, 255> table{};
  for (size_t i = 0; i < 255; ++i)
    table[i] = static_cast<float>(srgb_to_linear((static_cast<double>(i) + 0.5) / 255));
  return table;
}();

// The code at i / 4096. Thresholds lie more than 1/3300 apart, so that a value's code is that of the
// grid point below it or the next.
inline constexpr std::array<uint8_t, 4096> kSrgbOfGrid = [] {
  std::array<uint8_t, 4096> table{};
  size_t code = 0;
  for (size_t i = 0; i < 4096; ++i) {
    while (code < 255 && kSrgbThresholds[code] <= static_cast<float>(i) / 4096) ++code;
    table[i] = static_cast<uint8_t>(code);
  }
  return table;
}();

// The code of a linear value: the number of thresholds at or below it. Values outside [0, 1] and NaN
// are clamped (NaN to 0).
static inline uint8_t linear_to_srgb8(float x) {
  if (!(x > 0)) return 0;
  if (x >= 1) return 255;
  const uint8_t code = kSrgbOfGrid[static_cast<size_t>(x * 4096)];
  return code < 255 && x >= kSrgbThresholds[code] ? static_cast<uint8_t>(code + 1) : code;
}

}  // namespace vitral
