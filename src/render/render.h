// A frame over trees that are already built: for callers that render several, and for tests.
#pragma once
#include "render/accelerator.h"
#include "vitral/render.h"

namespace vitral {

// Throw UsageError when something is out of its range.
void check_settings(const Settings& settings);
void check_camera(const Camera& camera);
void check_lights(const Scene& scene);

// Objects that move are placed anew for every sample.
Frame render_frame(const Scene& scene, Accelerator& accelerator, const Camera& camera,
                   const Settings& settings, ThreadPool& pool, Control& control);

}  // namespace vitral
