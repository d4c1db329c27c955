// Compares two pictures exactly.
#pragma once
#include "vitral/image.h"
#include "vitral/render.h"

#include <cstddef>

namespace vitral {

struct Difference {
  size_t pixels = 0;    // that differ in any channel
  int largest = 0;      // of all channels, 1..255; 0 when the pictures are equal
  Rectangle box;        // of the pixels that differ; empty when none does
  Image<Rgb8> picture;  // |a - b| per channel, scaled so that the largest is 255; black when equal
};

// The pictures have the same size.
Difference compare(const Image<Rgb8>& a, const Image<Rgb8>& b);

}  // namespace vitral
