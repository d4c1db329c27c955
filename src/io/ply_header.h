// The header of a PLY file: what the body consists of.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace vitral {

enum class PlyFormat { ascii, little_endian, big_endian };
enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  bool is_list = false;
  PlyType count_type = PlyType::uint8;  // of a list
};

struct PlyElement {
  std::string name;
  uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  size_t body = 0;       // where it begins
  size_t body_line = 1;  // the number of its first line
};

size_t byte_size(PlyType type);

// Throws InputError unless the file begins as a PLY file does; four bytes are enough to tell.
void check_ply_magic(std::string_view bytes, const std::string& path);

// Reads the header of `bytes`, the whole file. Throws InputError, also when the elements promised
// could not fit into the file: every row takes at least its numbers, every list its count.
PlyHeader read_ply_header(std::string_view bytes, const std::string& path);

}  // namespace vitral
