// A rectangle of pixels, row by row from the top left.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace vitral {

template <class T>
struct Image {
  int width = 0, height = 0;
  std::vector<T> pixels;  // width * height

  Image() = default;
  Image(int w, int h, const T& fill = T{})
      : width(w), height(h), pixels(static_cast<size_t>(w) * static_cast<size_t>(h), fill) {}

  T* row(int y) { return pixels.data() + static_cast<size_t>(y) * static_cast<size_t>(width); }
  const T* row(int y) const { return pixels.data() + static_cast<size_t>(y) * static_cast<size_t>(width); }
};

struct Rgb8 {
  uint8_t r = 0, g = 0, b = 0;
};

}  // namespace vitral
