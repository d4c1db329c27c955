// From the root down: find the best plane, sort the references to its sides, cut those that straddle
// it, and stop when no plane is cheaper than a leaf (Wald and Havran 2006).
//
// Large nodes are split in rounds: all nodes of a round at once, each in pieces of a fixed size that
// are counted and sorted in parallel. Small ones are finished as subtrees, in parallel too. What
// becomes of a node depends on its references alone, and the parts are joined in depth-first order:
// the tree does not depend on the threads.
#include "kdtree/build.h"

#include "kdtree/cut.h"
#include "kdtree/subtree.h"

#include <algorithm>
#include <deque>
#include <mutex>
#include <span>

namespace vitral {
namespace {

constexpr size_t kPieceSize = 8192;  // references

// The upper part of the tree: an inner node with two children, or a finished subtree. Until it is
// decided on, its references are count of them at `first` in the round's buffer.
struct Upper {
  Node node;
  size_t first = 0, count = 0;
  Box4 tight;
  double share = 0;  // of the whole work
  Plane plane{};
  Upper *below = nullptr, *above = nullptr;
  Subtree subtree;
};

// A part of a large node's references, and what is found out about it.
struct Piece {
  Upper* upper;
  size_t first, count;
  BinCounts bins;
  Counts sides;
  size_t below_at = 0, above_at = 0;  // where its references go in the next round's buffer
  Box4 tight_below, tight_above;
};

class Builder {
 public:
  // New nodes are added to `uppers`.
  Builder(const BuildContext& context, const Executor& executor, const BuildProgress& on_progress,
          std::deque<Upper>& uppers)
      : context_(context), executor_(executor), on_progress_(on_progress), uppers_(uppers) {}

  void build(Upper& root, const std::vector<uint32_t>& members) {
    make_root(root, members);
    split_rounds(root);
  }

 private:
  void make_root(Upper& root, const std::vector<uint32_t>& members);
  void split_rounds(Upper& root);
  void finish(Upper& upper);
  void make_leaf(Upper& upper);
  void find_plane(std::span<Piece*> pieces);
  bool place(std::span<Piece*> pieces, size_t& next_size);
  void scatter(Piece& piece);
  void advance(double share);
  std::span<const Reference> references_of(const Upper& u) const { return {now_.data() + u.first, u.count}; }
  std::span<const Reference> references_of(const Piece& p) const { return {now_.data() + p.first, p.count}; }

  BuildContext context_;
  const Executor& executor_;
  const BuildProgress& on_progress_;
  std::deque<Upper>& uppers_;
  ReferenceBuffer now_, next_;  // the references of this round's nodes and of their children
  std::mutex mutex_;            // of what follows
  std::vector<std::unique_ptr<Scratch>> free_scratch_;
  double finished_ = 0;
};

// Every triangle with the bounds of all of it.
void Builder::make_root(Upper& root, const std::vector<uint32_t>& members) {
  root.count = members.size();
  root.share = 1;
  now_.grow(members.size(), 0);
  std::vector<Box4> tight((members.size() + kPieceSize - 1) / kPieceSize);
  executor_(tight.size(), [&](size_t piece) {
    const size_t end = std::min(members.size(), (piece + 1) * kPieceSize);
    for (size_t i = piece * kPieceSize; i < end; ++i) {
      Box box;
      const KdTriangle& t = context_.triangles[members[i]];
      for (const auto& c : t.corner) extend(box, Vec3{c[0], c[1], c[2]});
      Reference& r = now_.data()[i];
      r = {{box.min.x, box.min.y, box.min.z}, members[i], {box.max.x, box.max.y, box.max.z}, 0};
      extend(tight[piece], lower(r), upper(r));
    }
  });
  for (const Box4& t : tight) extend(root.tight, t.min, t.max);
  root.node = {to_box(root.tight), 0, 3 * members.size()};
}

void Builder::advance(double share) {
  if (!on_progress_) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  finished_ = std::min(1.0, finished_ + share);
  on_progress_(finished_);
}

void Builder::make_leaf(Upper& upper) {
  upper.subtree.nodes.push_back(leaf_node(references_of(upper), upper.subtree.references));
  advance(upper.share);
}

void Builder::finish(Upper& upper) {
  std::unique_ptr<Scratch> scratch;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!free_scratch_.empty()) {
      scratch = std::move(free_scratch_.back());
      free_scratch_.pop_back();
    }
  }
  if (!scratch) scratch = std::make_unique<Scratch>();
  upper.subtree = finish_subtree(context_, upper.node, references_of(upper), *scratch);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    free_scratch_.push_back(std::move(scratch));
  }
  advance(upper.share);
}

// The plane of the node whose pieces, all counted, these are.
void Builder::find_plane(std::span<Piece*> pieces) {
  Upper& upper = *pieces[0]->upper;
  const BinLayout layout = make_bins(upper.tight, upper.count);
  BinCounts& bins = pieces[0]->bins;
  for (const Piece* piece : pieces.subspan(1)) add_counts(layout, piece->bins, bins);
  Candidates candidates;
  find_binned_candidates(layout, bins, upper.count, candidates);
  upper.plane = best_plane(candidates, upper.node.cell, context_.settings.costs);
}

// Makes the children and gives each piece its places in them; false when the node is not to be split.
bool Builder::place(std::span<Piece*> pieces, size_t& next_size) {
  Upper& upper = *pieces[0]->upper;
  Counts total;
  for (const Piece* piece : pieces) {
    total.below += piece->sides.below;
    total.above += piece->sides.above;
  }
  if (!is_cheaper_than_leaf(upper.plane, upper.count, context_.settings.costs) ||
      !is_allowed(upper.node, total, upper.count)) {
    return false;
  }
  const Children children = make_children(upper.node, upper.plane, total, upper.count);
  const double share = upper.share / static_cast<double>(total.below + total.above);
  upper.below = &uppers_.emplace_back();
  upper.above = &uppers_.emplace_back();
  upper.below->node = children.below, upper.above->node = children.above;
  upper.below->count = total.below, upper.above->count = total.above;
  upper.below->share = share * static_cast<double>(total.below);
  upper.above->share = share * static_cast<double>(total.above);
  upper.below->first = next_size, upper.above->first = next_size + total.below;
  next_size += total.below + total.above;
  size_t below_at = upper.below->first, above_at = upper.above->first;
  for (Piece* piece : pieces) {
    piece->below_at = below_at, piece->above_at = above_at;
    below_at += piece->sides.below, above_at += piece->sides.above;
  }
  return true;
}

void Builder::scatter(Piece& piece) {
  const Plane plane = piece.upper->plane;
  Reference *below = next_.data() + piece.below_at, *above = next_.data() + piece.above_at;
  for (const Reference& r : references_of(piece)) {
    const bool starts_below =
        r.min[plane.axis]<plane.position, ends_above = r.max[plane.axis]> plane.position;
    if (starts_below && ends_above) {
      cut(context_.triangles[r.triangle], r, plane, *below, *above);
      extend(piece.tight_below, lower(*below), vitral::upper(*below));
      extend(piece.tight_above, lower(*above), vitral::upper(*above));
      ++below, ++above;
    } else if (starts_below || (!ends_above && plane.planar == PlanarSide::below)) {
      *below++ = r;
      extend(piece.tight_below, lower(r), vitral::upper(r));
    } else {
      *above++ = r;
      extend(piece.tight_above, lower(r), vitral::upper(r));
    }
  }
}

void Builder::split_rounds(Upper& root) {
  std::vector<Upper*> round{&root};
  while (!round.empty()) {
    // Small nodes are finished; large ones are counted in pieces.
    std::vector<Upper*> small;
    std::deque<Piece> pieces;
    std::vector<Piece*> list;
    for (Upper* upper : round) {
      if (upper->count <= context_.settings.subtree_at_most || upper->node.depth >= context_.max_depth) {
        small.push_back(upper);
        continue;
      }
      for (size_t at = 0; at < upper->count; at += kPieceSize) {
        Piece& piece = pieces.emplace_back();
        piece.upper = upper;
        piece.first = upper->first + at;
        piece.count = std::min(kPieceSize, upper->count - at);
        list.push_back(&piece);
      }
    }
    executor_(small.size() + list.size(), [&](size_t i) {
      if (i < small.size()) return finish(*small[i]);
      Piece& piece = *list[i - small.size()];
      const BinLayout layout = make_bins(piece.upper->tight, piece.upper->count);
      clear(layout, piece.bins);
      count_bins(references_of(piece), layout, piece.bins);
    });

    // The planes are chosen, and the pieces counted against them.
    const auto for_each_node = [&](const auto& body) {
      for (size_t i = 0, end; i < list.size(); i = end) {
        for (end = i; end < list.size() && list[end]->upper == list[i]->upper;) ++end;
        body(std::span<Piece*>(list.data() + i, end - i));
      }
    };
    for_each_node([&](std::span<Piece*> of_node) { find_plane(of_node); });
    executor_(list.size(), [&](size_t i) {
      list[i]->sides = count_sides(references_of(*list[i]), list[i]->upper->plane);
    });

    // The references go to the children, which are the next round.
    std::vector<Piece*> split;
    size_t next_size = 0;
    round.clear();
    for_each_node([&](std::span<Piece*> of_node) {
      Upper& upper = *of_node[0]->upper;
      if (!place(of_node, next_size)) return make_leaf(upper);
      round.insert(round.end(), {upper.below, upper.above});
      split.insert(split.end(), of_node.begin(), of_node.end());
    });
    if (next_.capacity() > 2 * next_size) next_ = ReferenceBuffer();
    next_.grow(next_size, 0);
    executor_(split.size(), [&](size_t i) { scatter(*split[i]); });
    for (const Piece* piece : split) {
      extend(piece->upper->below->tight, piece->tight_below.min, piece->tight_below.max);
      extend(piece->upper->above->tight, piece->tight_above.min, piece->tight_above.max);
    }
    std::swap(now_, next_);
  }
}

// A finished subtree and where it lands in the tree.
struct Landing {
  Subtree* subtree;
  size_t root, nodes, references;
};

// Lays out a node and all below it, depth first.
void lay_out(Upper& upper, size_t at, KdTree& tree, size_t& nodes, size_t& references,
             std::vector<Landing>& landings) {
  if (upper.below) {
    const size_t pair = nodes;
    nodes += 2;
    tree.nodes.resize(std::max(tree.nodes.size(), pair + 2));
    tree.nodes[at] = inner_node(upper.plane, pair);
    lay_out(*upper.below, pair, tree, nodes, references, landings);
    lay_out(*upper.above, pair + 1, tree, nodes, references, landings);
    return;
  }
  landings.push_back({&upper.subtree, at, nodes, references});
  nodes += upper.subtree.nodes.size() - 1;
  references += upper.subtree.references.size();
}

// Copies a subtree into its place and frees it.
void land(const Landing& landing, KdTree& tree) {
  const uint32_t node_shift = static_cast<uint32_t>(landing.nodes) - 1;  // nodes[1] lands at landing.nodes
  const uint32_t reference_shift = static_cast<uint32_t>(landing.references);
  const std::vector<KdNode>& nodes = landing.subtree->nodes;
  for (size_t i = 0; i < nodes.size(); ++i) {
    KdNode n = nodes[i];
    n.axis_and_index += (is_leaf(n) ? reference_shift : node_shift) << 2;
    tree.nodes[i == 0 ? landing.root : landing.nodes + i - 1] = n;
  }
  std::copy(landing.subtree->references.begin(), landing.subtree->references.end(),
            tree.references.begin() + static_cast<std::ptrdiff_t>(landing.references));
  *landing.subtree = Subtree{};
}

int depth_limit(size_t triangles) {
  int log2 = 0;
  while (triangles >> log2 > 1) ++log2;
  return std::min(8 + 13 * log2 / 10, kMaxTreeDepth - 1);
}

}  // namespace

KdTree build_kdtree(const std::vector<KdTriangle>& triangles, const std::vector<uint32_t>& members,
                    const BuildSettings& settings, const Executor& executor,
                    const BuildProgress& on_progress) {
  std::deque<Upper> uppers;
  Upper& root = uppers.emplace_back();
  Builder({triangles, settings, depth_limit(members.size())}, executor, on_progress, uppers)
      .build(root, members);

  KdTree tree;
  tree.bounds = root.node.cell;
  tree.nodes.resize(2, KdNode{0, 3});
  std::vector<Landing> landings;
  size_t nodes = 2, references = 0;
  lay_out(root, 0, tree, nodes, references, landings);
  tree.nodes.resize(nodes);
  tree.references.resize(references);
  executor(landings.size(), [&](size_t i) { land(landings[i], tree); });
  if (on_progress) on_progress(1);
  return tree;
}

KdView make_view(const KdTree& tree, const std::vector<KdTriangle>& triangles, const CutOuts& cut_outs) {
  return {tree.nodes.data(), tree.references.data(), triangles.data(),
          tree.bounds,       magnitude(tree.bounds), cut_outs};
}

}  // namespace vitral
