// One ray through the tree.
//
// A ray visits the cells of a kd-tree in order: at an inner node the plane cuts its parameter
// interval [t0, t1] in two; the child on the ray's near side is visited first, the far child waits on
// a stack with its part of the interval. When a hit lies before everything that waits, it is the
// closest (Havran, "Heuristic Ray Shooting Algorithms", 2000, chapter 4).
//
// All comparisons give way by the traversal slack, so that rounding cannot skip a cell.
#include "kdtree/kdtree.h"
#include "kdtree/triangle.h"
#include "vitral/ray.h"

namespace vitral {
namespace {

enum class Query { closest, any };

struct Interval {
  float t0, t1;
};

// The part of the ray inside the tree's box grown by the slack; empty (t0 > t1) when it misses.
Interval clip_to_bounds(const KdView& tree, const Ray& ray, const Vec3& reciprocal, float slack) {
  Interval i{ray.tmin, ray.tmax};
  for (int axis = 0; axis < 3; ++axis) {
    const float o = component(ray.origin, axis), r = component(reciprocal, axis);
    const float below = ((component(tree.bounds.min, axis) - slack) - o) * r;
    const float above = ((component(tree.bounds.max, axis) + slack) - o) * r;
    i.t0 = greatest(least(below, above), i.t0);
    i.t1 = least(greatest(below, above), i.t1);
  }
  return i;
}

// Does the ray meet the triangle inside (tmin, tmax), and closer than `hit`? Then `hit` becomes it.
bool test_triangle(const KdView& tree, const Ray& ray, int z_axis, const Shear<float>& shear, uint32_t id,
                   Hit& hit) {
  const KdTriangle& triangle = tree.triangles[id];
  Vec3 corner[3];
  for (int k = 0; k < 3; ++k) {
    const float* c = triangle.corner[k];
    corner[k] = project(permute(Vec3{c[0], c[1], c[2]} - ray.origin, z_axis), shear);
  }
  if (!may_surround_origin(corner[0], corner[1], corner[2])) return false;
  const auto found = surround_origin(corner[0], corner[1], corner[2], shear);
  if (!found.hit || !(found.t > ray.tmin && found.t < ray.tmax)) return false;
  if (!(found.t < hit.t || (found.t == hit.t && id < hit.triangle))) return false;
  if ((triangle.flags & kCutOutTriangle) &&
      !tree.cut_outs.is_there(tree.cut_outs.scene, id, found.u, found.v))
    return false;
  hit = {found.t, found.u, found.v, id};
  return true;
}

// What the walk counts, or does not.
struct NoCounts {
  void node() const {}
  void leaf() const {}
  void test() const {}
};
struct Counting {
  TraversalCounts& totals;
  void node() const { ++totals.other_nodes; }
  void leaf() const { ++totals.other_nodes, ++totals.leaves; }
  void test() const { ++totals.triangle_tests; }
};

template <Query query, class Counts>
Hit walk(const KdView& tree, const Ray& ray, GlassRule glass, Counts counts) {
  Hit best;
  if (!is_traceable(ray.origin, ray.direction)) return best;
  const Vec3 reciprocal{safe_reciprocal(ray.direction.x), safe_reciprocal(ray.direction.y),
                        safe_reciprocal(ray.direction.z)};
  const int z_axis = dominant_axis(ray.direction);
  const Shear<float> shear = make_shear(permute(ray.direction, z_axis));
  const float slack = traversal_slack(greatest(tree.magnitude, largest_component(ray.origin)));

  Interval now = clip_to_bounds(tree, ray, reciprocal, slack);
  if (!(now.t0 <= now.t1)) return best;
  struct Waiting {
    uint32_t node;
    Interval interval;
  } stack[kMaxTreeDepth];
  int waiting = 0;
  uint32_t node = 0;
  for (;;) {
    // Descend to the leaf at the near end of the interval.
    while (!is_leaf(tree.nodes[node])) {
      counts.node();
      const KdNode& n = tree.nodes[node];
      const float r = component(reciprocal, axis(n));
      const float t = (split(n) - component(ray.origin, axis(n))) * r;
      const float give = slack * absolute(r);
      const uint32_t near = child(n) + (r < 0 ? 1u : 0u), far = child(n) + (r < 0 ? 0u : 1u);
      if (t - give > now.t1) {
        node = near;
      } else if (t + give < now.t0) {
        node = far;
      } else {
        stack[waiting++] = {far, {greatest(t - give, now.t0), now.t1}};
        node = near;
        now.t1 = least(t + give, now.t1);
      }
    }

    // A hit counts even when it lies outside this cell: it is a hit all the same.
    counts.leaf();
    const KdNode& leaf = tree.nodes[node];
    for (uint32_t i = 0; i < count(leaf); ++i) {
      const uint32_t id = tree.references[first_reference(leaf) + i];
      if (glass == GlassRule::passes && (tree.triangles[id].flags & kGlassTriangle)) continue;
      counts.test();
      if (test_triangle(tree, ray, z_axis, shear, id, best) && query == Query::any) return best;
    }

    // Go on with the nearest cell that waits, unless the best hit lies before it.
    do {
      if (waiting == 0) return best;
      --waiting;
    } while (best.t < stack[waiting].interval.t0);
    node = stack[waiting].node;
    now = stack[waiting].interval;
  }
}

}  // namespace

Hit walk_closest(const KdView& tree, const Ray& ray) {
  return walk<Query::closest>(tree, ray, GlassRule::blocks, NoCounts{});
}

Hit walk_closest(const KdView& tree, const Ray& ray, TraversalCounts& counts) {
  return walk<Query::closest>(tree, ray, GlassRule::blocks, Counting{counts});
}

bool walk_any(const KdView& tree, const Ray& ray, GlassRule glass) {
  return walk<Query::any>(tree, ray, glass, NoCounts{}).triangle != kNoTriangle;
}

Hit brute_force_closest(const KdView& tree, uint32_t triangles, const Ray& ray, GlassRule glass) {
  Hit best;
  if (!is_traceable(ray.origin, ray.direction)) return best;
  const int z_axis = dominant_axis(ray.direction);
  const Shear<float> shear = make_shear(permute(ray.direction, z_axis));
  for (uint32_t id = 0; id < triangles; ++id) {
    if (glass == GlassRule::passes && (tree.triangles[id].flags & kGlassTriangle)) continue;
    test_triangle(tree, ray, z_axis, shear, id, best);
  }
  return best;
}

}  // namespace vitral
