#include "render/samples.h"

#include "math/sampling.h"
#include "math/strata.h"
#include "vitral/affine.h"

namespace vitral {
namespace {

// --- filters: where a sample lies along one axis, and its sign ------------------------------------

struct Place {
  double x;
  double sign;
};

// Integrals from 0 of the two pieces of the Mitchell filter with B = C = 1/3, |x| in [0, 1] and [1, 2].
double inner_integral(double x) {
  return x * (16.0 / 3 + x * x * (-4 + x * (7.0 / 4))) / 6;
}
double outer_integral(double x) {
  return x * (32.0 / 3 + x * (-10 + x * (4 + x * (-7.0 / 12)))) / 6;
}

// The second piece is -7/18 (x - 2)^2 (x - 8/7): the lobes are negative from 8/7 on. The integral of the
// filter's absolute value from 0 to x.
constexpr double kLobe = 8.0 / 7;
double mitchell_integral(double x) {
  if (x <= 1) return inner_integral(x);
  const double to_lobe = inner_integral(1) - outer_integral(1);
  if (x <= kLobe) return to_lobe + outer_integral(x);
  return to_lobe + 2 * outer_integral(kLobe) - outer_integral(x);
}

// The integral's inverse, by halving.
Place place_by_mitchell(double u) {
  const double side = u < 0.5 ? -1 : 1, wanted = (2 * u - 1) * side * mitchell_integral(2);
  double low = 0, high = 2;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (mitchell_integral(middle) < wanted ? low : high) = middle;
  }
  return {side * low, low > kLobe ? -1.0 : 1.0};
}

Place place_by(Filter filter, double u) {
  switch (filter) {
    case Filter::box:
      return {u - 0.5, 1};
    case Filter::tent:
      return {u < 0.5 ? square_root(2 * u) - 1 : 1 - square_root(2 - 2 * u), 1};
    case Filter::mitchell:
      return place_by_mitchell(u);
  }
  return {0, 1};
}

// Each dimension has keys of its own.
enum class Dimension : uint32_t { pixel = 1, lens, lens_order, time, time_order };
uint32_t key_of(Dimension d, uint32_t seed) {
  return branch_key(hash32(seed ^ 0x51ed270bu), static_cast<uint32_t>(d));
}

// Which point of the lens and which moment go with sample i of the pixel.
struct Partners {
  uint32_t lens, time;
};

PixelSample place_sample(const Settings& settings, const Camera& camera, uint32_t i, const Partners& with) {
  const auto n = static_cast<uint32_t>(settings.samples);
  PixelSample s;
  const Pair<float> pixel = stratified_pair(i, n, key_of(Dimension::pixel, settings.seed));
  const Place x = place_by(settings.filter, widen(pixel.u)), y = place_by(settings.filter, widen(pixel.v));
  s.x = narrow(x.x), s.y = narrow(y.x);
  s.weight = x.sign * y.sign;

  s.lens_index = with.lens;
  const Pair<float> lens = stratified_pair(s.lens_index, n, key_of(Dimension::lens, settings.seed));
  const Vec2 point = disk_point(lens.u, lens.v);
  s.lens_x = point.x, s.lens_y = point.y;

  const float share = stratified_pair(with.time, n, key_of(Dimension::time, settings.seed)).u;
  s.time = camera.shutter_open + (camera.shutter_close - camera.shutter_open) * share;
  return s;
}

// A camera's directions as a rotation: right, up and back are the axes x, y and z.
RigidKey pose_of(const CameraKey& key) {
  const Vec3d back = -normalize(to_double(key.view));
  const Vec3d right = normalize(cross(to_double(key.up), back));
  return {key.time, key.position,
          quaternion_of_frame(to_float(right), to_float(cross(back, right)), to_float(back))};
}

}  // namespace

std::vector<PixelSample> pixel_samples(const Settings& settings, const Camera& camera) {
  if (settings.samples == 1) {
    PixelSample middle;
    middle.time = middle_of_shutter(camera);
    return {middle};
  }
  const auto n = static_cast<uint32_t>(settings.samples);
  const std::vector<uint32_t> lens = random_order(n, key_of(Dimension::lens_order, settings.seed));
  const std::vector<uint32_t> time = random_order(n, key_of(Dimension::time_order, settings.seed));
  std::vector<PixelSample> samples;
  double sum = 0;
  for (uint32_t i = 0; i < n; ++i) {
    samples.push_back(place_sample(settings, camera, i, {lens[i], time[i]}));
    sum += samples.back().weight;
  }
  // So few samples that the negative ones nearly outweigh the others cannot stand for the filter.
  const bool weighs = sum > 0.5 * settings.samples;
  for (PixelSample& s : samples) s.weight = weighs ? s.weight / sum : 1.0 / settings.samples;
  return samples;
}

std::vector<uint32_t> random_order(uint32_t count, uint32_t key) {
  std::vector<uint32_t> order(count);
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t j = sample_hash(key, i) % (i + 1);
    order[i] = order[j];
    order[j] = i;
  }
  return order;
}

float middle_of_shutter(const Camera& camera) {
  return 0.5f * camera.shutter_open + 0.5f * camera.shutter_close;
}

Camera camera_at(const Camera& camera, float time) {
  Camera now = camera;
  if (camera.motion.empty()) return now;
  std::vector<RigidKey> poses;
  for (const CameraKey& key : camera.motion) {
    poses.push_back(pose_of(key));
    if (key.time == time || camera.motion.size() == 1) {
      now.position = key.position, now.view = key.view, now.up = key.up;
      return now;
    }
  }
  const RigidKey pose = pose_at(poses, time);
  now.position = pose.translation;
  now.view = rotate(pose.rotation, {0, 0, -1});
  now.up = rotate(pose.rotation, {0, 1, 0});
  return now;
}

SampleView sample_view(const Camera& camera, const Settings& settings, const PixelSample& sample) {
  SampleView view{make_pinhole(camera, settings.width, settings.height), {}};
  Pinhole& p = view.pinhole;
  p.footprint = p.step / narrow(square_root(static_cast<double>(settings.samples)));
  p.center_x -= sample.x * p.step, p.center_y -= sample.y * p.step;
  if (!(camera.aperture > 0) || settings.samples == 1) return view;
  if (settings.primary == Primary::trace) {
    view.lens = {0.5f * camera.aperture, camera.focus, sample.lens_index,
                 static_cast<uint32_t>(settings.samples), key_of(Dimension::lens, settings.seed)};
  } else {
    const float x = 0.5f * camera.aperture * sample.lens_x, y = 0.5f * camera.aperture * sample.lens_y;
    p.origin += p.right * x + p.up * y;
    p.center_x += x / camera.focus, p.center_y -= y / camera.focus;
  }
  return view;
}

}  // namespace vitral
