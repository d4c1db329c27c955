// Typed access to an XML element: what is missing, malformed or out of range is an error with
// file:line, what is unknown is a warning.
#pragma once
#include "io/values.h"
#include "io/xml.h"

#include <initializer_list>
#include <string>
#include <string_view>

namespace vitral {

// Where an element comes from and where its warnings go.
struct Source {
  const std::string& file;
  Warnings& warnings;
};

[[noreturn]] void fail(const Source& source, const XmlElement& element, const std::string& reason);

// At most a few warnings are kept of one file.
void warn(const Source& source, size_t line, const std::string& reason);
void warn_unknown_child(const Source& source, const XmlElement& parent, const XmlElement& child);
void warn_unknown_attributes(const Source& source, const XmlElement& element,
                             std::initializer_list<std::string_view> known);

// Without regard to case (of ASCII letters).
bool same_name(std::string_view a, std::string_view b);

// Null when there is none.
const std::string* find_attribute(const XmlElement& element, std::string_view name);

// Attributes; the value given is returned unchanged when the attribute is not there.
float number_attribute(const Source&, const XmlElement&, std::string_view name, Range range, float otherwise);
long integer_attribute(const Source&, const XmlElement&, std::string_view name, long least, long most,
                       long otherwise);
bool flag_attribute(const Source&, const XmlElement&, std::string_view name);  // false when not there

// The value of a whole element, as the three forms of project.h have it.
Vec3 vector_of(const Source&, const XmlElement&, Range range);
Vec3 color_of(const Source&, const XmlElement&, Range range);

float number_of(const Source&, const XmlElement&, Range range);  // the attribute `value`, or the text

// What an element names: its attribute `name`, `file`, `filename`, `path` or `value`, or its text.
std::string name_of(const Source&, const XmlElement&);

}  // namespace vitral
