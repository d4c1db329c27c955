// Objects on the screen. A mesh that is placed many times has more triangles than can be set up at once: they
// are drawn in batches, from the nearest object to the farthest, into a visibility buffer of the whole
// window. As at every pixel the greatest inverse depth wins, and of equal ones the lowest number, no order
// and no batch can be seen in the result.
//
// What cannot be seen is left out early: objects and clusters of triangles beside the window, and those
// behind what every pixel of their bound shows already (Greene, Kass and Miller, "Hierarchical Z-Buffer
// Visibility", SIGGRAPH 1993).
//
// Exact shapes are only found here, as the pixels they can cover at most: which do see them the camera rays
// tell afterwards, by the tracer's own test, and compare exact distances then.
#pragma once
#include "raster/bin.h"
#include "raster/clusters.h"
#include "raster/on_screen.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace vitral {

struct ObjectOnScreen {
  ScreenBound bound;
  uint32_t object;
};
// Whether it can be seen in the block of 8x8 pixels whose corner is (x, y).
static inline bool touches_block(const ObjectOnScreen& s, int x, int y) {
  const PixelBox& b = s.bound.pixels;
  return b.x0 < x + 8 && b.x1 > x && b.y0 < y + 8 && b.y1 > y;
}

// Kept from frame to frame. Tiles and blocks are those that the window touches, row by row, and the blocks of
// a tile side by side.
struct DrawnObjects {
  int tile_x = 0, tile_y = 0, across = 0, down = 0;
  std::vector<TileVisibility> tiles;
  std::vector<float> farthest_of_block, farthest_of_tile;  // least inverse depth of its pixels in the window
  std::vector<ObjectOnScreen> shapes;                      // the nearest first
  BinLists<uint32_t> shapes_of_tile;                       // in `shapes`
  BinnedTriangles batch;
};

static inline size_t tile_of(const DrawnObjects& drawn, int tile_x, int tile_y) {
  return static_cast<size_t>((tile_y - drawn.tile_y) * drawn.across + (tile_x - drawn.tile_x));
}

struct DrawKernels {
  FrontEnd front_end;
  FillKernel fill_tile, fill_over;
};

enum class Hidden { left_out, drawn };
struct DrawSettings {
  size_t batch_triangles = 1 << 16;  // a batch is full with so many; at least one object
  Hidden hidden = Hidden::left_out;  // meshes; tests compare the two
};

struct DrawStats {
  double setup = 0, bin = 0, fill = 0;  // seconds by the clock, on all threads
  size_t clusters = 0;                  // that were set up
};

// The meshes that objects place, as they are drawn.
struct DrawnModels {
  std::vector<ClusteredMesh> meshes;  // of Scene::models; empty where nothing is placed
  std::vector<bool> has_cut_outs;     // of ObjectsView::models
};

// Fills the window with the scene's own triangles, of which `own` is the view, and then with the objects.
DrawStats draw_objects(const DrawKernels& kernels, const RasterView& own, const Projection& projection,
                       const ObjectsView& objects, const DrawnModels& models, const DrawSettings& settings,
                       const ForEach& for_each, DrawnObjects& out);

}  // namespace vitral
