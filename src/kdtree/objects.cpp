// One ray through the tree over the objects.
//
// A node is entered when the ray's interval inside its box, grown by the slack that its objects need, is not
// empty. In a leaf the ray goes into the object's space and meets a shape or walks the model's own tree; what
// it finds there is compared by t and number.
#include "kdtree/objects.h"

#include "kdtree/object_tree.h"
#include "kdtree/shapes.h"

namespace vitral {
namespace {

bool is_closer(float t, uint32_t number, const Hit& best) {
  return t < best.t || (t == best.t && number < best.triangle);
}

// The next number above t >= 0: hits at t itself are within an interval that ends there.
float just_above(float t) {
  return t < kInfinity ? from_bits(as_bits(t) + 1) : t;
}

Ray to_object_space(const PlacedObject& object, const Ray& ray) {
  const ObjectRay<double> there = ray_to_object(object, ray.origin, ray.direction);
  return {narrowed(there.origin), ray.tmin, narrowed(there.direction), ray.tmax};
}

bool meet_shape(const ObjectsView& view, uint32_t i, const Ray& ray, float& t) {
  const PlacedObject& object = view.objects[i];
  if (object.flags & kCutOutTriangle) return meet_cut_out(view, i, ray, t);
  const ObjectRay<double> there = ray_to_object(object, ray.origin, ray.direction);
  const auto found = nearest_end(shape_span(object.shape, there.origin, there.direction), ray.tmin, ray.tmax);
  t = found.t;
  return found.hit;
}

// How the objects' triangles are searched: by their trees, or all of them.
enum class Search { tree, all };

Hit closest_in(const ModelView& model, const PlacedObject& object, const Ray& ray, Seen seen, Search search,
               TraversalCounts* counts) {
  if (search == Search::all) return brute_force_closest(model.tree, object.count, ray, GlassRule::blocks);
  const KdView& tree = seen == Seen::glass_only ? model.glass : model.tree;
  return counts ? walk_closest(tree, ray, *counts) : walk_closest(tree, ray);
}

void meet_closest(const ObjectsView& view, uint32_t i, const Ray& ray, Seen seen, Search search, Hit& best,
                  TraversalCounts* counts) {
  const PlacedObject& object = view.objects[i];
  if (object.shape != Shape::mesh) {
    if (seen == Seen::glass_only && !(object.flags & kGlassTriangle)) return;
    if (counts) ++counts->triangle_tests;
    float t = 0;
    if (meet_shape(view, i, ray, t) && is_closer(t, object.first_number, best))
      best = {t, 0, 0, object.first_number};
    return;
  }
  const ModelView& model = view.models[object.model];
  if (seen == Seen::glass_only && !model.has_glass) return;
  Ray there = to_object_space(object, ray);
  there.tmax = least(ray.tmax, just_above(best.t));
  const Hit hit = closest_in(model, object, there, seen, search, counts);
  if (hit.triangle == kNoTriangle) return;
  const uint32_t number = object.first_number + hit.triangle;
  if (is_closer(hit.t, number, best)) best = {hit.t, hit.u, hit.v, number};
}

bool meet_any(const ObjectsView& view, uint32_t i, const Ray& ray, GlassRule glass, Search search) {
  const PlacedObject& object = view.objects[i];
  if (object.shape != Shape::mesh) {
    float t = 0;
    if (glass == GlassRule::passes && (object.flags & kGlassTriangle)) return false;
    return meet_shape(view, i, ray, t);
  }
  const KdView& tree = view.models[object.model].tree;
  const Ray there = to_object_space(object, ray);
  if (search == Search::tree) return walk_any(tree, there, glass);
  return brute_force_closest(tree, object.count, there, glass).triangle != kNoTriangle;
}

// What a ray brings to the boxes.
struct BoxRay {
  Vec3 origin, reciprocal;
  float slack, tmin;
};
BoxRay box_ray(const ObjectsView& view, const Ray& ray) {
  const Vec3& d = ray.direction;
  return {ray.origin,
          {safe_reciprocal(d.x), safe_reciprocal(d.y), safe_reciprocal(d.z)},
          traversal_slack(greatest(view.magnitude, largest_component(ray.origin))),
          ray.tmin};
}
bool enters(const ObjectNode& node, const BoxRay& ray, float tmax) {
  const float slack = ray.slack * node.slack;
  float t0 = ray.tmin, t1 = tmax;
  for (int axis = 0; axis < 3; ++axis) {
    const float o = component(ray.origin, axis), r = component(ray.reciprocal, axis);
    const float below = ((component(node.bounds.min, axis) - slack) - o) * r;
    const float above = ((component(node.bounds.max, axis) + slack) - o) * r;
    t0 = greatest(least(below, above), t0);
    t1 = least(greatest(below, above), t1);
  }
  return t0 <= t1;
}

// Calls meet(object) for the objects whose boxes the ray enters before `tmax`, until one returns true.
template <class Meet>
void for_objects_on(const ObjectsView& view, const Ray& ray, const float& tmax, TraversalCounts* counts,
                    const Meet& meet) {
  if (view.count == 0 || !is_traceable(ray.origin, ray.direction)) return;
  if (view.nodes) {
    const BoxRay box = box_ray(view, ray);
    uint32_t stack[kMaxObjectDepth];
    int waiting = 0;
    stack[waiting++] = 0;
    while (waiting > 0) {
      const ObjectNode& node = view.nodes[stack[--waiting]];
      if (!enters(node, box, tmax)) continue;
      if (counts) ++counts->other_nodes;
      if (node.axis == 3) {
        if (counts) ++counts->leaves;
        if (meet(node.left)) return;
        continue;
      }
      const uint32_t near = component(ray.direction, static_cast<int>(node.axis)) < 0 ? 1u : 0u;
      stack[waiting++] = node.left + (1 - near);
      stack[waiting++] = node.left + near;
    }
  }
  for (uint32_t i = 0; i < view.unbounded_count; ++i) {
    if (meet(view.unbounded[i])) return;
  }
}

}  // namespace

bool meet_cut_out(const ObjectsView& view, uint32_t i, const Ray& ray, float& t) {
  const PlacedObject& object = view.objects[i];
  const ObjectRay<double> there = ray_to_object(object, ray.origin, ray.direction);
  const LineSpan<double> span = shape_span(object.shape, there.origin, there.direction);
  if (!(span.enter <= span.leave)) return false;
  for (const double end : {span.enter, span.leave}) {
    t = narrow(end);
    if (!(t > ray.tmin && t < ray.tmax)) continue;
    const Vec2 uv = shape_point(object.shape, there.origin, there.direction, end).texcoord;
    if (view.cut_outs.is_there(view.cut_outs.scene, i, uv.x, uv.y)) return true;
  }
  return false;
}

void walk_objects(const ObjectsView& view, const Ray& ray, Seen seen, Hit& best) {
  for_objects_on(view, ray, best.t, nullptr, [&](uint32_t i) {
    meet_closest(view, i, ray, seen, Search::tree, best, nullptr);
    return false;
  });
}

void walk_objects(const ObjectsView& view, const Ray& ray, Seen seen, Hit& best, TraversalCounts& counts) {
  for_objects_on(view, ray, best.t, &counts, [&](uint32_t i) {
    meet_closest(view, i, ray, seen, Search::tree, best, &counts);
    return false;
  });
}

bool walk_objects_any(const ObjectsView& view, const Ray& ray, GlassRule glass) {
  bool met = false;
  for_objects_on(view, ray, ray.tmax, nullptr,
                 [&](uint32_t i) { return met = meet_any(view, i, ray, glass, Search::tree); });
  return met;
}

void brute_force_objects(const ObjectsView& view, const Ray& ray, Hit& best) {
  if (!is_traceable(ray.origin, ray.direction)) return;
  for (uint32_t i = 0; i < view.count; ++i)
    meet_closest(view, i, ray, Seen::everything, Search::all, best, nullptr);
}

bool brute_force_objects_any(const ObjectsView& view, const Ray& ray, GlassRule glass) {
  if (!is_traceable(ray.origin, ray.direction)) return false;
  for (uint32_t i = 0; i < view.count; ++i) {
    if (meet_any(view, i, ray, glass, Search::all)) return true;
  }
  return false;
}

bool comes_near(const ObjectsView& view, const Box& box) {
  if (view.count == 0) return false;
  if (view.unbounded_count > 0) return true;
  const float slack = traversal_slack(greatest(view.magnitude, magnitude(box)));
  uint32_t stack[kMaxObjectDepth];
  int waiting = 0;
  if (view.nodes) stack[waiting++] = 0;
  while (waiting > 0) {
    const ObjectNode& node = view.nodes[stack[--waiting]];
    bool apart = false;
    for (int axis = 0; axis < 3; ++axis) {
      const float give = slack * node.slack;
      apart |= component(node.bounds.min, axis) - give > component(box.max, axis) ||
               component(node.bounds.max, axis) + give < component(box.min, axis);
    }
    if (apart) continue;
    if (node.axis == 3) return true;
    stack[waiting++] = node.left;
    stack[waiting++] = node.left + 1;
  }
  return false;
}

}  // namespace vitral
