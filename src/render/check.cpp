// What cannot be rendered is refused before anything is done.
#include "render/render.h"
#include "vitral/error.h"

#include <algorithm>
#include <cmath>

namespace vitral {

void check_settings(const Settings& s) {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw UsageError(what);
  };
  require(s.width >= 1 && s.width <= kMaxImageSide && s.height >= 1 && s.height <= kMaxImageSide,
          "the picture's size must be 1x1 to 16384x16384");
  require(s.crop.width == 0 || (s.crop.x >= 0 && s.crop.y >= 0 && s.crop.width > 0 && s.crop.height > 0 &&
                                s.crop.x <= s.width - s.crop.width && s.crop.y <= s.height - s.crop.height),
          "the crop must lie inside the picture");
  require(s.samples >= 1 && s.samples <= kMostPixelSamples, "the number of samples must be 1 to 65536");
  const int n = static_cast<int>(square_root(static_cast<float>(s.ao_samples)) + 0.5f);
  require(s.ao_samples >= 1 && s.ao_samples <= 1024 && n * n == s.ao_samples,
          "the number of ambient samples must be a square from 1 to 1024");
  require(s.ao_distance > 0 && std::isfinite(s.ao_distance), "the ambient distance must be greater than 0");
  require(s.ao_exponent > 0 && std::isfinite(s.ao_exponent), "the ambient exponent must be greater than 0");
  require(s.light_samples >= 0 && s.light_samples <= kMostLightSamples,
          "the number of light samples must be 0 (each light's own) to 1024");
  require(s.max_depth >= 0 && s.max_depth <= 100, "the depth limit must be 0 to 100");
  require(s.min_importance >= 0 && s.min_importance <= 1, "the least importance must be 0 to 1");
  require(s.threads >= 0 && s.threads <= 1024, "the number of threads must be 0 to 1024");
  for (const std::string& name : s.aovs) {
    require(std::find(std::begin(kAovNames), std::end(kAovNames), name) != std::end(kAovNames),
            "unknown auxiliary picture");
  }
}

static void check_motion(const Camera& c) {
  if (!(c.shutter_open <= c.shutter_close && std::isfinite(c.shutter_open) && std::isfinite(c.shutter_close)))
    throw UsageError("the shutter must not close before it opens");
  for (size_t i = 0; i < c.motion.size(); ++i) {
    const CameraKey& key = c.motion[i];
    if (!std::isfinite(key.time) || (i > 0 && !(key.time > c.motion[i - 1].time)))
      throw UsageError("the camera's keys must follow each other in time");
    Camera there = c;
    there.motion.clear();
    there.position = key.position, there.view = key.view, there.up = key.up;
    check_camera(there);
  }
}

void check_lights(const Scene& scene) {
  for (const Light& light : scene.lights) {
    if (!has_size(light)) continue;
    if (light.samples < 1 || light.samples > kMostLightSamples)
      throw UsageError("the number of a light's samples must be 1 to 1024");
    if (light.kind == Light::Kind::sphere && !(light.radius > 0 && std::isfinite(light.radius)))
      throw UsageError("the radius of a light must be greater than 0");
    if (light.kind == Light::Kind::sun && !(light.diameter_degrees > 0 && light.diameter_degrees <= 180))
      throw UsageError("the diameter of a sun must be greater than 0 and at most 180 degrees");
  }
}

void check_camera(const Camera& c) {
  const auto finite = [](const Vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
  };
  if (!finite(c.position) || !finite(c.view) || !finite(c.up))
    throw UsageError("the camera's vectors must be finite");
  if (!(length(cross(normalize(to_double(c.view)), normalize(to_double(c.up)))) > 1e-6)) {
    throw UsageError("the camera's up vector must not be zero or along its view");
  }
  if (!(c.fov > 0 && c.fov < 180)) throw UsageError("the field of view must be between 0 and 180 degrees");
  if (!(c.near > 0 && c.far > c.near && std::isfinite(c.far)))
    throw UsageError("the camera needs 0 < near < far");
  if (!(c.aperture >= 0 && std::isfinite(c.aperture))) throw UsageError("the aperture must not be negative");
  if (!(c.focus > 0 && std::isfinite(c.focus))) throw UsageError("the focus must be greater than 0");
  check_motion(c);
}

}  // namespace vitral
