// A camera and light for a mesh that comes with none: the whole of it in the picture, seen from the
// front, the right and above, lit from the left.
#pragma once
#include "vitral/scene.h"

#include <optional>

namespace vitral {

// What the user fixes of an automatic camera; the rest follows the bounds.
struct ViewWishes {
  std::optional<Vec3> eye, view, up;
  std::optional<float> fov, near, far;
};

// The share of the picture's half width or half height that the bounds fill, in the tighter of the
// two dimensions, when the camera may choose where it stands.
inline constexpr float kFrameFill = 0.9f;

// Puts the eight corners of the bounds between near and far and, unless the eye is fixed, inside the
// picture of width / height = aspect. `bounds` is not empty; flat ones and single points will do.
// Throws UsageError when the wishes contradict one another.
Camera auto_camera(const Box& bounds, float aspect, const ViewWishes& wishes);

// Sun, ambient light and a light grey background for what `camera` sees.
void light_automatically(const Camera& camera, Scene& scene);

// How far ambient rays reach in a mesh that has these bounds.
float auto_ao_distance(const Box& bounds);

}  // namespace vitral
