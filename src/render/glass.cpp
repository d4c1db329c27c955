// Mirrors and glass: the recursion of Whitted, "An improved illumination model for shaded display",
// 1980, unrolled into generations. All paths of a generation in a tile are sorted by kind and by the
// signs of their directions, packed 64 at a time, traced, lit like any other surface, and spawn the
// next generation. So packets stay full although paths end at different depths.
#include "math/absorption.h"
#include "math/footprint.h"
#include "math/fresnel.h"
#include "math/random.h"
#include "render/frame.h"
#include "render/hit_triangles.h"

namespace vitral {
namespace {

// The light that a surface sends on, split by direction: what `reflectivity` mirrors, and by the optics what
// is left. So glass sends on no more than comes, and at total reflection all.
struct Split {
  Vec3 reflected{0, 0, 0}, refracted{0, 0, 0};  // weights
  float eta = 1;                                // for the refracted direction; 1: straight on
  float cos_i = 1;
};

Split split_by_optics(const Material& m, const Settings& settings, float cos_i, Side side) {
  Split s;
  s.cos_i = cos_i;
  const Effects& on = settings.effects;
  switch (m.optics) {
    case Optics::opaque:
      break;
    case Optics::mirror:
      if (on.reflection) s.reflected = m.specular;
      break;
    case Optics::polished:
      if (on.reflection) s.reflected = m.specular * fresnel(settings.fresnel, cos_i, 1 / m.index);
      break;
    case Optics::dissolve:
      if (on.refraction) s.refracted = Vec3{1, 1, 1} * (1 - m.opacity);
      break;
    case Optics::solid:
    case Optics::thin: {
      const bool leaving = side == Side::back && m.optics == Optics::solid;
      s.eta = leaving ? m.index : 1 / m.index;
      // Light that is totally reflected inside glass belongs to the refraction that brought it there.
      const bool total = refracted_cosine_squared(cos_i, s.eta) <= 0;
      const float f = total ? 1.0f : fresnel(settings.fresnel, cos_i, s.eta);
      if (on.reflection || (total && on.refraction)) s.reflected = Vec3{1, 1, 1} * f;
      if (on.refraction) s.refracted = m.transmission * (1 - f);
      break;
    }
  }
  return s;
}

Split split_light(const Material& m, const Settings& settings, float cos_i, Side side) {
  Split s = split_by_optics(m, settings, cos_i, side);
  if (is_black(m.reflectivity)) return s;
  const Vec3 rest = Vec3{1, 1, 1} - m.reflectivity;
  s.reflected = s.reflected * rest;
  s.refracted = s.refracted * rest;
  if (settings.effects.reflection) s.reflected += m.reflectivity;
  return s;
}

// As curvature() has it, of a triangle of the scene's own mesh.
float mesh_curvature(const Mesh& mesh, uint32_t triangle, const Vec3& geometric, const Vec3& shading) {
  if (mesh.triangle_normals.empty()) return 0;
  const Corners& at = mesh.triangle_normals[triangle];
  if (at[0] == kNoIndex || at[1] == kNoIndex || at[2] == kNoIndex) return 0;
  const Corners& corner = mesh.triangles[triangle];
  const Vec3 normals[3] = {mesh.normals[at[0]], mesh.normals[at[1]], mesh.normals[at[2]]};
  const Vec3 corners[3] = {mesh.positions[corner[0]], mesh.positions[corner[1]], mesh.positions[corner[2]]};
  return curvature(corners, normals, geometric, shading);
}

// What the turning of the normal across the cone's section adds to the spread, besides Snell's part: the
// mirrored direction is d + 2 cos_i n, the refracted one eta d + (eta cos_i - cos_t) n. Of a mirror
// 2 instead of 2 cos_i is the mean of along and across the plane of incidence.
Cone reflected_cone(const Cone& here, float turning) {
  return {here.diameter, here.spread + 2 * turning * here.diameter};
}
Cone refracted_cone(const Cone& here, float turning, float eta, float cos_i, float cos_t) {
  return {here.diameter, eta * here.spread + (eta * cos_i - cos_t) * turning * here.diameter};
}

Path child_of(const Path& parent, PathKind kind, const Vec3& origin, const Vec3& direction,
              const Vec3& weight, const Cone& cone) {
  Path p = parent;
  p.cone = cone;
  p.origin = origin;
  p.direction = direction;
  p.weight = parent.weight * weight;
  p.kind = kind;
  p.root = parent.depth == 0 ? kind : parent.root;
  p.key = branch_key(parent.key, kind == PathKind::reflection ? 1 : 2);
  ++p.depth;
  return p;
}

// The glass on either side of a surface, as far as its hit tells: where the ray came from and where a
// refracted one goes.
struct Sides {
  uint32_t here, beyond;
};
Sides glass_around(const FrameContext& frame, const SurfacePacket& s, int lane, const Path& path) {
  const uint32_t material = s.material[lane];
  if (frame.scene.materials[material].optics != Optics::solid) return {path.inside, path.inside};
  if (s.back >> lane & 1) return {path.inside != kNoIndex ? path.inside : material, kNoIndex};
  return {path.inside, material};
}

// True of a ray that is worth its while; one that is not is counted, unless there is no light at all in it.
bool is_important(const FrameContext& frame, const Vec3& weight, PathKind kind, PassTally& tally) {
  const float importance = luminance(weight);
  if (importance >= frame.least_importance) return true;
  const Pass pass = kind == PathKind::reflection ? Pass::reflection : Pass::refraction;
  if (importance > 0) ++tally.rays_saved[static_cast<size_t>(pass)];
  return false;
}

void spawn_at(const FrameContext& frame, const SurfacePacket& s, int lane, const Path& parent,
              PassTally& tally, std::vector<Path>& out) {
  const Material& m = frame.scene.materials[s.material[lane]];
  const Vec3 position = get(s.points.px, s.points.py, s.points.pz, lane);
  const Vec3 geometric = get(s.points.gx, s.points.gy, s.points.gz, lane);
  const Vec3 incoming = -get(s.points.vx, s.points.vy, s.points.vz, lane);
  // A bent normal that faces away from the viewer cannot say how light bends.
  Vec3 n = get(s.points.nx, s.points.ny, s.points.nz, lane);
  if (!(dot(n, incoming) < -1e-4f)) n = geometric;
  const float cos_i = least(greatest(-dot(n, incoming), 0.0f), 1.0f);
  const Cone here{diameter_at(parent.cone, length(position - parent.origin)), parent.cone.spread};
  const float turning = is_object(frame.accelerator.placed.view, s.triangle[lane])
                            ? s.turning[lane]
                            : mesh_curvature(frame.scene.mesh, s.triangle[lane], geometric, n);
  const Split split = split_light(m, frame.settings, cos_i, s.back >> lane & 1 ? Side::back : Side::front);

  const Sides glass = glass_around(frame, s, lane, parent);

  if (is_important(frame, parent.weight * split.reflected, PathKind::reflection, tally)) {
    Vec3 d = reflect(incoming, n);
    if (!(dot(d, geometric) > 0)) d = reflect(d, geometric);
    out.push_back(child_of(parent, PathKind::reflection, position + geometric * s.points.offset[lane],
                           normalize(d), split.reflected, reflected_cone(here, turning)));
    out.back().inside = glass.here;
  }
  if (is_important(frame, parent.weight * split.refracted, PathKind::refraction, tally)) {
    Vec3 d = incoming;
    Cone cone = here;
    if (split.eta != 1) {
      const float cos_t = square_root(greatest(refracted_cosine_squared(cos_i, split.eta), 0.0f));
      d = refract(incoming, n, split.eta, cos_i, cos_t);
      if (!(dot(d, geometric) < 0)) d = reflect(d, geometric);
      cone = refracted_cone(here, turning, split.eta, cos_i, cos_t);
    }
    out.push_back(child_of(parent, PathKind::refraction, position - geometric * s.points.offset[lane],
                           normalize(d), split.refracted, cone));
    out.back().inside = glass.beyond;
  }
}

// Counting sort: reflections before refractions, each by octant; the order within is kept, so that
// what a pixel adds up, and in which order, depends on the pixel alone.
void sort_paths(const std::vector<Path>& paths, std::vector<Path>& sorted) {
  const auto bucket = [](const Path& p) {
    return (p.kind == PathKind::refraction ? 8u : 0u) + (p.direction.x < 0 ? 1u : 0u) +
           (p.direction.y < 0 ? 2u : 0u) + (p.direction.z < 0 ? 4u : 0u);
  };
  std::array<size_t, 17> first{};
  for (const Path& p : paths) ++first[bucket(p) + 1];
  for (size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
  sorted.resize(paths.size());
  for (const Path& p : paths) sorted[first[bucket(p)]++] = p;
}

// Traces and lights up to 64 paths of one kind, adds their light up, spawns the next generation. Returns
// those that met something.
uint64_t trace_packet(const FrameContext& frame, Path* paths, int count, std::vector<Path>& next,
                      PassTally& tally, const PathSums& sums) {
  RayPacket rays;
  HitPacket hits;
  SurfacePacket surfaces;
  LaneWork work;
  rays.tmin = 0;
  rays.live = count == kPacketSize ? ~0ull : (1ull << count) - 1;
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const Path& p = paths[lane < count ? lane : 0];
    set_ray(rays, lane, {p.origin, 0, p.direction, kInfinity});
    surfaces.points.key[lane] = p.key;
  }
  const Pass pass = paths[0].kind == PathKind::reflection ? Pass::reflection : Pass::refraction;
  {
    const PassTimer timer(tally, pass);
    if (sums.cost) work = {};
    count_rays(tally, pass, rays.live);
    run_closest(frame, pass, rays, tally, hits, &work);
  }
  {
    const PassTimer timer(tally, Pass::shade);
    float diameters[kPacketSize];
    for (int lane = 0; lane < kPacketSize; ++lane)
      diameters[lane] = diameter_at(paths[lane < count ? lane : 0].cone, hits.t[lane]);
    make_surfaces(frame, rays, hits, surfaces, diameters);
  }
  Lit lit;
  const SurfacePacket* const one = &surfaces;
  if (surfaces.points.live != 0) light_surfaces(frame, &one, 1, tally, &lit);

  const PassTimer timer(tally, pass);
  absorb_paths(frame, surfaces, paths, count);
  for (int lane = 0; lane < count; ++lane) {
    const Path& p = paths[lane];
    const bool met = surfaces.points.live >> lane & 1;
    const Vec3 seen =
        met ? lit.light.color[lane] : background_light(frame.scene, frame.accelerator.sky, p.direction);
    const Vec3 add = p.weight * seen;
    sums.pixels[p.pixel] += add;
    Vec3* part = p.root == PathKind::reflection ? sums.reflection : sums.refraction;
    if (part) part[p.pixel] += add;
    if (sums.cost) sums.cost[p.pixel] += work.work[lane] + (met ? lit.detail.work.work[lane] : 0.0f);
  }
  spawn_paths(frame, surfaces, paths, tally, next);
  return surfaces.points.live;
}

}  // namespace

void begin_paths(const FrameContext& frame, const PointPacket& points, int x, int y, Path* paths) {
  for (int lane = 0; lane < kPacketSize; ++lane) {
    paths[lane] = {};
    paths[lane].origin = frame.camera.origin;
    paths[lane].direction = -get(points.vx, points.vy, points.vz, lane);
    // The side of what a sample stands for is given at depth 1: at distance 1 it is less by the cosine
    // towards the axis.
    paths[lane].cone = {0, frame.camera.footprint * dot(paths[lane].direction, frame.camera.forward)};
    paths[lane].weight = {1, 1, 1};
    paths[lane].inside = kNoIndex;
    paths[lane].key = points.key[lane];
    paths[lane].pixel = static_cast<uint16_t>((y + lane / kBlockSide) * kTileSide + x + lane % kBlockSide);
  }
}

void absorb_paths(const FrameContext& frame, const SurfacePacket& surfaces, Path* paths, int count) {
  const TraitTable& traits = frame.accelerator.traits;
  if (!(traits.any & kAbsorbs)) return;
  for (int lane = 0; lane < count; ++lane) {
    Path& p = paths[lane];
    const bool met = surfaces.points.live >> lane & 1;
    const uint32_t glass = met ? glass_around(frame, surfaces, lane, p).here : p.inside;
    if (glass == kNoIndex || !(traits.of[glass] & kAbsorbs)) continue;
    const PointPacket& at = surfaces.points;
    const float way = met ? length(get(at.px, at.py, at.pz, lane) - p.origin) : kInfinity;
    p.weight *= transmittance(frame.scene.materials[glass].absorption, way);
  }
}

void spawn_paths(const FrameContext& frame, const SurfacePacket& surfaces, const Path* parents,
                 PassTally& tally, std::vector<Path>& out) {
  for (int lane = 0; lane < kPacketSize; ++lane) {
    if (!(surfaces.points.live >> lane & 1) || parents[lane].depth >= frame.settings.max_depth) continue;
    if (!(frame.accelerator.traits.of[surfaces.material[lane]] & kSendsRays)) continue;
    spawn_at(frame, surfaces, lane, parents[lane], tally, out);
  }
}

uint64_t trace_paths(const FrameContext& frame, PathScratch& scratch, PassTally& tally,
                     const PathSums& sums) {
  uint64_t met = 0;
  while (!scratch.current.empty()) {
    sort_paths(scratch.current, scratch.sorted);
    scratch.next.clear();
    std::vector<Path>& paths = scratch.sorted;
    for (size_t first = 0; first < paths.size();) {
      size_t end = first + 1;
      while (end < paths.size() && end - first < kPacketSize && paths[end].kind == paths[first].kind) ++end;
      const uint64_t hits =
          trace_packet(frame, &paths[first], static_cast<int>(end - first), scratch.next, tally, sums);
      met += static_cast<uint64_t>(__builtin_popcountll(hits));
      first = end;
    }
    scratch.current.swap(scratch.next);
  }
  return met;
}

}  // namespace vitral
