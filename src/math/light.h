// What arrives from a light at a point, written once for a number and for a register of them. All strengths
// are irradiances at normal incidence by the light's colour.
#pragma once
#include "math/elementary.h"
#include "math/sampling.h"
#include "vitral/scene.h"

namespace vitral {

// Blinn's highlight max(N.H, 0)^Ns, H halfway between the unit vectors to the light and to the viewer
// ("Models of light reflection for computer synthesized pictures", SIGGRAPH 1977).
static inline float blinn_highlight(const Vec3& n, const Vec3& to_light, const Vec3& to_viewer,
                                    float shininess) {
  const Vec3 halfway = to_light + to_viewer;
  const float squared = dot(halfway, halfway);
  const float cosine = squared > 0 ? dot(n, halfway) / square_root(squared) : 0.0f;
  return cosine > 0 ? power(least(cosine, 1.0f), shininess) : 0.0f;
}

// --- the spot ----------------------------------------------------------------------------------------

// A spot's intensity goes from 0 at the outer cone to 1 at the inner one by t^2 (3 - 2t), t linear in the
// cosine of the angle from its axis. On the outer cone itself there is no light.
struct SpotCone {
  float outer;  // cosine of the outer angle
  float scale;  // 1 / (cosine of the inner angle - outer); very large where the two are one
};
static inline SpotCone spot_cone(const Light& light) {
  double sine, inner, outer;
  sin_cos_degrees(static_cast<double>(light.inner_degrees), sine, inner);
  sin_cos_degrees(static_cast<double>(light.outer_degrees), sine, outer);
  return {static_cast<float>(outer), static_cast<float>(1 / greatest(inner - outer, 1e-9))};
}

// The share of a point light's intensity that a spot with this direction sends to where it is seen in the
// unit direction `to_light`.
template <class F>
static inline F spot_share(const SpotCone& cone, const Vec3& direction, const Vec3T<F>& to_light) {
  const Vec3T<F> axis{F(-direction.x), F(-direction.y), F(-direction.z)};
  const F t = least(greatest((dot(to_light, axis) - F(cone.outer)) * F(cone.scale), F(0.0f)), F(1.0f));
  return t * t * (F(3.0f) - F(2.0f) * t);
}

// --- lights with a size ------------------------------------------------------------------------------

// What the formulas below ask of a rectangle, a sphere or a sun.
struct LightShape {
  Light::Kind kind;
  Vec3 position;      // rectangle: the corner where u = v = 0; sphere: its centre
  Vec3 u, v, normal;  // rectangle: its sides, and where it shines; sun: a frame around the way to its middle
  float squared_radius;  // sphere
  float cap;             // sun: 1 - the cosine of half its diameter
};
static inline LightShape shape_of(const Light& light) {
  LightShape shape{light.kind, light.position, light.side_u, light.side_v, light.direction, 0, 0};
  if (light.kind == Light::Kind::rectangle)
    shape.position = light.position - (light.side_u + light.side_v) * 0.5f;
  shape.squared_radius = light.radius * light.radius;
  if (light.kind == Light::Kind::sun) {
    double sine, cosine;
    sin_cos_degrees(static_cast<double>(light.diameter_degrees) / 4, sine, cosine);
    shape.cap = static_cast<float>(2 * sine * sine);
    shape.normal = -light.direction;
    tangent_frame(shape.normal, shape.u, shape.v);
  }
  return shape;
}

// One sample of a light, seen from a point.
template <class F>
struct LightSample {
  Vec3T<F> direction;  // to the light, unit
  Vec3T<F> target;     // where it leaves the light; the sun has no such place
  F strength;          // not above 0: nothing comes from there
};

template <class F>
static inline Vec3T<F> broadcast(const Vec3& v) {
  return {F(v.x), F(v.y), F(v.z)};
}

// Uniform in the cap of directions around n whose height is `cap`, 1 - the cosine of its edge.
template <class F>
static inline Vec3T<F> cap_direction(const Vec3T<F>& t, const Vec3T<F>& b, const Vec3T<F>& n, const F& cap,
                                     const F& u, const F& v) {
  F sine, cosine;
  sin_cos_turn(v, sine, cosine);
  const F height = u * cap, radius = square_root(height * (F(2.0f) - height));
  return (t * (radius * cosine) + b * (radius * sine)) + n * (F(1.0f) - height);
}

// Uniform on the rectangle: what it sends there is its intensity straight on, by Lambert's law, over d^2.
template <class F>
static inline LightSample<F> sample_rectangle(const LightShape& light, const Vec3T<F>& p, const F& u,
                                              const F& v) {
  const Vec3T<F> target =
      broadcast<F>(light.position) + (broadcast<F>(light.u) * u + broadcast<F>(light.v) * v);
  const Vec3T<F> way = target - p;
  const F squared = dot(way, way), inverse = F(1.0f) / square_root(squared);
  const Vec3T<F> direction = way * inverse;
  const F cosine = -dot(direction, broadcast<F>(light.normal));
  return {direction, target, cosine * (inverse * inverse)};
}

// Uniform in the cone of directions under which the sphere is seen, up to its near side (Shirley, Wang and
// Zimmerman, "Monte Carlo Techniques for Direct Lighting Calculations", ACM TOG 15(1), 1996). A point inside
// sees the light all around it. The radiance is the colour / (pi r^2), the cone's solid angle 2 pi cap.
template <class F>
static inline LightSample<F> sample_sphere(const LightShape& light, const Vec3T<F>& p, const F& u,
                                           const F& v) {
  const F r2 = F(light.squared_radius);
  const Vec3T<F> way = broadcast<F>(light.position) - p;
  const F d2 = dot(way, way), d = square_root(d2);
  const auto outside = d2 > r2, apart = d2 > F(0.0f);
  const F inverse = F(1.0f) / select(apart, d, F(1.0f));
  const Vec3T<F> axis{way.x * inverse, select(apart, way.y * inverse, F(1.0f)), way.z * inverse};
  const F rim = F(1.0f) + square_root(F(1.0f) - select(outside, r2 / d2, F(0.0f)));
  const F cap = select(outside, r2 / (d2 * rim), F(2.0f));
  Vec3T<F> t, b;
  tangent_frame(axis, t, b);
  const Vec3T<F> direction = cap_direction(t, b, axis, cap, u, v);
  const F height = u * cap, middle = d * (F(1.0f) - height);
  const F half = square_root(greatest(r2 - d2 * (height * (F(2.0f) - height)), F(0.0f)));
  const F distance = select(outside, middle - half, middle + half);
  return {direction, p + direction * distance, select(outside, F(2.0f) / (d2 * rim), F(4.0f) / r2)};
}

// Uniform over the sun's disk. Its radiance is the colour / (pi sin^2 of half its diameter).
template <class F>
static inline LightSample<F> sample_sun(const LightShape& light, const F& u, const F& v) {
  const Vec3T<F> direction = cap_direction(broadcast<F>(light.u), broadcast<F>(light.v),
                                           broadcast<F>(light.normal), F(light.cap), u, v);
  return {direction, direction, F(2.0f / (2.0f - light.cap))};
}

}  // namespace vitral
