// From linear light to the bytes of the picture.
#include "math/srgb.h"
#include "render/frame.h"

namespace vitral {

Rgb8 encode_pixel(Vec3& color, uint64_t& not_finite) {
  const float sum = (absolute(color.x) + absolute(color.y)) + absolute(color.z);
  if (!(sum < std::numeric_limits<float>::infinity())) {
    ++not_finite;
    color = {1, 0, 0};
  }
  return {linear_to_srgb8(color.x), linear_to_srgb8(color.y), linear_to_srgb8(color.z)};
}

}  // namespace vitral
