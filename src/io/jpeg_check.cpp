#include "io/jpeg_check.h"

#include "vitral/error.h"

#include <cstddef>
#include <cstdint>

namespace vitral {
namespace {

// Markers (ITU T.81, table B.1): two bytes, the first of which is 0xff.
constexpr uint8_t kRestart0 = 0xd0, kStart = 0xd8, kEnd = 0xd9;
constexpr uint8_t kHuffmanTables = 0xc4, kScan = 0xda, kTemporary = 0x01;
constexpr int kMaxScans = 1000;

uint8_t byte_at(std::string_view bytes, size_t at) {
  return at < bytes.size() ? static_cast<uint8_t>(bytes[at]) : 0;
}

// One segment may hold several tables: a byte, the counts of codes of 1 to 16 bits, the symbols.
void check_tables(const std::string& path, std::string_view tables) {
  for (size_t at = 0; at < tables.size();) {
    size_t symbols = 0;
    for (size_t i = 1; i <= 16; ++i) symbols += byte_at(tables, at + i);
    if (symbols > 256) fail(path, "the picture is broken: a JPEG Huffman table of more than 256 symbols");
    at += 17 + symbols;
  }
}

}  // namespace

void check_jpeg(const std::string& path, std::string_view bytes) {
  int scans = 0;
  for (size_t at = 0; at + 1 < bytes.size();) {
    // Between a scan's header and the next marker stands its data, in which 0xff is followed by zero,
    // by a restart marker, or by another 0xff.
    const uint8_t marker = byte_at(bytes, at + 1);
    if (byte_at(bytes, at) != 0xff || marker == 0 || marker == 0xff || marker == kTemporary ||
        (marker >= kRestart0 && marker <= kStart)) {
      const size_t next = bytes.find('\xff', at + 1);
      if (next == std::string_view::npos) return;
      at = next;
      continue;
    }
    if (marker == kEnd) return;
    if (marker == kScan && ++scans > kMaxScans) fail(path, "more than 1000 JPEG scans");
    const size_t length = static_cast<size_t>(byte_at(bytes, at + 2) << 8 | byte_at(bytes, at + 3));
    if (marker == kHuffmanTables && length > 2)
      check_tables(path, bytes.substr(at + 4 > bytes.size() ? bytes.size() : at + 4, length - 2));
    at += 2 + length;
  }
}

}  // namespace vitral
