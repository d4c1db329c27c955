// Ambient occlusion: one stratum of the hemisphere after the other, for all points of a block.
#include "kernels/candidates.h"
#include "kernels/counts.h"
#include "kernels/lanes.h"
#include "kernels/meet.h"
#include "kernels/tables.h"
#include "math/sampling.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

// Stratum (sx, sy) of n x n: sx counts down from the normal, sy around it.
struct Stratum {
  int sample, x, y, n;
};

// Directions of one stratum, jittered by a hash of the point's key and the sample. A direction that dips
// under the geometric surface, which a bent shading normal allows, is mirrored back above it.
void make_directions(const PointPacket& points, const Frames& frames, const AmbientSettings& settings,
                     const Stratum& s, uint64_t lanes, RayPacket& rays) {
  const Float side = Float(1.0f / static_cast<float>(s.n)), unit = Float(1.0f / 65536);
  const Float x = Float(static_cast<float>(s.x)), y = Float(static_cast<float>(s.y));
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(lanes, g)) continue;
    const Uint h = sample_hash(load(points.key + g), static_cast<uint32_t>(s.sample), settings.sample_step);
    const Float u1 = (x + to_float(h & Uint(0xffffu)) * unit) * side;
    const Float u2 = (y + to_float(h >> 16) * unit) * side;
    const Vec3T<Float> normal = load3(points.gx, points.gy, points.gz, g);
    Vec3T<Float> d = cosine_hemisphere(load3(frames.tx, frames.ty, frames.tz, g),
                                       load3(frames.bx, frames.by, frames.bz, g),
                                       load3(points.nx, points.ny, points.nz, g), u1, u2);
    const Float below = least(dot(d, normal), Float(0.0f));
    d = d - normal * (below + below);
    store3(rays.dx, rays.dy, rays.dz, g, d);
  }
  rays.live = lanes;
}

// A candidate's points that may meet it in a stratum: in squared cosines from the normal the stratum spans
// [1 - (x + 1) / n, 1 - x / n], and around it [y / n, (y + 1) / n] of a turn.
inline uint64_t lanes_in(const Candidates& c, int i, const Stratum& s) {
  const int height = kHeights * (s.n - s.x - 1) / s.n;
  const int first = kQuadrants * s.y / s.n, last = (kQuadrants * (s.y + 1) - 1) / s.n;
  uint64_t around = 0;
  for (int q = first; q <= last; ++q) around |= c.quadrant[q][i];
  return c.height[height][i] & around;
}

// The points of a stratum's rays that meet something.
template <class Counts>
uint64_t trace_stratum(const KdView& tree, const PointPacket& points, const Frames& frames,
                       const AmbientSettings& settings, const Candidates& candidates, const Stratum& s,
                       RayPacket& rays, Counts counts) {
  uint64_t some = 0;
  for (int i = 0; i < candidates.count; ++i) some |= lanes_in(candidates, i, s);
  if (some == 0) return 0;
  make_directions(points, frames, settings, s, some, rays);
  Shears shears;
  derive_shears(rays, shears);
  counts.trace(shears.traceable);
  uint64_t met = 0;
  for (int i = 0; i < candidates.count; ++i) {
    const uint64_t lanes = lanes_in(candidates, i, s) & shears.traceable & ~met;
    if (lanes == 0) continue;
    counts.test(lanes);
    met |= test_any(tree, rays, shears, lanes, candidates.triangle[i]);
  }
  return met;
}

void make_frames(const PointPacket& points, Frames& frames) {
  for (int g = 0; g < kPacketSize; g += kLanes) {
    Vec3T<Float> t, b;
    tangent_frame(load3(points.nx, points.ny, points.nz, g), t, b);
    store3(frames.tx, frames.ty, frames.tz, g, t);
    store3(frames.bx, frames.by, frames.bz, g, b);
  }
}

// The rays of one block, given what they can meet.
template <class Counts>
void trace_block(const KdView& tree, const PointPacket& points, const Frames& frames,
                 const AmbientSettings& settings, const Candidates& candidates, uint32_t* free_rays,
                 Counts counts) {
  const int n = settings.strata;
  for (int g = 0; g < kPacketSize; g += kLanes) store(free_rays + g, Uint(static_cast<uint32_t>(n * n)));
  if (candidates.count == 0) return;
  RayPacket rays;
  set_origins(points, rays);
  rays.tmin = 0;
  for (int g = 0; g < kPacketSize; g += kLanes) store(rays.tmax + g, Float(settings.distance));
  for (int s = 0; s < n * n; ++s) {
    const Stratum stratum{s, s % n, s / n, n};
    uint64_t met;
    if (candidates.count <= kMaxCandidates) {
      met = trace_stratum(tree, points, frames, settings, candidates, stratum, rays, counts);
    } else {
      make_directions(points, frames, settings, stratum, points.live, rays);
      met = trace_any_from(tree, candidates.node, rays, GlassRule::passes, counts);
    }
    for (int g = 0; g < kPacketSize; g += kLanes) {
      if (group_empty(met, g)) continue;
      const Uint free = load(free_rays + g);
      store(free_rays + g, select(group_mask(met, g), free - Uint(1u), free));
    }
  }
}

// Some blocks with one pool of triangles; where that grows too large, a quarter of them at a time. When
// the blocks are small beside the rays, a quarter of them has hardly less within its reach, and the walk
// is left to find it.
template <class Counts>
void trace_group(const KdView& tree, const PointPacket* const* points, int count,
                 const AmbientSettings& settings, FreeRays* out, Counts counts) {
  // Squares of shorter lengths would fall among the denormal numbers.
  const bool shortcuts = settings.shortcuts == Shortcuts::taken && settings.distance > 1e-12f;
  const Reach reach = reach_of(tree, points, count, settings.distance);
  // Collecting must not take longer than what it saves.
  const int most_leaves = count * (32 + 4 * settings.strata * settings.strata);
  TrianglePool pool;
  const uint64_t mark = counts.mark();
  const bool pooled = shortcuts && collect(tree, reach, most_leaves, pool, counts) == Collected::all;
  counts.share(mark, count, [&](int i) { return points[i]->live; });
  if (!pooled && shortcuts && count > 1 && largest_component(extent(reach.start)) > settings.distance) {
    const int part = count > 4 ? 4 : 1;
    for (int i = 0; i < count; i += part) {
      trace_group(tree, points + i, count - i < part ? count - i : part, settings, out + i, counts.of(i));
    }
    return;
  }
  for (int i = 0; i < count; ++i) {
    Frames frames;
    make_frames(*points[i], frames);
    Candidates candidates;
    if (pooled) {
      const uint64_t before = counts.mark();
      counts.group_test(pool.count);
      counts.of(i).share(before, 1, [&](int) { return points[i]->live; });
      choose_candidates(tree, pool, *points[i], frames, settings.distance, candidates);
    } else {
      walk_instead(tree, *points[i], settings.distance, candidates);
    }
    trace_block(tree, *points[i], frames, settings, candidates, out[i].count, counts.of(i));
  }
}

}  // namespace

#ifdef VITRAL_COUNTED

void count_ambient(const KdView& tree, const PointPacket* const* points, int count,
                   const AmbientSettings& settings, FreeRays* out, const WorkCounts& work) {
  if (count > 0) trace_group(tree, points, count, settings, out, Counting{work.totals, work.work});
}

#else

void ambient_blocks(const KdView& tree, const PointPacket* const* points, int count,
                    const AmbientSettings& settings, FreeRays* out) {
  if (count > 0) trace_group(tree, points, count, settings, out, NoCounts{});
}

void ambient_occlusion(const KdView& tree, const PointPacket& points, const AmbientSettings& settings,
                       uint32_t* free_rays) {
  const PointPacket* const packet = &points;
  FreeRays free;
  trace_group(tree, &packet, 1, settings, &free, NoCounts{});
  for (int lane = 0; lane < kPacketSize; ++lane) free_rays[lane] = free.count[lane];
}

#endif

}  // namespace VITRAL_ISA
}  // namespace vitral
