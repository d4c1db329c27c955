#include "raster/bin.h"

namespace vitral {

BinGrid make_grid(int width, int height) {
  BinGrid grid{};
  int side = kTileSide;
  for (int level = 0; level < kBinLevels; ++level, side <<= kBinLevelShift) {
    grid.across[level] = (width + side - 1) / side;
    grid.first_bin[level] = grid.bins;
    grid.bins +=
        static_cast<uint32_t>(grid.across[level]) * static_cast<uint32_t>((height + side - 1) / side);
  }
  return grid;
}

void add_to_bins(const BinGrid& grid, const PixelBox& box, uint32_t place, std::vector<BinEntry>& entries) {
  int x0 = box.x0 / kTileSide, x1 = (box.x1 - 1) / kTileSide;
  int y0 = box.y0 / kTileSide, y1 = (box.y1 - 1) / kTileSide;
  int level = 0;
  while (level + 1 < kBinLevels && (x1 - x0 + 1) * (y1 - y0 + 1) > kMaxBinsTouched) {
    x0 >>= kBinLevelShift, x1 >>= kBinLevelShift;
    y0 >>= kBinLevelShift, y1 >>= kBinLevelShift;
    ++level;
  }
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      entries.push_back({grid.first_bin[level] + static_cast<uint32_t>(y * grid.across[level] + x), place});
    }
  }
}

namespace {

// The chunks are counted and scattered in a few groups side by side: a group's entries of a bin come
// after those of the groups before it, so the number of groups cannot be seen in the result.
template <class Entry, class Item, class MakeItem>
void sort_by_bin(uint32_t bins, const std::vector<SetupChunk>& chunks,
                 std::vector<Entry> SetupChunk::*entries, const MakeItem& make_item, const ForEach& for_each,
                 BinLists<Item>& lists) {
  constexpr size_t groups = 8;
  const size_t per_group = (chunks.size() + groups - 1) / groups;
  const auto for_each_entry = [&](size_t group, const auto& visit) {
    const size_t end = (group + 1) * per_group < chunks.size() ? (group + 1) * per_group : chunks.size();
    for (size_t c = group * per_group; c < end; ++c) {
      for (const Entry& e : chunks[c].*entries) visit(e, static_cast<uint32_t>(c));
    }
  };

  std::vector<std::vector<uint64_t>> next(groups);  // per bin: how many, then where the next one goes
  for_each(groups, [&](size_t group) {
    next[group].assign(bins, 0);
    for_each_entry(group, [&](const Entry& e, uint32_t) { ++next[group][e.bin]; });
  });

  lists.first.resize(bins + size_t{1});
  uint64_t total = 0;
  for (uint32_t bin = 0; bin < bins; ++bin) {
    lists.first[bin] = total;
    for (std::vector<uint64_t>& n : next) {
      const uint64_t count = n[bin];
      n[bin] = total;
      total += count;
    }
  }
  lists.first[bins] = total;

  lists.items.resize(total);
  for_each(groups, [&](size_t group) {
    for_each_entry(group, [&](const Entry& e, uint32_t chunk) {
      lists.items[next[group][e.bin]++] = make_item(e, chunk);
    });
  });
}

}  // namespace

void merge_bins(const BinGrid& grid, const std::vector<SetupChunk>& chunks, const ForEach& for_each,
                Bins& bins) {
  const auto reference = [](const BinEntry& e, uint32_t chunk) { return chunk << kPlaceBits | e.place; };
  const auto run = [&](const RunEntry& e, uint32_t chunk) {
    return FragmentRun{chunks[chunk].fragments.data() + e.first, e.count};
  };
  sort_by_bin(grid.bins, chunks, &SetupChunk::entries, reference, for_each, bins.references);
  sort_by_bin(grid.first_bin[1], chunks, &SetupChunk::runs, run, for_each, bins.runs);
}

void bin_triangles(const ForEach& for_each, BinnedTriangles& binned) {
  binned.chunk_triangles.clear();
  for (const SetupChunk& chunk : binned.chunks) binned.chunk_triangles.push_back(chunk.triangles.data());
  merge_bins(binned.grid, binned.chunks, for_each, binned.bins);
}

RasterView make_view(const BinnedTriangles& binned, const Projection& projection, const Pinhole& camera,
                     const KdTriangle* triangles, const CutOuts* cut_outs) {
  return {binned.chunk_triangles.data(),
          binned.bins.references.items.data(),
          binned.bins.references.first.data(),
          binned.bins.runs.items.data(),
          binned.bins.runs.first.data(),
          binned.grid,
          projection.window,
          projection.least_inverse_depth,
          &camera,
          triangles,
          cut_outs,
          nullptr,
          nullptr};
}

}  // namespace vitral
