#include "kdtree/cut.h"

namespace vitral {
namespace {

// Corner k; the fourth lane, which lies in the next corner or the flags, is cleared.
Float4 corner(const KdTriangle& t, size_t k) {
  Float4 v;
  std::memcpy(&v, reinterpret_cast<const char*>(&t) + sizeof t.corner[0] * k, sizeof v);
  return keep(Int4{-1, -1, -1, 0}, v);
}

// A part's old bounds become `tight`, or stay when that is empty: then rounding emptied it, and no part
// of a triangle is ever lost.
void narrow(const Box4& part, Reference& r) {
  const Float4 min = greatest(part.min, lower(r)), max = least(part.max, upper(r));
  const Int4 inverted = min > max;
  if (inverted[0] | inverted[1] | inverted[2]) return;
  const uint32_t triangle = r.triangle;
  store4(r.min, min), store4(r.max, max);
  r.triangle = triangle, r.unused = 0;
}

}  // namespace

void cut(const KdTriangle& triangle, const Reference& whole, const Plane& plane, Reference& below,
         Reference& above) {
  const Float4 corners[3] = {corner(triangle, 0), corner(triangle, 1), corner(triangle, 2)};
  const float p = plane.position;
  const int axis = plane.axis;
  Box4 part[2];
  for (size_t k = 0; k < 3; ++k) {
    const Float4 a = corners[k], b = corners[(k + 1) % 3];
    const float at = triangle.corner[k][axis], bt = triangle.corner[(k + 1) % 3][axis];
    if (at <= p) extend(part[0], a, a);
    if (at >= p) extend(part[1], a, a);
    if ((at < p && bt > p) || (at > p && bt < p)) {
      // The point is a + s d. Its error is at most 5 units of d's last place (three roundings of s, one
      // of d, one of the product), one of the sum's; a denormal product may lose its last bit.
      const Float4 d = b - a, x = a + d * ((p - at) / (bt - at));
      const Float4 error = (absolute(d) * 0x1p-21f + absolute(x) * 0x1p-22f) + 0x1p-148f;
      const Float4 low = x - error, high = x + error;
      extend(part[0], low, high);
      extend(part[1], low, high);
    }
  }
  below = above = whole;
  below.max[axis] = above.min[axis] = p;
  narrow(part[0], below);
  narrow(part[1], above);
}

}  // namespace vitral
