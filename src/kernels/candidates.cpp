#include "kernels/candidates.h"

#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

// What the rays of a block can reach.
struct Reach {
  Box box;          // of their points, grown by how far they go and by the traversal's slack
  float magnitude;  // largest coordinate of the points
  float distance;
};

Reach reach_of(const KdView& tree, const PointPacket& points, float distance) {
  Box box{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  float offset = 0;
  for (int lane = 0; lane < kPacketSize; ++lane) {
    if (!(points.live >> lane & 1)) continue;
    extend(box, Vec3{points.px[lane], points.py[lane], points.pz[lane]});
    offset = vitral::greatest(points.offset[lane], offset);
  }
  const float far = distance * 1.00001f + offset, size = magnitude(box);
  const float grow = far + traversal_slack(vitral::greatest(tree.magnitude, size + far));
  return {{box.min - Vec3{grow, grow, grow}, box.max + Vec3{grow, grow, grow}}, size, distance};
}

bool overlaps(const KdTriangle& t, const Box& box) {
  for (int a = 0; a < 3; ++a) {
    const float x = t.corner[0][a], y = t.corner[1][a], z = t.corner[2][a];
    if (vitral::greatest(x, vitral::greatest(y, z)) < component(box.min, a)) return false;
    if (vitral::least(x, vitral::least(y, z)) > component(box.max, a)) return false;
  }
  return true;
}

float magnitude_of(const KdTriangle& t) {
  float m = 0;
  for (int a = 0; a < 3; ++a) {
    for (int k = 0; k < 3; ++k) m = vitral::greatest(vitral::absolute(t.corner[k][a]), m);
  }
  return m;
}

// The points whose tangent plane, raised by the offset, the triangle rises above. The margin covers
// directions that are some ulps below the plane, and hits that are computed off their triangle: by
// less than 2^-20 of the largest coordinate that goes in.
uint64_t lanes_above(const KdTriangle& t, const PointPacket& points, const Reach& reach) {
  const float margin =
      (vitral::greatest(magnitude_of(t), reach.magnitude) + reach.distance) * (1.0f / 1048576);
  uint64_t above = 0;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Vec3T<Float> n{load(points.gx + g), load(points.gy + g), load(points.gz + g)};
    const Vec3T<Float> p{load(points.px + g), load(points.py + g), load(points.pz + g)};
    Float highest = Float(-kInfinity);
    for (const float* c : {t.corner[0], t.corner[1], t.corner[2]}) {
      highest =
          greatest(dot(n, Vec3T<Float>{Float(c[0]) - p.x, Float(c[1]) - p.y, Float(c[2]) - p.z}), highest);
    }
    above |= static_cast<uint64_t>(bits(highest > load(points.offset + g) - Float(margin))) << g;
  }
  return above & points.live;
}

void add(const KdView& tree, uint32_t id, const PointPacket& points, const Reach& reach, Candidates& out) {
  const KdTriangle& t = tree.triangles[id];
  if ((t.flags & kGlassTriangle) || !overlaps(t, reach.box)) return;
  for (int i = 0; i < out.count; ++i) {
    if (out.triangle[i] == id) return;
  }
  const uint64_t lanes = lanes_above(t, points, reach);
  if (lanes == 0) return;
  if (out.count < kMaxCandidates) {
    out.triangle[out.count] = id;
    out.lanes[out.count] = lanes;
  }
  ++out.count;
}

}  // namespace

void find_candidates(const KdView& tree, const PointPacket& points, float distance, Candidates& out) {
  const Reach reach = reach_of(tree, points, distance);
  const Box& box = reach.box;
  out.count = 0;

  // Down to where the box lies on both sides of the plane: nothing outside this node can be met.
  uint32_t node = 0;
  while (!is_leaf(tree.nodes[node])) {
    const KdNode& n = tree.nodes[node];
    const bool below = component(box.min, axis(n)) <= split(n),
               above = component(box.max, axis(n)) >= split(n);
    if (below && above) break;
    node = child(n) + (above ? 1u : 0u);
  }
  out.node = node;

  // All leaves that the box overlaps, until there are too many triangles, or too much empty space.
  constexpr int kMaxVisits = 200;
  uint32_t stack[kMaxTreeDepth];
  int waiting = 0;
  for (int visits = 0;; ++visits) {
    if (visits == kMaxVisits) out.count = kMaxCandidates + 1;
    if (out.count > kMaxCandidates) return;
    const KdNode& n = tree.nodes[node];
    if (is_leaf(n)) {
      for (uint32_t i = 0; i < count(n) && out.count <= kMaxCandidates; ++i) {
        add(tree, tree.references[first_reference(n) + i], points, reach, out);
      }
      if (waiting == 0) return;
      node = stack[--waiting];
      continue;
    }
    const bool below = component(box.min, axis(n)) <= split(n),
               above = component(box.max, axis(n)) >= split(n);
    if (below && above) stack[waiting++] = child(n) + 1;
    node = child(n) + (below ? 0u : 1u);
  }
}

}  // namespace VITRAL_ISA
}  // namespace vitral
