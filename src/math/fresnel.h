// Reflection and refraction at a smooth boundary. `eta` is the ratio of the indices of refraction,
// where the ray comes from over where it goes; cosines are against the normal on the ray's side.
#pragma once
#include "math/scalar.h"
#include "vitral/render.h"
#include "vitral/vec.h"

namespace vitral {

// The mirror direction of unit `d` about unit `n`; dot(d, n) may have either sign.
template <class F>
static inline Vec3T<F> reflect(const Vec3T<F>& d, const Vec3T<F>& n) {
  return d - n * (F(2.0f) * dot(d, n));
}

// 1 - eta^2 (1 - cos_i^2): the squared cosine of the refracted ray (Snell's law); negative at total
// internal reflection.
static inline float refracted_cosine_squared(float cos_i, float eta) {
  return 1 - eta * eta * (1 - cos_i * cos_i);
}

// The refracted direction of unit `d` that meets unit `n` with dot(d, n) = -cos_i < 0.
static inline Vec3 refract(const Vec3& d, const Vec3& n, float eta, float cos_i, float cos_t) {
  return d * eta + n * (eta * cos_i - cos_t);
}

// The fraction of unpolarized light that is reflected (Born and Wolf, Principles of Optics, 1.5.2):
// the mean of the squares of (n_i cos_i - n_t cos_t) / (n_i cos_i + n_t cos_t) and of the same with
// the cosines exchanged.
static inline float fresnel_exact(float cos_i, float eta) {
  const float squared = refracted_cosine_squared(cos_i, eta);
  if (!(squared > 0)) return 1;
  const float cos_t = square_root(squared);
  const float s = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  const float p = (eta * cos_t - cos_i) / (eta * cos_t + cos_i);
  return 0.5f * (s * s + p * p);
}

// Schlick, "An Inexpensive BRDF Model for Physically-based Rendering", 1994; from the denser side
// with the cosine on the thinner side.
static inline float fresnel_schlick(float cos_i, float eta) {
  const float squared = refracted_cosine_squared(cos_i, eta);
  if (!(squared > 0)) return 1;
  const float f0 = ((1 - eta) / (1 + eta)) * ((1 - eta) / (1 + eta));
  const float m = 1 - (eta > 1 ? square_root(squared) : cos_i);
  return f0 + (1 - f0) * ((m * m) * (m * m) * m);
}

// The report's equation 2 takes 1 - eta^2 (1 - cos_i^2) as the refracted part.
static inline float fresnel_report(float cos_i, float eta) {
  return 1 - least(greatest(refracted_cosine_squared(cos_i, eta), 0.0f), 1.0f);
}

static inline float fresnel(Fresnel model, float cos_i, float eta) {
  switch (model) {
    case Fresnel::schlick:
      return fresnel_schlick(cos_i, eta);
    case Fresnel::report:
      return fresnel_report(cos_i, eta);
    case Fresnel::exact:
      break;
  }
  return fresnel_exact(cos_i, eta);
}

}  // namespace vitral
