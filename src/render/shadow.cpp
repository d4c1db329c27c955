// Shadows: one any-hit ray per light for a point that faces it. Opaque surfaces block; glass tints.
#include "kdtree/shapes.h"
#include "math/absorption.h"
#include "render/frame.h"

namespace vitral {
namespace {

Hit nearest_glass(const FrameContext& frame, const Ray& ray, TraversalCounts& counts) {
  const KdView& tree = frame.accelerator.glass_view;
  const ObjectsView& objects = frame.accelerator.placed.view;
  const bool counted = frame.count != Count::nothing;
  Hit hit = counted ? walk_closest(tree, ray, counts) : walk_closest(tree, ray);
  if (objects.count == 0) return hit;
  if (counted) {
    walk_objects(objects, ray, Seen::glass_only, hit, counts);
  } else {
    walk_objects(objects, ray, Seen::glass_only, hit);
  }
  return hit;
}

// What passes a surface of glass on the straight way.
Vec3 tint_of(const Material& m) {
  const Vec3 tint = m.optics == Optics::dissolve ? Vec3{1, 1, 1} * (1 - m.opacity) : m.transmission;
  return tint * (Vec3{1, 1, 1} - m.reflectivity);
}

bool sees_back(const KdTriangle& t, const Vec3& direction) {
  const auto at = [&t](int k) { return Vec3{t.corner[k][0], t.corner[k][1], t.corner[k][2]}; };
  return dot(cross(at(1) - at(0), at(2) - at(0)), direction) > 0;
}

// Whether a ray runs out at its hit; of an object in the object's own space, where fronts are fronts however
// it is mirrored.
Side side_of(const Accelerator& a, const Ray& ray, const Hit& hit) {
  const auto side = [](bool back) { return back ? Side::back : Side::front; };
  const ObjectsView& view = a.placed.view;
  if (!is_object(view, hit.triangle)) return side(sees_back(a.triangles[hit.triangle], ray.direction));
  const PlacedObject& object = view.objects[object_of(view, hit.triangle)];
  const ObjectRay<double> there = ray_to_object(object, ray.origin, ray.direction);
  if (object.shape == Shape::mesh) {
    const KdTriangle& own = view.models[object.model].tree.triangles[hit.triangle - object.first_number];
    return side(sees_back(own, to_float(there.direction)));
  }
  const LineSpan<double> span = shape_span(object.shape, there.origin, there.direction);
  const ShapePoint point = shape_point(object.shape, there.origin, there.direction, exact_end(span, hit.t));
  return side(dot(point.normal, there.direction) > 0);
}

// The absorbing glass that a ray runs through since `since`.
struct Inside {
  const Material* glass = nullptr;
  float since = 0;
};

// At a surface of solid glass the ray leaves what it was in (before the first one it was in the glass whose
// back it sees) or enters it.
void cross_surface(const Material& m, Side side, float t, float unit, Inside& inside, Vec3& tint) {
  if (!inside.glass && side == Side::back) inside.glass = &m;
  if (inside.glass) tint *= transmittance(inside.glass->absorption, (t - inside.since) * unit);
  inside = {side == Side::front ? &m : nullptr, t};
}

// What is left of the light behind all sheets of glass on the ray, nearest first, and what the solid ones
// absorb between their surfaces. Sheets at the very same t, as at the edge that two triangles of a sheet
// share, count once.
Vec3 glass_tint(const FrameContext& frame, Ray ray, TraversalCounts& counts) {
  Vec3 tint{1, 1, 1};
  const bool absorbs = (frame.accelerator.traits.any & kAbsorbs) != 0;
  const float unit = absorbs ? length(ray.direction) : 1;
  Inside inside;
  for (;;) {
    const Hit hit = nearest_glass(frame, ray, counts);
    if (hit.triangle == kNoTriangle) {
      // A light in the midst of glass. One at infinity is in none.
      if (inside.glass && ray.tmax < kInfinity)
        tint *= transmittance(inside.glass->absorption, (ray.tmax - inside.since) * unit);
      return tint;
    }
    const Material& m =
        frame.scene.materials[material_of(frame.scene, frame.accelerator.placed, hit.triangle)];
    tint *= tint_of(m);
    if (absorbs && m.optics == Optics::solid)
      cross_surface(m, side_of(frame.accelerator, ray, hit), hit.t, unit, inside, tint);
    if (!(luminance(tint) > 0)) return {0, 0, 0};
    ray.tmin = hit.t;
  }
}

// A lifted point is rounded once more, at the size of its coordinates: a third of what its triangle's offset
// holds ready for that (kernels/ray_offset.h, steps 1 and 2).
constexpr float kLiftedOffset = 4.0f / 3;

// All or nothing, as it is without glass.
void set_visibility(const ShadowAnswer& answer, ColorPacket& visibility) {
  for (Vec3& v : visibility.color) v = {1, 1, 1};
  for (uint64_t left = answer.blocked; left != 0; left &= left - 1)
    visibility.color[__builtin_ctzll(left)] = {0, 0, 0};
}

}  // namespace

void find_shadow_starts(const FrameContext& frame, const SurfacePacket* const* surfaces, int count,
                        std::vector<PointPacket>& lifted, const PointPacket** starts) {
  if (frame.offset.lift == Lift::none || !frame.settings.effects.shadows) {
    for (int i = 0; i < count; ++i) starts[i] = &surfaces[i]->points;
    return;
  }
  lifted.resize(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) {
    const SurfacePacket& s = *surfaces[i];
    PointPacket& p = lifted[static_cast<size_t>(i)];
    p = s.points;
    for (uint64_t left = p.live; left != 0; left &= left - 1) {
      const int lane = __builtin_ctzll(left);
      const Vec3 start = get(s.lx, s.ly, s.lz, lane);
      if (start == get(p.px, p.py, p.pz, lane)) continue;
      p.px[lane] = start.x, p.py[lane] = start.y, p.pz[lane] = start.z;
      p.offset[lane] *= kLiftedOffset;
    }
    starts[i] = &p;
  }
}

void find_shadows(const FrameContext& frame, const Light& light, const PointPacket* const* points, int count,
                  PassTally& tally, ShadowAnswer* out, LaneWork* work) {
  for (int i = 0; i < count; ++i) out[i] = {0, 0};
  if (!frame.settings.effects.shadows) return;
  const PassTimer timer(tally, Pass::shadows);
  run_shadows(frame, light, points, count, tally, out, work);
  for (int i = 0; i < count; ++i) count_rays(tally, Pass::shadows, out[i].facing);
}

void light_visibility(const FrameContext& frame, const Light& light, const PointPacket& points,
                      const ShadowAnswer& answer, PassTally& tally, ColorPacket& visibility, LaneWork* work) {
  if (!frame.accelerator.has_glass || (answer.facing & ~answer.blocked) == 0) {
    set_visibility(answer, visibility);
    return;
  }
  RayPacket rays;
  {
    const PassTimer timer(tally, Pass::shadows);
    frame.kernels.shadow_rays(light, points, rays);
  }
  ray_visibility(frame, rays, answer, tally, visibility, work);
}

void ray_visibility(const FrameContext& frame, const RayPacket& rays, const ShadowAnswer& answer,
                    PassTally& tally, ColorPacket& visibility, LaneWork* work) {
  set_visibility(answer, visibility);
  const uint64_t lit = answer.facing & ~answer.blocked;
  if (!frame.settings.effects.shadows || !frame.accelerator.has_glass || lit == 0) return;
  const PassTimer timer(tally, Pass::shadows);
  RayPacket through = rays;
  through.live = lit;
  const uint64_t tinted = run_any_glass(frame, Pass::shadows, through, tally, work);
  TraversalCounts& counts = tally.traversal[static_cast<size_t>(Pass::shadows)];
  for (uint64_t left = tinted; left != 0; left &= left - 1) {
    const int lane = __builtin_ctzll(left);
    const uint64_t before = work_of(counts);
    visibility.color[lane] = glass_tint(frame, ray_of(rays, lane), counts);
    if (frame.count == Count::pixels) work->work[lane] += static_cast<float>(work_of(counts) - before);
  }
}

}  // namespace vitral
