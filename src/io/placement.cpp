#include "io/placement.h"

#include "io/text.h"

#include <algorithm>
#include <cmath>

namespace vitral {
namespace {

constexpr Range kScales{-1e6f, 1e6f};
constexpr Range kDegrees{-1e6f, 1e6f};
constexpr size_t kMostKeys = 1000;

Affine scaling(const Vec3& s) {
  return {{s.x, 0, 0}, {0, s.y, 0}, {0, 0, s.z}, {0, 0, 0}};
}

// Attribute `name` as a vector.
Vec3 axis_of(const Source& source, const XmlElement& element) {
  const std::string* text = find_attribute(element, "axis");
  if (!text) return {0, 1, 0};
  const std::optional<Vec3> axis = parse_vector(*text, kCoordinates);
  if (!axis) fail(source, element, "axis=\"" + printable(*text) + "\" is not three numbers");
  if (!(length(to_double(*axis)) > 0)) fail(source, element, "the axis is zero");
  return *axis;
}

struct Turn {
  Vec3 axis;
  float degrees;
};
Turn turn_of(const Source& source, const XmlElement& element) {
  warn_unknown_attributes(source, element, {"axis", "degrees"});
  if (!find_attribute(element, "degrees")) fail(source, element, "<rotate> needs degrees");
  return {axis_of(source, element), number_attribute(source, element, "degrees", kDegrees, 0)};
}

Vec3 scale_of(const Source& source, const XmlElement& element) {
  for (const char* name : {"x", "y", "z"}) {
    if (find_attribute(element, name)) return vector_of(source, element, kScales);
  }
  warn_unknown_attributes(source, element, {"value"});
  const std::string* value = find_attribute(element, "value");
  const std::string& text = value ? *value : element.text;
  if (const std::optional<Vec3> scale = parse_color(text, kScales)) return *scale;
  fail(source, element, "<scale> is '" + printable(text) + "', not one or three numbers");
}

// Three rows of four numbers.
Affine matrix_of(const Source& source, const XmlElement& element) {
  warn_unknown_attributes(source, element, {"value"});
  const std::string* value = find_attribute(element, "value");
  const std::string& text = value ? *value : element.text;
  std::vector<float> numbers;
  for (size_t at = 0; numbers.size() <= 12;) {
    at = text.find_first_not_of(" \t\r\n,", at);
    if (at == std::string::npos) break;
    const size_t end = std::min(text.find_first_of(" \t\r\n,", at), text.size());
    const std::optional<float> number =
        parse_number(std::string_view(text).substr(at, end - at), kCoordinates);
    if (!number)
      fail(source, element, "<matrix> holds " + quoted(text.substr(at, end - at)) + ", not a number");
    numbers.push_back(*number);
    at = end;
  }
  if (numbers.size() != 12) fail(source, element, "<matrix> needs 12 numbers, three rows of four");
  const auto& n = numbers;
  return {{n[0], n[4], n[8]}, {n[1], n[5], n[9]}, {n[2], n[6], n[10]}, {n[3], n[7], n[11]}};
}

// a after b.
Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
          a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}

RigidKey read_key(const Source& source, const XmlElement& element) {
  warn_unknown_attributes(source, element, {"time"});
  RigidKey key;
  key.time = number_attribute(source, element, "time", kCoordinates, 0);
  for (const XmlElement& child : element.children) {
    if (same_name(child.name, "translate")) {
      key.translation += vector_of(source, child, kCoordinates);
    } else if (same_name(child.name, "rotate")) {
      const Turn turn = turn_of(source, child);
      const Quaternion q = quaternion(turn.axis, turn.degrees);
      key.translation = rotate(q, key.translation);
      key.rotation = product(q, key.rotation);
    } else {
      warn_unknown_child(source, element, child);
    }
  }
  return key;
}

}  // namespace

bool apply_transform(const Source& source, const XmlElement& element, Affine& map) {
  if (same_name(element.name, "translate")) {
    Affine by;
    by.origin = vector_of(source, element, kCoordinates);
    map = by * map;
  } else if (same_name(element.name, "rotate")) {
    const Turn turn = turn_of(source, element);
    map = rotation(turn.axis, turn.degrees) * map;
  } else if (same_name(element.name, "scale")) {
    map = scaling(scale_of(source, element)) * map;
  } else if (same_name(element.name, "matrix")) {
    map = matrix_of(source, element) * map;
  } else {
    return false;
  }
  return true;
}

std::vector<RigidKey> read_motion(const Source& source, const XmlElement& element) {
  warn_unknown_attributes(source, element, {});
  std::vector<RigidKey> keys;
  for (const XmlElement& child : element.children) {
    if (!same_name(child.name, "key")) {
      warn_unknown_child(source, element, child);
      continue;
    }
    if (keys.size() == kMostKeys) fail(source, child, "more than " + std::to_string(kMostKeys) + " of <key>");
    keys.push_back(read_key(source, child));
    if (keys.size() > 1 && !(keys[keys.size() - 2].time < keys.back().time))
      fail(source, child, "the time of this key is not after the one before");
  }
  if (keys.empty()) fail(source, element, "<motion> has no <key>");
  return keys;
}

// Within these, rays in the object's space are ones that can be traced.
bool can_be_undone(const Affine& placement) {
  constexpr float kMostGrowth = 1e9f, kFarthest = 1e17f;
  const auto largest = [](const Vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); };
  const auto within = [&](const Affine& a) {
    return is_finite(a) && largest(a.x) <= kMostGrowth && largest(a.y) <= kMostGrowth &&
           largest(a.z) <= kMostGrowth && largest(a.origin) <= kFarthest;
  };
  return within(placement) && within(inverse(placement));
}

void check_placement(const Source& source, const XmlElement& element, const Affine& placement) {
  if (!can_be_undone(placement))
    fail(source, element, "this placement has no inverse: it flattens what it places");
}

// The rotation about y x n that brings y to n; without a shortest way, about x.
Affine upright_along(const Vec3& direction) {
  const Vec3d n = normalize(to_double(direction));
  const double aside = n.x * n.x + n.z * n.z;
  if (n.y < 0 && !(aside > 1e-30)) return {{1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {0, 0, 0}};
  const double over = n.y < 0 ? (1 - n.y) / aside : 1 / (1 + n.y);  // the same; no digits are lost
  const Vec3d x{1 - n.x * n.x * over, -n.x, -n.x * n.z * over};
  const Vec3d z{-n.x * n.z * over, -n.z, 1 - n.z * n.z * over};
  return {to_float(x), to_float(n), to_float(z), {0, 0, 0}};
}

}  // namespace vitral
