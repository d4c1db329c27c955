#include "kdtree/cut.h"

namespace vitral {
namespace {

// Corner k; the fourth lane, which lies in the next corner or the flags, is cleared.
Float4 corner(const KdTriangle& t, size_t k) {
  Float4 v;
  std::memcpy(&v, reinterpret_cast<const char*>(&t) + sizeof t.corner[0] * k, sizeof v);
  return keep(Int4{-1, -1, -1, 0}, v);
}

// A vector whose lanes count where the mask is set. The others become NaN, over which extend() passes.
Float4 only(int32_t mask, const Float4& v) {
  return floats_of(bits_of(v) | ~Int4{mask, mask, mask, mask});
}

// Writes the bounds of `part` inside the old ones, or these when nothing is left: then rounding emptied
// it, and no part of a triangle is ever lost. The fourth lanes are those of the old bounds.
void narrow(const Box4& part, const Box4& old, Reference& r) {
  const Float4 min = greatest(part.min, old.min), max = least(part.max, old.max);
  const Int4 inverted = min > max;
  const int32_t stays = inverted[0] | inverted[1] | inverted[2];
  const Int4 narrowed = Int4{~stays, ~stays, ~stays, 0};
  store(select(narrowed, min, old.min), select(narrowed, max, old.max), r);
}

}  // namespace

void cut(const KdTriangle& triangle, const Reference& whole, const Plane& plane, Reference& below,
         Reference& above) {
  const Float4 corners[3] = {corner(triangle, 0), corner(triangle, 1), corner(triangle, 2)};
  const float p = plane.position;
  const int axis = plane.axis;

  // All three edges at once: which of them cross the plane, and which part s of the way along.
  const Float4 from{triangle.corner[0][axis], triangle.corner[1][axis], triangle.corner[2][axis], p};
  const Float4 to{from[1], from[2], from[0], p};
  const Int4 starts_below = from<p, starts_above = from> p;
  const Int4 crosses = (starts_below & (to > p)) | (starts_above & (to < p));
  const Float4 s = (p - from) / (to - from);

  // A crossing is a + s d. Its error is at most 5 units of d's last place (three roundings of s, one of
  // d, one of the product) and one of the sum's; a denormal product may lose its last bit.
  Box4 crossings, part_below, part_above;
  for (size_t k = 0; k < 3; ++k) {
    const Float4 a = corners[k], d = corners[(k + 1) % 3] - a, x = a + d * s[k];
    const Float4 error = (absolute(d) * 0x1p-21f + absolute(x) * 0x1p-22f) + 0x1p-148f;
    extend(crossings, only(crosses[k], x - error), only(crosses[k], x + error));
    const Float4 in_below = only(~starts_above[k], a), in_above = only(~starts_below[k], a);
    extend(part_below, in_below, in_below);
    extend(part_above, in_above, in_above);
  }
  extend(part_below, crossings.min, crossings.max);
  extend(part_above, crossings.min, crossings.max);

  const Int4 across = Int4{0, 1, 2, 3} == axis;
  const Box4 old{lower(whole), upper(whole)};
  narrow(part_below, {old.min, select(across, splat(p), old.max)}, below);
  narrow(part_above, {select(across, splat(p), old.min), old.max}, above);
}

}  // namespace vitral
