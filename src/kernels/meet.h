// Rays of a packet meet a triangle: the test that every traversal ends in. For a single ray it is
// that of kdtree/walk.cpp, and the bits are the same.
#pragma once
#include "kdtree/kdtree.h"
#include "kdtree/triangle.h"
#include "kernels/packet.h"
#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {

enum class Query { closest, any };

// The packet's rays as the triangle test wants them.
struct alignas(64) Shears {
  float sx[kPacketSize], sy[kPacketSize], sz[kPacketSize];
  uint64_t z_is[3];    // rays whose dominant axis is x, y, z
  uint64_t traceable;  // of the live rays
  float reach;         // largest absolute coordinate of their origins
};

static inline Mask group_mask(uint64_t lanes, int g) {
  return mask_of_bits(lanes >> g);
}
static inline bool group_empty(uint64_t lanes, int g) {
  constexpr uint64_t all = kLanes == 64 ? ~0ull : (1ull << kLanes) - 1;
  return ((lanes >> g) & all) == 0;
}

// Which rays can be traced at all, how far out their origins lie, and their shears.
static inline void derive_shears(const RayPacket& rays, Shears& d) {
  d.z_is[0] = d.z_is[1] = d.z_is[2] = d.traceable = 0;
  Float reach = Float(0.0f);
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(rays.live, g)) continue;
    const Vec3T<Float> o{load(rays.ox + g), load(rays.oy + g), load(rays.oz + g)};
    const Float x = load(rays.dx + g), y = load(rays.dy + g), z = load(rays.dz + g);
    const Mask good = both(is_traceable(o, Vec3T<Float>{x, y, z}), group_mask(rays.live, g));
    d.traceable |= static_cast<uint64_t>(bits(good)) << g;
    const Float farthest = greatest(absolute(o.x), greatest(absolute(o.y), absolute(o.z)));
    reach = greatest(select(good, farthest, Float(0.0f)), reach);

    const Float ax = absolute(x), ay = absolute(y), az = absolute(z);
    // As dominant_axis() decides it.
    const Mask x_over_y = ax > ay;
    const Mask is_x = both(x_over_y, ax > az);
    const Mask is_y = both(invert(x_over_y), ay > az);
    d.z_is[0] |= static_cast<uint64_t>(bits(is_x)) << g;
    d.z_is[1] |= static_cast<uint64_t>(bits(is_y)) << g;
    d.z_is[2] |= static_cast<uint64_t>(bits(invert(either(is_x, is_y)))) << g;
    const Vec3T<Float> permuted{select(is_x, y, select(is_y, z, x)), select(is_x, z, select(is_y, x, y)),
                                select(is_x, x, select(is_y, y, z))};
    const Shear<Float> shear = make_shear(permuted);
    store(d.sx + g, shear.x), store(d.sy + g, shear.y), store(d.sz + g, shear.z);
  }
  d.reach = greatest_lane(reach);
}

// The corner of a triangle as the rays of group g see it. When all rays run fastest along the same
// axis the permutation is a choice of pointers, else a choice per lane; the bits are the same.
struct Viewer {
  const float *ox, *oy, *oz;  // origins, permuted
  int kx, ky, kz;
};

static inline Vec3T<Float> relative_corner(const float* c, const Viewer& v, int g) {
  return {Float(c[v.kx]) - load(v.ox + g), Float(c[v.ky]) - load(v.oy + g), Float(c[v.kz]) - load(v.oz + g)};
}
static inline Vec3T<Float> relative_corner(const float* c, const RayPacket& p, int g, Mask is_x, Mask is_y) {
  const Float x = Float(c[0]) - load(p.ox + g), y = Float(c[1]) - load(p.oy + g),
              z = Float(c[2]) - load(p.oz + g);
  return {select(is_x, y, select(is_y, z, x)), select(is_x, z, select(is_y, x, y)),
          select(is_x, x, select(is_y, y, z))};
}

// Clears the lanes of `hit` where a cut-out triangle is not there.
static inline uint64_t keep_visible(const KdView& tree, uint32_t id, uint64_t hit, const Float& u,
                                    const Float& v) {
  alignas(64) float us[kLanes], vs[kLanes];
  store(us, u), store(vs, v);
  for (int lane = 0; lane < kLanes; ++lane) {
    if ((hit >> lane & 1) && !tree.cut_outs.is_there(tree.cut_outs.scene, id, us[lane], vs[lane]))
      hit &= ~(1ull << lane);
  }
  return hit;
}

// Tests one triangle against `lanes`; returns those that meet it (closest: and record it).
template <Query query, bool same_axis>
static uint64_t test_triangle(const KdView& tree, const RayPacket& rays, const Shears& d,
                              const Viewer& viewer, uint64_t lanes, uint32_t id, HitPacket* hits) {
  const KdTriangle& triangle = tree.triangles[id];
  uint64_t met = 0;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(lanes, g)) continue;
    const Shear<Float> shear{load(d.sx + g), load(d.sy + g), load(d.sz + g)};
    Vec3T<Float> corner[3];
    for (int k = 0; k < 3; ++k) {
      if constexpr (same_axis) {
        corner[k] = project(relative_corner(triangle.corner[k], viewer, g), shear);
      } else {
        corner[k] = project(
            relative_corner(triangle.corner[k], rays, g, group_mask(d.z_is[0], g), group_mask(d.z_is[1], g)),
            shear);
      }
    }
    Mask maybe = both(may_surround_origin(corner[0], corner[1], corner[2]), group_mask(lanes, g));
    if (!any(maybe)) continue;
    if constexpr (query == Query::any) {
      // Most hits are so clear that they need no double to be certain of.
      if (!(triangle.flags & kCutOutTriangle)) {
        const Mask sure =
            both(surely_meets(corner[0], corner[1], corner[2], shear, Float(rays.tmin), load(rays.tmax + g)),
                 maybe);
        met |= static_cast<uint64_t>(bits(sure)) << g;
        maybe = both(maybe, invert(sure));
        if (!any(maybe)) continue;
      }
    }

    const auto found = surround_origin(corner[0], corner[1], corner[2], shear);
    Mask hit = both(both(found.hit, maybe), both(found.t > Float(rays.tmin), found.t < load(rays.tmax + g)));
    if constexpr (query == Query::closest) {
      const Float best = load(hits->t + g);
      hit = both(hit, either(found.t < best, both(found.t == best, Uint(id) < load(hits->triangle + g))));
    }
    uint64_t hit_bits = bits(hit);
    if (hit_bits != 0 && (triangle.flags & kCutOutTriangle))
      hit_bits = keep_visible(tree, id, hit_bits, found.u, found.v);
    if (hit_bits == 0) continue;
    met |= hit_bits << g;
    if constexpr (query == Query::closest) {
      const Mask keep = mask_of_bits(hit_bits);
      store(hits->t + g, select(keep, found.t, load(hits->t + g)));
      store(hits->u + g, select(keep, found.u, load(hits->u + g)));
      store(hits->v + g, select(keep, found.v, load(hits->v + g)));
      store(hits->triangle + g, select(keep, Uint(id), load(hits->triangle + g)));
    }
  }
  return met;
}

// The pointers for rays that run fastest along the same axis; false when they do not.
static inline bool find_viewer(const RayPacket& rays, const Shears& d, uint64_t lanes, Viewer& viewer) {
  const float* origin[3] = {rays.ox, rays.oy, rays.oz};
  for (int z = 0; z < 3; ++z) {
    const int x = (z + 1) % 3, y = (z + 2) % 3;
    viewer = {origin[x], origin[y], origin[z], x, y, z};
    if ((lanes & ~d.z_is[z]) == 0) return true;
  }
  return false;
}

// Those of `lanes` that meet the triangle.
static inline uint64_t test_any(const KdView& tree, const RayPacket& rays, const Shears& d, uint64_t lanes,
                                uint32_t id) {
  Viewer viewer;
  return find_viewer(rays, d, lanes, viewer)
             ? test_triangle<Query::any, true>(tree, rays, d, viewer, lanes, id, nullptr)
             : test_triangle<Query::any, false>(tree, rays, d, viewer, lanes, id, nullptr);
}

}  // namespace VITRAL_ISA
}  // namespace vitral
