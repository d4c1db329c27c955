#include "io/ply_header.h"

#include "vitral/error.h"

#include "io/text.h"

#include <array>
#include <charconv>
#include <utility>

namespace vitral {
namespace {

constexpr size_t kMaxHeaderLines = 10000;

constexpr std::array<std::pair<std::string_view, PlyType>, 16> kTypes = {{{"char", PlyType::int8},
                                                                          {"int8", PlyType::int8},
                                                                          {"uchar", PlyType::uint8},
                                                                          {"uint8", PlyType::uint8},
                                                                          {"short", PlyType::int16},
                                                                          {"int16", PlyType::int16},
                                                                          {"ushort", PlyType::uint16},
                                                                          {"uint16", PlyType::uint16},
                                                                          {"int", PlyType::int32},
                                                                          {"int32", PlyType::int32},
                                                                          {"uint", PlyType::uint32},
                                                                          {"uint32", PlyType::uint32},
                                                                          {"float", PlyType::float32},
                                                                          {"float32", PlyType::float32},
                                                                          {"double", PlyType::float64},
                                                                          {"float64", PlyType::float64}}};

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (size_t at = line.find_first_not_of(" \t"); at < line.size();) {
    const size_t end = std::min(line.find_first_of(" \t", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = std::min(line.find_first_not_of(" \t", end), line.size());
  }
  return words;
}

class HeaderReader {
 public:
  HeaderReader(std::string_view bytes, const std::string& path) : bytes_(bytes), path_(path) {}

  PlyHeader read() {
    check_ply_magic(bytes_, path_);
    next_line();
    while (read_statement(words_of(next_line()))) {
    }
    if (!format_known_) fail(path_, "the header names no format");
    header_.body = at_;
    header_.body_line = line_;
    check_sizes();
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail_here(const std::string& reason) const { fail(path_, line_ - 1, reason); }

  std::string_view next_line() {
    const size_t end = bytes_.find_first_of("\r\n", at_);
    if (end == std::string_view::npos || line_ > kMaxHeaderLines) fail(path_, line_, "the header has no end");
    const std::string_view line = bytes_.substr(at_, end - at_);
    at_ = end + (bytes_.substr(end, 2) == "\r\n" ? 2 : 1);
    ++line_;
    return line;
  }

  // False at the end of the header.
  bool read_statement(const std::vector<std::string_view>& words) {
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") return true;
    if (words[0] == "end_header") return false;
    if (words[0] == "format" && words.size() >= 2) {
      read_format(words[1]);
    } else if (words[0] == "element" && words.size() == 3) {
      PlyElement element;
      element.name = words[1];
      const char* const end = words[2].data() + words[2].size();
      const auto [last, error] = std::from_chars(words[2].data(), end, element.count);
      if (error != std::errc() || last != end) fail_here(quoted(words[2]) + " is not a count");
      header_.elements.push_back(element);
    } else if (words[0] == "property" && (words.size() == 3 || (words.size() == 5 && words[1] == "list"))) {
      if (header_.elements.empty()) fail_here("a property without an element");
      PlyProperty property;
      property.name = words.back();
      property.is_list = words.size() == 5;
      property.type = read_type(words[words.size() - 2]);
      if (property.is_list) property.count_type = read_type(words[2]);
      if (property.is_list &&
          (property.count_type == PlyType::float32 || property.count_type == PlyType::float64)) {
        fail_here("the length of a list must be an integer");
      }
      header_.elements.back().properties.push_back(property);
    } else {
      fail_here(quoted(words[0]) + " is not a statement of a PLY header");
    }
    return true;
  }

  void read_format(std::string_view name) {
    format_known_ = true;
    if (name == "ascii") {
      header_.format = PlyFormat::ascii;
    } else if (name == "binary_little_endian") {
      header_.format = PlyFormat::little_endian;
    } else if (name == "binary_big_endian") {
      header_.format = PlyFormat::big_endian;
    } else {
      fail_here(quoted(name) + " is not a PLY format");
    }
  }

  PlyType read_type(std::string_view name) const {
    for (const auto& [known, type] : kTypes) {
      if (known == name) return type;
    }
    fail_here(quoted(name) + " is not a PLY type");
  }

  void check_sizes() const {
    uint64_t left = bytes_.size() - header_.body + 1;  // the last newline may be missing
    for (const PlyElement& element : header_.elements) {
      uint64_t row = 0;
      for (const PlyProperty& p : element.properties) {
        row += header_.format == PlyFormat::ascii ? 2 : byte_size(p.is_list ? p.count_type : p.type);
      }
      if (row == 0) continue;
      if (element.count > left / row) {
        fail(path_, "the header promises " + std::to_string(element.count) + " of " + quoted(element.name) +
                        ", more than the file holds");
      }
      left -= element.count * row;
    }
  }

  std::string_view bytes_;
  const std::string& path_;
  size_t at_ = 0, line_ = 1;
  bool format_known_ = false;
  PlyHeader header_;
};

}  // namespace

size_t byte_size(PlyType type) {
  switch (type) {
    case PlyType::int8:
    case PlyType::uint8:
      return 1;
    case PlyType::int16:
    case PlyType::uint16:
      return 2;
    case PlyType::int32:
    case PlyType::uint32:
    case PlyType::float32:
      return 4;
    case PlyType::float64:
      return 8;
  }
  return 0;
}

void check_ply_magic(std::string_view bytes, const std::string& path) {
  if (bytes.empty()) fail(path, "the file is empty");
  if (bytes.substr(0, 3) != "ply" || bytes.size() < 4 || !is_newline(bytes[3])) {
    fail(path, "not a PLY file: it does not begin with 'ply'");
  }
}

PlyHeader read_ply_header(std::string_view bytes, const std::string& path) {
  return HeaderReader(bytes, path).read();
}

}  // namespace vitral
