// The lights of a project.
#include "io/project_reading.h"
#include "io/text.h"

namespace vitral {
namespace {

using Kind = Light::Kind;

// The children of a light that were there, and those that have to wait for others.
struct LightParts {
  bool direction = false, position = false;
  const XmlElement *size = nullptr, *radius = nullptr, *diameter = nullptr, *cone = nullptr, *side = nullptr;
};

// What a kind of light must have.
struct KindRow {
  const char* name;
  Kind kind;
  bool direction, position, size, radius;
};
constexpr KindRow kKinds[] = {
    {"directional", Kind::directional, true, false, false, false},
    {"point", Kind::point, false, true, false, false},
    {"spot", Kind::spot, true, true, false, false},
    {"rectangle", Kind::rectangle, true, true, true, false},
    {"sphere", Kind::sphere, false, true, false, true},
    {"sun", Kind::sun, true, false, false, false},
};

// As its type says or, without a type, directional or point by what it has: direction or position.
const KindRow& kind_of(const Source& source, const XmlElement& element, const LightParts& parts) {
  const std::string type = attribute_or(element, "type", parts.direction ? "directional" : "point");
  for (const KindRow& row : kKinds) {
    if (!same_name(type, row.name)) continue;
    if (!parts.position && !parts.direction && !find_attribute(element, "type"))
      fail(source, element, "this light has neither direction nor position");
    const auto must_have = [&](bool wanted, bool there, const char* what) {
      if (wanted && !there) fail(source, element, std::string("this light has no ") + what);
    };
    must_have(row.direction, parts.direction, "direction");
    must_have(row.position, parts.position, "position");
    must_have(row.size, parts.size, "size");
    must_have(row.radius, parts.radius, "radius");
    return row;
  }
  fail(source, element,
       "type=" + named(type) + " is not one of directional, point, spot, rectangle, sphere, sun");
}

// The sides of a rectangle: its width runs along <side>, made perpendicular to the direction; by itself,
// horizontally, and along x where the light shines straight up or down.
void set_sides(const Source& source, const LightParts& parts, Light& light) {
  warn_unknown_attributes(source, *parts.size, {"width", "height"});
  const float width = number_attribute(source, *parts.size, "width", kDistances, 1);
  const float height = number_attribute(source, *parts.size, "height", kDistances, width);
  const Vec3d n = to_double(light.direction);
  Vec3d side = cross(n, Vec3d{0, 1, 0});
  if (!(length(side) > 1e-6)) side = {1, 0, 0};
  if (parts.side) side = to_double(vector_of(source, *parts.side, kCoordinates));
  const double along = length(side);
  side = side - n * dot(n, side);
  if (!(length(side) > 1e-6 * along))
    fail(source, *parts.side, "the side is zero or runs along the direction");
  side = normalize(side);
  light.side_u = to_float(side * static_cast<double>(width));
  light.side_v = to_float(normalize(cross(side, n)) * static_cast<double>(height));
}

void set_cone(const Source& source, const XmlElement& cone, Light& light) {
  warn_unknown_attributes(source, cone, {"inner", "outer"});
  light.outer_degrees = number_attribute(source, cone, "outer", kConeDegrees, light.outer_degrees);
  const float inner = least(light.inner_degrees, light.outer_degrees);
  light.inner_degrees = number_attribute(source, cone, "inner", kConeDegrees, inner);
  if (light.inner_degrees > light.outer_degrees)
    fail(source, cone, "the inner cone is wider than the outer one");
}

// Reads what this kind of light has and warns of what only others have.
void set_size(const Source& source, const XmlElement& element, const LightParts& parts, Light& light) {
  const auto part = [&](const XmlElement* child, Kind kind, auto read) {
    if (!child) return;
    if (light.kind == kind)
      read(*child);
    else
      warn(source, child->line, "this kind of light has no <" + printable(child->name) + ">");
  };
  part(parts.size, Kind::rectangle, [&](const XmlElement&) { set_sides(source, parts, light); });
  part(parts.side, Kind::rectangle, [](const XmlElement&) {});
  part(parts.radius, Kind::sphere,
       [&](const XmlElement& child) { light.radius = number_of(source, child, kDistances); });
  part(parts.diameter, Kind::sun,
       [&](const XmlElement& child) { light.diameter_degrees = number_of(source, child, kDiskDegrees); });
  part(parts.cone, Kind::spot, [&](const XmlElement& child) { set_cone(source, child, light); });
  if (find_attribute(element, "samples") && !has_size(light))
    warn(source, element.line, "a light without a size needs no samples");
}

// True when the element was one of those whose meaning depends on others.
bool read_part(const XmlElement& child, LightParts& parts) {
  const std::pair<const char*, const XmlElement**> places[] = {{"size", &parts.size},
                                                               {"radius", &parts.radius},
                                                               {"diameter", &parts.diameter},
                                                               {"cone", &parts.cone},
                                                               {"side", &parts.side}};
  for (const auto& [name, place] : places) {
    if (!same_name(child.name, name)) continue;
    *place = &child;
    return true;
  }
  return false;
}

}  // namespace

void read_light(Reading& reading, const XmlElement& element) {
  const Source& source = reading.source;
  warn_unknown_attributes(source, element, {"name", "type", "samples"});
  reading.lights.push_back(attribute_or(element, "name", ""));
  Light light;
  LightParts parts;
  for (const XmlElement& child : element.children) {
    if (same_name(child.name, "direction")) {
      const Vec3 direction = vector_of(source, child, kCoordinates);
      if (!(length(direction) > 0)) fail(source, child, "the direction is zero");
      light.direction = normalize(direction);
      parts.direction = true;
    } else if (same_name(child.name, "position")) {
      light.position = vector_of(source, child, kCoordinates);
      parts.position = true;
    } else if (same_name(child.name, "color")) {
      light.color = color_of(source, child, kRadiances);
    } else if (same_name(child.name, "ambient")) {
      if (!reading.has_ambient) reading.project.scene.ambient = {0, 0, 0};
      reading.has_ambient = true;
      reading.project.scene.ambient += color_of(source, child, kRadiances);
    } else if (!read_part(child, parts)) {
      warn_unknown_child(source, element, child);
    }
  }
  light.kind = kind_of(source, element, parts).kind;
  light.samples = static_cast<int>(
      integer_attribute(source, element, "samples", 1, kMostLightSamples, has_size(light) ? 16 : 1));
  set_size(source, element, parts, light);
  reading.project.scene.lights.push_back(light);
}

}  // namespace vitral
