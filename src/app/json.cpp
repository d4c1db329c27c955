#include "app/json.h"

#include <charconv>
#include <cmath>

namespace vitral {
namespace {

std::string quoted(std::string_view text) {
  constexpr char kHex[] = "0123456789abcdef";
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (byte < 0x20) {
      result += "\\u00";
      result += kHex[byte >> 4];
      result += kHex[byte & 15];
    } else {
      result += c;
    }
  }
  return result + '"';
}

// JSON has no infinities and no NaN.
template <class Number>
std::string shortest(Number value) {
  if (!std::isfinite(value)) return "null";
  char digits[64];
  return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

}  // namespace

void JsonWriter::next(std::string_view key) {
  if (!first_) text_ += ',';
  if (depth_ > 0) text_ += '\n' + std::string(static_cast<size_t>(depth_) * 2, ' ');
  first_ = false;
  if (!key.empty()) text_ += quoted(key) + ": ";
}

JsonWriter& JsonWriter::open(std::string_view key, char bracket) {
  next(key);
  text_ += bracket;
  ++depth_;
  first_ = true;
  return *this;
}

JsonWriter& JsonWriter::close(char bracket) {
  --depth_;
  if (!first_) text_ += '\n' + std::string(static_cast<size_t>(depth_) * 2, ' ');
  text_ += bracket;
  first_ = false;
  return *this;
}

JsonWriter& JsonWriter::raw(std::string_view key, std::string_view value) {
  next(key);
  text_ += value;
  return *this;
}

JsonWriter& JsonWriter::add(std::string_view key, std::string_view value) {
  return raw(key, quoted(value));
}
JsonWriter& JsonWriter::add(std::string_view key, double value) {
  return raw(key, shortest(value));
}
JsonWriter& JsonWriter::add(std::string_view key, float value) {
  return raw(key, shortest(value));
}
JsonWriter& JsonWriter::add(std::string_view key, uint64_t value) {
  return raw(key, std::to_string(value));
}
JsonWriter& JsonWriter::add(std::string_view key, int value) {
  return raw(key, std::to_string(value));
}
JsonWriter& JsonWriter::add(std::string_view key, bool value) {
  return raw(key, value ? "true" : "false");
}
JsonWriter& JsonWriter::add(std::string_view key, const Vec3& v) {
  return raw(key, "[" + shortest(v.x) + ", " + shortest(v.y) + ", " + shortest(v.z) + "]");
}

}  // namespace vitral
