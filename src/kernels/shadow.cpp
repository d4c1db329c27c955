// Shadows of a directional light, for the blocks of a tile at once.
//
// All rays run in one direction. In coordinates sheared along it, as the triangle test shears them, a
// ray is a point (x, y) and a depth z, a triangle is flat, and "does the ray meet it" is "is the point
// inside, and does the plane lie beyond its depth". The rays of a tile walk the tree together, from the
// light towards them: what the light meets first is what keeps it from most rays. A ray that is blocked takes
// no further part, and no node is visited that no open ray passes through.
//
// None of this decides what it cannot be sure of. Every comparison is by a margin that covers the
// rounding of both this file's arithmetic and the exact test's (kdtree/triangle.h); where it falls in
// between, the exact test is made. So the answer is that of the walk through the tree, ray for ray.
#include "kernels/counts.h"
#include "kernels/lanes.h"
#include "kernels/meet.h"
#include "kernels/points.h"
#include "kernels/shadow_cells.h"
#include "kernels/shaft.h"
#include "kernels/tables.h"
#include "kernels/trace.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

// --- the walk --------------------------------------------------------------------------------------

// So many triangles, and pairs of triangles and cells, are tried before the rays go on by packets: where
// triangles are far smaller than the distance between rays, most meet none.
inline constexpr int kMostEffort = 4096;

// Walks the tree from the light towards the rays, and tests what stands in the leaves. A node is skipped when
// no open ray passes through it.
template <class Counts>
Walked walk(const KdView& tree, const LightFrame& frame, GlassRule glass, float reach, ShadowCells& cells,
            Counts counts) {
  const Shaft shaft = make_shaft(tree, frame, cells.starts, reach);
  return walk_tile(
      tree, whole_part(tree, shaft, frame, cells.starts),
      [&](uint32_t node, Part& now, Waiting* stack, int& waiting) {
        const uint64_t mark = counts.mark();
        const uint32_t leaf = descend(tree, shaft, node, now, stack, waiting, counts);
        share_work(mark, cells, counts);
        return leaf;
      },
      [&](const uint32_t* ids, int count) {
        meet(tree, glass, ids, count, cells, counts);
        return cells.all_far == -kInfinity || cells.effort > kMostEffort ? Use::enough : Use::more;
      },
      [&](const Part& now) { return is_wanted(shaft, frame, cells, now); });
}

// --- a tile ----------------------------------------------------------------------------------------

// The directions' common shear, and a reference in the middle of the origins.
LightFrame make_frame(const Vec3& direction, const Box& box) {
  LightFrame f;
  f.kz = dominant_axis(direction);
  f.kx = (f.kz + 1) % 3, f.ky = (f.kz + 2) % 3;
  const Shear<float> s = make_shear(permute(direction, f.kz));
  f.sx = s.x, f.sy = s.y, f.forward = s.z > 0 ? 1.0f : -1.0f;
  f.reference = (box.min + box.max) * 0.5f;
  f.extent = largest_component(box.max - box.min);
  return f;
}

Box box_of(const RayPacket* rays, const uint64_t* lanes, int count) {
  BoxLanes box = no_box();
  for (int i = 0; i < count; ++i) {
    for (int g = 0; g < kPacketSize; g += kLanes)
      extend(box, group_mask(lanes[i], g), load3(rays[i].ox, rays[i].oy, rays[i].oz, g));
  }
  return as_box(box_of(box));
}

// The live rays that can be traced.
uint64_t traceable(const RayPacket& rays) {
  uint64_t lanes = 0;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Vec3T<Float> o{load(rays.ox + g), load(rays.oy + g), load(rays.oz + g)};
    const Vec3T<Float> d{load(rays.dx + g), load(rays.dy + g), load(rays.dz + g)};
    lanes |= static_cast<uint64_t>(bits(is_traceable(o, d))) << g;
  }
  return lanes & rays.live;
}

// Rays from all over the scene have little in common.
inline constexpr float kNarrow = 4;
bool is_narrow(const KdView& tree, const Box& box) {
  return largest_component(extent(box)) * kNarrow < largest_component(extent(tree.bounds));
}

// No ray is in a cell yet.
void start_cells(const LightFrame& frame, const RayPacket* rays, const uint64_t* lanes, int count,
                 ShadowCells& cells) {
  cells.frame = &frame, cells.rays = rays, cells.packets = count;
  cells.starts = bound_rays(frame, rays, lanes, count);
  cells.effort = 0, cells.bounded = false, cells.all_far = kInfinity;
  for (int i = 0; i < kMaxPackets; ++i) {
    cells.sheared[i] = false;
    for (int c = 0; c < kCellsOfPacket; ++c) {
      cells.live[i * kCellsOfPacket + c] = i < count ? cell_lanes(lanes[i], c) : 0;
      cells.tested[i * kCellsOfPacket + c] = 0;
    }
  }
}

// Some blocks by one walk. Where that is given up, the rays still open walk the tree by packets. No
// coordinate of an origin is beyond `reach`.
template <class Counts>
void trace_together(const KdView& tree, const LightFrame& frame, GlassRule glass, const RayPacket* rays,
                    const uint64_t* lanes, int count, float reach, ShadowAnswer* out, Counts counts) {
  ShadowCells cells;
  start_cells(frame, rays, lanes, count, cells);
  const Walked walked = walk(tree, frame, glass, reach, cells, counts);
  for (int i = 0; i < count; ++i) {
    const uint64_t open = live_rays(cells, i), left = walked == Walked::through ? 0 : open;
    out[i].blocked = lanes[i] & ~open;
    counts.of(i).trace(rays_of(cells.tested, i) & ~left);
    if (left == 0) continue;
    RayPacket rest = rays[i];
    rest.live = left;
    out[i].blocked |= trace_any_from(tree, 0, rest, glass, counts.of(i));
  }
}

// Blocks that lie near each other by one walk, others a quarter of them at a time, and a single block with
// scattered origins by packets.
template <class Counts>
void trace_group(const KdView& tree, const Vec3& direction, GlassRule glass, const RayPacket* rays,
                 const uint64_t* lanes, int count, ShadowAnswer* out, Counts counts) {
  const Box box = box_of(rays, lanes, count);
  if (!(box.min.x <= box.max.x)) return;
  if (!is_narrow(tree, box)) {
    if (count == 1) {
      out->blocked = trace_any_from(tree, 0, *rays, glass, counts);
      return;
    }
    const int part = count > 4 ? 4 : 1;
    for (int i = 0; i < count; i += part)
      trace_group(tree, direction, glass, rays + i, lanes + i, count - i < part ? count - i : part, out + i,
                  counts.of(i));
    return;
  }
  trace_together(tree, make_frame(direction, box), glass, rays, lanes, count, magnitude(box), out, counts);
}

template <class Counts>
void find_blocked(const KdView& tree, const Light& light, GlassRule glass, const PointPacket* const* points,
                  int count, ShadowAnswer* out, Counts counts) {
  RayPacket rays[kMaxPackets];
  for (int i = 0; i < count; ++i) {
    shadow_rays(light, *points[i], rays[i]);
    out[i] = {rays[i].live, 0};
  }
  if (light.kind != Light::Kind::directional) {
    for (int i = 0; i < count; ++i) {
      if (rays[i].live != 0) out[i].blocked = trace_any_from(tree, 0, rays[i], glass, counts.of(i));
    }
    return;
  }
  uint64_t lanes[kMaxPackets];
  for (int i = 0; i < count; ++i) lanes[i] = traceable(rays[i]);
  trace_group(tree, -light.direction, glass, rays, lanes, count, out, counts);
}

}  // namespace

#ifdef VITRAL_COUNTED

void count_shadows(const KdView& tree, const Light& light, GlassRule glass, const PointPacket* const* points,
                   int count, ShadowAnswer* out, const WorkCounts& work) {
  find_blocked(tree, light, glass, points, count, out, Counting{work.totals, work.work});
}

#else

void trace_shadows(const KdView& tree, const Light& light, GlassRule glass, const PointPacket* const* points,
                   int count, ShadowAnswer* out) {
  find_blocked(tree, light, glass, points, count, out, NoCounts{});
}

#endif

}  // namespace VITRAL_ISA
}  // namespace vitral
