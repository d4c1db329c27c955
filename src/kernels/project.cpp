// Brings vertices to the screen, a register at a time.
#include "raster/project.h"
#include "kernels/tables.h"
#include "simd/gather.h"
#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {

void project_vertices(const Projection& projection, const Vec3* positions, size_t count, ScreenVertex* out) {
  const auto project_register = [&projection](const Vec3* from, ScreenVertex* to) {
    Float p[4];
    load_records([from](int lane) { return &from[lane].x; }, p);
    const Vec3T<Double> v = project(projection, Vec3T<Double>{widen(p[0]), widen(p[1]), widen(p[2])});
    const Uint outside = outside_planes<Uint>(v, projection.near);
    const Mask seen = outside == Uint(0);
    const Double inverse_w = Double(1.0) / select(seen, v.z, Double(1.0));
    const auto place = [&](const Double& x) {
      return from_bits(fine_place<Int>(select(seen, x * inverse_w, Double(0.0))));
    };
    const Float record[4] = {place(v.x), place(v.y), select(seen, narrow(inverse_w), Float(0.0f)),
                             from_bits(outside)};
    store_records([to](int lane) { return &to[lane]; }, record);
  };

  // A position is read together with the number after it, which the last one does not have.
  size_t first = 0;
  for (; first + kLanes < count; first += kLanes) project_register(positions + first, out + first);
  Vec3 rest[kLanes + 1] = {};
  ScreenVertex last[kLanes];
  for (size_t i = first; i < count; ++i) rest[i - first] = positions[i];
  project_register(rest, last);
  for (size_t i = first; i < count; ++i) out[i] = last[i - first];
}

}  // namespace VITRAL_ISA
}  // namespace vitral
