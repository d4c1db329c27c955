// Texture lookup: bilinear, repeated, decoded to linear.
#pragma once
#include "vitral/scene.h"

namespace vitral {

Vec3 sample_color(const Texture& texture, Vec2 uv);
float sample_alpha(const Texture& texture, Vec2 uv);  // 0..1

}  // namespace vitral
