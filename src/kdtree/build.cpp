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
#include "kdtree/upper.h"

#include <algorithm>
#include <deque>
#include <mutex>
#include <span>

namespace vitral {
namespace {

constexpr size_t kPieceSize = 8192;  // references

// A part of a large node's references, and what is found out about it.
struct Piece {
  Piece(Upper* upper_node, size_t first_reference, size_t reference_count)
      : upper(upper_node), first(first_reference), count(reference_count) {}

  Upper* upper;
  size_t first, count;
  BinCounts bins;
  Counts sides;
  size_t below_at = 0, above_at = 0;  // where its references go in the next round's buffer
  Box4 tight_below, tight_above;
};

// Calls body with the pieces of each node in turn.
template <class Body>
void for_each_node(std::vector<Piece>& pieces, const Body& body) {
  for (size_t i = 0, end; i < pieces.size(); i = end) {
    for (end = i + 1; end < pieces.size() && pieces[end].upper == pieces[i].upper;) ++end;
    body(std::span<Piece>(pieces).subspan(i, end - i));
  }
}

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
  std::vector<Piece> cut_up(const std::vector<Upper*>& round, std::vector<Upper*>& small) const;
  void bin(Piece& piece) const;
  void find_plane(std::span<Piece> pieces);
  std::vector<Upper*> make_children(std::vector<Piece>& pieces);
  bool place(std::span<Piece> pieces, size_t& next_size);
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

void Builder::bin(Piece& piece) const {
  const BinLayout layout = make_bins(piece.upper->tight, piece.upper->count);
  clear(layout, piece.bins);
  count_bins(references_of(piece), layout, piece.bins);
}

// The plane of the node whose pieces, all counted, these are.
void Builder::find_plane(std::span<Piece> pieces) {
  Upper& upper = *pieces[0].upper;
  const BinLayout layout = make_bins(upper.tight, upper.count);
  BinCounts& bins = pieces[0].bins;
  for (const Piece& piece : pieces.subspan(1)) add_counts(layout, piece.bins, bins);
  Candidates candidates;
  find_binned_candidates(layout, bins, upper.count, candidates);
  upper.plane = best_plane(candidates, upper.node.cell, context_.settings.costs);
}

// Makes the children and gives each piece its places in them; false when the node is not to be split.
bool Builder::place(std::span<Piece> pieces, size_t& next_size) {
  Upper& upper = *pieces[0].upper;
  Counts total;
  for (const Piece& piece : pieces) {
    total.below += piece.sides.below;
    total.above += piece.sides.above;
  }
  if (!is_cheaper_than_leaf(upper.plane, upper.count, context_.settings.costs) ||
      !is_allowed(upper.node, total, upper.count)) {
    return false;
  }
  const Children children = vitral::make_children(upper.node, upper.plane, total, upper.count);
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
  for (Piece& piece : pieces) {
    piece.below_at = below_at, piece.above_at = above_at;
    below_at += piece.sides.below, above_at += piece.sides.above;
  }
  return true;
}

// Sorts a piece to the children, if its node has any.
void Builder::scatter(Piece& piece) {
  if (!piece.upper->below) return;
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

// Sorts out the small nodes, and cuts the references of the others into pieces.
std::vector<Piece> Builder::cut_up(const std::vector<Upper*>& round, std::vector<Upper*>& small) const {
  std::vector<Piece> pieces;
  for (Upper* upper : round) {
    if (upper->count <= context_.settings.subtree_at_most || upper->node.depth >= context_.max_depth) {
      small.push_back(upper);
      continue;
    }
    for (size_t at = 0; at < upper->count; at += kPieceSize)
      pieces.emplace_back(upper, upper->first + at, std::min(kPieceSize, upper->count - at));
  }
  return pieces;
}

// Makes the children of the nodes whose pieces these are, all of them counted. Nodes that are better
// not split become leaves.
std::vector<Upper*> Builder::make_children(std::vector<Piece>& pieces) {
  std::vector<Upper*> children;
  size_t next_size = 0;
  for_each_node(pieces, [&](std::span<Piece> of_node) {
    Upper& upper = *of_node[0].upper;
    if (!place(of_node, next_size)) return make_leaf(upper);
    children.insert(children.end(), {upper.below, upper.above});
  });
  if (next_.capacity() > 2 * next_size) next_ = ReferenceBuffer();
  next_.grow(next_size, 0);
  return children;
}

void Builder::split_rounds(Upper& root) {
  std::vector<Upper*> round{&root};
  while (!round.empty()) {
    // Small nodes are finished, large ones binned.
    std::vector<Upper*> small;
    std::vector<Piece> pieces = cut_up(round, small);
    executor_(small.size() + pieces.size(), [&](size_t i) {
      if (i < small.size())
        finish(*small[i]);
      else
        bin(pieces[i - small.size()]);
    });

    // The planes are chosen, and the references sorted to the children, which are the next round.
    for_each_node(pieces, [&](std::span<Piece> of_node) { find_plane(of_node); });
    executor_(pieces.size(), [&](size_t i) {
      pieces[i].sides = count_sides(references_of(pieces[i]), pieces[i].upper->plane);
    });
    round = make_children(pieces);
    executor_(pieces.size(), [&](size_t i) { scatter(pieces[i]); });
    for (const Piece& piece : pieces) {
      if (!piece.upper->below) continue;
      extend(piece.upper->below->tight, piece.tight_below.min, piece.tight_below.max);
      extend(piece.upper->above->tight, piece.tight_above.min, piece.tight_above.max);
    }
    std::swap(now_, next_);
  }
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
  join(root, executor, tree);
  if (on_progress) on_progress(1);
  return tree;
}

KdView make_view(const KdTree& tree, const std::vector<KdTriangle>& triangles, const CutOuts& cut_outs) {
  return {tree.nodes.data(), tree.references.data(), triangles.data(),
          tree.bounds,       magnitude(tree.bounds), cut_outs};
}

}  // namespace vitral
