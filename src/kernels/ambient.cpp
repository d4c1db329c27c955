// Ambient occlusion: one stratum of the hemisphere after the other, for all points of a block.
#include "kernels/candidates.h"
#include "kernels/counts.h"
#include "kernels/lanes.h"
#include "kernels/meet.h"
#include "kernels/sorter.h"
#include "kernels/strata.h"
#include "kernels/tables.h"
#include "kernels/trace.h"
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
    const Uint h = sample_hash(load(points.key + g), settings.first_sample + static_cast<uint32_t>(s.sample),
                               settings.sample_step);
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

// Those of the lanes whose rays pass through a cell, as derive_intervals() has it.
struct alignas(64) Reciprocals {
  float x[kPacketSize], y[kPacketSize], z[kPacketSize];
};
uint64_t enter(const PlainBox& cell, const RayPacket& rays, const Reciprocals& r, float slack, float distance,
               uint64_t lanes) {
  uint64_t inside = 0;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(lanes, g)) continue;
    Float t0 = Float(0.0f), t1 = Float(distance);
    const auto cut = [&](float low, float high, const float* origin, const float* reciprocal) {
      const Float o = load(origin + g), d = load(reciprocal + g);
      const Float below = (Float(low - slack) - o) * d, above = (Float(high + slack) - o) * d;
      t0 = greatest(least(below, above), t0);
      t1 = least(greatest(below, above), t1);
    };
    cut(cell.min.x, cell.max.x, rays.ox, r.x);
    cut(cell.min.y, cell.max.y, rays.oy, r.y);
    cut(cell.min.z, cell.max.z, rays.oz, r.z);
    inside |= static_cast<uint64_t>(bits(t0 <= t1)) << g;
  }
  return inside & lanes;
}

// Points that may see a shape in a stratum. More strata than parts lie in one ring, and in one column or two.
struct Test {
  uint64_t lanes;
  int shape;
};
template <int kMost>
int find_tests(const Seen<kMost>& seen, const Parts& parts, const Stratum& s, Test* tests, uint64_t& some) {
  const int r = parts.count * (s.n - s.x - 1) / s.n;
  const uint64_t* const ring = seen.ring[r];
  const uint64_t* const first = seen.column[parts.count * s.y / s.n];
  const uint64_t* const last = seen.column[(parts.count * (s.y + 1) - 1) / s.n];
  int count = 0;
  for (int k = 0; k < seen.reaching[r]; ++k) {
    const int i = seen.order[k];
    const uint64_t lanes = ring[i] & (first[i] | last[i]);
    tests[count] = {lanes, i};
    count += lanes != 0;
    some |= lanes;
  }
  return count;
}

// Of a stratum's rays those that meet one of the triangles, and those that meet none but enter a node.
struct Outcome {
  uint64_t met, walks;
};
template <class Counts>
Outcome trace_stratum(const KdView& tree, const PointPacket& points, const Frames& frames,
                      const AmbientSettings& settings, const Parts& parts, const Candidates& candidates,
                      const Stratum& s, RayPacket& rays, Counts counts) {
  Test triangles[kMaxCandidates], nodes[kMaxNodes];
  uint64_t some = 0;
  const int triangle_count = find_tests(candidates.triangles, parts, s, triangles, some);
  const int node_count = find_tests(candidates.nodes, parts, s, nodes, some);
  if (some == 0) return {0, 0};
  make_directions(points, frames, settings, s, some, rays);
  Shears shears;
  derive_shears(rays, shears);
  counts.trace(shears.traceable);
  Outcome out{0, 0};
  for (int i = 0; i < triangle_count; ++i) {
    const uint64_t lanes = triangles[i].lanes & shears.traceable & ~out.met;
    if (lanes == 0) continue;
    counts.test(lanes);
    out.met |= test_any(tree, rays, shears, lanes, candidates.triangle[triangles[i].shape]);
  }
  if (node_count == 0) return out;
  Reciprocals r;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(some, g)) continue;
    store(r.x + g, safe_reciprocal(load(rays.dx + g))), store(r.y + g, safe_reciprocal(load(rays.dy + g)));
    store(r.z + g, safe_reciprocal(load(rays.dz + g)));
  }
  const float slack = traversal_slack(vitral::greatest(tree.magnitude, shears.reach));
  for (int i = 0; i < node_count; ++i) {
    const uint64_t lanes = nodes[i].lanes & shears.traceable & ~(out.met | out.walks);
    if (lanes == 0) continue;
    counts.node(lanes);
    const PlainBox& cell = candidates.cell[nodes[i].shape];
    out.walks |= enter(cell, rays, r, slack, settings.distance, lanes);
  }
  return out;
}

void make_frames(const PointPacket& points, Frames& frames) {
  for (int g = 0; g < kPacketSize; g += kLanes) {
    Vec3T<Float> t, b;
    tangent_frame(load3(points.nx, points.ny, points.nz, g), t, b);
    store3(frames.tx, frames.ty, frames.tz, g, t);
    store3(frames.bx, frames.by, frames.bz, g, b);
  }
}

void remove_rays(uint64_t met, FreeRays& rays) {
  for (int g = 0; g < kPacketSize; g += kLanes) {
    if (group_empty(met, g)) continue;
    const Uint free = load(rays.count + g);
    store(rays.count + g, select(group_mask(met, g), free - Uint(1u), free));
  }
}

void begin_rays(const PointPacket& points, const AmbientSettings& settings, RayPacket& rays) {
  set_origins(points, rays);
  rays.tmin = 0;
  for (int g = 0; g < kPacketSize; g += kLanes) store(rays.tmax + g, Float(settings.distance));
}

// What the rays of a block meet, found among candidates. Rays that enter a node go to the sorter.
template <class Counts>
void test_block(const KdView& tree, const PointPacket& points, const Frames& frames,
                const AmbientSettings& settings, const Parts& parts, const Candidates& candidates,
                RaySorter& sorter, int block, FreeRays* free_rays, Counts counts) {
  if (candidates.triangles.count == 0 && candidates.nodes.count == 0) return;
  const int n = settings.strata;
  RayPacket rays;
  begin_rays(points, settings, rays);
  for (int s = 0; s < n * n; ++s) {
    const Outcome outcome = trace_stratum(tree, points, frames, settings, parts, candidates,
                                          {s, s % n, s / n, n}, rays, counts.of(block));
    remove_rays(outcome.met, free_rays[block]);
    rays.live = outcome.walks;
    if (rays.live != 0) sort_rays(tree, sorter, rays, block, settings.distance, free_rays, counts);
  }
}

// What they meet, found by the walk, by way of the sorter or as they come.
enum class Walk { sorted, as_they_come };
template <class Counts>
void walk_block(const KdView& tree, const PointPacket& points, const AmbientSettings& settings, Walk walk,
                RaySorter& sorter, int block, FreeRays* free_rays, Counts counts) {
  const int n = settings.strata;
  Frames frames;
  make_frames(points, frames);
  RayPacket rays;
  begin_rays(points, settings, rays);
  for (int s = 0; s < n * n; ++s) {
    make_directions(points, frames, settings, {s, s % n, s / n, n}, points.live, rays);
    if (walk == Walk::sorted)
      sort_rays(tree, sorter, rays, block, settings.distance, free_rays, counts);
    else
      remove_rays(trace_any_from(tree, 0, rays, GlassRule::passes, counts.of(block)), free_rays[block]);
  }
}

// How far it pays to look, for few samples and for many: for all blocks of a tile, for up to four, for one,
// and for one again that has much near it; how many triangles are too many; how often a block is cut in
// parts.
inline constexpr int kMostLevels = 4, kFirstOfOne = 2, kManyStrata = 6;
struct Plan {
  int levels;
  Effort effort[kMostLevels];
  int most_triangles, splits;
};
inline constexpr Plan kFewSamples = {3, {{2, 256, 192}, {2, 96, 48}, {2, 96, 32}}, 256, 0};
inline constexpr Plan kManySamples = {4, {{1, 512, 512}, {1, 256, 128}, {1, 192, 64}, {4, 128, 16}}, 512, 2};

// Some blocks of those that are traced together, from number `block` on; a block that was split in parts
// `splits` times counts as one.
struct Group {
  const PointPacket* const* points;
  int count, block, splits;
};

// Points of a block that lie far apart, on surfaces at different depths, have too much between them: cuts its
// longest axis in half.
void split_block(const PointPacket& points, PointPacket* halves) {
  const PointPacket* const packet = &points;
  const Box box = as_box(start_of(&packet, 1));
  const Vec3 size = extent(box);
  const int axis = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
  const float* const along = axis == 0 ? points.px : axis == 1 ? points.py : points.pz;
  const Float middle = Float(component(center(box), axis));
  uint64_t below = 0;
  for (int g = 0; g < kPacketSize; g += kLanes)
    below |= static_cast<uint64_t>(bits(load(along + g) < middle)) << g;
  halves[0] = halves[1] = points;
  halves[0].live &= below, halves[1].live &= ~below;
}

// The blocks with one pool; where that would grow too large, a quarter of them at a time, and where a single
// block has too much near it, in parts; what is left then walks the tree.
template <class Counts>
void trace_group(const KdView& tree, const Group& group, int level, const AmbientSettings& settings,
                 const Parts& parts, RaySorter& sorter, FreeRays* out, Counts counts) {
  const Plan& plan = settings.strata < kManyStrata ? kFewSamples : kManySamples;
  const auto trace_part = [&](int first, int count, int next) {
    const Group part{group.points + first, count, group.block + first, group.splits};
    trace_group(tree, part, next, settings, parts, sorter, out, counts);
  };
  if (level == plan.levels) {
    const PointPacket& points = *group.points[0];
    if (group.splits == plan.splits) {
      walk_block(tree, points, settings, Walk::sorted, sorter, group.block, out, counts);
      return;
    }
    PointPacket halves[2];
    split_block(points, halves);
    for (const PointPacket& half : halves) {
      if (half.live == 0) continue;
      const PointPacket* const packet = &half;
      trace_group(tree, {&packet, 1, group.block, group.splits + 1}, kFirstOfOne, settings, parts, sorter,
                  out, counts);
    }
    return;
  }
  Pool pool;
  uint64_t mark = counts.mark();
  const Collected collected = collect(tree, reach_of(tree, group.points, group.count, settings.distance),
                                      plan.effort[level], pool, counts);
  counts.of(group.block).share(mark, group.count, [&](int i) { return group.points[i]->live; });
  if (collected == Collected::too_many) {
    const int part = level == 0 ? 4 : 1;
    for (int i = 0; i < group.count; i += part)
      trace_part(i, group.count - i < part ? group.count - i : part, level + 1);
    return;
  }
  for (int i = 0; i < group.count; ++i) {
    const PointPacket& points = *group.points[i];
    const int block = group.block + i;
    Frames frames;
    make_frames(points, frames);
    Candidates candidates;
    mark = counts.mark();
    counts.group_test(pool.count);
    counts.of(block).share(mark, 1, [&](int) { return points.live; });
    if (choose_candidates(tree, pool, points, frames, parts, settings.distance, plan.most_triangles,
                          candidates) == Enough::candidates)
      test_block(tree, points, frames, settings, parts, candidates, sorter, block, out, counts);
    else
      trace_part(i, 1, level < kFirstOfOne ? kFirstOfOne : level + 1);
  }
}

template <class Counts>
void trace_blocks(const KdView& tree, const PointPacket* const* points, int count,
                  const AmbientSettings& settings, FreeRays* out, Counts counts) {
  if (count == 0) return;
  RaySorter sorter;
  for (RayBin& bin : sorter.bins) bin.count = 0;
  sorter.node = entry_node(tree, as_box(reach_of(tree, points, count, settings.distance).box));
  const uint32_t samples = static_cast<uint32_t>(settings.strata * settings.strata);
  for (int i = 0; i < count; ++i) {
    for (int g = 0; g < kPacketSize; g += kLanes) store(out[i].count + g, Uint(samples));
  }
  // Squares of shorter lengths would fall among the denormal numbers.
  if (settings.shortcuts == Shortcuts::taken && settings.distance > 1e-12f) {
    const int level = count > 4 ? 0 : count > 1 ? 1 : kFirstOfOne;
    trace_group(tree, {points, count, 0, 0}, level, settings, parts_of(settings.strata), sorter, out, counts);
  } else {
    for (int i = 0; i < count; ++i)
      walk_block(tree, *points[i], settings, Walk::as_they_come, sorter, i, out, counts);
  }
  for (RayBin& bin : sorter.bins) {
    if (bin.count > 0) flush(tree, sorter, settings.distance, bin, out, counts);
  }
}

}  // namespace

#ifdef VITRAL_COUNTED

void count_ambient(const KdView& tree, const PointPacket* const* points, int count,
                   const AmbientSettings& settings, FreeRays* out, const WorkCounts& work) {
  trace_blocks(tree, points, count, settings, out, Counting{work.totals, work.work});
}

#else

void ambient_blocks(const KdView& tree, const PointPacket* const* points, int count,
                    const AmbientSettings& settings, FreeRays* out) {
  trace_blocks(tree, points, count, settings, out, NoCounts{});
}

void stratum_rays(const PointPacket& points, const AmbientSettings& settings, int sample, RayPacket& rays) {
  const int n = settings.strata;
  Frames frames;
  make_frames(points, frames);
  begin_rays(points, settings, rays);
  for (int g = 0; g < kPacketSize; g += kLanes)
    store3(rays.dx, rays.dy, rays.dz, g, {Float(0.0f), Float(0.0f), Float(1.0f)});
  make_directions(points, frames, settings, {sample, sample % n, sample / n, n}, points.live, rays);
}

void ambient_occlusion(const KdView& tree, const PointPacket& points, const AmbientSettings& settings,
                       uint32_t* free_rays) {
  const PointPacket* const packet = &points;
  FreeRays free;
  trace_blocks(tree, &packet, 1, settings, &free, NoCounts{});
  for (int lane = 0; lane < kPacketSize; ++lane) free_rays[lane] = free.count[lane];
}

#endif

}  // namespace VITRAL_ISA
}  // namespace vitral
