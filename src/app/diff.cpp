#include "app/diff.h"

#include "app/commands.h"
#include "io/image_file.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace vitral {

Difference compare(const Image<Rgb8>& a, const Image<Rgb8>& b) {
  Difference result;
  result.picture = Image<Rgb8>(a.width, a.height);
  int left = a.width, top = a.height, right = 0, bottom = 0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      const Rgb8 p = a.row(y)[x], q = b.row(y)[x];
      const int red = std::abs(p.r - q.r), green = std::abs(p.g - q.g), blue = std::abs(p.b - q.b);
      const int largest = std::max({red, green, blue});
      if (largest == 0) continue;
      ++result.pixels;
      result.largest = std::max(result.largest, largest);
      left = std::min(left, x);
      right = std::max(right, x + 1);
      top = std::min(top, y);
      bottom = std::max(bottom, y + 1);
      result.picture.row(y)[x] = {static_cast<uint8_t>(red), static_cast<uint8_t>(green),
                                  static_cast<uint8_t>(blue)};
    }
  }
  if (result.pixels == 0) return result;
  result.box = {left, top, right - left, bottom - top};
  const auto scaled = [&](uint8_t c) { return static_cast<uint8_t>(c * 255 / result.largest); };
  for (Rgb8& c : result.picture.pixels) c = {scaled(c.r), scaled(c.g), scaled(c.b)};
  return result;
}

int run_diff(const Options& options) {
  const std::string &first = options.inputs[0], &second = options.inputs[1];
  if (!options.output.empty()) check_output(options.output, options.inputs);
  const Image<Rgb8> a = read_png(first), b = read_png(second);

  // The report goes beside the picture when that takes standard output.
  std::FILE* report = options.output == "-" ? stderr : stdout;
  if (a.width != b.width || a.height != b.height) {
    if (!options.quiet) {
      std::fprintf(report, "sizes differ: %dx%d and %dx%d\n", a.width, a.height, b.width, b.height);
    }
    return kDifferent;
  }
  const Difference difference = compare(a, b);
  if (!options.output.empty()) write_png(options.output, difference.picture);
  if (!options.quiet && difference.pixels == 0)
    std::fprintf(report, "equal: %dx%d pixels\n", a.width, a.height);
  if (!options.quiet && difference.pixels > 0) {
    std::fprintf(report, "%zu of %zu pixels differ, by at most %d of 255, in %d,%d,%dx%d\n",
                 difference.pixels, a.pixels.size(), difference.largest, difference.box.x, difference.box.y,
                 difference.box.width, difference.box.height);
  }
  return difference.pixels == 0 ? kDone : kDifferent;
}

}  // namespace vitral
