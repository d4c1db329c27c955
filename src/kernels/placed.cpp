// The visible points of a block of pixels on placed meshes (visible.h), each in its object's space.
#include "kdtree/objects.h"
#include "kernels/facet.h"
#include "kernels/tables.h"
#include "kernels/visible.h"
#include "simd/gather.h"
#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

// The object that the last lanes saw.
struct Seen {
  const PlacedObject* object;
  const KdTriangle* triangles;
  Eye eye;
};

void look_at(const ObjectsView& view, const Pinhole& camera, uint32_t number, Seen& seen) {
  const auto has = [&](const PlacedObject& o) { return number - o.first_number < o.count; };
  if (seen.object != nullptr && has(*seen.object)) return;
  seen.object = view.objects + object_of(view, number);
  seen.triangles = view.models[seen.object->model].tree.triangles;
  seen.eye = eye_of(camera, seen.object);
}

void put_one(const Seen& seen, uint32_t number, int x, int y, int pixel, HitPacket& hits) {
  const auto p = vitral::visible_point(seen.eye, seen.triangles[number - seen.object->first_number],
                                       x + pixel % kBlockSide, y + pixel / kBlockSide);
  hits.t[pixel] = p.t, hits.u[pixel] = p.u, hits.v[pixel] = p.v;
}

// The lanes of the register from g on that see triangles of the object; `local` has a triangle of it in all.
void put_register(const Seen& seen, Uint local, Mask mine, int x, int y, int g, const uint32_t* numbers,
                  HitPacket& hits) {
  constexpr size_t stride = sizeof(KdTriangle) / sizeof(float);
  alignas(64) uint32_t rows[kLanes];
  store(rows, local);
  Vec3T<Float> corner[3];
  for (int k = 0; k < 3; ++k) {
    gather3(seen.triangles->corner[k], stride, rows, corner[k].x, corner[k].y, corner[k].z);
    corner[k] = corner[k] - broadcast(seen.eye.origin);
  }
  const Uint pixel = lane_numbers() + Uint(static_cast<uint32_t>(g));
  const Float px = to_float(Uint(static_cast<uint32_t>(x)) + (pixel & Uint(7u)));
  const Float py = to_float(Uint(static_cast<uint32_t>(y)) + (pixel >> 3));
  const auto hit = meet_from_eye(corner, direction_from(seen.eye, px, py));
  store(hits.t + g, select(mine, hit.t, load(hits.t + g)));
  store(hits.u + g, select(mine, hit.u, load(hits.u + g)));
  store(hits.v + g, select(mine, hit.v, load(hits.v + g)));
  for (uint32_t missed = bits(both(mine, invert(hit.hit))); missed != 0; missed &= missed - 1) {
    const int lane = g + __builtin_ctz(missed);
    put_one(seen, numbers[lane], x, y, lane, hits);
  }
}

}  // namespace

void intersect_placed(const ObjectsView& view, const Pinhole& camera, int x, int y, const uint32_t* numbers,
                      HitPacket& hits) {
  Seen seen{nullptr, nullptr, {nullptr, nullptr, {0, 0, 0}}};
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Uint number = load(numbers + g);
    Mask left = both(number >= Uint(view.first_number), number < Uint(view.end_number));
    store(hits.triangle + g, select(left, number, load(hits.triangle + g)));
    while (any(left)) {
      const int lane = g + __builtin_ctz(bits(left));
      look_at(view, camera, numbers[lane], seen);
      const Uint first = Uint(seen.object->first_number);
      const Mask mine = both(left, number - first < Uint(seen.object->count));
      left = both(left, invert(mine));
      if ((bits(mine) & (bits(mine) - 1)) == 0) {
        put_one(seen, numbers[lane], x, y, lane, hits);
      } else {
        const Uint local = select(mine, number - first, Uint(numbers[lane] - seen.object->first_number));
        put_register(seen, local, mine, x, y, g, numbers, hits);
      }
    }
  }
}

}  // namespace VITRAL_ISA
}  // namespace vitral
