#include "render/measure_picture.h"
#include "render/render.h"

#include <algorithm>

namespace vitral {
namespace {

// Worker seconds of a frame in passes that trace rays, their set-up included.
double tracing_seconds(const Stats& stats, Primary primary) {
  double seconds = 0;
  for (size_t p = 0; p < stats.passes.size(); ++p) {
    const Pass pass = static_cast<Pass>(p);
    const bool traces =
        pass == Pass::raster ? primary == Primary::trace : pass != Pass::shade && pass != Pass::resolve;
    if (traces) seconds += stats.passes[p].seconds;
  }
  return seconds;
}

FrameTimes measure_frame(const Scene& scene, Accelerator& accelerator, const FrameJob& job, ThreadPool& pool,
                         const Runs& runs, Control& control) {
  FrameTimes out;
  double tracing = 0, whole = 0;
  out.ms = time_runs(runs, job.name.c_str(), [&] {
    const Stats stats = render_frame(scene, accelerator, job.camera, job.settings, pool, control).stats;
    out.rays = 0;
    for (const PassStats& pass : stats.passes) out.rays += pass.rays;
    tracing += tracing_seconds(stats, job.settings.primary);
    whole += stats.frame_seconds * stats.threads;
  });
  out.tracer_share = whole > 0 ? std::min(tracing / whole, 1.0) : 0;
  return out;
}

}  // namespace

FramesMeasured measure_frames(const Scene& scene, const std::vector<FrameJob>& jobs, const Runs& runs,
                              Control& control) {
  FramesMeasured out;
  if (jobs.empty()) return out;
  for (const FrameJob& job : jobs) {
    check_settings(job.settings);
    check_camera(job.camera);
  }
  ThreadPool pool(jobs.front().settings.threads);
  if (runs.on_progress) runs.on_progress({"build", 0, 0});
  Accelerator accelerator;
  build_accelerator(scene, pool, control, accelerator);
  accelerator.mip_maps = make_mip_maps(scene, pool);
  out.isa = make_context(scene, accelerator, jobs.front().camera, jobs.front().settings).kernels.isa;
  out.threads = static_cast<int>(pool.workers());
  for (const FrameJob& job : jobs)
    out.frames.push_back(measure_frame(scene, accelerator, job, pool, runs, control));
  return out;
}

}  // namespace vitral
