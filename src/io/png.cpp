#include "io/png.h"

#include "io/deflate.h"

#include <array>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <vector>

namespace vitral {
namespace {

constexpr size_t kPixel = 3;  // bytes

void put_big_endian(std::string& out, uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>((value >> shift) & 0xff);
}

constexpr std::array<uint32_t, 256> make_crc_table() {
  std::array<uint32_t, 256> table{};
  for (uint32_t n = 0; n < 256; ++n) {
    uint32_t c = n;
    for (int k = 0; k < 8; ++k) c = (c & 1) != 0 ? 0xedb88320u ^ (c >> 1) : c >> 1;
    table[n] = c;
  }
  return table;
}

uint32_t crc32(std::string_view bytes) {
  static constexpr std::array<uint32_t, 256> kTable = make_crc_table();
  uint32_t crc = 0xffffffffu;
  for (const char c : bytes) crc = kTable[(crc ^ static_cast<uint8_t>(c)) & 0xff] ^ (crc >> 8);
  return ~crc;
}

void put_chunk(std::string& out, std::string_view type, std::string_view data) {
  put_big_endian(out, static_cast<uint32_t>(data.size()));
  const size_t start = out.size();
  out += type;
  out += data;
  put_big_endian(out, crc32(std::string_view(out).substr(start)));
}

// Row filters by their PNG number: the difference to a prediction from the pixel on the left, the
// one above, or whichever of left, above and their corner is nearest to left + above - corner.
enum Filter : uint8_t { kSub = 1, kUp = 2, kPaeth = 4 };

uint8_t paeth(int left, int up, int corner) {
  const int to_left = std::abs(up - corner), to_up = std::abs(left - corner);
  const int to_corner = std::abs(left + up - 2 * corner);
  const int other = to_up <= to_corner ? up : corner;
  return static_cast<uint8_t>(to_left <= to_up && to_left <= to_corner ? left : other);
}

// `row` and `above` have kPixel zeros before them. Returns the sum of the differences' magnitudes,
// the usual guess of how well the row will compress.
template <Filter filter>
uint64_t filter_row(const uint8_t* row, const uint8_t* above, size_t bytes, uint8_t* out) {
  uint32_t sum = 0;
  for (size_t i = 0; i < bytes; ++i) {
    const uint8_t left = row[i - kPixel], up = above[i];
    const uint8_t guess = filter == kSub ? left : filter == kUp ? up : paeth(left, up, above[i - kPixel]);
    const auto difference = static_cast<uint8_t>(row[i] - guess);
    out[i] = difference;
    sum += difference < 128 ? difference : 256u - difference;
  }
  return sum;
}

}  // namespace

std::string encode_png(const Image<Rgb8>& image) {
  static_assert(sizeof(Rgb8) == kPixel);
  const auto width = static_cast<size_t>(image.width), height = static_cast<size_t>(image.height);
  const size_t bytes = width * kPixel;

  // Each row takes the filter that makes it smallest, told in a byte before it.
  std::vector<uint8_t> filtered(height * (bytes + 1));
  std::vector<uint8_t> row(kPixel + bytes, 0), above(kPixel + bytes, 0);
  std::vector<uint8_t> tried(bytes);
  for (size_t y = 0; y < height; ++y) {
    std::memcpy(row.data() + kPixel, image.row(static_cast<int>(y)), bytes);
    uint8_t* const out = &filtered[y * (bytes + 1)];
    const uint8_t *r = row.data() + kPixel, *a = above.data() + kPixel;
    out[0] = kUp;
    uint64_t best = filter_row<kUp>(r, a, bytes, out + 1);
    const auto keep_if_better = [&](Filter filter, uint64_t sum) {
      if (sum >= best) return;
      best = sum;
      out[0] = filter;
      std::memcpy(out + 1, tried.data(), bytes);
    };
    if (best > 0) keep_if_better(kSub, filter_row<kSub>(r, a, bytes, tried.data()));
    if (best > 0) keep_if_better(kPaeth, filter_row<kPaeth>(r, a, bytes, tried.data()));
    std::swap(row, above);
  }

  std::string header;
  put_big_endian(header, static_cast<uint32_t>(width));
  put_big_endian(header, static_cast<uint32_t>(height));
  header += std::string_view("\x08\x02\x00\x00\x00", 5);  // 8 bits, RGB, deflate, filters, not interlaced
  std::string out = "\x89PNG\r\n\x1a\n";
  put_chunk(out, "IHDR", header);
  put_chunk(out, "IDAT", zlib_compress(filtered));
  put_chunk(out, "IEND", {});
  return out;
}

}  // namespace vitral
