#include "app/job.h"

#include "app/auto_view.h"
#include "app/richness.h"
#include "io/mesh_file.h"
#include "io/text.h"
#include "io/values.h"
#include "render/kernel_choice.h"
#include "render/tile.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>

namespace vitral {
namespace {

namespace fs = std::filesystem;

InputKind kind_of(const std::string& path) {
  std::error_code code;
  const fs::file_status status = fs::status(path, code);
  if (status.type() == fs::file_type::none) fail(path, code.message());
  if (!fs::exists(status)) fail(path, "no such file");
  if (fs::is_directory(status)) fail(path, "is a directory");
  const std::string extension = lower_case(fs::path(path).extension().string());
  if (extension == ".xml") return InputKind::project;
  if (extension == ".obj" || extension == ".ply") return InputKind::mesh;
  fail(path, "is neither a project (.xml) nor a mesh (.obj, .ply) by its name");
}

template <class Named>
std::string listed(const std::vector<Named>& things) {
  std::string line;
  for (const Named& thing : things) line += (line.empty() ? "" : ", ") + thing.name;
  return line.empty() ? "it has none" : "it has " + line;
}

template <class Named>
const Named& find(const std::vector<Named>& things, const std::string& name, const char* what,
                  const std::string& file) {
  for (const Named& thing : things) {
    if (thing.name == name) return thing;
  }
  throw UsageError(file + " has no " + what + " '" + name + "'; " + listed(things));
}

void override_settings(const Options& options, Settings& settings) {
  if (options.size) {
    settings.width = options.size->width;
    settings.height = options.size->height;
  }
  override_with(options.crop, settings.crop);
  override_with(options.samples, settings.samples);
  override_with(options.filter, settings.filter);
  override_with(options.effects, settings.effects);
  override_with(options.light_samples, settings.light_samples);
  override_with(options.ao_samples, settings.ao_samples);
  override_with(options.ao_distance, settings.ao_distance);
  override_with(options.ao_exponent, settings.ao_exponent);
  override_with(options.max_depth, settings.max_depth);
  override_with(options.min_importance, settings.min_importance);
  override_with(options.fresnel, settings.fresnel);
  override_with(options.primary, settings.primary);
  override_with(options.terminator, settings.terminator);
  override_with(options.isa, settings.isa);
  override_with(options.threads, settings.threads);
  override_with(options.seed, settings.seed);
  settings.aovs = options.aovs;
  settings.count_traversal = !options.stats.empty();
  settings.keep_radiance = false;  // nobody writes it
}

void override_lens(const Options& options, Camera& camera) {
  override_with(options.aperture, camera.aperture);
  override_with(options.focus, camera.focus);
  if (options.shutter)
    camera.shutter_open = options.shutter->open, camera.shutter_close = options.shutter->close;
}

void override_camera(const Options& options, Camera& camera) {
  override_with(options.eye, camera.position);
  override_with(options.view, camera.view);
  override_with(options.up, camera.up);
  override_with(options.fov, camera.fov);
  override_with(options.near, camera.near);
  override_with(options.far, camera.far);
  override_lens(options, camera);
  // Who says where to stand or look wants the camera to rest there.
  if (options.eye || options.view || options.up) camera.motion.clear();
  const std::string fault = camera_fault(camera);
  if (!fault.empty()) throw UsageError("camera: " + fault);
}

// Where objects are rasterized, the triangle and the depth of every pixel.
size_t object_bytes(const Settings& settings) {
  const Tiles tiles = tiles_of(crop_of(settings));
  const size_t count = static_cast<size_t>(tiles.across) * static_cast<size_t>(tiles.down);
  return settings.primary == Primary::raster ? count * sizeof(TileVisibility) : 0;
}

void check_frame(const Job& job, const Options& options) {
  const Settings& settings = job.pipeline.settings;
  const Rectangle& crop = settings.crop;
  if (crop.x + crop.width > settings.width || crop.y + crop.height > settings.height) {
    throw UsageError("--crop reaches out of the picture of " + std::to_string(settings.width) + "x" +
                     std::to_string(settings.height) + " pixels");
  }
  const size_t needed = frame_bytes(settings) + (job.project.object_count > 0 ? object_bytes(settings) : 0),
               limit = memory_limit();
  if (needed <= limit) return;
  const std::string reason = std::to_string(settings.width) + "x" + std::to_string(settings.height) +
                             " pixels need " + std::to_string(needed >> 20) + " MiB, there are " +
                             std::to_string(limit >> 20);
  if (options.size || options.crop) throw UsageError(reason);
  fail(job.input, reason);
}

bool has_plane(const Scene& scene) {
  return std::any_of(scene.objects.begin(), scene.objects.end(),
                     [](const Object& object) { return object.shape == Shape::plane; });
}

// A box's corners as a mesh; what lies between them does not matter.
void add_box(const Box& b, Mesh& mesh) {
  if (is_empty(b)) return;
  const uint32_t first = static_cast<uint32_t>(mesh.positions.size());
  for (uint32_t i = 0; i < 8; ++i) {
    mesh.positions.push_back(
        {i & 1 ? b.max.x : b.min.x, i & 2 ? b.max.y : b.min.y, i & 4 ? b.max.z : b.min.z});
    mesh.triangles.push_back({first + i, first + (i + 1) % 8, first + (i + 2) % 8});
  }
}

// Something that stands where the scene does, for the automatic camera: the mesh, and the boxes of objects.
Mesh stand_in(const Scene& scene) {
  Mesh mesh;
  mesh.positions = scene.mesh.positions;
  mesh.triangles = scene.mesh.triangles;
  Scene one;
  for (const Mesh& model : scene.models) add_box(bounds(model), one.models.emplace_back());
  constexpr size_t kMost = 4096;  // evenly taken, they tell as much as all
  for (size_t i = 0; i < scene.objects.size(); i += scene.objects.size() / kMost + 1) {
    one.objects = {scene.objects[i]};
    add_box(bounds(one), mesh);
  }
  if (mesh.triangles.empty()) add_box({{-1, -1, -1}, {1, 1, 1}}, mesh);  // planes alone
  return mesh;
}

// Camera and, for a bare mesh, light from the mesh itself. Where the user says neither where to stand
// nor where to look, several views are tried.
void find_view(Job& job, const Options& options) {
  Scene& scene = job.project.scene;
  Settings& settings = job.pipeline.settings;
  const float aspect = static_cast<float>(settings.width) / static_cast<float>(settings.height);
  // Products of edges and distances must not vanish among the floats.
  constexpr double kLeastDiagonal = 1e-30;
  const Mesh around = scene.objects.empty() ? Mesh{} : stand_in(scene);
  const Mesh& mesh = scene.objects.empty() ? scene.mesh : around;
  const Box box = bounds(mesh);
  const double diagonal = length(to_double(box.max) - to_double(box.min));
  if (diagonal > 0 && diagonal < kLeastDiagonal)
    fail(job.input, "the mesh is too small for a camera to see it");
  const ViewWishes wishes{options.eye, options.view, options.up, options.fov, options.near, options.far};
  View view;
  if (options.eye || options.view || !scene.objects.empty()) {
    view.camera = auto_camera(mesh, aspect, wishes);
  } else {
    Control control;
    view = best_view(candidate_views(mesh, aspect, wishes), triangle_counter(scene, settings, control));
  }
  job.camera = view.camera;
  const Vec3 middle = center(core(mesh)) - view.camera.position;
  job.camera.focus = greatest(dot(middle, normalize(view.camera.view)), view.camera.near);
  override_lens(options, job.camera);
  if (job.kind == InputKind::project) return;
  light_automatically(view, scene);
  if (!options.ao_distance) settings.ao_distance = auto_ao_distance(core(mesh));
}

// The first directional light or sun takes the direction; a project without one gets a white sun.
void turn_sun(const Vec3& direction, Scene& scene) {
  const auto found = std::find_if(scene.lights.begin(), scene.lights.end(), [](const Light& light) {
    return light.kind == Light::Kind::directional || light.kind == Light::Kind::sun;
  });
  Light& sun = found != scene.lights.end() ? *found : scene.lights.emplace_back();
  sun.direction = normalize(direction);
}

}  // namespace

Job plan_job(const Options& options) {
  Job job;
  job.input = options.inputs[0];
  job.kind = kind_of(job.input);
  if (job.kind == InputKind::project) {
    job.project = read_project(job.input, job.warnings);
    const Project& project = job.project;
    job.pipeline = options.pipeline ? find(project.pipelines, *options.pipeline, "pipeline", job.input)
                                    : project.pipelines[project.default_pipeline];
  } else {
    for (const auto& [name, value] :
         {std::pair{"pipeline", &options.pipeline}, std::pair{"camera", &options.camera}}) {
      if (*value)
        throw UsageError(std::string("--") + name + " needs a project: a mesh has no " + name + "s");
    }
    job.project.file = job.input;
    job.project.meshes = {{job.input, 0}};
    job.project.pipelines = {job.pipeline};
  }

  override_settings(options, job.pipeline.settings);
  const std::string camera = options.camera.value_or(job.pipeline.camera);
  job.automatic = camera.empty();
  if (!job.automatic) {
    job.camera = find(job.project.scene.cameras, camera, "camera", job.input);
    override_camera(options, job.camera);
  }
  check_frame(job, options);
  choose_kernels(job.pipeline.settings.isa);  // throws when this processor lacks them
  return job;
}

void load_job(Job& job, const Options& options) {
  const auto start = std::chrono::steady_clock::now();
  Scene& scene = job.project.scene;
  load_assets(job.project, job.pipeline, job.warnings);
  if (is_empty(bounds(scene)) && !has_plane(scene)) fail(job.input, "there is no triangle in it");

  if (job.automatic && options.command != Command::info) find_view(job, options);
  if (options.sun) turn_sun(*options.sun, scene);
  if (options.background) {
    scene.background = {};
    scene.background.color = *options.background;
  }
  job.load_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

size_t frame_bytes(const Settings& settings) {
  // Pixels, auxiliary pictures, and what the encoder of the PNG holds beside them.
  const size_t sums = settings.samples > 1 ? sizeof(Vec3d) : 0;
  const size_t bytes = sums + sizeof(Vec3) * settings.aovs.size() + sizeof(Rgb8) * 3;
  const bool whole = settings.crop.width == 0;
  return bytes * static_cast<size_t>(whole ? settings.width : settings.crop.width) *
         static_cast<size_t>(whole ? settings.height : settings.crop.height);
}

size_t memory_limit() {
  size_t limit = static_cast<size_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<size_t>(sysconf(_SC_PAGE_SIZE));
  rlimit address_space{};
  if (getrlimit(RLIMIT_AS, &address_space) == 0 && address_space.rlim_cur != RLIM_INFINITY) {
    limit = std::min(limit, static_cast<size_t>(address_space.rlim_cur));
  }
  // The control group's limit; the file holds a number or the word max, and may not be there.
  size_t group = 0;
  if (std::ifstream("/sys/fs/cgroup/memory.max") >> group) limit = std::min(limit, group);
  return limit;
}

size_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<size_t>(usage.ru_maxrss) * 1024;
}

}  // namespace vitral
