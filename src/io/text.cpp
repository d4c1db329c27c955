#include "io/text.h"

#include <charconv>
#include <limits>
#include <system_error>

namespace vitral {

std::string read_rest(Cursor& c) {
  std::string text;
  for (;;) {
    if (const int n = continuation(c)) {
      text += ' ';
      c.p += n;
      ++c.line;
    } else if (is_newline(*c.p)) {
      break;
    } else {
      text += *c.p++;
    }
  }
  const size_t first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

bool read_float_slow(Cursor& c, float& value) {
  const bool plus = *c.p == '+';
  const char* const first = c.p + (plus ? 1 : 0);
  if (plus && *first == '-') return false;
  const auto [last, error] = std::from_chars(first, c.end, value);
  if (error == std::errc::invalid_argument) return false;

  // A magnitude outside the range is too large, unless its exponent is negative or its digits say so.
  if (error == std::errc::result_out_of_range) {
    double wide = 0;
    const auto parsed = std::from_chars(first, c.end, wide);
    const bool tiny = parsed.ec == std::errc()
                          ? (wide > -1 && wide < 1)
                          : std::string_view(first, last).find("e-") != std::string_view::npos ||
                                std::string_view(first, last).find("E-") != std::string_view::npos;
    value = tiny ? 0.0f : std::numeric_limits<float>::infinity();
  }
  c.p = last;

  // Old Microsoft libraries print "1.#QNAN", "-1.#IND" or "1.#INF".
  if (*c.p == '#' && c.p[-1] == '.') {
    value = std::numeric_limits<float>::quiet_NaN();
    read_word(c);
  }
  return true;
}

std::string printable(std::string_view text) {
  std::string shown;
  for (const char c : text.substr(0, 40)) shown += static_cast<unsigned char>(c) < 32 || c == 127 ? '?' : c;
  return text.size() > 40 ? shown + "..." : shown;
}

std::string quoted(std::string_view text) {
  std::string shown = "'";
  shown += printable(text);
  shown += '\'';
  return shown;
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return lower;
}

}  // namespace vitral
