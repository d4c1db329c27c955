#include "kernels/candidates.h"

#include "simd/simd.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

// The box of the rays' points, grown by how far they go and by the traversal's slack.
Box reach_of(const KdView& tree, const PointPacket& points, float distance, float offset, float& slack) {
  Box box{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  for (int lane = 0; lane < kPacketSize; ++lane) {
    if (points.live >> lane & 1) extend(box, Vec3{points.px[lane], points.py[lane], points.pz[lane]});
  }
  const float reach = distance * 1.00001f + offset;
  slack = traversal_slack(vitral::greatest(tree.magnitude, magnitude(box) + reach));
  const Vec3 grow{reach + slack, reach + slack, reach + slack};
  return {box.min - grow, box.max + grow};
}

bool overlaps(const KdTriangle& t, const Box& box) {
  for (int a = 0; a < 3; ++a) {
    const float x = t.corner[0][a], y = t.corner[1][a], z = t.corner[2][a];
    if (vitral::greatest(x, vitral::greatest(y, z)) < component(box.min, a)) return false;
    if (vitral::least(x, vitral::least(y, z)) > component(box.max, a)) return false;
  }
  return true;
}

// The points whose tangent plane the triangle rises above. A ray's direction is at most a few ulps
// below the plane; a computed hit is within a quarter of the slack of its triangle.
uint64_t lanes_above(const KdTriangle& t, const PointPacket& points, float offset, float margin) {
  uint64_t above = 0;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Vec3T<Float> n{load(points.gx + g), load(points.gy + g), load(points.gz + g)};
    const Vec3T<Float> p{load(points.px + g), load(points.py + g), load(points.pz + g)};
    Float highest = Float(-kInfinity);
    for (const float* c : {t.corner[0], t.corner[1], t.corner[2]}) {
      highest = greatest(dot(n, Vec3T<Float>{Float(c[0]) - p.x, Float(c[1]) - p.y, Float(c[2]) - p.z}), highest);
    }
    above |= static_cast<uint64_t>(bits(highest > Float(offset - margin))) << g;
  }
  return above & points.live;
}

void add(const KdView& tree, uint32_t id, const Box& box, const PointPacket& points, float offset, float margin, Candidates& out) {
  const KdTriangle& t = tree.triangles[id];
  if ((t.flags & kGlassTriangle) || !overlaps(t, box)) return;
  for (int i = 0; i < out.count; ++i) {
    if (out.triangle[i] == id) return;
  }
  const uint64_t lanes = lanes_above(t, points, offset, margin);
  if (lanes == 0) return;
  if (out.count < kMaxCandidates) {
    out.triangle[out.count] = id;
    out.lanes[out.count] = lanes;
  }
  ++out.count;
}

}  // namespace

void find_candidates(const KdView& tree, const PointPacket& points, float distance, float offset, Candidates& out) {
  float slack;
  const Box box = reach_of(tree, points, distance, offset, slack);
  const float margin = 0.25f * slack + distance * (1.0f / 1048576);
  out.count = 0;

  // Down to where the box lies on both sides of the plane: nothing outside this node can be met.
  uint32_t node = 0;
  while (!is_leaf(tree.nodes[node])) {
    const KdNode& n = tree.nodes[node];
    const bool below = component(box.min, axis(n)) <= split(n), above = component(box.max, axis(n)) >= split(n);
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
        add(tree, tree.references[first_reference(n) + i], box, points, offset, margin, out);
      }
      if (waiting == 0) return;
      node = stack[--waiting];
      continue;
    }
    const bool below = component(box.min, axis(n)) <= split(n), above = component(box.max, axis(n)) >= split(n);
    if (below && above) stack[waiting++] = child(n) + 1;
    node = child(n) + (below ? 0u : 1u);
  }
}

}  // namespace VITRAL_ISA
}  // namespace vitral
