// The visible points of a block of pixels.
#include "kernels/visible.h"

#include "kernels/facet.h"
#include "kernels/lanes.h"
#include "kernels/tables.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

void store_hit(HitPacket& hits, int g, Uint number, Mask seen, Float t, Float u, Float v) {
  store(hits.triangle + g, number);
  store(hits.t + g, select(seen, t, Float(kInfinity)));
  store(hits.u + g, select(seen, u, Float(0.0f)));
  store(hits.v + g, select(seen, v, Float(0.0f)));
}

}  // namespace

void intersect_visible(const Pinhole& camera, const KdTriangle* triangles, int x, int y,
                       const uint32_t* numbers, HitPacket& hits) {
  const SurfaceView scene{triangles, nullptr, nullptr, nullptr, nullptr};
  OneFacet one;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Uint number = load(numbers + g);
    const Mask seen = invert(number == Uint(kNoTriangle));
    if (!any(seen)) {
      store_hit(hits, g, number, seen, Float(0.0f), Float(0.0f), Float(0.0f));
      continue;
    }
    const Vec3T<Float> direction = pixel_directions(camera, x, y, g);
    with_facets(scene, camera.origin, numbers + g, seen, one, [&](const auto& facet, uint32_t) {
      const auto hit = visible_hit(facet, direction, camera, seen);
      store_hit(hits, g, number, seen, hit.t, hit.u, hit.v);
    });
  }
}

}  // namespace VITRAL_ISA
}  // namespace vitral
