// Affine maps and rigid motions as a project writes them.
#pragma once
#include "io/element.h"
#include "vitral/affine.h"

#include <vector>

namespace vitral {

// Whether the element is one of translate, rotate, scale, matrix; then `map` goes before it.
bool apply_transform(const Source& source, const XmlElement& element, Affine& map);

// The keys of a <motion>.
std::vector<RigidKey> read_motion(const Source& source, const XmlElement& element);

// Throws InputError where a placement cannot be undone, or only by numbers that are out of all proportion.
void check_placement(const Source& source, const XmlElement& element, const Affine& placement);

// Whether it can.
bool can_be_undone(const Affine& placement);

// Turns +y into `direction`, which is not zero, the shortest way.
Affine upright_along(const Vec3& direction);

}  // namespace vitral
