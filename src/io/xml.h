// A reader for the part of XML that project files use: elements, attributes quoted or bare, text,
// comments, the five named entities. Document types and the entities they could define are refused,
// so nothing outside the file is ever read and nothing expands.
#pragma once
#include "vitral/error.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace vitral {

struct XmlAttribute {
  std::string name, value;  // entities resolved
};

struct XmlElement {
  std::string name;
  size_t line = 0;   // of its `<`, from 1
  std::string text;  // of the element itself, without its children's; entities resolved, ends trimmed
  std::vector<XmlAttribute> attributes;
  std::vector<XmlElement> children;
};

// What a file may hold. A file that exceeds one is refused.
inline constexpr size_t kMaxXmlBytes = size_t{16} << 20;
inline constexpr size_t kMaxXmlDepth = 64;
inline constexpr size_t kMaxXmlNodes = 100000;   // elements and attributes together
inline constexpr size_t kMaxXmlAttributes = 64;  // of one element

// Returns the root element. `file` names the text in errors. Throws InputError with file:line.
XmlElement parse_xml(std::string_view text, const std::string& file);

// Reads the file whole, within the bounds above, and parses it. Throws InputError.
XmlElement read_xml(const std::string& path);

}  // namespace vitral
