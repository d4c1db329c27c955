// How much a view shows of a scene.
#pragma once
#include "app/auto_view.h"
#include "vitral/render.h"

#include <functional>

namespace vitral {

// Returns the function that counts the triangles to be seen from a camera in a small picture of these
// proportions. It refers to the scene. An interruption reaches it through `control`.
std::function<Richness(const Camera&)> triangle_counter(const Scene& scene, const Settings& settings,
                                                        Control& control);

}  // namespace vitral
