// Sets up triangles, a register at a time. Most triangles of a detailed mesh cover a pixel or two: for these
// it costs more to hand them from tile to cell to pixel than to try all pixels of their bounding box here.
// The stages, each over a whole batch with the triangles that are left side by side:
//   1. sort out: nothing to see; to be clipped or very large (the caller's); small; and all others
//   2. small ones: which of kSmallSide x kSmallSide pixels are covered, and how deep they are there
//   3. the others: the plane of their inverse depth
#include "kdtree/kdtree.h"
#include "kdtree/triangle.h"
#include "kernels/small_triangles.h"
#include "kernels/tables.h"
#include "raster/coverage.h"
#include "raster/project.h"
#include "raster/raster.h"
#include "simd/gather.h"
#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

constexpr uint32_t kBatchTriangles = 128;

// Triangles in a row, their corners in the order that makes the inside positive; as in ScreenVertex.
struct Queue {
  int32_t x[3][kBatchTriangles + 16], y[3][kBatchTriangles + 16];
  float inverse_depth[3][kBatchTriangles + 16];
  uint32_t number[kBatchTriangles + 16];
  uint32_t count;
};

// Triangles with sides under this many 1/256 pixels have their areas and edge values below 2^31.
constexpr int32_t kLongestSide = 1 << 15;

// The corners of triangles [first, first + kLanes), as far as they lie before `end`; in the other lanes
// some triangle's.
ScreenCorners load_corners(const SetupInput& in, uint32_t first, uint32_t end) {
  ScreenCorners c;
  Uint outside[3];
  for (size_t k = 0; k < 3; ++k) {
    Float v[4];
    load_records(
        [&](int lane) {
          const uint32_t t = first + static_cast<uint32_t>(lane);
          return reinterpret_cast<const float*>(in.vertices +
                                                in.corners[size_t{3} * (t < end ? t : first) + k]);
        },
        v);
    c.x[k] = as_int(v[0]), c.y[k] = as_int(v[1]), c.inverse_depth[k] = v[2], outside[k] = as_bits(v[3]);
  }
  c.outside_any = outside[0] | outside[1] | outside[2];
  c.outside_all = outside[0] & outside[1] & outside[2];
  return c;
}

Mask cut_outs_among(const SetupInput& in, uint32_t first, Mask asked) {
  uint32_t found = 0;
  for (uint32_t left = bits(asked); left != 0; left &= left - 1) {
    const uint32_t lane = static_cast<uint32_t>(__builtin_ctz(left));
    if ((in.flags_of[first + lane].flags & kCutOutTriangle) != 0) found |= 1u << lane;
  }
  return mask_of_bits(found);
}

inline uint32_t population(Mask m) {
  return static_cast<uint32_t>(__builtin_popcount(bits(m)));
}

void append(const ScreenCorners& c, Uint numbers, Mask m, Queue& queue) {
  const uint32_t n = queue.count;
  for (int k = 0; k < 3; ++k) {
    compress(queue.x[k] + n, c.x[k], m);
    compress(queue.y[k] + n, c.y[k], m);
    compress(queue.inverse_depth[k] + n, c.inverse_depth[k], m);
  }
  compress(queue.number + n, numbers, m);
  queue.count = n + population(m);
}

ScreenCorners queued(const Queue& queue, uint32_t g) {
  ScreenCorners c;
  for (int k = 0; k < 3; ++k) {
    c.x[k] = load(queue.x[k] + g), c.y[k] = load(queue.y[k] + g);
    c.inverse_depth[k] = load(queue.inverse_depth[k] + g);
  }
  return c;
}

template <class V>
inline void swap_where(Mask m, V& a, V& b) {
  const V old = a;
  a = select(m, b, old), b = select(m, old, b);
}

void sort_out(const SetupInput& in, uint32_t begin, uint32_t end, Queue& small, Queue& others,
              SetupOutput& out) {
  small.count = others.count = 0;
  const PixelBox& window = in.projection.window;
  for (uint32_t first = begin; first < end; first += kLanes) {
    const Uint numbers = Uint(first) + lane_numbers();
    ScreenCorners c = load_corners(in, first, end);
    const Mask seen = both(numbers < Uint(end), c.outside_all == Uint(0));
    const Mask on_screen = both(seen, c.outside_any == Uint(0));
    const Mask clipped = both(seen, invert(on_screen));

    const Int x[3] = {snapped(c.x[0]), snapped(c.x[1]), snapped(c.x[2])};
    const Int y[3] = {snapped(c.y[0]), snapped(c.y[1]), snapped(c.y[2])};
    const PixelBoxT<Int> box = centers_within(x, y);
    const Mask inside = both(both(greatest(box.x0, Int(window.x0)) < least(box.x1, Int(window.x1)),
                                  greatest(box.y0, Int(window.y0)) < least(box.y1, Int(window.y1))),
                             on_screen);
    const Float high = greatest_of(c.inverse_depth[0], c.inverse_depth[1], c.inverse_depth[2]);
    const Mask near_enough = both(inside, high >= Float(in.projection.least_inverse_depth));

    const Int longest = Int(kLongestSide / kSubpixels - 2);
    const Mask fits = both(box.x1 - box.x0 < longest, box.y1 - box.y0 < longest);
    Int side_x[3], side_y[3];  // as seen from corner 0; 0 in lanes that do not fit, which would overflow
    for (int k = 0; k < 3; ++k) {
      side_x[k] = select(fits, x[k] - x[0], Int(0));
      side_y[k] = select(fits, y[k] - y[0], Int(0));
    }
    const Int area = doubled_area<Int>(side_x, side_y);
    const Mask ordinary = both(both(near_enough, fits), invert(area == Int(0)));

    const Mask large = either(clipped, both(near_enough, invert(fits)));
    if (any(large)) {
      compress(out.others + out.other_count, numbers, large);
      out.other_count += population(large);
    }
    if (!any(ordinary)) continue;
    const Mask turned = area < Int(0);
    swap_where(turned, c.x[1], c.x[2]);
    swap_where(turned, c.y[1], c.y[2]);
    swap_where(turned, c.inverse_depth[1], c.inverse_depth[2]);
    const Int most = Int(kSmallSide);
    Mask is_small = both(ordinary, both(box.x1 - box.x0 <= most, box.y1 - box.y0 <= most));
    if (in.flags_of != nullptr) is_small = both(is_small, invert(cut_outs_among(in, first, is_small)));
    append(c, numbers, is_small, small);
    append(c, numbers, both(ordinary, invert(is_small)), others);
  }
}

inline Mask lanes_before(uint32_t g, uint32_t end) {
  return Uint(g) + lane_numbers() < Uint(end);
}

// The pixels of the small triangles.
void emit_fragments(const SetupInput& in, const Queue& queue, SetupOutput& out) {
  uint32_t n = out.fragment_count;
  for (uint32_t g = 0; g < queue.count; g += kLanes) {
    const ScreenCorners c = queued(queue, g);
    const Coverage coverage = find_coverage(in, c, lanes_before(g, queue.count));
    if (!coverage.any) continue;
    const SmallPlane plane = small_plane(c, coverage.x0, coverage.y0);
    const Uint number = load(queue.number + g);
    for (int p = 0; p < kSmallSide * kSmallSide; ++p) {
      Mask m = coverage.covered[p];
      if (!any(m)) continue;
      const int i = p % kSmallSide, j = p / kSmallSide;
      Float depth = (plane.at_corner + plane.across * Float(static_cast<float>(i))) +
                    plane.down * Float(static_cast<float>(j));
      depth = least(greatest(depth, plane.least), plane.greatest);
      m = both(m, depth >= Float(in.projection.least_inverse_depth));
      compress(out.inverse_depth + n, depth, m);
      compress(out.x_y + n, (coverage.x0 + Int(i)) | (coverage.y0 + Int(j)) * Int(1 << 16), m);
      compress(out.triangle + n, number, m);
      n += population(m);
    }
  }
  out.fragment_count = n;
}

void prefetch_positions(const SetupInput& in, const Queue& queue, uint32_t g) {
  for (uint32_t i = g; i < queue.count && i < g + kLanes; ++i) {
    for (size_t k = 0; k < 3; ++k)
      __builtin_prefetch(in.positions + in.corners[size_t{3} * queue.number[i] + k]);
  }
}

// The planes of the triangles in a queue from g on, as the scene has them: neither snapped nor turned.
InverseDepth<Double> planes(const SetupInput& in, const Queue& queue, uint32_t g, Float otherwise) {
  alignas(64) float x[3][kLanes], y[3][kLanes], z[3][kLanes];
  for (uint32_t lane = 0; lane < kLanes; ++lane) {
    const uint32_t* corner = in.corners + size_t{3} * queue.number[g + lane < queue.count ? g + lane : g];
    for (int k = 0; k < 3; ++k) {
      const Vec3& p = in.positions[corner[k]];
      x[k][lane] = p.x, y[k][lane] = p.y, z[k][lane] = p.z;
    }
  }
  Vec3T<Double> corner[3];
  for (int k = 0; k < 3; ++k) {
    corner[k] =
        project(in.projection, Vec3T<Double>{widen(load(x[k])), widen(load(y[k])), widen(load(z[k]))});
  }
  return inverse_depth_plane(corner[0], corner[1], corner[2], widen(otherwise));
}

inline void store_lanes(double* p, const Double& v) {
  __builtin_memcpy(p, &v, sizeof v);
}

// The triangles that are filled tile by tile.
void emit_triangles(const SetupInput& in, const Queue& queue, SetupOutput& out) {
  prefetch_positions(in, queue, 0);
  for (uint32_t g = 0; g < queue.count; g += kLanes) {
    prefetch_positions(in, queue, g + kLanes);
    const ScreenCorners c = queued(queue, g);
    const Float low = least_of(c.inverse_depth[0], c.inverse_depth[1], c.inverse_depth[2]);
    const Float high = greatest_of(c.inverse_depth[0], c.inverse_depth[1], c.inverse_depth[2]);
    const InverseDepth<Double> plane = planes(in, queue, g, low);
    alignas(64) double across[kLanes], down[kLanes], at_0[kLanes];
    store_lanes(across, plane.across), store_lanes(down, plane.down), store_lanes(at_0, plane.at_0);
    alignas(64) float lows[kLanes], highs[kLanes];
    store(lows, low), store(highs, high);
    for (uint32_t lane = 0; lane < kLanes && g + lane < queue.count; ++lane) {
      const uint32_t q = g + lane;
      SetupTriangle& t = out.triangles[out.triangle_count++];
      for (int k = 0; k < 3; ++k) t.x[k] = snapped(queue.x[k][q]), t.y[k] = snapped(queue.y[k][q]);
      t.triangle = queue.number[q];
      t.least = lows[lane], t.greatest = highs[lane];
      t.across = across[lane], t.down = down[lane], t.at_0 = at_0[lane];
    }
  }
}

}  // namespace

void setup_triangles(const SetupInput& in, uint32_t begin, uint32_t end, SetupOutput& out) {
  out.other_count = out.triangle_count = out.fragment_count = 0;
  for (uint32_t first = begin; first < end; first += kBatchTriangles) {
    Queue small, others;
    sort_out(in, first, first + kBatchTriangles < end ? first + kBatchTriangles : end, small, others, out);
    emit_fragments(in, small, out);
    emit_triangles(in, others, out);
  }
}

}  // namespace VITRAL_ISA
}  // namespace vitral
