#include "math/pinhole.h"

#include "math/elementary.h"

namespace vitral {

Pinhole make_pinhole(const Camera& camera, int width, int height) {
  const Vec3d forward = normalize(to_double(camera.view));
  const Vec3d right = normalize(cross(forward, to_double(camera.up)));
  const Vec3d up = cross(right, forward);
  const double half_height = tangent(static_cast<double>(camera.fov) * (3.14159265358979323846 / 360));
  const double step = 2 * half_height / height;
  return {camera.position,
          to_float(right),
          to_float(up),
          to_float(forward),
          static_cast<float>(step),
          static_cast<float>(step * width / 2),
          static_cast<float>(half_height),
          camera.near,
          camera.far,
          static_cast<float>(step)};
}

}  // namespace vitral
