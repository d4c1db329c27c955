// Reads JSON strictly, for tests of what the program prints.
#pragma once
#include <algorithm>
#include <charconv>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace vitral::test {

struct Json {
  enum class Kind { object, array, string, number, boolean, null };
  Kind kind = Kind::null;
  std::vector<std::string> keys;  // of an object, in the order of the text
  std::vector<Json> items;        // of an array, or what belongs to the keys
  std::string text;
  double number = 0;

  // Throws when there is no such member, or more than one.
  const Json& operator[](std::string_view key) const {
    if (std::count(keys.begin(), keys.end(), key) != 1)
      throw std::runtime_error("not one member " + std::string(key));
    return items[static_cast<size_t>(std::find(keys.begin(), keys.end(), key) - keys.begin())];
  }
};

// A recursive descent over the grammar of RFC 8259; escapes other than \" and \\ stay as they are written.
class JsonReader {
 public:
  static Json read(std::string_view text) {
    JsonReader reader(text);
    Json value = reader.value();
    reader.skip_blanks();
    if (!reader.text_.empty()) reader.complain("something follows");
    return value;
  }

 private:
  explicit JsonReader(std::string_view text) : text_(text) {}

  [[noreturn]] void complain(const char* what) const {
    throw std::runtime_error(std::string("not JSON: ") + what + " at '" + std::string(text_.substr(0, 30)) +
                             "'");
  }
  void skip_blanks() { text_.remove_prefix(std::min(text_.find_first_not_of(" \n\r\t"), text_.size())); }
  bool take(std::string_view token) {
    skip_blanks();
    if (!text_.starts_with(token)) return false;
    text_.remove_prefix(token.size());
    return true;
  }
  void expect(std::string_view token) {
    if (!take(token)) complain(std::string(token).c_str());
  }

  std::string string() {
    expect("\"");
    std::string out;
    for (;;) {
      if (text_.empty()) complain("a string without an end");
      char c = text_.front();
      text_.remove_prefix(1);
      if (c == '"') return out;
      if (static_cast<unsigned char>(c) < 0x20) complain("a control character");
      if (c == '\\' && (text_.starts_with('"') || text_.starts_with('\\'))) {
        c = text_.front();
        text_.remove_prefix(1);
      }
      out += c;
    }
  }

  Json number() {
    Json out{Json::Kind::number, {}, {}, {}, 0};
    const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), out.number);
    if (error != std::errc{}) complain("a number");
    out.text = std::string(text_.data(), end);
    text_.remove_prefix(out.text.size());
    return out;
  }

  Json value() {
    Json out;
    if (take("{")) {
      out.kind = Json::Kind::object;
      if (take("}")) return out;
      do {
        out.keys.push_back(string());
        expect(":");
        out.items.push_back(value());
      } while (take(","));
      expect("}");
    } else if (take("[")) {
      out.kind = Json::Kind::array;
      if (take("]")) return out;
      do out.items.push_back(value());
      while (take(","));
      expect("]");
    } else if (text_.starts_with('"')) {
      out.kind = Json::Kind::string;
      out.text = string();
    } else if (take("true") || take("false")) {
      out.kind = Json::Kind::boolean;
    } else if (!take("null")) {
      return number();
    }
    return out;
  }

  std::string_view text_;
};

}  // namespace vitral::test
