// From linear light to the bytes of the picture.
#include "math/srgb.h"
#include "render/frame.h"

namespace vitral {
namespace {

Rgb8 encode_pixel(Vec3& color, uint64_t& not_finite) {
  const float sum = (absolute(color.x) + absolute(color.y)) + absolute(color.z);
  if (!(sum < std::numeric_limits<float>::infinity())) {
    ++not_finite;
    color = {1, 0, 0};
  }
  return {linear_to_srgb8(color.x), linear_to_srgb8(color.y), linear_to_srgb8(color.z)};
}

}  // namespace

void encode_row(Vec3* colors, size_t count, Rgb8* pixels, uint64_t& not_finite) {
  Rgb8 pixel;
  for (size_t i = 0; i < count; ++i) {
    if (i == 0 || !(colors[i] == colors[i - 1])) pixel = encode_pixel(colors[i], not_finite);
    pixels[i] = pixel;
  }
}

}  // namespace vitral
