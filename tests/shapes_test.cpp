// Exact shapes against their equations, solved in long double piece by piece.
#include "kdtree/shapes.h"
#include "support.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace vitral::test {
namespace {

constexpr Shape kShapes[] = {Shape::sphere, Shape::plane, Shape::box, Shape::cylinder, Shape::disk};
constexpr Shape kBodies[] = {Shape::sphere, Shape::box, Shape::cylinder};

struct Long3 {
  long double x, y, z;
};
Long3 at(const Vec3d& o, const Vec3d& d, long double t) {
  return {static_cast<long double>(o.x) + t * static_cast<long double>(d.x),
          static_cast<long double>(o.y) + t * static_cast<long double>(d.y),
          static_cast<long double>(o.z) + t * static_cast<long double>(d.z)};
}

// Roots of a t^2 + 2 b t + c.
void add_roots(long double a, long double b, long double c, std::vector<long double>& out) {
  const long double d = b * b - a * c;
  if (d < 0 || a == 0) return;
  const long double q = -(b + std::copysign(std::sqrt(d), b));
  out.push_back(q / a);
  if (q != 0) out.push_back(c / q);
}

// All t at which the line crosses the shape's surface. Points this close to an edge may be in or out.
constexpr long double kEdge = 1e-9L;
std::vector<long double> crossings(Shape shape, const Vec3d& o, const Vec3d& d, bool& unclear) {
  std::vector<long double> out, found;
  const long double ox = static_cast<long double>(o.x), oy = static_cast<long double>(o.y),
                    oz = static_cast<long double>(o.z), dx = static_cast<long double>(d.x),
                    dy = static_cast<long double>(d.y), dz = static_cast<long double>(d.z);
  const auto keep = [&](long double t, long double inside) {
    if (std::abs(inside) < kEdge) unclear = true;
    if (inside <= 0) out.push_back(t);
  };
  if (shape == Shape::sphere) {
    add_roots(dx * dx + dy * dy + dz * dz, ox * dx + oy * dy + oz * dz, ox * ox + oy * oy + oz * oz - 1, out);
    return out;
  }
  if (shape == Shape::cylinder) {
    add_roots(dx * dx + dz * dz, ox * dx + oz * dz, ox * ox + oz * oz - 1, found);
    for (const long double t : found) keep(t, std::abs(at(o, d, t).y) - 1);
    for (const long double y : {-1.0L, 1.0L}) {
      const long double t = (y - oy) / dy;
      const Long3 p = at(o, d, t);
      if (std::isfinite(t)) keep(t, p.x * p.x + p.z * p.z - 1);
    }
    return out;
  }
  if (shape == Shape::box) {
    for (const long double side : {-1.0L, 1.0L}) {
      const long double tx = (side - ox) / dx, ty = (side - oy) / dy, tz = (side - oz) / dz;
      const Long3 px = at(o, d, tx), py = at(o, d, ty), pz = at(o, d, tz);
      if (std::isfinite(tx)) keep(tx, std::max(std::abs(px.y), std::abs(px.z)) - 1);
      if (std::isfinite(ty)) keep(ty, std::max(std::abs(py.x), std::abs(py.z)) - 1);
      if (std::isfinite(tz)) keep(tz, std::max(std::abs(pz.x), std::abs(pz.y)) - 1);
    }
    return out;
  }
  const long double t = -oy / dy;
  if (!std::isfinite(t)) return out;
  const Long3 p = at(o, d, t);
  if (shape == Shape::disk)
    keep(t, p.x * p.x + p.z * p.z - 1);
  else
    out.push_back(t);
  return out;
}

Ray ray_for(Random& random, uint32_t kind) {
  Ray ray{random.in_box(-3, 3), 0, random.direction(), kInfinity};
  switch (kind % 7) {
    case 0:  // towards the shape
      ray.direction = random.in_box(-1, 1) - ray.origin;
      break;
    case 1:  // from inside
      ray.origin = random.in_box(-0.55f, 0.55f);
      break;
    case 2:  // from far away
      ray.origin = random.direction() * 1e5f;
      ray.direction = random.in_box(-1, 1) - ray.origin;
      break;
    case 3:  // along an axis
      ray.direction = {0, random.below(2) ? 1.0f : -1.0f, 0};
      break;
    case 4:  // along another, of any length
      ray.direction = {random.between(-100, 100), 0, 0};
      break;
    case 5:  // from the surface of the sphere
      ray.origin = random.direction();
      break;
    default:
      break;
  }
  return ray;
}

TEST(Shapes, MeetRaysWhereTheirEquationsSay) {
  Random random(1);
  int met = 0, inside = 0;
  for (uint32_t i = 0; i < 20000; ++i) {
    const Shape shape = kShapes[i % 5];
    const Ray ray = ray_for(random, i / 5);
    const Vec3d o = to_double(ray.origin), d = to_double(ray.direction);
    bool unclear = false;
    const std::vector<long double> all = crossings(shape, o, d, unclear);
    if (unclear) continue;
    const LineSpan<double> span = shape_span(shape, o, d);
    ASSERT_EQ(span.enter <= span.leave, !all.empty()) << i;
    if (all.empty()) continue;
    const auto [first, last] = std::minmax_element(all.begin(), all.end());
    // A grazing line's ends are roots that nearly coincide: off by the root of what rounding is.
    const double reach = length(o) / length(d) + 1 / length(d);
    const double width = static_cast<double>(*last - *first);
    const double room = shape == Shape::plane || shape == Shape::disk
                            ? 1e-14 * reach / std::max(absolute(d.y) / length(d), 1e-9)
                            : 1e-13 * reach * (1 + reach / std::max(width, 1e-6 * reach));
    ASSERT_NEAR(span.enter, static_cast<double>(*first), room) << i;
    ASSERT_NEAR(span.leave, static_cast<double>(*last), room) << i;
    ++met;
    inside += *first < 0 && *last > 0;
  }
  EXPECT_GT(met, 4000);
  EXPECT_GT(inside, 1000);
}

TEST(Shapes, TheNearerEndInTheOpenIntervalIsTheHit) {
  const LineSpan<double> span{1, 3};
  const auto t_of = [&](float tmin, float tmax) {
    const auto found = nearest_end(span, tmin, tmax);
    return found.hit ? found.t : -1;
  };
  EXPECT_EQ(t_of(0, kInfinity), 1);
  EXPECT_EQ(t_of(1, kInfinity), 3) << "open at tmin";
  EXPECT_EQ(t_of(2, kInfinity), 3);
  EXPECT_EQ(t_of(3, kInfinity), -1);
  EXPECT_EQ(t_of(0, 1), -1) << "open at tmax";
  EXPECT_EQ(t_of(2, 3), -1);
  const auto none = nearest_end(LineSpan<double>{3, 1}, 0.0f, kInfinity);
  EXPECT_FALSE(none.hit);
}

// Rays of a float's accuracy that only touch from outside must not meet; a float beside them must.
TEST(Shapes, SilhouettesAreExact) {
  const Vec3d down{0, -1, 0};
  const double beside = 1 + 0x1p-50, within = 1 - 0x1p-50;
  for (const Shape shape : {Shape::sphere, Shape::cylinder, Shape::disk, Shape::box}) {
    const LineSpan<double> out = shape_span(shape, Vec3d{beside, 1e3, 0}, down);
    const LineSpan<double> in = shape_span(shape, Vec3d{within, 1e3, 0}, down);
    EXPECT_FALSE(out.enter <= out.leave) << static_cast<int>(shape);
    EXPECT_TRUE(in.enter <= in.leave) << static_cast<int>(shape);
  }
}

double distance_to_surface(Shape shape, const Vec3d& p) {
  const double flat = std::hypot(p.x, p.z);
  switch (shape) {
    case Shape::sphere:
      return std::abs(length(p) - 1);
    case Shape::box:
      return std::abs(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) - 1);
    case Shape::cylinder:
      return std::abs(std::max(flat, std::abs(p.y)) - 1);
    default:
      return std::abs(p.y);
  }
}

TEST(Shapes, PointsLieOnTheSurfaceWithItsNormalTangentsAndTexture) {
  Random random(2);
  int checked = 0;
  for (uint32_t i = 0; i < 20000; ++i) {
    const Shape shape = kShapes[i % 5];
    const Ray ray = ray_for(random, i / 5);
    const Vec3d o = to_double(ray.origin), d = to_double(ray.direction);
    const LineSpan<double> span = shape_span(shape, o, d);
    if (!(span.enter <= span.leave)) continue;
    const double t = i % 2 ? span.enter : span.leave;
    const ShapePoint p = shape_point(shape, o, d, t);
    ASSERT_LT(distance_to_surface(shape, p.position), 1e-14);
    ASSERT_LT(length(p.position - (o + d * t)), 1e-9 * (1 + length(o)));
    ASSERT_NEAR(length(p.normal), 1, 1e-14);
    ASSERT_LT(length(cross(p.along_u, p.along_v) - p.normal), 1e-12);
    ASSERT_NEAR(length(p.along_u), 1, 1e-12);
    const bool body = std::find(std::begin(kBodies), std::end(kBodies), shape) != std::end(kBodies);
    if (body) {
      // To the outside: where the line enters it runs against the normal.
      ASSERT_LE(dot(p.normal, d) * (t == span.enter ? 1 : -1), 1e-6 * length(d)) << i;
    }
    if (shape != Shape::plane) {
      ASSERT_GE(p.texcoord.x, 0) << i;
      ASSERT_LE(p.texcoord.x, 1) << i;
      ASSERT_GE(p.texcoord.y, 0) << i;
      ASSERT_LE(p.texcoord.y, 1) << i;
    }
    ++checked;
  }
  EXPECT_GT(checked, 5000);
}

// A step along a tangent changes the texture coordinates by the slopes and turns the normal by the curvature.
TEST(Shapes, SlopesAndCurvaturesAreThoseOfNeighbours) {
  Random random(3);
  int checked = 0;
  for (uint32_t i = 0; i < 5000; ++i) {
    const Shape shape = kShapes[i % 5];
    const Vec3d o = to_double(random.direction() * 3), d = to_double(random.in_box(-0.8f, 0.8f)) - o;
    const LineSpan<double> span = shape_span(shape, o, d);
    if (!(span.enter <= span.leave)) continue;
    const ShapePoint p = shape_point(shape, o, d, span.enter);
    // Far out on the plane texture coordinates are coarse; next to the poles they run away.
    if (absolute(p.texcoord.x) > 4 || absolute(p.texcoord.y) > 4 || p.slope_u > 2) continue;
    const double step = 1e-3;
    for (const bool along_v : {false, true}) {
      const Vec3d way = along_v ? p.along_v : p.along_u;
      // The neighbour lies straight below a step in the tangent plane.
      const Vec3d above = p.position + way * step + p.normal * 0.01;
      const LineSpan<double> next = shape_span(shape, above, -p.normal);
      if (!(next.enter <= next.leave)) continue;
      const ShapePoint q = shape_point(shape, above, -p.normal, next.enter);
      if (dot(p.normal, q.normal) < 0.99) continue;  // around an edge
      const double du = static_cast<double>(q.texcoord.x) - static_cast<double>(p.texcoord.x);
      const double dv = static_cast<double>(q.texcoord.y) - static_cast<double>(p.texcoord.y);
      if (std::abs(du) > 0.5) continue;  // across the seam
      const double room = 1e-6 + 1e-5 * p.slope_u;
      EXPECT_NEAR(du, along_v ? 0 : p.slope_u * step, room) << i;
      EXPECT_NEAR(dv, along_v ? p.slope_v * step : 0, 2e-6 + 1e-5 * p.slope_v) << i;
      const double turn = dot(q.normal - p.normal, way) / step;
      EXPECT_NEAR(turn, along_v ? p.turn_v : p.turn_u, 1e-3) << i;
      ++checked;
    }
  }
  EXPECT_GT(checked, 2000);
}

TEST(Shapes, TexturesAreUprightAndNotMirrored) {
  const auto uv_at = [](Shape shape, const Vec3d& p) {
    const Vec3d from = p * 2.0;
    const LineSpan<double> span = shape_span(shape, from, -p);
    return shape_point(shape, from, -p, span.enter).texcoord;
  };
  EXPECT_NEAR(uv_at(Shape::sphere, {0, 0, 1}).x, 0.5, 1e-6);
  EXPECT_NEAR(uv_at(Shape::sphere, {1, 0, 0}).x, 0.75, 1e-6) << "to the right, seen from +z";
  EXPECT_NEAR(uv_at(Shape::sphere, {0, 1, 1e-9}).y, 1, 1e-6) << "north is up";
  EXPECT_NEAR(uv_at(Shape::cylinder, {1, 0.5, 0}).y, 0.75, 1e-6);
  for (const Vec3d& face : {Vec3d{1, 0, 0}, Vec3d{-1, 0, 0}, Vec3d{0, 0, 1}, Vec3d{0, 0, -1}}) {
    const Vec3d right = cross(Vec3d{0, 1, 0}, face);
    const Vec2 middle = uv_at(Shape::box, face), aside = uv_at(Shape::box, face + right * 0.5),
               above = uv_at(Shape::box, face + Vec3d{0, 0.5, 0});
    EXPECT_NEAR(middle.x, 0.5, 1e-6);
    EXPECT_GT(aside.x, middle.x);
    EXPECT_GT(above.y, middle.y);
  }
  const Vec3d o{0.25, 5, -0.5};
  const ShapePoint p = shape_point(Shape::plane, o, {0, -1, 0}, 5);
  EXPECT_EQ(p.texcoord.x, 0.25f);
  EXPECT_EQ(p.texcoord.y, 0.5f);
}

}  // namespace
}  // namespace vitral::test
