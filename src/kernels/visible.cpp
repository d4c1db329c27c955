// The visible points of a block of pixels.
#include "kernels/visible.h"

#include "kernels/facet.h"
#include "kernels/lanes.h"
#include "kernels/tables.h"

namespace vitral {
namespace VITRAL_ISA {

void intersect_visible(const Pinhole& camera, const KdTriangle* triangles, int x, int y,
                       const uint32_t* numbers, HitPacket& hits) {
  const SurfaceView scene{triangles, nullptr, nullptr, nullptr, nullptr};
  const auto put = [&](int g, Float t, Float u, Float v) {
    store(hits.triangle + g, load(numbers + g));
    store(hits.t + g, t), store(hits.u + g, u), store(hits.v + g, v);
  };
  const Float zero = Float(0.0f), far = Float(kInfinity);
  for_each_visible(
      {scene, camera, x, y, numbers}, [&](int g) { put(g, far, zero, zero); },
      [&](int g, Mask seen, const Facet<Float, Mask>&, const VisiblePoint& p, const Vec3T<Float>&, uint32_t) {
        put(g, select(seen, p.t, far), select(seen, p.u, zero), select(seen, p.v, zero));
      });
}

}  // namespace VITRAL_ISA
}  // namespace vitral
