// Writes what a block of pixels sees (layout.h).
#include "kernels/layout.h"

#include "kernels/facet.h"
#include "kernels/lanes.h"
#include "kernels/octahedral.h"
#include "kernels/tables.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

// A register of pixels.
struct Seen {
  Mask seen;
  Float depth;
  Vec3T<Float> position, normal;
};

// Calls body(g, pixels, number) for every register of the block; `number` is the triangle that all see, or
// kNoTriangle. Where nothing is seen, the numbers of `pixels` mean nothing.
template <class Body>
[[gnu::always_inline]] inline void for_each_register(const SurfaceView& scene, const Pinhole& camera, int x,
                                                     int y, const uint32_t* numbers, const Body& body) {
  OneFacet one;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Mask seen = invert(load(numbers + g) == Uint(kNoTriangle));
    if (!any(seen)) {
      const Vec3T<Float> zero = broadcast(Vec3{0, 0, 0});
      body(g, Seen{seen, Float(0.0f), zero, zero}, kNoTriangle);
      continue;
    }
    const Vec3T<Float> direction = pixel_directions(camera, x, y, g);
    with_facets(
        scene, camera.origin, numbers + g, seen, one, [&](const Facet<Float, Mask>& f, uint32_t number) {
          const auto hit = visible_hit(f, direction, camera, seen);
          const Vec3T<Float> geometric = flip_where(looks_away_along(f.normal, direction, seen), f.normal);
          const Vec3T<Float> normal =
              any(f.smooth) ? interpolated_normal(f.corner_normal[0], f.corner_normal[1], f.corner_normal[2],
                                                  hit.u, hit.v, geometric, f.smooth)
                            : geometric;
          body(g, Seen{seen, hit.t, position_at(f, hit.u, hit.v), normal}, number);
        });
  }
}

inline void store_kept(float* p, Float v, Mask keep) {
  store(p, select(keep, v, Float(0.0f)));
}

}  // namespace

void write_full(const SurfaceView& scene, const Pinhole& camera, int x, int y, const uint32_t* numbers,
                FullBlock& out) {
  for_each_register(scene, camera, x, y, numbers, [&](int g, const Seen& s, uint32_t number) {
    store_kept(out.depth + g, s.depth, s.seen);
    store_kept(out.px + g, s.position.x, s.seen);
    store_kept(out.py + g, s.position.y, s.seen);
    store_kept(out.pz + g, s.position.z, s.seen);
    store_kept(out.nx + g, s.normal.x, s.seen);
    store_kept(out.ny + g, s.normal.y, s.seen);
    store_kept(out.nz + g, s.normal.z, s.seen);
    store(out.triangle + g, load(numbers + g));
    if (number != kNoTriangle) {
      const uint32_t material = scene.materials[number];
      store(out.material + g, Uint(material));
      store(out.albedo + g, Uint(scene.colors[material].rgba8));
      return;
    }
    store(out.material + g, Uint(kNoMaterial));
    store(out.albedo + g, Uint(0u));
    for (uint32_t left = bits(s.seen); left != 0; left &= left - 1) {
      const int lane = g + __builtin_ctz(left);
      const uint32_t material = scene.materials[numbers[lane]];
      out.material[lane] = material;
      out.albedo[lane] = scene.colors[material].rgba8;
    }
  });
}

void write_min(const SurfaceView& scene, const Pinhole& camera, int x, int y, const uint32_t* numbers,
               MinBlock& out) {
  for_each_register(scene, camera, x, y, numbers, [&](int g, const Seen& s, uint32_t number) {
    store_kept(out.depth + g, s.depth, s.seen);
    store(out.normal + g, select(s.seen, octahedral_normal(s.normal), Uint(0u)));
    if (number != kNoTriangle) {
      const uint16_t material = static_cast<uint16_t>(scene.materials[number]);
      for (int i = 0; i < kLanes; ++i) out.material[g + i] = material;
      return;
    }
    for (int i = 0; i < kLanes; ++i) {
      const uint32_t triangle = numbers[g + i];
      out.material[g + i] =
          triangle == kNoTriangle ? kNoMinMaterial : static_cast<uint16_t>(scene.materials[triangle]);
    }
  });
}

}  // namespace VITRAL_ISA
}  // namespace vitral
