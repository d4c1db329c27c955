#include "render/measure.h"

#include "math/random.h"
#include "render/render.h"
#include "render/tile.h"
#include "vitral/box.h"
#include "vitral/error.h"

#include <functional>

namespace vitral {
namespace {

// What the camera sees in one block, kept from pass to pass.
struct Block {
  int x = 0, y = 0;
  uint64_t lanes = 0;  // pixels in the picture
  SurfacePacket surfaces;
};

struct Counts {
  uint64_t rays = 0, hits = 0, blocked = 0, free = 0;
};

// A worker's own memory.
struct Scratch {
  Counts counts;
  PassTally tally;
  TileVisibility visibility;
  PathScratch paths;
  std::vector<Vec3> color;
};

// The blocks of a tile stand side by side, tiles row by row.
struct Picture {
  const FrameContext& frame;
  ThreadPool& pool;
  const Control& control;
  int repeat;
  int tiles_x, tiles_y;
  std::vector<Block> blocks;
  std::vector<Scratch> scratch;
};

uint64_t pixels_in(const Settings& settings, int x, int y) {
  uint64_t lanes = 0;
  for (int lane = 0; lane < kPacketSize; ++lane) {
    if (x + lane % kBlockSide < settings.width && y + lane / kBlockSide < settings.height)
      lanes |= 1ull << lane;
  }
  return lanes;
}

// Every block has its place, whatever it sees.
void lay_out(Picture& p) {
  p.tiles_x = (p.frame.settings.width + kTileSide - 1) / kTileSide;
  p.tiles_y = (p.frame.settings.height + kTileSide - 1) / kTileSide;
  p.blocks.resize(static_cast<size_t>(p.tiles_x) * static_cast<size_t>(p.tiles_y) * kTileBlocks);
  for (size_t i = 0; i < p.blocks.size(); ++i) {
    const int tile = static_cast<int>(i / kTileBlocks), inside = static_cast<int>(i % kTileBlocks);
    Block& b = p.blocks[i];
    b.x = tile % p.tiles_x * kTileSide + inside % kTileBlocksAcross * kBlockSide;
    b.y = tile / p.tiles_x * kTileSide + inside / kTileBlocksAcross * kBlockSide;
    b.lanes = pixels_in(p.frame.settings, b.x, b.y);
  }
  p.scratch.resize(p.pool.workers());
}

// Runs body(first block, scratch) for all tiles.
using TileBody = std::function<void(Block*, Scratch&)>;
void for_each_tile(Picture& p, const TileBody& body) {
  p.pool.parallel_for(p.blocks.size() / kTileBlocks, [&](size_t tile, size_t worker) {
    if (p.control.stop.load(std::memory_order_relaxed)) throw Interrupted();
    body(&p.blocks[tile * kTileBlocks], p.scratch[worker]);
  });
}

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

// Once to warm up, then `repeat` times by the clock.
std::vector<double> time_runs(int repeat, const std::function<void()>& run) {
  run();
  std::vector<double> ms;
  for (int i = 0; i < repeat; ++i) {
    const auto start = std::chrono::steady_clock::now();
    run();
    ms.push_back(milliseconds_since(start));
  }
  return ms;
}

PassTimes time_pass(Picture& p, const char* name, Counts& counts, const std::function<void()>& run) {
  PassTimes pass{name, {}, 0, 0};
  pass.ms = time_runs(p.repeat, [&] {
    for (Scratch& s : p.scratch) s.counts = {}, s.tally = {};
    run();
  });
  counts = {};
  for (const Scratch& s : p.scratch) {
    counts.rays += s.counts.rays;
    counts.hits += s.counts.hits;
    counts.blocked += s.counts.blocked;
    counts.free += s.counts.free;
    for (const uint64_t rays : s.tally.rays) counts.rays += rays;
  }
  pass.rays = counts.rays;
  return pass;
}

uint64_t count_of(uint64_t lanes) {
  return static_cast<uint64_t>(__builtin_popcountll(lanes));
}

// Finds what a tile sees; the tile's blocks get position and geometric normal, or all that shading asks for.
enum class Detail { points, surfaces };
void see_tile(const Picture& p, Block* blocks, Detail detail, Scratch& s) {
  const FrameContext& frame = p.frame;
  rasterize_tile(frame, blocks->x, blocks->y, s.tally, s.visibility);
  for (int i = 0; i < kTileBlocks; ++i) {
    Block& b = blocks[i];
    b.surfaces.points.live = 0;
    if (b.lanes == 0 || is_background(frame, s.visibility, i)) continue;
    RayPacket rays;
    HitPacket hits;
    primary_hits(frame, s.visibility, i, b.x, b.y, b.lanes, s.tally, rays, hits);
    if (detail == Detail::points) {
      frame.kernels.surface_points(frame.accelerator.triangles.data(), rays, hits, frame.offset,
                                   b.surfaces.points);
    } else {
      make_surfaces(frame, rays, hits, b.surfaces);
    }
  }
}

void set_keys(Picture& p, RayRules rules) {
  const Settings& settings = p.frame.settings;
  for (Block& b : p.blocks) {
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const int x = b.x + lane % kBlockSide, y = b.y + lane / kBlockSide;
      b.surfaces.points.key[lane] = rules == RayRules::scene ? pixel_key(x, y, settings.seed)
                                                             : static_cast<uint32_t>(y * settings.width + x) *
                                                                   static_cast<uint32_t>(settings.ao_samples);
    }
  }
}

PassTimes measure_primary(Picture& p, FrameContext& frame, RasterView& view, RayRules rules,
                          uint64_t& covered) {
  Counts counts;
  RasterFrame raster;
  const bool rasterize = frame.settings.primary == Primary::raster;
  const PassTimes pass = time_pass(p, rasterize ? "raster" : "primary", counts, [&] {
    if (rasterize) {
      view =
          setup_raster(frame, {0, 0, frame.settings.width, frame.settings.height}, p.pool, p.control, raster);
      frame.raster = &view;
    }
    for_each_tile(p, [&](Block* blocks, Scratch& s) { see_tile(p, blocks, Detail::points, s); });
  });
  for_each_tile(p, [&](Block* blocks, Scratch& s) { see_tile(p, blocks, Detail::surfaces, s); });
  frame.raster = nullptr;
  set_keys(p, rules);
  covered = 0;
  for (const Block& b : p.blocks) covered += count_of(b.surfaces.points.live);
  return pass;
}

// All that is traced to find out what one light sends to some packets; returns how many points are blocked.
uint64_t trace_light(const FrameContext& frame, const Light& light, const PointPacket* const* points,
                     int count, PassTally& tally) {
  ShadowAnswer answers[kTileBlocks];
  find_shadows(frame, light, points, count, tally, answers);
  uint64_t blocked = 0;
  for (int i = 0; i < count; ++i) {
    blocked += count_of(answers[i].blocked);
    if (!frame.accelerator.has_glass) continue;
    ColorPacket visibility;
    light_visibility(frame, light, *points[i], answers[i], tally, visibility);
  }
  return blocked;
}

PassTimes measure_shadows(Picture& p, uint64_t& shadowed) {
  const FrameContext& frame = p.frame;
  Counts counts;
  const PassTimes pass = time_pass(p, "shadows", counts, [&] {
    for_each_tile(p, [&](Block* blocks, Scratch& s) {
      const PointPacket* points[kTileBlocks];
      int count = 0;
      for (Block* b = blocks; b != blocks + kTileBlocks; ++b) {
        if (b->surfaces.points.live != 0) points[count++] = &b->surfaces.points;
      }
      for (const Light& light : frame.scene.lights) {
        const uint64_t blocked = trace_light(frame, light, points, count, s.tally);
        if (&light == &frame.scene.lights.front()) s.counts.blocked += blocked;
      }
    });
  });
  shadowed = counts.blocked;
  return pass;
}

PassTimes measure_ambient(Picture& p, double& mean) {
  const FrameContext& frame = p.frame;
  Counts counts;
  const PassTimes pass = time_pass(p, "ao", counts, [&] {
    for_each_tile(p, [&](Block* blocks, Scratch& s) {
      for (Block* b = blocks; b != blocks + kTileBlocks; ++b) {
        if (b->surfaces.points.live == 0) continue;
        alignas(64) uint32_t free_rays[kPacketSize];
        count_free_rays(frame, b->surfaces.points, s.tally, free_rays);
        for (int lane = 0; lane < kPacketSize; ++lane) {
          if (b->surfaces.points.live >> lane & 1) s.counts.free += free_rays[lane];
        }
      }
    });
  });
  mean = counts.rays > 0 ? static_cast<double>(counts.free) / static_cast<double>(counts.rays) : 0;
  return pass;
}

// One mirrored ray from every visible point, one shadow ray from every point that it finds.
PassTimes measure_mirror(Picture& p, uint64_t& reflection_hits) {
  const FrameContext& frame = p.frame;
  Counts counts;
  const PassTimes pass = time_pass(p, "reflection", counts, [&] {
    for_each_tile(p, [&](Block* blocks, Scratch& s) {
      for (Block* b = blocks; b != blocks + kTileBlocks; ++b) {
        if (b->surfaces.points.live == 0) continue;
        RayPacket rays;
        HitPacket hits;
        PointPacket seen;
        frame.kernels.mirror_rays(b->surfaces.points, rays);
        frame.kernels.trace_closest(frame.accelerator.view, rays, hits);
        frame.kernels.surface_points(frame.accelerator.triangles.data(), rays, hits, frame.offset, seen);
        s.counts.rays += count_of(rays.live);
        s.counts.hits += count_of(seen.live);
        if (seen.live == 0) continue;
        const PointPacket* const points = &seen;
        for (const Light& light : frame.scene.lights) trace_light(frame, light, &points, 1, s.tally);
      }
    });
  });
  reflection_hits = counts.hits;
  return pass;
}

// The paths of the frame that begin with the effects of `frame`, lit as in the frame.
PassTimes measure_paths(Picture& p, const FrameContext& frame, const char* name, uint64_t& hits) {
  Counts counts;
  const PassTimes pass = time_pass(p, name, counts, [&] {
    for_each_tile(p, [&](Block* blocks, Scratch& s) {
      s.color.assign(static_cast<size_t>(kTileSide) * kTileSide, Vec3{0, 0, 0});
      s.paths.current.clear();
      for (int i = 0; i < kTileBlocks; ++i) {
        const SurfacePacket& surfaces = blocks[i].surfaces;
        if (surfaces.points.live == 0) continue;
        Path camera_paths[kPacketSize];
        begin_paths(surfaces.points, blocks[i].x - blocks->x, blocks[i].y - blocks->y, camera_paths);
        spawn_paths(frame, surfaces, camera_paths, s.paths.current);
      }
      s.counts.hits += trace_paths(frame, s.paths, s.tally, {s.color.data(), nullptr, nullptr});
    });
  });
  hits = counts.hits;
  return pass;
}

PassTimes measure_resolve(Picture& p, const Image<Vec3>& radiance) {
  Counts counts;
  Image<Rgb8> pixels(radiance.width, radiance.height);
  return time_pass(p, "resolve", counts, [&] {
    p.pool.parallel_for(static_cast<size_t>(radiance.height), [&](size_t y, size_t) {
      uint64_t not_finite = 0;
      const size_t width = static_cast<size_t>(radiance.width);
      for (size_t i = y * width; i < (y + 1) * width; ++i) {
        Vec3 color = radiance.pixels[i];
        pixels.pixels[i] = encode_pixel(color, not_finite);
      }
    });
  });
}

}  // namespace

void simplify(Scene& scene, Camera& camera) {
  for (Material& m : scene.materials) {
    m.optics = Optics::opaque;
    m.opacity_map = kNoTexture;
  }
  scene.mesh.triangle_normals.clear();
  std::erase_if(scene.lights, [](const Light& light) { return light.kind != Light::Kind::directional; });
  const float diagonal = length(extent(bounds(scene.mesh)));
  camera.near = 1e-6f * diagonal;
  camera.far = 1e6f * diagonal;
}

void make_mirrors(Scene& scene) {
  for (Material& m : scene.materials) {
    m.optics = Optics::mirror;
    m.specular = {1, 1, 1};
  }
}

Measurement measure_passes(const Scene& scene, const Camera& camera, const Settings& settings, RayRules rules,
                           int repeat, const Control& control) {
  check_settings(settings);
  check_camera(camera);
  ThreadPool pool(settings.threads);
  Measurement out;
  Accelerator accelerator;
  out.passes.push_back({"build", {}, 0, 0});
  out.passes.back().ms = time_runs(repeat, [&] { build_accelerator(scene, pool, control, accelerator); });
  out.passes.back().bytes = tree_bytes(accelerator.all) + tree_bytes(accelerator.glass);

  FrameContext frame = make_context(scene, accelerator, camera, settings);
  if (rules == RayRules::anchor) {
    frame.offset.fixed = 1e-4f * length(extent(bounds(scene.mesh)));
    frame.sample_step = 1;
  }
  out.isa = frame.kernels.isa;
  out.threads = static_cast<int>(pool.workers());
  Picture picture{frame, pool, control, repeat, 0, 0, {}, {}};
  lay_out(picture);
  RasterView view{};
  out.passes.push_back(measure_primary(picture, frame, view, rules, out.covered_pixels));

  const Effects& on = settings.effects;
  if (on.shadows) out.passes.push_back(measure_shadows(picture, out.shadowed_pixels));
  const auto paths = [&](const char* name, Effects effects, uint64_t& hits) {
    Settings alone = settings;
    alone.effects = effects;
    FrameContext context = make_context(scene, accelerator, camera, alone);
    out.passes.push_back(measure_paths(picture, context, name, hits));
  };
  if (on.reflection) {
    if (rules == RayRules::anchor)
      out.passes.push_back(measure_mirror(picture, out.reflection_hits));
    else
      paths("reflection", {on.shadows, true, false, false}, out.reflection_hits);
  }
  uint64_t refraction_hits = 0;
  if (on.refraction && rules == RayRules::scene)
    paths("refraction", {on.shadows, false, true, false}, refraction_hits);
  if (on.ambient_occlusion) out.passes.push_back(measure_ambient(picture, out.ao_mean));
  std::vector<Block>().swap(picture.blocks);

  Control watch;
  Frame rendered;
  PassTimes whole{"frame", {}, 0, 0};
  whole.ms = time_runs(repeat, [&] {
    if (control.stop.load(std::memory_order_relaxed)) throw Interrupted();
    rendered = render_frame(scene, accelerator, camera, settings, pool, watch);
  });
  for (const PassStats& pass : rendered.stats.passes) whole.rays += pass.rays;
  if (settings.keep_radiance) out.passes.push_back(measure_resolve(picture, rendered.radiance));
  out.passes.push_back(whole);
  return out;
}

}  // namespace vitral
