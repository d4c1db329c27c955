// Is the mean of random pictures the one expected? A z-test of every pixel and channel.
#pragma once
#include "support.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace vitral::test {

// Means and variances of the colours of pictures that differ only in their seeds, pixel by pixel.
struct PictureSum {
  size_t count = 0;
  int samples = 1;                   // of a pixel in each picture
  std::vector<double> sum, squares;  // three a pixel

  void add(const std::vector<Vec3>& pixels) {
    sum.resize(3 * pixels.size()), squares.resize(3 * pixels.size());
    ++count;
    for (size_t i = 0; i < pixels.size(); ++i) {
      const float rgb[3] = {pixels[i].x, pixels[i].y, pixels[i].z};
      for (size_t k = 0; k < 3; ++k) {
        const double value = static_cast<double>(rgb[k]);
        sum[3 * i + k] += value, squares[3 * i + k] += value * value;
      }
    }
  }
  double mean(size_t i) const { return sum[i] / static_cast<double>(count); }
  // Of the mean.
  double variance(size_t i) const {
    const double n = static_cast<double>(count), m = mean(i);
    return std::max((squares[i] / n - m * m) / (n - 1), 0.0);
  }
  // What is seen rarely may not have been seen at all: a mean is uncertain by at least half of one sample's
  // white.
  double least_variance() const {
    const double all = static_cast<double>(count) * samples;
    return 0.25 / (all * all);
  }
};

// The largest |difference of means| / sqrt(sum of their variances) that may occur among `tests` of them at a
// significance of one in a thousand for all together (Sidak 1967), found from the normal distribution.
inline double critical_z(size_t tests) {
  const double each = 1 - std::pow(1 - 1e-3, 1 / static_cast<double>(tests));
  double low = 0, high = 40;
  for (int i = 0; i < 100; ++i) {
    const double z = (low + high) / 2;
    (std::erfc(z / std::sqrt(2.0)) > each ? low : high) = z;
  }
  return high;
}

// The greatest z over all pixels and channels. Rounding is let pass: differences below 1e-5 count as none.
inline double greatest_z(const PictureSum& a, const PictureSum& b) {
  double greatest = 0;
  for (size_t i = 0; i < a.sum.size(); ++i) {
    const double difference = std::abs(a.mean(i) - b.mean(i));
    if (difference < 1e-5) continue;
    greatest = std::max(greatest,
                        difference / std::sqrt(std::max(a.variance(i), a.least_variance()) + b.variance(i)));
  }
  return greatest;
}
inline double greatest_z(const PictureSum& a, const std::vector<Vec3>& expected) {
  PictureSum exact;
  for (int i = 0; i < 2; ++i) exact.add(expected);
  return greatest_z(a, exact);
}

}  // namespace vitral::test
