#include "app/commands.h"
#include "app/json.h"

namespace vitral {
namespace {

void add_settings(JsonWriter& json, const Settings& settings) {
  json.begin_object("settings")
      .add("width", settings.width)
      .add("height", settings.height)
      .add("samples", settings.samples)
      .add("filter", name_of(settings.filter))
      .begin_object("effects")
      .add("shadows", settings.effects.shadows)
      .add("reflection", settings.effects.reflection)
      .add("refraction", settings.effects.refraction)
      .add("ao", settings.effects.ambient_occlusion)
      .end_object()
      .add("light_samples", settings.light_samples)
      .add("ao_samples", settings.ao_samples)
      .add("ao_distance", settings.ao_distance)
      .add("ao_exponent", settings.ao_exponent)
      .add("max_depth", settings.max_depth)
      .add("min_importance", settings.min_importance)
      .add("fresnel", name_of(settings.fresnel))
      .add("compositing", name_of(settings.compositing))
      .add("primary", name_of(settings.primary))
      .add("terminator", name_of(settings.terminator))
      .add("seed", uint64_t{settings.seed});
  if (settings.crop.width > 0) {
    json.begin_object("crop")
        .add("x", settings.crop.x)
        .add("y", settings.crop.y)
        .add("width", settings.crop.width)
        .add("height", settings.crop.height)
        .end_object();
  }
  json.end_object();
}

void add_camera(JsonWriter& json, const Camera& camera) {
  json.begin_object("camera")
      .add("name", camera.name)
      .add("eye", camera.position)
      .add("view", camera.view)
      .add("up", camera.up)
      .add("fov", camera.fov)
      .add("near", camera.near)
      .add("far", camera.far)
      .add("aperture", camera.aperture)
      .add("focus", camera.focus)
      .add("shutter_open", camera.shutter_open)
      .add("shutter_close", camera.shutter_close)
      .end_object();
}

// With keys of their own beside those of a pass, or in an object.
void add_counts(JsonWriter& json, const TraversalCounts& counts) {
  const double steps = static_cast<double>(counts.steps);
  json.add("nodes", nodes_of(counts))
      .add("leaves", counts.leaves)
      .add("triangle_tests", counts.triangle_tests)
      .add("rays_traced", counts.rays_traced)
      .add("rays_culled", counts.rays_culled)
      .add("packet_steps", counts.steps)
      .add("lanes_per_step", counts.steps > 0 ? static_cast<double>(counts.lanes_in_steps) / steps : 0.0);
}

}  // namespace

std::string stats_json(const Job& job, const Stats& stats, const RunTimes& times) {
  JsonWriter json;
  json.begin_object()
      .add("version", kVersion)
      .add("input", job.input)
      .add("pipeline", job.pipeline.name)
      .add("isa", stats.isa)
      .add("threads", stats.threads);
  add_settings(json, job.pipeline.settings);
  add_camera(json, job.camera);
  json.add("triangles", uint64_t{stats.triangles})
      .add("dropped_triangles", uint64_t{stats.dropped_triangles})
      .add("tree_nodes", uint64_t{stats.tree_nodes})
      .add("tree_bytes", uint64_t{stats.tree_bytes})
      .add("covered_pixels", stats.covered_pixels)
      .add("not_finite_pixels", stats.not_finite_pixels)
      .add("peak_memory_bytes", uint64_t{peak_memory()})
      .begin_object("seconds")
      .add("load", times.load_seconds)
      .add("build", stats.build_seconds)
      .add("frame", stats.frame_seconds)
      .add("render", times.render_seconds)
      .add("write", times.write_seconds)
      .end_object()
      .begin_array("passes");
  for (const PassStats& pass : stats.passes) {
    json.begin_object()
        .add("name", pass.name)
        .add("worker_seconds", pass.seconds)
        .add("rays", pass.rays)
        .add("rays_saved", pass.rays_saved);
    if (stats.counted) add_counts(json, pass.traversal);
    json.end_object();
  }
  json.end_array();
  if (stats.counted) {
    json.begin_object("traversal");
    add_counts(json, stats.traversal);
    json.end_object();
  }
  return json.end_object().text();
}

}  // namespace vitral
