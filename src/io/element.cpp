#include "io/element.h"

#include "io/text.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace vitral {
namespace {

constexpr size_t kMostWarnings = 20;

// Three attributes of the given names, or the attribute `value`, or the text, as one line of numbers.
std::string numbers_of(const Source& source, const XmlElement& element,
                       const std::array<std::string_view, 3>& components) {
  std::string numbers;
  size_t found = 0;
  for (const std::string_view component : components) {
    if (const std::string* value = find_attribute(element, component)) {
      numbers += (found++ ? " " : "") + *value;
    }
  }
  if (found == 0) {
    warn_unknown_attributes(source, element, {"value"});
    const std::string* value = find_attribute(element, "value");
    return value ? *value : element.text;
  }
  if (found != components.size())
    fail(source, element, "<" + printable(element.name) + "> needs three components");
  warn_unknown_attributes(source, element, {components[0], components[1], components[2]});
  return numbers;
}

}  // namespace

void fail(const Source& source, const XmlElement& element, const std::string& reason) {
  fail(source.file, element.line, reason);
}

void warn(const Source& source, size_t line, const std::string& reason) {
  const std::string prefix = source.file + ":";
  const auto ours = std::count_if(source.warnings.begin(), source.warnings.end(),
                                  [&](const std::string& warning) { return warning.starts_with(prefix); });
  if (static_cast<size_t>(ours) < kMostWarnings) {
    source.warnings.push_back(prefix + std::to_string(line) + ": " + reason);
  } else if (static_cast<size_t>(ours) == kMostWarnings) {
    source.warnings.push_back(prefix + std::to_string(line) + ": more like this is not reported");
  }
}

void warn_unknown_child(const Source& source, const XmlElement& parent, const XmlElement& child) {
  warn(source, child.line,
       "unknown element <" + printable(child.name) + "> in <" + printable(parent.name) + ">");
}

void warn_unknown_attributes(const Source& source, const XmlElement& element,
                             std::initializer_list<std::string_view> known) {
  for (const XmlAttribute& attribute : element.attributes) {
    const bool is_known = std::any_of(known.begin(), known.end(),
                                      [&](std::string_view name) { return same_name(name, attribute.name); });
    if (!is_known) {
      warn(source, element.line,
           "unknown attribute '" + printable(attribute.name) + "' of <" + printable(element.name) + ">");
    }
  }
}

bool same_name(std::string_view a, std::string_view b) {
  return lower_case(a) == lower_case(b);
}

const std::string* find_attribute(const XmlElement& element, std::string_view name) {
  for (const XmlAttribute& attribute : element.attributes) {
    if (same_name(attribute.name, name)) return &attribute.value;
  }
  return nullptr;
}

float number_attribute(const Source& source, const XmlElement& element, std::string_view name, Range range,
                       float otherwise) {
  const std::string* text = find_attribute(element, name);
  if (!text) return otherwise;
  if (const std::optional<float> number = parse_number(*text, range)) return *number;
  fail(source, element,
       std::string(name) + "=\"" + printable(*text) + "\" is not a number " + in_words(range));
}

long integer_attribute(const Source& source, const XmlElement& element, std::string_view name, long least,
                       long most, long otherwise) {
  const std::string* text = find_attribute(element, name);
  if (!text) return otherwise;
  if (const std::optional<long> number = parse_integer(*text, least, most)) return *number;
  fail(source, element,
       std::string(name) + "=\"" + printable(*text) + "\" is not a whole number from " +
           std::to_string(least) + " to " + std::to_string(most));
}

bool flag_attribute(const Source& source, const XmlElement& element, std::string_view name) {
  const std::string* text = find_attribute(element, name);
  if (!text) return false;
  for (const std::string_view yes : {"true", "yes", "1"}) {
    if (same_name(*text, yes)) return true;
  }
  for (const std::string_view no : {"false", "no", "0"}) {
    if (same_name(*text, no)) return false;
  }
  fail(source, element, std::string(name) + "=\"" + printable(*text) + "\" is neither true nor false");
}

Vec3 vector_of(const Source& source, const XmlElement& element, Range range) {
  const std::string numbers = numbers_of(source, element, {"x", "y", "z"});
  if (const std::optional<Vec3> vector = parse_vector(numbers, range)) return *vector;
  fail(source, element,
       "<" + printable(element.name) + "> is '" + printable(numbers) + "', not three numbers " +
           in_words(range));
}

Vec3 color_of(const Source& source, const XmlElement& element, Range range) {
  const std::string numbers = numbers_of(source, element, {"r", "g", "b"});
  if (const std::optional<Vec3> color = parse_color(numbers, range)) return *color;
  fail(source, element,
       "<" + printable(element.name) + "> is '" + printable(numbers) + "', not one or three numbers " +
           in_words(range));
}

float number_of(const Source& source, const XmlElement& element, Range range) {
  warn_unknown_attributes(source, element, {"value"});
  const std::string* value = find_attribute(element, "value");
  const std::string& text = value ? *value : element.text;
  if (const std::optional<float> number = parse_number(text, range)) return *number;
  fail(source, element,
       "<" + printable(element.name) + "> is '" + printable(text) + "', not a number " + in_words(range));
}

std::string name_of(const Source& source, const XmlElement& element) {
  warn_unknown_attributes(source, element, {"name", "file", "filename", "path", "value"});
  for (const std::string_view attribute : {"name", "file", "filename", "path", "value"}) {
    const std::string* value = find_attribute(element, attribute);
    if (value && !value->empty()) return *value;
  }
  if (element.text.empty()) fail(source, element, "<" + printable(element.name) + "> names nothing");
  return element.text;
}

}  // namespace vitral
