#include "raster/drawn.h"

#include "kdtree/objects.h"
#include "kdtree/shapes.h"
#include "raster/coverage.h"

#include <algorithm>
#include <chrono>
#include <memory>

namespace vitral {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// What all steps of a frame read.
struct Drawing {
  const DrawKernels& kernels;
  const RasterView& own;
  const Projection& projection;
  const ObjectsView& objects;
  const DrawnModels& models;
  const DrawSettings& settings;
  const ForEach& for_each;
};

const ClusteredMesh& mesh_of(const Drawing& d, const PlacedObject& object) {
  return d.models.meshes[d.objects.models[object.model].mesh];
}

// --- what the window shows so far -----------------------------------------------------------------

PixelBox tile_window(const Drawing& d, int x, int y) {
  return intersection(d.projection.window, {x, y, x + kTileSide, y + kTileSide});
}

// Finds the farthest pixel of every block of a tile.
void look_for_farthest(const Drawing& d, size_t tile, DrawnObjects& out) {
  const int x = (out.tile_x + static_cast<int>(tile) % out.across) * kTileSide;
  const int y = (out.tile_y + static_cast<int>(tile) / out.across) * kTileSide;
  const PixelBox window = tile_window(d, x, y);
  float of_tile = kInfinity;
  for (int block = 0; block < kTileBlocks; ++block) {
    const float* depth = out.tiles[tile].inverse_depth + block * 64;
    const int bx = x + block % kTileBlocksAcross * 8, by = y + block / kTileBlocksAcross * 8;
    const PixelBox inside = intersection(window, {bx, by, bx + 8, by + 8});
    float of_block = kInfinity;
    if (inside.x1 - inside.x0 == 8 && inside.y1 - inside.y0 == 8) {
      for (int i = 0; i < 64; ++i) of_block = least(depth[i], of_block);
    } else {
      for (int py = inside.y0; py < inside.y1; ++py) {
        for (int px = inside.x0; px < inside.x1; ++px)
          of_block = least(depth[(py - by) * 8 + px - bx], of_block);
      }
    }
    out.farthest_of_block[tile * kTileBlocks + static_cast<size_t>(block)] = of_block;
    of_tile = least(of_block, of_tile);
  }
  out.farthest_of_tile[tile] = of_tile;
}

// Whether every pixel of the bound shows something nearer. A computed inverse depth lies within the range of
// its triangle's corners, which are rounded once: the bound is more than that off.
bool is_hidden(const ScreenBound& bound, const DrawnObjects& out) {
  const PixelBox& b = bound.pixels;
  for (int ty = b.y0 / kTileSide; ty * kTileSide < b.y1; ++ty) {
    for (int tx = b.x0 / kTileSide; tx * kTileSide < b.x1; ++tx) {
      const size_t tile = tile_of(out, tx, ty);
      if (out.farthest_of_tile[tile] > bound.nearest) continue;
      const PixelBox blocks{std::max(b.x0 / 8 - tx * kTileBlocksAcross, 0),
                            std::max(b.y0 / 8 - ty * kTileBlocksAcross, 0),
                            std::min((b.x1 + 7) / 8 - tx * kTileBlocksAcross, kTileBlocksAcross),
                            std::min((b.y1 + 7) / 8 - ty * kTileBlocksAcross, kTileBlocksAcross)};
      const float* farthest = &out.farthest_of_block[tile * kTileBlocks];
      for (int y = blocks.y0; y < blocks.y1; ++y) {
        for (int x = blocks.x0; x < blocks.x1; ++x) {
          if (!(farthest[y * kTileBlocksAcross + x] > bound.nearest)) return false;
        }
      }
    }
  }
  return true;
}

// The scene's own triangles come first: ground and walls hide much.
void draw_own(const Drawing& d, DrawnObjects& out) {
  const PixelBox& w = d.projection.window;
  out.tile_x = w.x0 / kTileSide, out.tile_y = w.y0 / kTileSide;
  out.across = (w.x1 - 1) / kTileSide - out.tile_x + 1, out.down = (w.y1 - 1) / kTileSide - out.tile_y + 1;
  out.tiles.resize(static_cast<size_t>(out.across) * static_cast<size_t>(out.down));
  out.farthest_of_tile.resize(out.tiles.size());
  out.farthest_of_block.resize(out.tiles.size() * kTileBlocks);
  d.for_each(out.tiles.size(), [&](size_t tile) {
    d.kernels.fill_tile(d.own, out.tile_x + static_cast<int>(tile) % out.across,
                        out.tile_y + static_cast<int>(tile) / out.across, out.tiles[tile]);
    look_for_farthest(d, tile, out);
  });
}

// --- which objects come to the screen -------------------------------------------------------------

struct Candidates {
  std::vector<ObjectOnScreen> meshes, shapes;
};

void look_at_object(const Drawing& d, uint32_t number, Candidates& out) {
  const PlacedObject& object = d.objects.objects[number];
  const Projection projection = project_object(d.projection, d.own.camera->origin, object);
  if (object.shape == Shape::mesh) {
    const ClusteredMesh& mesh = mesh_of(d, object);
    if (mesh.clusters.empty()) return;
    const ScreenBound bound = bound_on_screen(projection, mesh.bounds, 1);
    if (!is_empty(bound.pixels)) out.meshes.push_back({bound, number});
  } else {
    // A plane without end comes near wherever it is seen.
    const ScreenBound bound =
        object.shape == Shape::plane
            ? ScreenBound{d.projection.window, kInfinity}
            : bound_on_screen(projection, shape_bounds(object.shape), ray_margin(*d.own.camera, object));
    if (!is_empty(bound.pixels)) out.shapes.push_back({bound, number});
  }
}

Candidates find_candidates(const Drawing& d) {
  constexpr size_t per_piece = 1024;
  std::vector<Candidates> pieces((d.objects.count + per_piece - 1) / per_piece);
  d.for_each(pieces.size(), [&](size_t piece) {
    const size_t end = std::min<size_t>(d.objects.count, (piece + 1) * per_piece);
    for (size_t i = piece * per_piece; i < end; ++i)
      look_at_object(d, static_cast<uint32_t>(i), pieces[piece]);
  });
  Candidates all;
  for (const Candidates& piece : pieces) {
    all.meshes.insert(all.meshes.end(), piece.meshes.begin(), piece.meshes.end());
    all.shapes.insert(all.shapes.end(), piece.shapes.begin(), piece.shapes.end());
  }
  const auto nearest_first = [](const ObjectOnScreen& a, const ObjectOnScreen& b) {
    const float p = a.bound.nearest, q = b.bound.nearest;
    return p > q || (p == q && a.object < b.object);
  };
  std::sort(all.meshes.begin(), all.meshes.end(), nearest_first);
  std::sort(all.shapes.begin(), all.shapes.end(), nearest_first);
  return all;
}

// --- batches --------------------------------------------------------------------------------------

struct ClusterOfObject {
  uint32_t object, cluster;
};

// Takes objects from `next` on until the batch is full; returns where it stopped.
size_t fill_batch(const Drawing& d, const std::vector<ObjectOnScreen>& candidates, size_t next,
                  const DrawnObjects& out, std::vector<ClusterOfObject>& batch) {
  batch.clear();
  for (size_t triangles = 0; next < candidates.size() && triangles < d.settings.batch_triangles; ++next) {
    const ObjectOnScreen& c = candidates[next];
    if (d.settings.hidden == Hidden::left_out && is_hidden(c.bound, out)) continue;
    const PlacedObject& object = d.objects.objects[c.object];
    const size_t clusters = mesh_of(d, object).clusters.size();
    for (uint32_t k = 0; k < clusters; ++k) batch.push_back({c.object, k});
    triangles += object.count;
  }
  return next;
}

// Where each chunk of a batch begins, and the last one's end.
std::vector<size_t> cut_into_chunks(const Drawing& d, const std::vector<ClusterOfObject>& clusters) {
  std::vector<size_t> first{0};
  uint32_t triangles = 0;
  for (size_t i = 0; i < clusters.size(); ++i) {
    const PlacedObject& object = d.objects.objects[clusters[i].object];
    const uint32_t more = mesh_of(d, object).clusters[clusters[i].cluster].triangles;
    if (triangles + more > kChunkTriangles) first.push_back(i), triangles = 0;
    triangles += more;
  }
  first.push_back(clusters.size());
  return first;
}

// Sets clusters up, one after the other, if they can be seen; returns how many.
size_t setup_clusters(const Drawing& d, const ClusterOfObject* begin, const ClusterOfObject* end,
                      const DrawnObjects& out, SetupChunk& chunk) {
  clear(chunk);
  const auto output = std::make_unique_for_overwrite<SetupOutput>();
  std::vector<ScreenVertex> vertices;
  SetupInput in{};
  uint32_t last = kNoIndex;
  size_t count = 0;
  for (const ClusterOfObject* c = begin; c != end; ++c) {
    const PlacedObject& object = d.objects.objects[c->object];
    const ClusteredMesh& mesh = mesh_of(d, object);
    const Cluster& cluster = mesh.clusters[c->cluster];
    if (c->object != last) in.projection = project_object(d.projection, d.own.camera->origin, object);
    last = c->object;
    if (mesh.clusters.size() > 1) {
      const ScreenBound bound = bound_on_screen(in.projection, cluster.bounds, 1);
      if (is_empty(bound.pixels)) continue;
      if (d.settings.hidden == Hidden::left_out && is_hidden(bound, out)) continue;
    }
    vertices.resize(cluster.vertices);
    in.positions = mesh.positions.data() + cluster.first_vertex;
    d.kernels.front_end.project_vertices(in.projection, in.positions, cluster.vertices, vertices.data());
    in.vertices = vertices.data();
    in.corners = mesh.corners.data() + size_t{3} * cluster.first_triangle;
    in.flags_of = d.models.has_cut_outs[object.model]
                      ? d.objects.models[object.model].tree.triangles + cluster.first_triangle
                      : nullptr;
    in.first_number = object.first_number + cluster.first_triangle;
    in.object = c->object;
    setup_range(d.kernels.front_end.setup_triangles, in, out.batch.grid, 0, cluster.triangles, *output,
                chunk);
    ++count;
  }
  return count;
}

bool has_any(const RasterView& view, int tile_x, int tile_y) {
  for (int level = 0; level < kBinLevels; ++level) {
    const uint32_t bin = bin_of(view.grid, level, tile_x, tile_y);
    if (view.first_reference[bin] != view.first_reference[bin + 1]) return true;
  }
  const uint32_t bin = bin_of(view.grid, 0, tile_x, tile_y);
  return view.first_run[bin] != view.first_run[bin + 1];
}

void draw_batch(const Drawing& d, const std::vector<ClusterOfObject>& clusters, DrawnObjects& out,
                DrawStats& stats) {
  Clock::time_point start = Clock::now();
  const auto take_time = [&](double& seconds) {
    seconds += seconds_since(start);
    start = Clock::now();
  };
  const std::vector<size_t> first = cut_into_chunks(d, clusters);
  out.batch.grid = d.own.grid;
  out.batch.chunks.resize(first.size() - 1);
  std::vector<size_t> set_up(out.batch.chunks.size());
  d.for_each(out.batch.chunks.size(), [&](size_t i) {
    set_up[i] = setup_clusters(d, clusters.data() + first[i], clusters.data() + first[i + 1], out,
                               out.batch.chunks[i]);
  });
  for (const size_t count : set_up) stats.clusters += count;
  take_time(stats.setup);
  bin_triangles(d.for_each, out.batch);
  take_time(stats.bin);
  RasterView view = make_view(out.batch, d.projection, *d.own.camera, nullptr, nullptr);
  view.placed = &d.objects;
  d.for_each(out.tiles.size(), [&](size_t tile) {
    const int x = out.tile_x + static_cast<int>(tile) % out.across,
              y = out.tile_y + static_cast<int>(tile) / out.across;
    if (!has_any(view, x, y)) return;
    d.kernels.fill_over(view, x, y, out.tiles[tile]);
    look_for_farthest(d, tile, out);
  });
  take_time(stats.fill);
}

// --- shapes ---------------------------------------------------------------------------------------

// The shapes of each tile, the nearest first. Hidden ones are left to those who know exact distances: the
// inverse depths of pixels are rounded by more than shapes are off.
void list_shapes(std::vector<ObjectOnScreen> shapes, DrawnObjects& out) {
  out.shapes = std::move(shapes);
  const auto for_each_tile = [&](const ObjectOnScreen& s, const auto& visit) {
    const PixelBox& b = s.bound.pixels;
    for (int ty = b.y0 / kTileSide; ty * kTileSide < b.y1; ++ty) {
      for (int tx = b.x0 / kTileSide; tx * kTileSide < b.x1; ++tx) visit(tile_of(out, tx, ty));
    }
  };
  std::vector<uint64_t>& first = out.shapes_of_tile.first;
  first.assign(out.tiles.size() + 1, 0);
  for (const ObjectOnScreen& s : out.shapes) for_each_tile(s, [&](size_t tile) { ++first[tile + 1]; });
  for (size_t tile = 0; tile < out.tiles.size(); ++tile) first[tile + 1] += first[tile];
  std::vector<uint64_t> next(first.begin(), first.end() - 1);
  out.shapes_of_tile.items.resize(first.back());
  for (size_t i = 0; i < out.shapes.size(); ++i) {
    for_each_tile(out.shapes[i],
                  [&](size_t tile) { out.shapes_of_tile.items[next[tile]++] = static_cast<uint32_t>(i); });
  }
}

}  // namespace

DrawStats draw_objects(const DrawKernels& kernels, const RasterView& own, const Projection& projection,
                       const ObjectsView& objects, const DrawnModels& models, const DrawSettings& settings,
                       const ForEach& for_each, DrawnObjects& out) {
  const Drawing d{kernels, own, projection, objects, models, settings, for_each};
  DrawStats stats;
  const Clock::time_point start = Clock::now();
  draw_own(d, out);
  stats.fill += seconds_since(start);
  const Clock::time_point filled = Clock::now();
  Candidates candidates = find_candidates(d);
  stats.setup += seconds_since(filled);
  std::vector<ClusterOfObject> batch;
  for (size_t next = 0; next < candidates.meshes.size();) {
    next = fill_batch(d, candidates.meshes, next, out, batch);
    if (!batch.empty()) draw_batch(d, batch, out, stats);
  }
  list_shapes(std::move(candidates.shapes), out);
  return stats;
}

}  // namespace vitral
