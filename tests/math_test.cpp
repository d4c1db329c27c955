// Own arithmetic against the C library in double, and closed forms.
#include "math/elementary.h"
#include "math/fresnel.h"
#include "math/pinhole.h"
#include "math/random.h"
#include "math/sampling.h"
#include "math/srgb.h"

#include <gtest/gtest.h>

#include <cfenv>
#include <cfloat>
#include <cmath>
#include <limits>
#include <set>

namespace vitral {
namespace {

// Fused multiply-add, wider intermediate results or flushed denormals would change pictures.
TEST(Arithmetic, IsPlainIeee) {
  volatile float a = 1.0f + 0x1p-12f, b = 1.0f + 0x1p-12f, c = 1.0f + 0x1p-11f;
  const float product = a * b - c;  // fused: 2^-24
  EXPECT_EQ(product, 0.0f);
  volatile double x = 1.0 + 0x1p-27, y = 1.0 + 0x1p-26;
  const double wide = x * x - y;
  EXPECT_EQ(wide, 0.0);
  volatile float tiny = std::numeric_limits<float>::min();
  const float denormal = tiny * 0.5f;
  EXPECT_GT(denormal, 0.0f);
  EXPECT_EQ(std::fegetround(), FE_TONEAREST);
  EXPECT_EQ(FLT_EVAL_METHOD, 0);
}

TEST(Elementary, SineAndCosineOfATurn) {
  for (int i = 0; i < 100000; ++i) {
    const float u = static_cast<float>(i) / 100000;
    float s, c;
    sin_cos_turn(u, s, c);
    ASSERT_NEAR(s, std::sin(2 * M_PI * static_cast<double>(u)), 1e-6);
    ASSERT_NEAR(c, std::cos(2 * M_PI * static_cast<double>(u)), 1e-6);
  }
}

TEST(Elementary, Tangent) {
  for (int i = 1; i < 1000; ++i) {
    const double x = 1.57 * i / 1000;
    ASSERT_NEAR(tangent(x) / std::tan(x), 1, 1e-11) << x;
  }
}

TEST(Elementary, LogarithmAndExponential) {
  for (int i = -3000; i < 3000; ++i) {
    const double y = i * 0.3371;
    if (y > -1022 && y < 1023.5) {
      ASSERT_NEAR(exp2_of(y) / std::exp2(y), 1, 2e-15) << y;
      ASSERT_NEAR(log2_of(std::exp2(y)), y, 1e-13) << y;
    }
  }
  EXPECT_EQ(exp2_of(-2000), 0);
  EXPECT_EQ(exp2_of(2000), std::numeric_limits<double>::infinity());
  EXPECT_EQ(exp2_of(10), 1024);
}

TEST(Elementary, Power) {
  EXPECT_EQ(power(0, 0), 1);
  EXPECT_EQ(power(0, 5), 0);
  EXPECT_EQ(power(1, 1e4f), 1);
  for (int i = 1; i <= 200; ++i) {
    const float x = static_cast<float>(i) / 100, y = static_cast<float>(i % 17) * 1.7f;
    const double expected = std::pow(static_cast<double>(x), static_cast<double>(y));
    ASSERT_NEAR(power(x, y), expected, expected * 6e-8 + 1e-45);
  }
}

TEST(Srgb, RoundTripsEveryCodeAndIsMonotone) {
  for (int i = 0; i < 256; ++i) {
    EXPECT_EQ(linear_to_srgb8(kLinearOfSrgb[static_cast<size_t>(i)]), i);
    const double s = i / 255.0;
    EXPECT_NEAR(kLinearOfSrgb[static_cast<size_t>(i)],
                s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4), 1e-7);
  }
  int last = 0;
  for (int i = 0; i <= 1000000; ++i) {
    const float x = static_cast<float>(i) / 1000000;
    const double xd = static_cast<double>(x);
    const int code = linear_to_srgb8(x);
    ASSERT_GE(code, last);
    last = code;
    const double exact = 255 * (xd <= 0.0031308 ? 12.92 * xd : 1.055 * std::pow(xd, 1 / 2.4) - 0.055);
    ASSERT_NEAR(code, exact, 0.5 + 1e-3);
  }
  EXPECT_EQ(linear_to_srgb8(-1), 0);
  EXPECT_EQ(linear_to_srgb8(7), 255);
  EXPECT_EQ(linear_to_srgb8(std::numeric_limits<float>::quiet_NaN()), 0);
}

TEST(Fresnel, ClosedForms) {
  const float n = 1.5f;
  // Normal incidence: ((n-1)/(n+1))^2, from both sides.
  EXPECT_NEAR(fresnel_exact(1, 1 / n), 0.04, 1e-6);
  EXPECT_NEAR(fresnel_exact(1, n), 0.04, 1e-6);
  EXPECT_NEAR(fresnel_schlick(1, 1 / n), 0.04, 1e-6);
  // Brewster's angle, tan = n: p-polarized light is not reflected, s by (cos i^2 - sin i^2)^2.
  const double brewster = std::atan(1.5);
  const double s =
      std::pow(std::cos(brewster) * std::cos(brewster) - std::sin(brewster) * std::sin(brewster), 2);
  EXPECT_NEAR(fresnel_exact(static_cast<float>(std::cos(brewster)), 1 / n), 0.5 * s, 1e-6);
  // Grazing incidence and total internal reflection.
  EXPECT_NEAR(fresnel_exact(0, 1 / n), 1, 1e-6);
  EXPECT_NEAR(fresnel_schlick(0, 1 / n), 1, 1e-6);
  const double critical = std::asin(1 / 1.5);
  EXPECT_EQ(fresnel_exact(static_cast<float>(std::cos(critical + 0.01)), n), 1);
  EXPECT_LT(fresnel_exact(static_cast<float>(std::cos(critical - 0.01)), n), 1);
  EXPECT_EQ(fresnel_schlick(static_cast<float>(std::cos(critical + 0.01)), n), 1);
  // The report's: all is refracted at normal incidence, 1 - K^2 at grazing.
  EXPECT_EQ(fresnel_report(1, 1 / 1.1f), 0);
  EXPECT_NEAR(fresnel_report(0, 1 / 1.1f), 1 / 1.21, 1e-6);
  EXPECT_EQ(fresnel_report(0.1f, 1.5f), 1);
  for (int i = 0; i <= 100; ++i) {
    const float c = static_cast<float>(i) / 100;
    for (const float eta : {1 / 1.5f, 1.5f, 1.0f, 1 / 2.4f}) {
      for (const Fresnel model : {Fresnel::exact, Fresnel::schlick, Fresnel::report}) {
        ASSERT_GE(fresnel(model, c, eta), 0);
        ASSERT_LE(fresnel(model, c, eta), 1);
      }
    }
  }
}

TEST(Fresnel, RefractionObeysSnell) {
  for (int i = 0; i < 100; ++i) {
    const double angle = 1.5 * i / 100;
    const Vec3 d{static_cast<float>(std::sin(angle)), static_cast<float>(-std::cos(angle)), 0};
    const float cos_i = -d.y, eta = 1 / 1.33f;
    const Vec3 t = refract(d, {0, 1, 0}, eta, cos_i, square_root(refracted_cosine_squared(cos_i, eta)));
    EXPECT_NEAR(t.x, std::sin(angle) / 1.33, 1e-6);
    EXPECT_NEAR(length(t), 1, 1e-6);
    EXPECT_LT(t.y, 0);
  }
}

TEST(Sampling, FrameIsOrthonormalAndStrataKeepTheirMean) {
  const Vec3 normals[] = {{0, 0, 1},
                          {0, 0, -1},
                          {1, 0, 0},
                          {0, -1, 0},
                          normalize(Vec3{1, 2, -3}),
                          normalize(Vec3{-1e-4f, 1e-4f, -1})};
  for (const Vec3& n : normals) {
    Vec3 t, b;
    tangent_frame(n, t, b);
    EXPECT_NEAR(dot(t, b), 0, 1e-6);
    EXPECT_NEAR(dot(t, n), 0, 1e-6);
    EXPECT_NEAR(dot(b, n), 0, 1e-6);
    EXPECT_NEAR(dot(cross(t, b), n), 1, 1e-6);
    // The mean of cos over a cosine-weighted hemisphere is 2/3, that of the tangent parts 0.
    double cosine = 0, side = 0;
    const int k = 64;
    for (int i = 0; i < k * k; ++i) {
      const float u1 = (static_cast<float>(i % k) + 0.5f) / k, u2 = (static_cast<float>(i / k) + 0.5f) / k;
      const Vec3 d = cosine_hemisphere(n, u1, u2);
      ASSERT_NEAR(length(d), 1, 2e-6);
      ASSERT_GE(dot(d, n), 0);
      cosine += static_cast<double>(dot(d, n));
      side += static_cast<double>(dot(d, t));
    }
    EXPECT_NEAR(cosine / (k * k), 2.0 / 3, 1e-3);
    EXPECT_NEAR(side / (k * k), 0, 1e-3);
  }
}

TEST(Random, KeysOfPixelsDoNotRepeat) {
  std::set<uint32_t> keys;
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) keys.insert(pixel_key(x, y, 1));
  }
  EXPECT_GT(keys.size(), 9990u);
  EXPECT_NE(pixel_key(3, 4, 1), pixel_key(3, 4, 2));
  EXPECT_NE(pixel_key(3, 4, 1), pixel_key(4, 3, 1));
}

TEST(Pinhole, PixelCentresAndTheFieldOfView) {
  Camera camera;
  camera.position = {1, 2, 3}, camera.view = {0, 0, -2}, camera.up = {0, 5, 0};
  camera.fov = 90, camera.near = 0.1f, camera.far = 100;
  const Pinhole p = make_pinhole(camera, 200, 100);
  // The centre of the picture lies between pixels: (99, 49) and (100, 50) see it from both sides.
  const Vec3 a = primary_direction(p, 99.0f, 49.0f), b = primary_direction(p, 100.0f, 50.0f);
  EXPECT_NEAR(a.x, -b.x, 1e-6);
  EXPECT_NEAR(a.y, -b.y, 1e-6);
  EXPECT_NEAR(a.z, -1, 1e-6);
  // 90 degrees: the upper edge (y = -0.5 + 0) is at slope 1, half a pixel above the first centre.
  EXPECT_NEAR(primary_direction(p, 0.0f, 0.0f).y, 1 - 0.01, 1e-6);
  EXPECT_NEAR(primary_direction(p, 0.0f, 0.0f).x, -2 + 0.01, 1e-6);
  EXPECT_NEAR(primary_direction(p, 0.0f, 99.0f).y, -1 + 0.01, 1e-6);
}

}  // namespace
}  // namespace vitral
