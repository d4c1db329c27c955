#include "kdtree/object_tree.h"

#include <algorithm>
#include <cstddef>

namespace vitral {
namespace {

struct Item {
  Box box;
  Vec3 middle;
  uint32_t object;
  float slack;
};

float half_area(const Box& b) {
  if (is_empty(b)) return 0;
  const Vec3 e = extent(b);
  return (e.x * e.y + e.y * e.z) + e.z * e.x;
}

constexpr int kBins = 16;
constexpr int kHeuristicDepth = 48;  // below, nodes are halved: 48 levels more are enough for 2^32 objects

struct Cut {
  float cost = std::numeric_limits<float>::infinity();
  int axis = 0, bin = 0;  // bins below this one go left
};

// Which of the bins between the outermost middles an item falls into.
struct Bins {
  float lower, scale;
  int of(float x) const { return std::clamp(static_cast<int>((x - lower) * scale), 0, kBins - 1); }
};
Bins bins_along(const Box& middles, int axis) {
  const float lower = component(middles.min, axis), width = component(middles.max, axis) - lower;
  const float scale = static_cast<float>(kBins) / width;
  return {lower, scale - scale == 0 ? scale : 0.0f};  // no width has no finite scale
}

// The least cost over the planes between bins; ties go to the lower axis, then to the lower bin.
Cut best_cut(const std::vector<Item>& items, size_t begin, size_t end, const Box& middles) {
  Cut best;
  for (int axis = 0; axis < 3; ++axis) {
    const Bins bins = bins_along(middles, axis);
    if (bins.scale == 0) continue;
    Box box[kBins];
    size_t count[kBins] = {};
    for (size_t i = begin; i < end; ++i) {
      const int b = bins.of(component(items[i].middle, axis));
      extend(box[b], items[i].box);
      ++count[b];
    }
    float right_cost[kBins];
    Box right;
    size_t right_count = 0;
    for (int b = kBins - 1; b > 0; --b) {
      if (count[b] > 0) extend(right, box[b]);
      right_count += count[b];
      right_cost[b] = half_area(right) * static_cast<float>(right_count);
    }
    Box left;
    size_t left_count = 0;
    for (int b = 1; b < kBins; ++b) {
      if (count[b - 1] > 0) extend(left, box[b - 1]);
      left_count += count[b - 1];
      if (left_count == 0 || left_count == end - begin) continue;
      const float cost = half_area(left) * static_cast<float>(left_count) + right_cost[b];
      if (cost < best.cost) best = {cost, axis, b};
    }
  }
  return best;
}

class Builder {
 public:
  Builder(std::vector<Item> items, std::vector<ObjectNode>& nodes)
      : items_(std::move(items)), nodes_(nodes) {}

  // Decides on items [begin, end), which are to be node `at`, and on all below it.
  void build(size_t at, size_t begin, size_t end, int depth) {
    Box bounds, middles;
    float slack = 0;
    for (size_t i = begin; i < end; ++i) {
      extend(bounds, items_[i].box);
      extend(middles, items_[i].middle);
      slack = greatest(slack, items_[i].slack);
    }
    if (end - begin == 1) {
      nodes_[at] = {bounds, slack, items_[begin].object, 3};
      return;
    }
    uint32_t axis = 0;
    const size_t middle = divide(begin, end, middles, depth, axis);
    const size_t left = nodes_.size();
    nodes_[at] = {bounds, slack, static_cast<uint32_t>(left), axis};
    nodes_.resize(left + 2);
    build(left, begin, middle, depth + 1);
    build(left + 1, middle, end, depth + 1);
  }

 private:
  size_t divide(size_t begin, size_t end, const Box& middles, int depth, uint32_t& axis) {
    if (depth < kHeuristicDepth) {
      const Cut cut = best_cut(items_, begin, end, middles);
      if (cut.cost < std::numeric_limits<float>::infinity()) {
        axis = static_cast<uint32_t>(cut.axis);
        const Bins bins = bins_along(middles, cut.axis);
        const auto first = items_.begin() + static_cast<ptrdiff_t>(begin),
                   last = items_.begin() + static_cast<ptrdiff_t>(end);
        const auto middle = std::stable_partition(first, last, [&](const Item& item) {
          return bins.of(component(item.middle, cut.axis)) < cut.bin;
        });
        return static_cast<size_t>(middle - items_.begin());
      }
    }
    return begin + (end - begin) / 2;
  }

  std::vector<Item> items_;
  std::vector<ObjectNode>& nodes_;
};

// The largest sum of the absolute values of a row: no coordinate grows by more.
double norm(const PreciseAffine& a) {
  const auto row = [](double x, double y, double z) { return (absolute(x) + absolute(y)) + absolute(z); };
  return greatest(row(a.x.x, a.y.x, a.z.x), greatest(row(a.x.y, a.y.y, a.z.y), row(a.x.z, a.y.z, a.z.z)));
}

}  // namespace

// traversal_slack() bounds what rounding does in a space by its largest coordinate. The object's space brings
// its own, of the ray's origin o moved there: no more than |M^-1| (|o| + |c|), c the placement's origin; back
// in the world it is |M| times as large. Twice that covers the rounding of the ray and of the boxes.
float slack_of(const PlacedObject& object) {
  return narrow(2 * norm(to_double(object.to_world)) * norm(object.to_object));
}

ObjectTree build_object_tree(const std::vector<PlacedObject>& objects) {
  ObjectTree tree;
  std::vector<Item> items;
  for (uint32_t i = 0; i < objects.size(); ++i) {
    const Box& box = objects[i].bounds;
    if (is_empty(box)) continue;
    const float size = diagonal(box);
    if (size - size == 0) {
      items.push_back({box, center(box), i, slack_of(objects[i])});
    } else {
      tree.unbounded.push_back(i);
    }
  }
  if (items.empty()) return tree;
  tree.nodes.reserve(2 * items.size());
  tree.nodes.resize(1);
  const size_t count = items.size();
  Builder(std::move(items), tree.nodes).build(0, 0, count, 0);
  return tree;
}

}  // namespace vitral
