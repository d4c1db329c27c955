// The cameras of a project, with their lenses and the way they move.
#include "io/project_reading.h"
#include "io/text.h"

#include <algorithm>

namespace vitral {
namespace {

// True when the element was one of the vectors that say where a camera is and looks.
template <class Placed>
bool read_place(const Source& source, const XmlElement& element, Placed& camera) {
  if (same_name(element.name, "position")) {
    camera.position = vector_of(source, element, kCoordinates);
  } else if (same_name(element.name, "view")) {
    camera.view = vector_of(source, element, kCoordinates);
  } else if (same_name(element.name, "up")) {
    camera.up = vector_of(source, element, kCoordinates);
  } else {
    return false;
  }
  return true;
}

// Keys in order of time. What a key does not say is as in the one before, or as the camera stands.
void read_motion(const Reading& reading, const XmlElement& element, Camera& camera) {
  const Source& source = reading.source;
  warn_unknown_attributes(source, element, {});
  CameraKey key{0, camera.position, camera.view, camera.up};
  each(reading, element, "key", [&](const XmlElement& e) {
    warn_unknown_attributes(source, e, {"time"});
    if (!find_attribute(e, "time")) fail(source, e, "this key has no time");
    key.time = number_attribute(source, e, "time", kTimes, 0);
    if (!camera.motion.empty() && !(key.time > camera.motion.back().time))
      fail(source, e, "this key is not later than the one before");
    for (const XmlElement& child : e.children) {
      if (!read_place(source, child, key)) warn_unknown_child(source, e, child);
    }
    Camera there = camera;
    there.position = key.position, there.view = key.view, there.up = key.up;
    const std::string fault = camera_fault(there);
    if (!fault.empty()) fail(source, e, fault);
    camera.motion.push_back(key);
  });
}

// The parts of a camera that are not where it is. True when the element was one of them.
bool read_optics(const Source& source, const XmlElement& element, Camera& camera) {
  if (same_name(element.name, "perspective") || same_name(element.name, "projection")) {
    warn_unknown_attributes(source, element, {"type", "fov", "near", "far"});
    camera.fov = number_attribute(source, element, "fov", kFovDegrees, camera.fov);
    camera.near = number_attribute(source, element, "near", kDistances, camera.near);
    camera.far = number_attribute(source, element, "far", kDistances, camera.far);
  } else if (same_name(element.name, "lens")) {
    warn_unknown_attributes(source, element, {"aperture", "focus"});
    camera.aperture = number_attribute(source, element, "aperture", kApertures, camera.aperture);
    camera.focus = number_attribute(source, element, "focus", kDistances, camera.focus);
  } else if (same_name(element.name, "shutter")) {
    warn_unknown_attributes(source, element, {"open", "close"});
    camera.shutter_open = number_attribute(source, element, "open", kTimes, camera.shutter_open);
    camera.shutter_close = number_attribute(source, element, "close", kTimes, camera.shutter_open);
    if (!(camera.shutter_open <= camera.shutter_close))
      fail(source, element, "the shutter closes before it opens");
  } else {
    return same_name(element.name, "viewport");
  }
  return true;
}

}  // namespace

void read_camera(Reading& reading, const XmlElement& element) {
  const Source& source = reading.source;
  warn_unknown_attributes(source, element, {"name", "type"});
  Camera camera;
  camera.name = attribute_or(element, "name", "");
  if (camera.name.empty()) fail(source, element, "this camera has no name");
  if (has_camera(reading.project, camera.name)) {
    fail(source, element, "there is another camera " + named(camera.name));
  }
  for (const XmlElement& child : element.children) {
    if (read_place(source, child, camera) || read_optics(source, child, camera)) continue;
    if (!same_name(child.name, "motion")) warn_unknown_child(source, element, child);
  }
  const std::string fault = camera_fault(camera);
  if (!fault.empty()) fail(source, element, "camera " + named(camera.name) + ": " + fault);
  // Keys start from where the camera stands, wherever in the element that is said.
  for (const XmlElement& child : element.children) {
    if (same_name(child.name, "motion")) read_motion(reading, child, camera);
  }
  reading.project.scene.cameras.push_back(camera);
}

}  // namespace vitral
