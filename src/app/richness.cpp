#include "app/richness.h"

#include "render/render.h"

#include <algorithm>
#include <memory>

namespace vitral {

std::function<Richness(const Camera&)> triangle_counter(const Scene& scene, const Settings& settings,
                                                        Control& control) {
  // Only what is seen, no rays: the rasterizer needs no tree.
  Settings small = settings;
  const int longer = std::max(settings.width, settings.height);
  constexpr int kSide = 96;
  small.width = std::max(1, settings.width * kSide / longer);
  small.height = std::max(1, settings.height * kSide / longer);
  small.crop = {};
  small.effects = {false, false, false, false};
  small.primary = Primary::raster;
  small.aovs = {"primitive"};
  const auto pool = std::make_shared<ThreadPool>(settings.threads);
  const auto accelerator = std::make_shared<Accelerator>();
  gather_triangles(scene, *pool, *accelerator);
  return [&scene, &control, small, pool, accelerator](const Camera& camera) {
    const Frame frame = render_frame(scene, *accelerator, camera, small, *pool, control);
    std::vector<float> seen;
    for (const Vec3& pixel : frame.aovs.at(0).pixels.pixels) seen.push_back(pixel.x);
    std::sort(seen.begin(), seen.end());
    const auto triangles = static_cast<size_t>(std::unique(seen.begin(), seen.end()) - seen.begin());
    return Richness{triangles, frame.stats.covered_pixels};
  };
}

}  // namespace vitral
