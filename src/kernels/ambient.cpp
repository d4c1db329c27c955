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

// The points of a stratum's rays that meet something. In squared cosines from the normal the stratum spans
// [1 - (x + 1) / n, 1 - x / n], and around it [y / n, (y + 1) / n] of a turn.
template <class Counts>
uint64_t trace_stratum(const KdView& tree, const PointPacket& points, const Frames& frames,
                       const AmbientSettings& settings, const Candidates& candidates, const Stratum& s,
                       RayPacket& rays, Counts counts) {
  const int height = kHeights * (s.n - s.x - 1) / s.n;
  const int first = kQuadrants * s.y / s.n, last = (kQuadrants * (s.y + 1) - 1) / s.n;
  uint64_t some = 0;
  struct Test {
    uint64_t lanes;
    uint32_t triangle;
  } tests[kMaxCandidates];
  int count = 0;
  for (int i = 0; i < candidates.seen_at[height]; ++i) {
    const Candidate& c = candidates.list[i];
    uint64_t around = 0;
    for (int q = first; q <= last; ++q) around |= c.quadrant[q];
    const uint64_t lanes = c.height[height] & around;
    tests[count] = {lanes, c.triangle};
    count += lanes != 0;
    some |= lanes;
  }
  if (some == 0) return 0;
  make_directions(points, frames, settings, s, some, rays);
  Shears shears;
  derive_shears(rays, shears);
  counts.trace(shears.traceable);
  uint64_t met = 0;
  for (int i = 0; i < count; ++i) {
    const uint64_t lanes = tests[i].lanes & shears.traceable & ~met;
    if (lanes == 0) continue;
    counts.test(lanes);
    met |= test_any(tree, rays, shears, lanes, tests[i].triangle);
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

// Rays of several blocks, sorted by the signs of their directions and by the axis along which they run
// fastest: packets of one kind visit the cells of the tree in one order and are tested without a choice
// per lane.
inline constexpr int kRayKinds = 24;
struct alignas(64) RayBin {
  static constexpr int kRoom = kPacketSize + 16;
  float ox[kRoom], oy[kRoom], oz[kRoom], dx[kRoom], dy[kRoom], dz[kRoom];
  uint32_t id[kRoom];  // 64 * block + lane
  int count;
};
struct RaySorter {
  RayBin bins[kRayKinds];
  uint32_t node;  // where the walk begins
};

inline Uint kind_of(const Vec3T<Float>& d) {
  const Float zero = Float(0.0f), x = absolute(d.x), y = absolute(d.y), z = absolute(d.z);
  const auto bit = [](Mask m, uint32_t value) { return select(m, Uint(value), Uint(0u)); };
  const Uint signs = bit(d.x < zero, 1) + bit(d.y < zero, 2) + bit(d.z < zero, 4);
  const Mask x_leads = both(x > y, x > z), y_leads = both(invert(x_leads), y > z);
  return signs + bit(x_leads, 8) + bit(y_leads, 16);
}

// Traces up to 64 rays of a bin and takes them out.
template <class Counts>
void flush(const KdView& tree, const RaySorter& sorter, float distance, RayBin& bin, FreeRays* free_rays,
           Counts counts) {
  const int n = bin.count < kPacketSize ? bin.count : kPacketSize;
  RayPacket rays;
  float* const to[6] = {rays.ox, rays.oy, rays.oz, rays.dx, rays.dy, rays.dz};
  float* const from[6] = {bin.ox, bin.oy, bin.oz, bin.dx, bin.dy, bin.dz};
  for (int a = 0; a < 6; ++a) {
    std::memcpy(to[a], from[a], sizeof rays.ox);
    std::memcpy(from[a], from[a] + kPacketSize, sizeof(float) * 16);
  }
  for (int g = 0; g < kPacketSize; g += kLanes) store(rays.tmax + g, Float(distance));
  rays.tmin = 0;
  rays.live = n == kPacketSize ? ~0ull : (1ull << n) - 1;
  uint64_t met = counts.of_lanes(bin.id, n, [&](auto of_packet) {
    return trace_any_from(tree, sorter.node, rays, GlassRule::passes, of_packet);
  });
  for (; met != 0; met &= met - 1) {
    const uint32_t id = bin.id[__builtin_ctzll(met)];
    --free_rays[id / kPacketSize].count[id % kPacketSize];
  }
  std::memcpy(bin.id, bin.id + kPacketSize, sizeof(uint32_t) * 16);
  bin.count -= n;
}

// Puts the live rays of a block into the bins, and traces those that are full.
template <class Counts>
void sort_rays(const KdView& tree, RaySorter& sorter, const RayPacket& rays, int block, float distance,
               FreeRays* free_rays, Counts counts) {
  for (int g = 0; g < kPacketSize; g += kLanes) {
    uint32_t left = bits(group_mask(rays.live, g));
    if (left == 0) continue;
    const Vec3T<Float> o = load3(rays.ox, rays.oy, rays.oz, g), d = load3(rays.dx, rays.dy, rays.dz, g);
    const Uint id = lane_numbers() + Uint(static_cast<uint32_t>(block * kPacketSize + g)), kinds = kind_of(d);
    uint32_t kind[kLanes];
    store(kind, kinds);
    while (left != 0) {
      const uint32_t k = kind[__builtin_ctz(left)];
      const uint32_t same = bits(kinds == Uint(k)) & left;
      left &= ~same;
      const Mask m = mask_of_bits(same);
      RayBin& bin = sorter.bins[k];
      const int n = bin.count;
      compress(bin.ox + n, o.x, m), compress(bin.oy + n, o.y, m), compress(bin.oz + n, o.z, m);
      compress(bin.dx + n, d.x, m), compress(bin.dy + n, d.y, m), compress(bin.dz + n, d.z, m);
      compress(bin.id + n, id, m);
      bin.count += __builtin_popcount(same);
      if (bin.count >= kPacketSize) flush(tree, sorter, distance, bin, free_rays, counts);
    }
  }
}

// What the rays of one block meet: found among the candidates, or, where these are too many, by the walk.
enum class Walk { sorted, as_they_come };
template <class Counts>
void trace_block(const KdView& tree, const PointPacket& points, const Frames& frames,
                 const AmbientSettings& settings, const Candidates& candidates, Walk walk, RaySorter& sorter,
                 int block, FreeRays* free_rays, Counts counts) {
  const int n = settings.strata;
  uint32_t* const count = free_rays[block].count;
  for (int g = 0; g < kPacketSize; g += kLanes) store(count + g, Uint(static_cast<uint32_t>(n * n)));
  if (candidates.count == 0) return;
  RayPacket rays;
  set_origins(points, rays);
  rays.tmin = 0;
  for (int g = 0; g < kPacketSize; g += kLanes) store(rays.tmax + g, Float(settings.distance));
  for (int s = 0; s < n * n; ++s) {
    const Stratum stratum{s, s % n, s / n, n};
    uint64_t met = 0;
    if (candidates.count > 0) {
      met = trace_stratum(tree, points, frames, settings, candidates, stratum, rays, counts.of(block));
    } else {
      make_directions(points, frames, settings, stratum, points.live, rays);
      if (walk == Walk::sorted)
        sort_rays(tree, sorter, rays, block, settings.distance, free_rays, counts);
      else
        met = trace_any_from(tree, 0, rays, GlassRule::passes, counts.of(block));
    }
    for (int g = 0; g < kPacketSize; g += kLanes) {
      if (group_empty(met, g)) continue;
      const Uint free = load(count + g);
      store(count + g, select(group_mask(met, g), free - Uint(1u), free));
    }
  }
}

// Some blocks with one pool of triangles; where that grows too large, each with its own. When the blocks
// lie close together beside the length of the rays, one of them has hardly less within its reach than all,
// and the walk is left to find it.
template <class Counts>
void trace_group(const KdView& tree, const PointPacket* const* points, int count,
                 const AmbientSettings& settings, FreeRays* out, Counts counts) {
  // Squares of shorter lengths would fall among the denormal numbers.
  const bool shortcuts = settings.shortcuts == Shortcuts::taken && settings.distance > 1e-12f;
  const Reach reach = reach_of(tree, points, count, settings.distance);
  // Collecting must not take longer than what it saves.
  const int most_leaves = count * (16 + 2 * settings.strata * settings.strata);
  const int most_candidates =
      settings.strata < 6 ? 128 + 24 * settings.strata * settings.strata : kMaxCandidates;
  TrianglePool pool;
  const uint64_t mark = counts.mark();
  const bool pooled = shortcuts && collect(tree, reach, most_leaves, pool, counts) == Collected::all;
  counts.share(mark, count, [&](int i) { return points[i]->live; });
  if (!pooled && shortcuts && count > 1 &&
      largest_component(extent(as_box(reach.start))) > 2 * settings.distance) {
    for (int i = 0; i < count; ++i) trace_group(tree, points + i, 1, settings, out + i, counts.of(i));
    return;
  }
  RaySorter sorter;
  for (RayBin& bin : sorter.bins) bin.count = 0;
  sorter.node = entry_node(tree, as_box(reach.box));
  const Walk walk = shortcuts ? Walk::sorted : Walk::as_they_come;
  for (int i = 0; i < count; ++i) {
    Frames frames;
    make_frames(*points[i], frames);
    Candidates candidates;
    candidates.count = kTooMany;
    if (pooled) {
      const uint64_t before = counts.mark();
      counts.group_test(pool.count);
      counts.of(i).share(before, 1, [&](int) { return points[i]->live; });
      choose_candidates(tree, pool, *points[i], frames, settings.distance, most_candidates, candidates);
    }
    trace_block(tree, *points[i], frames, settings, candidates, walk, sorter, i, out, counts);
  }
  for (RayBin& bin : sorter.bins) {
    if (bin.count > 0) flush(tree, sorter, settings.distance, bin, out, counts);
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
