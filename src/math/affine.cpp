#include "vitral/affine.h"

#include "math/elementary.h"

namespace vitral {
namespace {

Vec3d apply(const Affine& a, const Vec3d& v) {
  return to_double(a.x) * v.x + to_double(a.y) * v.y + to_double(a.z) * v.z;
}

struct Quaterniond {
  double x, y, z, w;
};
Quaternion rounded(const Quaterniond& q) {
  const double length = __builtin_sqrt(((q.x * q.x + q.y * q.y) + q.z * q.z) + q.w * q.w);
  return {narrow(q.x / length), narrow(q.y / length), narrow(q.z / length), narrow(q.w / length)};
}

// sin(angle) for a small number of radians in [-pi, pi].
double sine_of(double radians) {
  double s, c;
  sin_cos_degrees(radians * 57.29577951308232, s, c);
  return s;
}

Quaternion slerp(const Quaternion& from, const Quaternion& to, double t) {
  const Quaterniond a{from.x, from.y, from.z, from.w};
  Quaterniond b{to.x, to.y, to.z, to.w};
  double cosine = ((a.x * b.x + a.y * b.y) + a.z * b.z) + a.w * b.w;
  // q and -q are the same rotation: the nearer one is the shorter way.
  if (cosine < 0) b = {-b.x, -b.y, -b.z, -b.w}, cosine = -cosine;
  const double rest = 1 - cosine * cosine;
  const double sine = __builtin_sqrt(rest > 0 ? rest : 0.0);
  double wa = 1 - t, wb = t;
  if (sine > 1e-6) {
    const double angle = arc_tangent(sine, cosine);
    wa = sine_of((1 - t) * angle) / sine, wb = sine_of(t * angle) / sine;
  }
  return rounded({a.x * wa + b.x * wb, a.y * wa + b.y * wb, a.z * wa + b.z * wb, a.w * wa + b.w * wb});
}

}  // namespace

Affine operator*(const Affine& a, const Affine& b) {
  return {to_float(apply(a, to_double(b.x))), to_float(apply(a, to_double(b.y))),
          to_float(apply(a, to_double(b.z))), to_float(apply(a, to_double(b.origin)) + to_double(a.origin))};
}

PreciseAffine to_double(const Affine& a) {
  return {to_double(a.x), to_double(a.y), to_double(a.z), to_double(a.origin)};
}

double determinant(const Affine& a) {
  return dot(to_double(a.x), cross(to_double(a.y), to_double(a.z)));
}

PreciseAffine precise_inverse(const Affine& a) {
  const PreciseAffine d = to_double(a);
  const Vec3d yz = cross(d.y, d.z), zx = cross(d.z, d.x), xy = cross(d.x, d.y);
  const double over = 1 / dot(d.x, yz);
  // The rows of the inverse are the columns' cross products over the determinant.
  const Vec3d rx = yz * over, ry = zx * over, rz = xy * over;
  return {{rx.x, ry.x, rz.x},
          {rx.y, ry.y, rz.y},
          {rx.z, ry.z, rz.z},
          {-dot(rx, d.origin), -dot(ry, d.origin), -dot(rz, d.origin)}};
}

Affine inverse(const Affine& a) {
  const PreciseAffine i = precise_inverse(a);
  return {to_float(i.x), to_float(i.y), to_float(i.z), to_float(i.origin)};
}

bool is_finite(const Affine& a) {
  const auto finite = [](const Vec3& v) { return v.x - v.x == 0 && v.y - v.y == 0 && v.z - v.z == 0; };
  return finite(a.x) && finite(a.y) && finite(a.z) && finite(a.origin);
}

Quaternion quaternion(const Vec3& axis, float degrees) {
  double s, c;
  sin_cos_degrees(static_cast<double>(degrees) / 2, s, c);
  const Vec3d n = normalize(to_double(axis));
  return rounded({n.x * s, n.y * s, n.z * s, c});
}

// After Shepperd, "Quaternion from rotation matrix", 1978: the largest component by a root, the others by
// division, so that none is lost to cancellation.
Quaternion quaternion_of_frame(const Vec3& x, const Vec3& y, const Vec3& z) {
  const Vec3d a = to_double(x), b = to_double(y), c = to_double(z);
  const double trace = (a.x + b.y) + c.z;
  if (trace >= a.x && trace >= b.y && trace >= c.z)
    return rounded({b.z - c.y, c.x - a.z, a.y - b.x, 1 + trace});
  if (a.x >= b.y && a.x >= c.z) return rounded({1 + a.x - b.y - c.z, a.y + b.x, a.z + c.x, b.z - c.y});
  if (b.y >= c.z) return rounded({a.y + b.x, 1 + b.y - a.x - c.z, b.z + c.y, c.x - a.z});
  return rounded({a.z + c.x, b.z + c.y, 1 + c.z - a.x - b.y, a.y - b.x});
}

Vec3 rotate(const Quaternion& q, const Vec3& v) {
  const Vec3d u{q.x, q.y, q.z}, d = to_double(v);
  const Vec3d t = cross(u, d) * 2.0;
  return to_float(d + t * static_cast<double>(q.w) + cross(u, t));
}

Affine rotation(const Vec3& axis, float degrees) {
  return affine_of({0, {0, 0, 0}, quaternion(axis, degrees)});
}

Affine affine_of(const RigidKey& pose) {
  const Quaternion& q = pose.rotation;
  return {rotate(q, {1, 0, 0}), rotate(q, {0, 1, 0}), rotate(q, {0, 0, 1}), pose.translation};
}

RigidKey pose_at(const std::vector<RigidKey>& keys, float time) {
  if (!(time > keys.front().time)) return keys.front();
  for (size_t i = 1; i < keys.size(); ++i) {
    const RigidKey &a = keys[i - 1], &b = keys[i];
    if (!(time < b.time)) continue;
    const double t = (static_cast<double>(time) - static_cast<double>(a.time)) /
                     (static_cast<double>(b.time) - static_cast<double>(a.time));
    const Vec3d way = to_double(b.translation) - to_double(a.translation);
    return {time, to_float(to_double(a.translation) + way * t), slerp(a.rotation, b.rotation, t)};
  }
  return keys.back();
}

}  // namespace vitral
