// Writes JSON: keys in the order given, two spaces of indentation, numbers in the shortest form that
// reads back the same. Bytes of strings pass as they are, except for what JSON must escape.
#pragma once
#include "vitral/vec.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace vitral {

// Knows where commas go. Each begin needs its end.
class JsonWriter {
 public:
  JsonWriter& begin_object(std::string_view key = {}) { return open(key, '{'); }
  JsonWriter& end_object() { return close('}'); }
  JsonWriter& begin_array(std::string_view key = {}) { return open(key, '['); }
  JsonWriter& end_array() { return close(']'); }

  JsonWriter& add(std::string_view key, std::string_view value);
  JsonWriter& add(std::string_view key, const char* value) { return add(key, std::string_view(value)); }
  JsonWriter& add(std::string_view key, double value);
  JsonWriter& add(std::string_view key, float value);
  JsonWriter& add(std::string_view key, uint64_t value);
  JsonWriter& add(std::string_view key, int value);
  JsonWriter& add(std::string_view key, bool value);
  JsonWriter& add(std::string_view key, const Vec3& value);

  std::string text() const { return text_ + "\n"; }

 private:
  JsonWriter& open(std::string_view key, char bracket);
  JsonWriter& close(char bracket);
  JsonWriter& raw(std::string_view key, std::string_view value);
  void next(std::string_view key);

  std::string text_;
  int depth_ = 0;
  bool first_ = true;
};

}  // namespace vitral
