#include "render/tile.h"

#include "math/random.h"

#include <algorithm>

namespace vitral {
namespace {

constexpr size_t kTilePixels = static_cast<size_t>(kTileSide) * kTileSide;

// Where the frame's pixel (x, y) lies in the pictures of the crop.
size_t frame_pixel(const Rectangle& crop, int x, int y) {
  return static_cast<size_t>(y - crop.y) * static_cast<size_t>(crop.width) + static_cast<size_t>(x - crop.x);
}

// Adds the tile's colours to those of the samples before, and becomes the sum.
void add_samples(const FrameContext& frame, Vec3* colors, Vec3d* sums, size_t count) {
  for (size_t i = 0; i < count; ++i) {
    const Vec3d color = to_double(colors[i]) * frame.weight;
    sums[i] = frame.sample == 0 ? color : sums[i] + color;
    colors[i] = to_float(sums[i]);
  }
}

// Moves the tile's colours to the frame, and encodes them when no sample is to come.
void resolve_tile(const FrameContext& frame, const Rectangle& crop, int tile_x, int tile_y, Worker& worker,
                  FrameTargets& out) {
  const PassTimer timer(worker.tally, Pass::resolve);
  const bool last = frame.sample + 1 == frame.settings.samples;
  const int x0 = std::max(tile_x, crop.x), x1 = std::min(tile_x + kTileSide, crop.x + crop.width);
  const int y0 = std::max(tile_y, crop.y), y1 = std::min(tile_y + kTileSide, crop.y + crop.height);
  for (int y = y0; y < y1; ++y) {
    Vec3* const colors = &worker.color[static_cast<size_t>((y - tile_y) * kTileSide + (x0 - tile_x))];
    const size_t first = frame_pixel(crop, x0, y), count = static_cast<size_t>(x1 - x0);
    if (frame.settings.samples > 1) add_samples(frame, colors, &out.sums.pixels[first], count);
    if (last) encode_row(colors, count, &out.frame.pixels.pixels[first], worker.not_finite);
    for (int x = x0; x < x1; ++x) {
      const size_t here = static_cast<size_t>((y - tile_y) * kTileSide + (x - tile_x));
      const size_t there = frame_pixel(crop, x, y);
      if (last && !out.frame.radiance.pixels.empty()) out.frame.radiance.pixels[there] = worker.color[here];
      if (!out.aovs.any) continue;
      put(frame, out.aovs, AovKind::reflection, there, worker.reflection[here]);
      put(frame, out.aovs, AovKind::refraction, there, worker.refraction[here]);
      if (frame.count == Count::pixels) put(frame, out.aovs, AovKind::cost, there, {worker.cost[here], 0, 0});
    }
  }
}

// Where a lane of the block at (x, y) of a tile lies in the tile.
size_t tile_pixel(int x, int y, int lane) {
  return static_cast<size_t>((y + lane / kBlockSide) * kTileSide + x + lane % kBlockSide);
}

// What the pixels of a tile see: what the tracer did for them, when that is asked for.
void add_cost(const FrameContext& frame, Worker& worker) {
  if (frame.count != Count::pixels || frame.raster) return;
  for (size_t i = 0; i < kTileBlocks; ++i) {
    const int block = kBlocksInOrder[i];
    const int x = block % kTileBlocksAcross * kBlockSide, y = block / kTileBlocksAcross * kBlockSide;
    for (int lane = 0; lane < kPacketSize; ++lane)
      worker.cost[tile_pixel(x, y, lane)] += worker.seen.work[i].work[lane];
  }
}

// The background where the pixels `lanes` of the i-th block of kBlocksInOrder, whose corner is (x, y), see
// nothing; a constant one is there already.
void see_background(const FrameContext& frame, size_t i, int x, int y, uint64_t lanes, int tile_x, int tile_y,
                    Worker& worker) {
  if (frame.scene.background.kind == Background::Kind::constant) return;
  const RayPacket& traced = worker.seen.rays[i];
  for (uint64_t left = lanes; left != 0; left &= left - 1) {
    const int lane = __builtin_ctzll(left);
    const Vec3 direction = frame.raster
                               ? primary_direction(frame.camera, static_cast<float>(x + lane % kBlockSide),
                                                   static_cast<float>(y + lane / kBlockSide))
                               : get(traced.dx, traced.dy, traced.dz, lane);
    worker.color[tile_pixel(x - tile_x, y - tile_y, lane)] =
        background_light(frame.scene, frame.accelerator.sky, direction);
  }
}

}  // namespace

Rectangle crop_of(const Settings& s) {
  return s.crop.width == 0 ? Rectangle{0, 0, s.width, s.height} : s.crop;
}

Tiles tiles_of(const Rectangle& crop) {
  const int x = crop.x / kTileSide, y = crop.y / kTileSide;
  return {x, y, (crop.x + crop.width - 1) / kTileSide - x + 1,
          (crop.y + crop.height - 1) / kTileSide - y + 1};
}

uint64_t lanes_inside(const Rectangle& crop, int x, int y) {
  if (x >= crop.x && y >= crop.y && x + kBlockSide <= crop.x + crop.width &&
      y + kBlockSide <= crop.y + crop.height)
    return ~0ull;
  uint64_t lanes = 0;
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const int px = x + lane % kBlockSide, py = y + lane / kBlockSide;
    if (px >= crop.x && px < crop.x + crop.width && py >= crop.y && py < crop.y + crop.height)
      lanes |= 1ull << lane;
  }
  return lanes;
}

void render_tile(const FrameContext& frame, const Rectangle& crop, int tile_x, int tile_y, Worker& worker,
                 FrameTargets& out) {
  worker.color.assign(kTilePixels, frame.scene.background.color);
  PathSums sums{worker.color.data(), nullptr, nullptr, nullptr};
  if (out.aovs.any) {
    worker.reflection.assign(kTilePixels, Vec3{0, 0, 0});
    worker.refraction.assign(kTilePixels, Vec3{0, 0, 0});
    sums = {worker.color.data(), worker.reflection.data(), worker.refraction.data(), nullptr};
  }
  if (frame.count == Count::pixels) {
    worker.cost.assign(kTilePixels, 0);
    sums.cost = worker.cost.data();
  }
  worker.paths.current.clear();
  // What the tile's blocks see, those that see anything, with the keys of their random numbers.
  uint64_t lanes[kTileBlocks];
  for (int i = 0; i < kTileBlocks; ++i) {
    const int block = kBlocksInOrder[i];
    lanes[i] = lanes_inside(crop, tile_x + block % kTileBlocksAcross * kBlockSide,
                            tile_y + block / kTileBlocksAcross * kBlockSide);
  }
  TileHits& tile = worker.seen;
  if (frame.count == Count::pixels) tile.work = {};
  find_primary_hits(frame, tile_x, tile_y, lanes, worker.tally, tile);
  add_cost(frame, worker);
  worker.surfaces.resize(kTileBlocks);
  const SurfacePacket* seen[kTileBlocks];
  int corner_x[kTileBlocks], corner_y[kTileBlocks];
  int count = 0;
  for (size_t i = 0; i < kTileBlocks; ++i) {
    const PassTimer timer(worker.tally, Pass::shade);
    const int block = kBlocksInOrder[i];
    const int x = tile_x + block % kTileBlocksAcross * kBlockSide,
              y = tile_y + block / kTileBlocksAcross * kBlockSide;
    SurfacePacket& surfaces = worker.surfaces[static_cast<size_t>(count)];
    const bool sees_any = see_surfaces(frame, tile, i, x, y, surfaces);
    see_background(frame, i, x, y, lanes[i] & ~surfaces.points.live, tile_x, tile_y, worker);
    if (!sees_any) continue;
    for (int lane = 0; lane < kPacketSize; ++lane)
      surfaces.points.key[lane] =
          pixel_key(x + lane % kBlockSide, y + lane / kBlockSide, frame.settings.seed);
    seen[count] = &surfaces;
    corner_x[count] = x, corner_y[count] = y;
    ++count;
  }

  Lit lit[kTileBlocks];
  light_surfaces(frame, seen, count, worker.tally, lit);
  for (int i = 0; i < count; ++i) {
    const SurfacePacket& surfaces = *seen[i];
    Path camera_paths[kPacketSize];
    begin_paths(frame, surfaces.points, corner_x[i] - tile_x, corner_y[i] - tile_y, camera_paths);
    absorb_paths(frame, surfaces, camera_paths, kPacketSize);
    for (uint64_t left = surfaces.points.live; left != 0; left &= left - 1) {
      const int lane = __builtin_ctzll(left);
      if (frame.sample == 0) ++worker.covered;
      worker.color[camera_paths[lane].pixel] = lit[i].light.color[lane] * camera_paths[lane].weight;
      if (sums.cost) sums.cost[camera_paths[lane].pixel] += lit[i].detail.work.work[lane];
      if (out.aovs.any)
        write_aovs(frame, out.aovs, surfaces, lit[i].detail, lane,
                   frame_pixel(crop, corner_x[i] + lane % kBlockSide, corner_y[i] + lane / kBlockSide));
    }
    spawn_paths(frame, surfaces, camera_paths, worker.tally, worker.paths.current);
  }
  trace_paths(frame, worker.paths, worker.tally, sums);

  resolve_tile(frame, crop, tile_x, tile_y, worker, out);
}

}  // namespace vitral
