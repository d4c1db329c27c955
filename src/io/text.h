// A cursor over text in memory. The buffer carries one byte more than the text, a line feed, at
// which every loop below stops: so no loop has to compare with the end.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace vitral {

struct Cursor {
  const char* p = nullptr;
  const char* end = nullptr;  // *end == '\n', past the text
  size_t line = 1;
};

static inline bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
static inline bool is_blank(char c) {
  return c == ' ' || c == '\t';
}

// Lines end with LF, CR LF or CR.
static inline bool is_newline(char c) {
  return c == '\n' || c == '\r';
}

// Bytes of a line continuation, a backslash and the newline after it; 0 where there is none.
static inline int continuation(const Cursor& c) {
  if (*c.p != '\\' || c.p + 1 >= c.end) return 0;
  if (c.p[1] == '\n') return 2;
  if (c.p[1] == '\r') return c.p + 2 < c.end && c.p[2] == '\n' ? 3 : 2;
  return 0;
}

static inline void skip_blanks(Cursor& c) {
  for (;;) {
    while (is_blank(*c.p)) ++c.p;
    const int n = continuation(c);
    if (n == 0) return;
    c.p += n;
    ++c.line;
  }
}

// Nothing but a comment is left of the line.
static inline bool at_line_end(const Cursor& c) {
  return is_newline(*c.p) || *c.p == '#';
}

// Goes to the start of the next line that is not a continuation of this one.
static inline void skip_line(Cursor& c) {
  for (;; ++c.p) {
    if (const int n = continuation(c)) {
      c.p += n - 1;
      ++c.line;
    } else if (is_newline(*c.p)) {
      break;
    }
  }
  if (c.p < c.end) c.p += *c.p == '\r' && c.p + 1 < c.end && c.p[1] == '\n' ? 2 : 1;
  ++c.line;
}

// The characters up to the next blank or line end.
static inline std::string_view read_word(Cursor& c) {
  const char* const first = c.p;
  while (!is_blank(*c.p) && !is_newline(*c.p) && continuation(c) == 0) ++c.p;
  return {first, static_cast<size_t>(c.p - first)};
}

// What is left of the line without blanks at both ends; continuations become one space.
std::string read_rest(Cursor& c);

// Reads a decimal number, rounded correctly to float; "nan", "inf" and the like give values that are
// not finite. False, with the cursor unmoved, when there is no number.
bool read_float_slow(Cursor& c, float& value);

// Powers of ten that a double holds exactly.
inline constexpr double kPowersOfTen[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                          1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                          1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

static inline bool read_float(Cursor& c, float& value) {
  // Collect up to 19 digits as one integer and the power of ten that scales it.
  const char* p = c.p;
  const bool negative = *p == '-';
  if (negative) ++p;
  uint64_t mantissa = 0;
  const char* const first = p;
  while (is_digit(*p)) mantissa = mantissa * 10 + static_cast<uint64_t>(*p++ - '0');
  ptrdiff_t digits = p - first;
  int exponent = 0;
  if (*p == '.') {
    const char* const fraction = ++p;
    while (is_digit(*p)) mantissa = mantissa * 10 + static_cast<uint64_t>(*p++ - '0');
    digits += p - fraction;
    if (digits > 19) return read_float_slow(c, value);
    exponent = -static_cast<int>(p - fraction);
  }
  if (digits == 0 || digits > 19 || (*p != ' ' && !is_newline(*p) && *p != '\t'))
    return read_float_slow(c, value);

  // An integer under 2^53 and a power of ten up to 10^22 are exact doubles, so that one operation
  // rounds their quotient correctly (Clinger 1990). Rounding that again to float is correct as well,
  // unless it lies exactly between two floats or among the denormal ones: those go the slow way.
  if (mantissa >= (uint64_t{1} << 53) || exponent < -22) return read_float_slow(c, value);
  const double wide = static_cast<double>(mantissa) / kPowersOfTen[-exponent];
  uint64_t bits;
  __builtin_memcpy(&bits, &wide, sizeof bits);
  if ((bits & 0x1fffffff) == 0x10000000 || (wide < 1.2e-38 && mantissa != 0))
    return read_float_slow(c, value);
  value = static_cast<float>(negative ? -wide : wide);
  c.p = p;
  return true;
}

// Reads a whole number of at most 18 digits. False, with the cursor unmoved, when there is none.
static inline bool read_integer(Cursor& c, int64_t& value) {
  const char* p = c.p;
  const bool negative = *p == '-';
  if (negative || *p == '+') ++p;
  const char* const first = p;
  int64_t n = 0;
  while (is_digit(*p) && p - first < 18) n = n * 10 + (*p++ - '0');
  if (p == first || is_digit(*p)) return false;
  value = negative ? -n : n;
  c.p = p;
  return true;
}

// Text of a message: at most 40 characters, without control characters.
std::string printable(std::string_view text);
std::string quoted(std::string_view text);  // the same between single quotes

std::string lower_case(std::string_view text);  // ASCII letters only

}  // namespace vitral
