#include "render/pattern.h"

#include "math/absorption.h"
#include "math/elementary.h"
#include "math/noise.h"

namespace vitral {
namespace {

// Wider than this many periods everything is its mean.
constexpr double kBoundless = 1e6;
// Narrower than this part of a period a box is a point: its integral would be lost in rounding.
constexpr double kPoint = 1e-7;

double floor_of(double x) {
  const double cut = static_cast<double>(static_cast<int64_t>(x));
  return cut > x ? cut - 1 : cut;
}

// Coordinates and widths along one axis, in periods.
struct Span {
  double at, width;
};

// A box has a twelfth of its width's square for a variance; a parallelogram that of both its sides.
Span span(float at, float first, float second, float period) {
  const double p = static_cast<double>(period), x = static_cast<double>(at) / p;
  const double a = static_cast<double>(first) / p, b = static_cast<double>(second) / p;
  const double width = square_root(a * a + b * b);
  return {absolute(x) < 1e15 ? x : 0, width < kBoundless ? width : kBoundless};
}

// The mean over a span of the wave that is 1 in the first `duty` of every period and 0 in the rest.
double pulse(const Span& s, double duty) {
  if (s.width < kPoint) return s.at - floor_of(s.at) < duty ? 1 : 0;
  const auto integral = [duty](double x) {
    const double whole = floor_of(x);
    return whole * duty + least(x - whole, duty);
  };
  return (integral(s.at + s.width / 2) - integral(s.at - s.width / 2)) / s.width;
}

Vec3 mixed(const Pattern& p, double share_of_first) {
  const float share = static_cast<float>(share_of_first);
  return p.first * share + p.second * (1 - share);
}

// The checker of +1 and -1 is the product of a wave along each axis.
Vec3 checker(const Pattern& p, const PatternPlace& at) {
  double product = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const float beneath = component(at.position, axis) - component(at.outward, axis) * (p.size / 1024);
    const Span s = span(beneath, component(at.first, axis), component(at.second, axis), 2 * p.size);
    product *= 2 * pulse(s, 0.5) - 1;
  }
  return mixed(p, 0.5 + 0.5 * product);
}

// A brick is where both its length and its height say so. Where several courses are seen, those that are
// moved and those that are not count by what is seen of them.
Vec3 brick(const Pattern& p, const PatternPlace& at) {
  const Vec3 n{absolute(at.outward.x), absolute(at.outward.y), absolute(at.outward.z)};
  const bool floor = n.y > n.x && n.y > n.z;
  const int along = !floor && n.x > n.z ? 2 : 0, upward = floor ? 2 : 1;
  const auto on = [&](int axis, float period, float shift) {
    return span(component(at.position, axis) + shift, component(at.first, axis), component(at.second, axis),
                period);
  };
  // Half a joint on either side: whole numbers are in the middle of joints.
  const float half = 0.5f * p.mortar;
  const Span course = on(upward, p.height, -half), two_courses = on(upward, 2 * p.height, 0);
  const Span straight = on(along, p.size, -half), moved = on(along, p.size, 0.5f * p.size - half);
  const double high = pulse(course, 1 - static_cast<double>(p.mortar / p.height));
  const double duty = 1 - static_cast<double>(p.mortar / p.size);
  const double even = pulse(two_courses, 0.5);
  return mixed(p, high * (even * pulse(straight, duty) + (1 - even) * pulse(moved, duty)));
}

// Noise is flat at its lattice's planes. Turned away from the axes, they neither lie in walls and floors nor
// keep step with the veins.
Vec3 turned(const Vec3& p) {
  return {0.36f * p.x + 0.48f * p.y - 0.8f * p.z, -0.8f * p.x + 0.6f * p.y,
          0.48f * p.x + 0.64f * p.y + 0.6f * p.z};
}

// Mean and variance of |gradient_noise|, and the mean square of its slope along any axis.
constexpr float kMeanNoise = 0.22f, kNoiseVariance = 0.0245f, kSquaredSlope = 0.5f;
constexpr int kOctaves = 8;

// The sum of octaves, and its variance over what is seen around the point.
struct Turbulence {
  float value, variance;
};

// `squared` is the sum of the squares of the seen sides, in bumps. An octave fades from where half a bump is
// seen at once to where a whole one is; of what is visible the slope spreads the values, and what is not is
// spread as widely as it can be.
Turbulence turbulence(Vec3 p, float squared) {
  Turbulence sum{0, 0};
  float width = square_root(0.5f * squared), scale = 1;
  for (int i = 0; i < kOctaves; ++i) {
    const float visible = least(greatest(2 - 2 * width, 0.0f), 1.0f);
    const float bump = visible > 0 ? absolute(gradient_noise(p)) : 0;
    sum.value += scale * (kMeanNoise + visible * (bump - kMeanNoise));
    sum.variance += visible * (kSquaredSlope / 12) * squared + (1 - visible) * scale * scale * kNoiseVariance;
    scale *= 0.5f, width *= 2, p = p * 2.0f;
  }
  return sum;
}

// Veins are cos^8 (pi w), a sum of waves of 0 to 4 periods:
//   (35 + 56 cos 2 pi w + 28 cos 4 pi w + 8 cos 6 pi w + cos 8 pi w) / 128.
// Where w varies by v around the point a wave of k periods is left with the part exp(-2 pi^2 k^2 v), the mean
// over a normal distribution.
float vein(float w, float variance) {
  float sine, cosine;
  sin_cos_turn(least(split_at_integer(w).rest, 0x1.fffffep-1f), sine, cosine);
  constexpr float kWeights[] = {35.0f / 128, 56.0f / 128, 28.0f / 128, 8.0f / 128, 1.0f / 128};
  const float least_left = transmittance(19.7392088f, variance);  // 2 pi^2
  float sum = kWeights[0], before = 1, wave = cosine, left = least_left, ratio = least_left;
  for (int k = 1; k <= 4; ++k) {
    sum += kWeights[k] * left * wave;
    const float next = 2 * cosine * wave - before;  // cos (k + 1) x
    before = wave, wave = next;
    ratio *= least_left * least_left, left *= ratio;  // the next square is 2 k + 1 further
  }
  return least(greatest(sum, 0.0f), 1.0f);
}

Vec3 marble(const Pattern& p, const PatternPlace& at) {
  const float inverse = 1 / p.size;
  const auto bounded = [](float squared) { return squared < 1e12f ? squared : 1e12f; };
  const float squared = bounded((dot(at.first, at.first) + dot(at.second, at.second)) * inverse * inverse);
  const float across = bounded((at.first.x * at.first.x + at.second.x * at.second.x) * inverse * inverse);
  const Turbulence t = turbulence(turned(at.position * inverse), squared);
  const float w = at.position.x * inverse + p.turbulence * t.value;
  return mixed(p, 1 - static_cast<double>(vein(w, across / 12 + p.turbulence * p.turbulence * t.variance)));
}

}  // namespace

Vec3 pattern_color(const Pattern& pattern, const PatternPlace& place) {
  switch (pattern.kind) {
    case Pattern::Kind::checker:
      return checker(pattern, place);
    case Pattern::Kind::brick:
      return brick(pattern, place);
    case Pattern::Kind::marble:
      return marble(pattern, place);
    case Pattern::Kind::none:
      break;
  }
  return {1, 1, 1};
}

}  // namespace vitral
