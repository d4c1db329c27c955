// The triangles that a register of points lies on, and what those points are like.
//
// Neighbouring pixels mostly see the same triangle: what depends on it alone is then computed once, as plain
// numbers, and kept for the next register. Registers that see several look them up in a table of the
// block's, if these are no more than a register has lanes. Otherwise every lane's triangle is gathered and
// all is computed lane by lane. All ways are the same roundings in the same order.
#pragma once
#include "kernels/points.h"
#include "kernels/shading.h"
#include "kernels/visible.h"
#include "simd/gather.h"
#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {

// After the parameters of a lambda: its captures and arguments stay in registers.
#define VITRAL_INLINED __attribute__((always_inline))

inline constexpr uint32_t kAllLanes = static_cast<uint32_t>((uint64_t{1} << kLanes) - 1);

// The last triangle that a whole register saw.
struct OneFacet {
  uint32_t triangle = kNoTriangle;
  Facet<float, bool> facet{};
};

static inline Vec3T<Float> broadcast(const Vec3& v) {
  return {Float(v.x), Float(v.y), Float(v.z)};
}

static inline Vec3 corner_of(const KdTriangle& t, int k) {
  return {t.corner[k][0], t.corner[k][1], t.corner[k][2]};
}

static inline bool is_flat(const SurfaceView& scene, uint32_t triangle) {
  if (scene.normal_indices == nullptr) return true;
  const uint32_t* n = scene.normal_indices + size_t{3} * triangle;
  return n[0] == kNoIndex || n[1] == kNoIndex || n[2] == kNoIndex;
}

static inline void make_facet(const SurfaceView& scene, uint32_t triangle, const Vec3& eye, OneFacet& out) {
  if (out.triangle == triangle) return;
  out.triangle = triangle;
  Facet<float, bool>& f = out.facet;
  const KdTriangle& t = scene.triangles[triangle];
  const float more_offset = scene.more_offset == nullptr ? 0.0f : scene.more_offset[triangle];
  set_corners(corner_of(t, 0), corner_of(t, 1), corner_of(t, 2), eye, more_offset, f);
  f.smooth = !is_flat(scene, triangle);
  for (int k = 0; k < 3; ++k) {
    f.corner_normal[k] =
        f.smooth ? scene.normals[scene.normal_indices[size_t{3} * triangle + static_cast<size_t>(k)]]
                 : Vec3{0, 0, 1};
  }
}

[[gnu::always_inline]] static inline Facet<Float, Mask> broadcast(const Facet<float, bool>& f) {
  return {broadcast(f.a),
          broadcast(f.ab),
          broadcast(f.ac),
          {broadcast(f.from_eye[0]), broadcast(f.from_eye[1]), broadcast(f.from_eye[2])},
          broadcast(f.normal),
          Float(f.offset),
          {broadcast(f.corner_normal[0]), broadcast(f.corner_normal[1]), broadcast(f.corner_normal[2])},
          mask_of_bits(f.smooth ? kAllLanes : 0)};
}

// `numbers` has a triangle in every lane; only the first `count` matter.
[[gnu::always_inline]] static inline Facet<Float, Mask> gather_facet(const SurfaceView& scene,
                                                                     const uint32_t* numbers, int count,
                                                                     const Vec3& eye) {
  constexpr size_t stride = sizeof(KdTriangle) / sizeof(float);
  Facet<Float, Mask> f;
  Vec3T<Float> corner[3];
  for (int k = 0; k < 3; ++k) {
    gather3(scene.triangles->corner[k], stride, numbers, corner[k].x, corner[k].y, corner[k].z);
  }
  alignas(64) float more_offset[kLanes] = {};
  for (int i = 0; scene.more_offset != nullptr && i < count; ++i)
    more_offset[i] = scene.more_offset[numbers[i]];
  set_corners(corner[0], corner[1], corner[2], broadcast(eye), load(more_offset), f);
  uint32_t smooth = 0;
  uint32_t index[3][kLanes] = {};
  if (scene.normal_indices != nullptr) {
    for (int i = 0; i < count; ++i) {
      if (is_flat(scene, numbers[i])) continue;
      smooth |= 1u << i;
      for (int k = 0; k < 3; ++k)
        index[k][i] = scene.normal_indices[size_t{3} * numbers[i] + static_cast<size_t>(k)];
    }
  }
  f.smooth = mask_of_bits(smooth);
  for (int k = 0; k < 3; ++k) {
    f.corner_normal[k] = broadcast(Vec3{0, 0, 1});
    if (smooth != 0)
      gather3(&scene.normals->x, 3, index[k], f.corner_normal[k].x, f.corner_normal[k].y,
              f.corner_normal[k].z);
  }
  return f;
}

// The triangles of a block, each once.
struct FacetTable {
  enum class State { unknown, made, too_many } state = State::unknown;
  Facet<Float, Mask> facet;
  alignas(64) uint32_t place[kPacketSize];  // of each pixel's triangle in the table
};

// Many small triangles lie scattered in memory: all are asked for before the first is used.
static inline void prefetch_facets(const SurfaceView& scene, const uint32_t* numbers) {
  for (int i = 0; i < kPacketSize; ++i) {
    if (numbers[i] == kNoTriangle) continue;
    __builtin_prefetch(scene.triangles + numbers[i]);
    if (scene.normal_indices != nullptr) __builtin_prefetch(scene.normal_indices + size_t{3} * numbers[i]);
  }
}

// `numbers` are those of the block's pixels; kNoTriangle counts as the triangle of some other pixel.
[[gnu::noinline]] static inline void make_table(const SurfaceView& scene, const uint32_t* numbers,
                                                const Vec3& eye, FacetTable& table) {
  uint64_t left = 0;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    left |= static_cast<uint64_t>(bits(invert(load(numbers + g) == Uint(kNoTriangle)))) << g;
    store(table.place + g, Uint(0));
  }
  alignas(64) uint32_t different[kLanes] = {};
  uint32_t count = 0;
  table.state = FacetTable::State::too_many;
  const int all = __builtin_popcountll(left);
  for (; left != 0; ++count) {
    // Half of the places taken and not half of the pixels: it will not do.
    if (count == kLanes || (count == kLanes / 2 && 2 * __builtin_popcountll(left) > all)) {
      prefetch_facets(scene, numbers);
      return;
    }
    const uint32_t number = numbers[__builtin_ctzll(left)];
    different[count] = number;
    for (int g = 0; g < kPacketSize; g += kLanes) {
      const Mask same = load(numbers + g) == Uint(number);
      left &= ~(static_cast<uint64_t>(bits(same)) << g);
      store(table.place + g, select(same, Uint(count), load(table.place + g)));
    }
  }
  for (uint32_t i = count; i < kLanes; ++i) different[i] = different[0];
  table.facet = gather_facet(scene, different, static_cast<int>(count), eye);
  table.state = FacetTable::State::made;
}

static inline Vec3T<Float> pick(const Vec3T<Float>& table, Uint place) {
  return {pick(table.x, place), pick(table.y, place), pick(table.z, place)};
}

[[gnu::always_inline]] static inline Facet<Float, Mask> look_up(const FacetTable& table, int g) {
  const Facet<Float, Mask>& f = table.facet;
  const Uint place = load(table.place + g);
  return {pick(f.a, place),
          pick(f.ab, place),
          pick(f.ac, place),
          {pick(f.from_eye[0], place), pick(f.from_eye[1], place), pick(f.from_eye[2], place)},
          pick(f.normal, place),
          pick(f.offset, place),
          {pick(f.corner_normal[0], place), pick(f.corner_normal[1], place), pick(f.corner_normal[2], place)},
          pick(select(f.smooth, Uint(1), Uint(0)), place) == Uint(1)};
}

// Calls body(facet, number) for the triangles of a register of points from g on, at least one of which is
// `seen`. The lanes that are not get another one's triangle. `number` is the triangle of all lanes, or
// kNoTriangle.
template <class Body>
[[gnu::always_inline]] static inline void with_facets(const SurfaceView& scene, const Vec3& eye,
                                                      const uint32_t* block, int g, Mask seen, OneFacet& one,
                                                      FacetTable& table, const Body& body) {
  const uint32_t* numbers = block + g;
  const uint32_t first = numbers[__builtin_ctz(bits(seen))];
  const Uint number = select(seen, load(numbers), Uint(first));
  if (bits(number == Uint(first)) == kAllLanes) {
    make_facet(scene, first, eye, one);
    body(broadcast(one.facet), first);
    return;
  }
  if (table.state == FacetTable::State::unknown) make_table(scene, block, eye, table);
  if (table.state == FacetTable::State::too_many) {
    alignas(64) uint32_t valid[kLanes];
    store(valid, number);
    table.facet = gather_facet(scene, valid, kLanes, eye);
    store(table.place + g, lane_numbers());
  }
  body(look_up(table, g), kNoTriangle);
}

// Exactly whether the front looks away from a viewer who sees the point along `direction`; `viewer` is the
// unit vector that way, rounded.
static inline Mask looks_away(const Vec3T<Float>& normal, const Vec3T<Float>& viewer) {
  return dot(normal, viewer) < Float(0.0f);
}

// The same, without the viewer unless it matters: both dot products are off by less than 2^-20 of the
// direction's length, so that far from 0 their signs are opposite.
static inline Mask looks_away_along(const Vec3T<Float>& normal, const Vec3T<Float>& direction, Mask wanted) {
  const Float along = dot(normal, direction);
  const Float margin =
      ((absolute(direction.x) + absolute(direction.y)) + absolute(direction.z)) * Float(1e-5f);
  if (bits(either(absolute(along) > margin, invert(wanted))) == kAllLanes) return along > Float(0.0f);
  return looks_away(normal, -normalize(direction));
}

static inline Vec3T<Float> position_at(const Facet<Float, Mask>& f, Float u, Float v) {
  return (f.a + f.ab * u) + f.ac * v;
}

static inline NormalSum<Float, Mask> normal_sum_at(const Facet<Float, Mask>& f, Float u, Float v) {
  return sum_normals(f.corner_normal[0], f.corner_normal[1], f.corner_normal[2], u, v, f.smooth);
}

// The pixels of a register within the block at (x, y), g their first lane.
static inline Vec3T<Float> pixel_directions(const Pinhole& camera, int x, int y, int g) {
  const Uint pixel = lane_numbers() + Uint(static_cast<uint32_t>(g));
  const Float px = to_float(Uint(static_cast<uint32_t>(x)) + (pixel & Uint(7u)));
  const Float py = to_float(Uint(static_cast<uint32_t>(y)) + (pixel >> 3));
  return primary_direction(camera, px, py);
}

// A block of pixels at (x, y) and the triangles they see.
struct SeenBlock {
  const SurfaceView& scene;
  const Pinhole& camera;
  int x, y;
  const uint32_t* numbers;
};

struct VisiblePoint {
  Float t, u, v;
};

// Replaces the points of the lanes from g on whose rays miss their triangles.
[[gnu::noinline]] static inline void correct_misses(const SeenBlock& block, int g, uint32_t missed, float* t,
                                                    float* u, float* v) {
  for (; missed != 0; missed &= missed - 1) {
    const int lane = __builtin_ctz(missed), pixel = g + lane;
    const auto point = vitral::visible_point(block.camera, block.scene.triangles[block.numbers[pixel]],
                                             block.x + pixel % kBlockSide, block.y + pixel / kBlockSide);
    t[lane] = point.t, u[lane] = point.u, v[lane] = point.v;
  }
}

// Where rays from the eye meet triangles whose corners are given from there. Nearly always all lanes have one
// dominant axis.
[[gnu::always_inline]] static inline TriangleHit<Float, Mask> meet_from_eye(const Vec3T<Float> corner[3],
                                                                            const Vec3T<Float>& d) {
  const Float x = absolute(d.x), y = absolute(d.y), z = absolute(d.z);
  const Mask x_over_y = x > y;
  const Mask along_x = both(x_over_y, x > z), along_y = both(invert(x_over_y), y > z);
  Vec3T<Float> p[4] = {corner[0], corner[1], corner[2], d};
  if (any(either(along_x, along_y))) {
    for (Vec3T<Float>& each : p)
      each = select3(along_x, permute(each, 0), select3(along_y, permute(each, 1), each));
  }
  const Shear<Float> shear = make_shear(p[3]);
  auto hit = surround_origin(project(p[0], shear), project(p[1], shear), project(p[2], shear), shear);
  hit.hit = both(hit.hit, hit.t > Float(0.0f));
  return hit;
}

// Where the camera's rays through a register of pixels meet their facets (visible.h). Nearly always all do.
[[gnu::always_inline]] static inline VisiblePoint visible_points(const SeenBlock& block, int g,
                                                                 const Facet<Float, Mask>& f,
                                                                 const Vec3T<Float>& d, Mask seen) {
  const auto hit = meet_from_eye(f.from_eye, d);
  const uint32_t missed = bits(both(seen, invert(hit.hit)));
  if (missed == 0) return {hit.t, hit.u, hit.v};
  alignas(64) float t[kLanes], u[kLanes], v[kLanes];
  store(t, hit.t), store(u, hit.u), store(v, hit.v);
  correct_misses(block, g, missed, t, u, v);
  return {load(t), load(u), load(v)};
}

// For every register of the block's pixels from g on: body(g, seen, facet, point, direction, number) where
// any sees a triangle, nothing(g) where none does; `number` as above.
template <class Body, class Nothing>
[[gnu::always_inline]] static inline void for_each_visible(const SeenBlock& block, const Nothing& nothing,
                                                           const Body& body) {
  OneFacet one;
  FacetTable table;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Mask seen = invert(load(block.numbers + g) == Uint(kNoTriangle));
    if (!any(seen)) {
      nothing(g);
      continue;
    }
    const Vec3T<Float> direction = pixel_directions(block.camera, block.x, block.y, g);
    with_facets(block.scene, block.camera.origin, block.numbers, g, seen, one, table,
                [&](const Facet<Float, Mask>& facet, uint32_t number) VITRAL_INLINED {
                  body(g, seen, facet, visible_points(block, g, facet, direction, seen), direction, number);
                });
  }
}

}  // namespace VITRAL_ISA
}  // namespace vitral
