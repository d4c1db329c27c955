// Binning: which setup triangles a tile has to look at.
#pragma once
#include "raster/raster.h"
#include "raster/setup.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace vitral {

// Runs body(i) once for every i in [0, count), in any order, on any threads.
using ForEach = std::function<void(size_t count, const std::function<void(size_t)>& body)>;

// Bins are anchored at the frame's corner (0, 0), whatever the crop.
BinGrid make_grid(int width, int height);

// Appends `place` to every bin that the box, which must not be empty, touches at the level it goes to.
void add_to_bins(const BinGrid& grid, const PixelBox& box, uint32_t place, std::vector<BinEntry>& entries);

// A list for every bin, one after the other: bin b has [first[b], first[b + 1]) of the items.
template <class Item>
struct BinLists {
  std::vector<uint64_t> first;
  std::vector<Item> items;
};

struct Bins {
  BinLists<SetupReference> references;  // of all levels
  BinLists<FragmentRun> runs;           // of the finest level
};

// Sorts the entries and the runs of all chunks by bin (counting sort, stable: in the order of the chunks).
// The result depends on nothing else. The runs refer to the chunks' fragments.
void merge_bins(const BinGrid& grid, const std::vector<SetupChunk>& chunks, const ForEach& for_each,
                Bins& bins);

// Triangles that are set up and sorted; kept from use to use, so that the memory is.
struct BinnedTriangles {
  BinGrid grid;
  std::vector<SetupChunk> chunks;
  std::vector<const SetupTriangle*> chunk_triangles;
  Bins bins;
};
void bin_triangles(const ForEach& for_each, BinnedTriangles& binned);

// What the fill kernel is given. Everything pointed to must outlive it. `triangles` has one entry for each
// triangle; it and `cut_outs` matter only to cut-outs and may be null.
RasterView make_view(const BinnedTriangles& binned, const Projection& projection, const Pinhole& camera,
                     const KdTriangle* triangles, const CutOuts* cut_outs);

}  // namespace vitral
