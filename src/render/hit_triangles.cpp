#include "render/hit_triangles.h"

#include "kdtree/shapes.h"
#include "kernels/ray_offset.h"
#include "math/footprint.h"
#include "render/frame.h"

#include <utility>

namespace vitral {
namespace {

void set_corner(HitTriangles& out, int lane, int k, const Vec3& p) {
  float* c = out.triangles[lane].corner[k];
  c[0] = p.x, c[1] = p.y, c[2] = p.z;
}
Vec3 corner(const HitTriangles& hits, int lane, int k) {
  const float* c = hits.triangles[lane].corner[k];
  return {c[0], c[1], c[2]};
}

// Normals are the lane's own three, or none.
void set_normals(HitTriangles& out, int lane, bool smooth) {
  for (int k = 0; k < 3; ++k)
    out.normal_indices[3 * lane + k] = smooth ? static_cast<uint32_t>(3 * lane + k) : kNoIndex;
}

// What a mesh has of a triangle, in its own space.
void copy_triangle(const Mesh& mesh, const KdTriangle& triangle, uint32_t number, int lane,
                   HitTriangles& out) {
  out.triangles[lane] = triangle;
  out.materials[lane] = mesh.triangle_material[number];
  out.texcoords[lane] = corner_texcoords(mesh, number);
  bool smooth = !mesh.triangle_normals.empty();
  for (size_t k = 0; k < 3 && smooth; ++k) {
    const uint32_t at = mesh.triangle_normals[number][k];
    smooth = at != kNoIndex;
    if (smooth) out.normals[3 * static_cast<size_t>(lane) + k] = mesh.normals[at];
  }
  set_normals(out, lane, smooth);
}

// The other winding.
void swap_corners(int lane, HitTriangles& out) {
  std::swap(out.triangles[lane].corner[1], out.triangles[lane].corner[2]);
  std::swap(out.normals[3 * lane + 1], out.normals[3 * lane + 2]);
  std::swap(out.texcoords[lane][1], out.texcoords[lane][2]);
  std::swap(out.hits.u[lane], out.hits.v[lane]);
}

bool is_identity(const Affine& a) {
  const Affine id;
  return a.x == id.x && a.y == id.y && a.z == id.z && a.origin == id.origin;
}

// The corners in one space and in the other.
struct MovedCorners {
  Vec3 own[3], moved[3];
};
float more_offset(const Affine& map, const MovedCorners& c) {
  const auto largest = [](const Vec3* p) {
    return greatest(absolute(p[0]), greatest(absolute(p[1]), absolute(p[2])));
  };
  const Vec3* o = c.own;
  const Vec3 apart = greatest(o[0], greatest(o[1], o[2])) - least(o[0], least(o[1], o[2]));
  const Vec3d a = to_double(c.moved[0]);
  const Vec3d normal = normalize(cross(to_double(c.moved[1]) - a, to_double(c.moved[2]) - a));
  return dot(absolute(to_float(normal)), placement_error(map, largest(o), apart, largest(c.moved)));
}

void place_triangle(const PlacedObject& object, int lane, HitTriangles& out) {
  // An identity must not cost the normals a rounding.
  if (is_identity(object.to_world)) return;
  const PreciseAffine to_world = to_double(object.to_world);
  MovedCorners c;
  for (int k = 0; k < 3; ++k) {
    c.own[k] = corner(out, lane, k);
    c.moved[k] = to_float(transform_point(to_world, to_double(c.own[k])));
    set_corner(out, lane, k, c.moved[k]);
    Vec3& n = out.normals[3 * lane + k];
    if (out.normal_indices[3 * lane] != kNoIndex)
      n = to_float(normalize(transform_normal(object.to_object, to_double(n))));
  }
  out.more_offset[lane] = more_offset(object.to_world, c);
  if (object.mirrored) swap_corners(lane, out);
}

// How the unit normal of the world turns when the object's normal n changes by `change`; `normal` is the
// world's, of length `length` before it was normalized.
Vec3d turned(const PlacedObject& object, const Vec3d& change, const Vec3d& normal, double length) {
  const Vec3d moved = transform_normal(object.to_object, change);
  return (moved - normal * dot(normal, moved)) * (1 / length);
}

void place_shape(const PlacedObject& object, const Ray& ray, float t, int lane, HitTriangles& out) {
  const ObjectRay<double> there = ray_to_object(object, ray.origin, ray.direction);
  const LineSpan<double> span = shape_span(object.shape, there.origin, there.direction);
  const ShapePoint point = shape_point(object.shape, there.origin, there.direction, exact_end(span, t));
  const PreciseAffine to_world = to_double(object.to_world);
  const Vec3d position = transform_point(to_world, point.position);
  const Vec3d upright = transform_normal(object.to_object, point.normal);
  const double length = vitral::length(upright);
  const Vec3d normal = upright * (1 / length);
  Vec3d side[2] = {transform_vector(to_world, point.along_u), transform_vector(to_world, point.along_v)};
  const Vec3d change[2] = {point.along_u * point.turn_u, point.along_v * point.turn_v};
  const double slope[2] = {point.slope_u, point.slope_v};
  // The corners are rounded where they are: sides as long as the point is far keep their directions.
  const float far = largest_component(to_float(position));
  const bool smooth = point.turn_u != 0 || point.turn_v != 0;
  Vec2 uv[2];
  set_corner(out, lane, 0, to_float(position));
  out.normals[3 * lane] = to_float(normal);
  for (int k = 0; k < 2; ++k) {
    const double size = vitral::length(side[k]);
    const double stretch = greatest(1.0, static_cast<double>(far) / size);
    set_corner(out, lane, k + 1, to_float(position + side[k] * stretch));
    const Vec3d n = normal + turned(object, change[k], normal, length) * stretch;
    out.normals[3 * lane + k + 1] = to_float(n);
    uv[k] = point.texcoord;
    (k == 0 ? uv[k].x : uv[k].y) += narrow(slope[k] * stretch);
  }
  set_normals(out, lane, smooth);
  out.texcoords[lane] = {point.texcoord, uv[0], uv[1]};
  out.materials[lane] = object.material;
  out.triangles[lane].flags = object.flags;
  out.hits.u[lane] = out.hits.v[lane] = 0;
  // The ray goes to the shape, and its root is taken, in double: what float is to a placed triangle, by the
  // unit roundoff of double and ten roundings for one.
  constexpr float kDoubleRoundoff = 10 * 0x1p-53f / kUnitRoundoff;
  const Vec3 own = absolute(to_float(point.position));
  out.more_offset[lane] =
      dot(absolute(to_float(normal)),
          placement_error(object.to_world, own, own,
                          absolute(to_float(position)) + absolute(object.to_world.origin))) *
      kDoubleRoundoff;
  if (object.mirrored) swap_corners(lane, out);
}

}  // namespace

void gather_hits(const FrameContext& frame, const RayPacket& rays, const HitPacket& hits, HitTriangles& out) {
  const Accelerator& a = frame.accelerator;
  const ObjectsView& view = a.placed.view;
  out.hits = hits;
  for (int lane = 0; lane < kPacketSize; ++lane) {
    const uint32_t number = hits.triangle[lane];
    if (!(rays.live >> lane & 1) || number == kNoTriangle) {
      out.hits.triangle[lane] = kNoTriangle;
      continue;
    }
    out.hits.triangle[lane] = static_cast<uint32_t>(lane);
    out.more_offset[lane] = 0;
    if (!is_object(view, number)) {
      copy_triangle(frame.scene.mesh, a.triangles[number], number, lane, out);
      continue;
    }
    const PlacedObject& object = view.objects[object_of(view, number)];
    if (object.shape != Shape::mesh) {
      place_shape(object, ray_of(rays, lane), hits.t[lane], lane, out);
      continue;
    }
    const PlacedModel& model = *a.placed.models[object.model];
    const uint32_t own = number - object.first_number;
    copy_triangle(frame.scene.models[model.mesh], model.triangles[own], own, lane, out);
    if (object.material != kNoIndex) out.materials[lane] = object.material;
    place_triangle(object, lane, out);
  }
}

SurfaceView view_of(const FrameContext& frame, const HitTriangles& hits) {
  return {hits.triangles,  hits.normal_indices, hits.normals, hits.materials, frame.accelerator.colors.data(),
          hits.more_offset};
}

float curvature(const Vec3* corners, const Vec3* normals, const Vec3& geometric, const Vec3& shading) {
  const Vec3 &a = normals[0], &b = normals[1], &c = normals[2];
  const BarycentricSlopes<float> slopes =
      barycentric_slopes(corners[1] - corners[0], corners[2] - corners[0], geometric);
  const float half = 0.5f * (dot(slopes.b, b - a) + dot(slopes.c, c - a));
  if (!(absolute(half) < 1e9f)) return 0;
  return dot((a + b) + c, shading) < 0 ? -half : half;
}

float curvature(const HitTriangles& hits, int lane, const Vec3& geometric, const Vec3& shading) {
  if (hits.normal_indices[3 * lane] == kNoIndex) return 0;
  const Vec3 corners[3] = {corner(hits, lane, 0), corner(hits, lane, 1), corner(hits, lane, 2)};
  return curvature(corners, &hits.normals[3 * lane], geometric, shading);
}

}  // namespace vitral
