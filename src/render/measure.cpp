#include "render/measure.h"

#include "math/random.h"
#include "render/gbuffer.h"
#include "render/light_sample.h"
#include "render/measure_picture.h"
#include "render/render.h"
#include "render/samples.h"
#include "vitral/box.h"

namespace vitral {
namespace {

uint64_t count_of(uint64_t lanes) {
  return static_cast<uint64_t>(__builtin_popcountll(lanes));
}

// Where traced rays met something: position and geometric normal. Objects say it as all surfaces do.
void hit_points(const FrameContext& frame, const RayPacket& rays, const HitPacket& hits, SurfacePacket& out) {
  if (frame.accelerator.placed.view.count > 0) {
    make_surfaces(frame, rays, hits, out);
  } else {
    frame.kernels.surface_points(frame.accelerator.triangles.data(), rays, hits, frame.offset, out.points);
  }
}

// Finds what a tile sees; the tile's blocks get position and geometric normal, or all that shading asks for.
enum class Detail { points, surfaces };
void see_tile(const Picture& p, Block* blocks, Detail detail, Scratch& s) {
  const FrameContext& frame = p.frame;
  uint64_t lanes[kTileBlocks];
  for (size_t i = 0; i < kTileBlocks; ++i) lanes[i] = blocks[kBlocksInOrder[i]].lanes;
  TileHits& seen = s.tile_hits;
  find_primary_hits(frame, blocks->x, blocks->y, lanes, s.tally, seen);
  for (size_t i = 0; i < kTileBlocks; ++i) {
    Block& b = blocks[kBlocksInOrder[i]];
    if (detail == Detail::points && !frame.raster) {
      b.surfaces.points.live = 0;
      if (seen.rays[i].live == 0) continue;
      hit_points(frame, seen.rays[i], seen.hits[i], b.surfaces);
    } else {
      see_surfaces(frame, seen, i, b.x, b.y, b.surfaces);
    }
  }
}

void set_keys(const Settings& settings, RayRules rules, Block& b) {
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const int x = b.x + lane % kBlockSide, y = b.y + lane / kBlockSide;
    b.surfaces.points.key[lane] = rules == RayRules::scene ? pixel_key(x, y, settings.seed)
                                                           : static_cast<uint32_t>(y * settings.width + x) *
                                                                 static_cast<uint32_t>(settings.ao_samples);
  }
}

// The triangles on the screen, when primary hits are rasterized.
struct Screen {
  RasterFrame raster;
  RasterView view{};
};
void set_up_screen(const Picture& p, FrameContext& frame, Screen& screen) {
  if (frame.settings.primary != Primary::raster) return;
  SetupTimes times;
  screen.view = setup_raster(frame, p.crop, p.pool, p.control, screen.raster, times);
  frame.raster = &screen.view;
}

PassTimes measure_raster(Picture& p, const FrameContext& frame, Layout layout, uint64_t& covered) {
  GBuffer target = make_gbuffer(frame, layout);
  RasterFrame raster;
  RasterTimes times;
  PassTimes pass{"raster", {}, 0, 0, {}};
  pass.ms = time_runs(p.runs, "raster", [&] {
    write_gbuffer(frame, p.pool, p.control, raster, target, times);
    pass.parts.push_back(times);
  });
  pass.parts.erase(pass.parts.begin(), pass.parts.end() - static_cast<ptrdiff_t>(pass.ms.size()));
  covered = count_covered(target);
  return pass;
}

PassTimes measure_primary(Picture& p, uint64_t& covered) {
  Counts counts;
  const PassTimes pass = time_pass(p, "primary", counts, [&] {
    for_each_tile(p, [&](Block* blocks, Scratch& s) { see_tile(p, blocks, Detail::points, s); });
  });
  covered = 0;
  for (const Block& b : p.blocks) covered += count_of(b.surfaces.points.live);
  return pass;
}

// What the later passes start from.
void see_picture(Picture& p, FrameContext& frame, RayRules rules) {
  Screen screen;
  set_up_screen(p, frame, screen);
  for_each_tile(p, [&](Block* blocks, Scratch& s) { see_tile(p, blocks, Detail::surfaces, s); });
  frame.raster = nullptr;
  for (Block& b : p.blocks) set_keys(frame.settings, rules, b);
}

// The rays of some neighbouring blocks, and what they count.
using PointsBody = std::function<void(const PointPacket* const*, int, Scratch&)>;

// All that is traced to find out what one light sends to some packets; returns how many points are blocked.
uint64_t trace_light(const FrameContext& frame, const Light& light, const PointPacket* const* points,
                     int count, PassTally& tally) {
  uint64_t blocked = 0;
  if (has_size(light)) {
    for (int i = 0; i < count; ++i)
      blocked += count_of(trace_samples(frame, light, *points[i], tally, nullptr));
    return blocked;
  }
  ShadowAnswer answers[kTileBlocks];
  find_shadows(frame, light, points, count, tally, answers, nullptr);
  for (int i = 0; i < count; ++i) {
    blocked += count_of(answers[i].blocked);
    if (!frame.accelerator.has_glass) continue;
    ColorPacket visibility;
    light_visibility(frame, light, *points[i], answers[i], tally, visibility, nullptr);
  }
  return blocked;
}

void trace_shadows(const FrameContext& frame, const PointPacket* const* points, int count, Scratch& s) {
  for (const Light& light : frame.scene.lights) {
    const uint64_t blocked = trace_light(frame, light, points, count, s.tally);
    if (&light == &frame.scene.lights.front()) s.counts.blocked += blocked;
  }
}

void trace_ambient(const FrameContext& frame, const PointPacket* const* points, int count, Scratch& s) {
  FreeRays free_rays[kTileBlocks];
  count_free_rays(frame, points, count, s.tally, free_rays, nullptr);
  for (int i = 0; i < count; ++i) {
    for (uint64_t left = points[i]->live; left != 0; left &= left - 1)
      s.counts.free += free_rays[i].count[__builtin_ctzll(left)];
  }
}

// One mirrored ray from every point, one shadow ray for every light from where it arrives.
void trace_mirror(const FrameContext& frame, const PointPacket* const* points, int count, Scratch& s) {
  std::vector<SurfacePacket>& seen = s.seen;
  seen.resize(kTileBlocks);
  const PointPacket* arrived[kTileBlocks];
  int arrivals = 0;
  for (int i = 0; i < count; ++i) {
    RayPacket rays;
    HitPacket hits;
    SurfacePacket& here = seen[static_cast<size_t>(i)];
    frame.kernels.mirror_rays(*points[i], rays);
    run_closest(frame, Pass::reflection, rays, s.tally, hits, nullptr);
    hit_points(frame, rays, hits, here);
    s.counts.rays += count_of(rays.live);
    s.counts.hits += count_of(here.points.live);
    if (here.points.live != 0) arrived[arrivals++] = &here.points;
  }
  for (const Light& light : frame.scene.lights) trace_light(frame, light, arrived, arrivals, s.tally);
}

// The packets of a tile's blocks that see anything.
int points_of(const Block* blocks, const PointPacket** points) {
  int count = 0;
  for (const int block : kBlocksInOrder) {
    if (blocks[block].surfaces.points.live != 0) points[count++] = &blocks[block].surfaces.points;
  }
  return count;
}

PassTimes measure_points(Picture& p, const char* name, Counts& counts, const PointsBody& body) {
  return time_pass(p, name, counts, [&] {
    for_each_tile(p, [&](Block* blocks, Scratch& s) {
      const PointPacket* points[kTileBlocks];
      const int count = points_of(blocks, points);
      if (count > 0) body(points, count, s);
    });
  });
}

// The anchor's passes, one after the other in each tile.
PassTimes measure_anchor_frame(Picture& p, FrameContext& frame) {
  const Effects& on = frame.settings.effects;
  Counts counts;
  Screen screen;
  const PassTimes pass = time_pass(p, "frame", counts, [&] {
    set_up_screen(p, frame, screen);
    for_each_tile(p, [&](Block* blocks, Scratch& s) {
      for (int i = 0; i < kTileBlocks; ++i) {
        Block& b = s.tile[static_cast<size_t>(i)];
        b.x = blocks[i].x, b.y = blocks[i].y, b.lanes = blocks[i].lanes;
        set_keys(frame.settings, RayRules::anchor, b);
      }
      see_tile(p, s.tile.data(), Detail::points, s);
      const PointPacket* points[kTileBlocks];
      const int count = points_of(s.tile.data(), points);
      if (count == 0) return;
      if (on.shadows) trace_shadows(frame, points, count, s);
      if (on.reflection) trace_mirror(frame, points, count, s);
      if (on.ambient_occlusion) trace_ambient(frame, points, count, s);
    });
  });
  frame.raster = nullptr;
  return pass;
}

// The paths of the frame that begin with the effects of `frame`, lit as in the frame.
PassTimes measure_paths(Picture& p, const FrameContext& frame, const char* name, Counts& counts) {
  return time_pass(p, name, counts, [&] {
    for_each_tile(p, [&](Block* blocks, Scratch& s) {
      s.color.assign(static_cast<size_t>(kTileSide) * kTileSide, Vec3{0, 0, 0});
      s.paths.current.clear();
      for (int i = 0; i < kTileBlocks; ++i) {
        const SurfacePacket& surfaces = blocks[i].surfaces;
        if (surfaces.points.live == 0) continue;
        Path camera_paths[kPacketSize];
        begin_paths(frame, surfaces.points, blocks[i].x - blocks->x, blocks[i].y - blocks->y, camera_paths);
        absorb_paths(frame, surfaces, camera_paths, kPacketSize);
        spawn_paths(frame, surfaces, camera_paths, s.tally, s.paths.current);
      }
      s.counts.hits += trace_paths(frame, s.paths, s.tally, {s.color.data(), nullptr, nullptr, nullptr});
    });
  });
}

PassTimes measure_resolve(Picture& p, const Image<Vec3>& radiance) {
  Counts counts;
  Image<Rgb8> pixels(radiance.width, radiance.height);
  return time_pass(p, "resolve", counts, [&] {
    p.pool.parallel_for(static_cast<size_t>(radiance.height), [&](size_t y, size_t) {
      uint64_t not_finite = 0;
      const size_t width = static_cast<size_t>(radiance.width);
      std::vector<Vec3> row(&radiance.pixels[y * width], &radiance.pixels[y * width] + width);
      encode_row(row.data(), width, &pixels.pixels[y * width], not_finite);
    });
  });
}

}  // namespace

void fill_cut_outs(Scene& scene) {
  for (Material& m : scene.materials) m.opacity_map = kNoTexture;
}

void simplify(Scene& scene, Camera& camera) {
  fill_cut_outs(scene);
  for (Material& m : scene.materials) {
    m.optics = Optics::opaque;
    m.reflectivity = {0, 0, 0};
  }
  scene.mesh.triangle_normals.clear();
  for (Mesh& model : scene.models) model.triangle_normals.clear();
  for (Light& light : scene.lights) {
    if (light.kind == Light::Kind::sun) light.kind = Light::Kind::directional;
  }
  std::erase_if(scene.lights, [](const Light& light) { return light.kind != Light::Kind::directional; });
  const float diagonal = length(extent(bounds(scene)));
  camera.near = 1e-6f * diagonal;
  camera.far = 1e6f * diagonal;
}

void make_mirrors(Scene& scene) {
  for (Material& m : scene.materials) {
    m.optics = Optics::mirror;
    m.reflectivity = {0, 0, 0};
    m.specular = {1, 1, 1};
  }
}

Measurement measure_passes(const Scene& scene, const Camera& camera, const Settings& wanted, RayRules rules,
                           Layout layout, const Runs& runs, Control& control) {
  check_settings(wanted);
  check_camera(camera);
  check_lights(scene);
  Settings settings = wanted;
  settings.keep_radiance = false;
  settings.aovs.clear();
  ThreadPool pool(settings.threads);
  Measurement out;
  Accelerator accelerator;
  const Effects& on = settings.effects;
  const bool has_effects = on.shadows || on.reflection || on.refraction || on.ambient_occlusion;
  PassTimes build{"build", {}, 0, 0, {}};
  build.ms = time_runs(runs, "build", [&] {
    if (has_effects || settings.primary == Primary::trace)
      build_accelerator(scene, pool, control, accelerator);
    else
      gather_triangles(scene, pool, accelerator);
  });
  build.bytes = tree_bytes(accelerator.all) + tree_bytes(accelerator.glass);
  out.passes.push_back(build);
  accelerator.mip_maps = make_mip_maps(scene, pool);
  if (moves(scene)) place_objects(scene, middle_of_shutter(camera), accelerator);

  FrameContext frame = make_context(scene, accelerator, camera, settings);
  if (rules == RayRules::anchor) {
    frame.offset.fixed = 1e-4f * length(extent(bounds(scene)));
    frame.sample_step = 1;
  }
  out.isa = frame.kernels.isa;
  out.threads = static_cast<int>(pool.workers());
  Picture picture = lay_out(frame, pool, control, runs);
  out.passes.push_back(settings.primary == Primary::raster
                           ? measure_raster(picture, frame, layout, out.covered_pixels)
                           : measure_primary(picture, out.covered_pixels));
  if (has_effects) see_picture(picture, frame, rules);

  Counts counts;
  const auto blocks = [&](const char* name, auto trace) {
    out.passes.push_back(measure_points(
        picture, name, counts,
        [&](const PointPacket* const* points, int count, Scratch& s) { trace(frame, points, count, s); }));
  };
  const auto paths = [&](const char* name, Effects effects) {
    Settings alone = settings;
    alone.effects = effects;
    const FrameContext context = make_context(scene, accelerator, camera, alone);
    out.passes.push_back(measure_paths(picture, context, name, counts));
  };
  if (on.shadows) {
    blocks("shadows", trace_shadows);
    out.shadowed_pixels = counts.blocked;
  }
  if (on.reflection) {
    if (rules == RayRules::anchor)
      blocks("reflection", trace_mirror);
    else
      paths("reflection", {on.shadows, true, false, false});
    out.reflection_hits = counts.hits;
  }
  if (on.refraction && rules == RayRules::scene) paths("refraction", {on.shadows, false, true, false});
  if (on.ambient_occlusion) {
    blocks("ao", trace_ambient);
    if (counts.rays > 0) out.ao_mean = static_cast<double>(counts.free) / static_cast<double>(counts.rays);
  }

  Settings plain = settings;
  plain.effects = {false, false, false, false};
  plain.keep_radiance = true;
  const Frame picture_without_effects = render_frame(scene, accelerator, camera, plain, pool, control);
  out.passes.push_back(measure_resolve(picture, picture_without_effects.radiance));

  if (rules == RayRules::anchor) {
    out.passes.push_back(measure_anchor_frame(picture, frame));
    return out;
  }
  std::vector<Block>().swap(picture.blocks);
  PassTimes whole{"frame", {}, 0, 0, {}};
  whole.ms = time_runs(runs, "frame", [&] {
    const Frame rendered = render_frame(scene, accelerator, camera, settings, pool, control);
    whole.rays = 0;
    for (const PassStats& pass : rendered.stats.passes) whole.rays += pass.rays;
  });
  out.passes.push_back(whole);
  return out;
}

}  // namespace vitral
