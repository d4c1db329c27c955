// A fast compressor in zlib's format (RFC 1950 and 1951).
#pragma once
#include <cstdint>
#include <span>
#include <string>

namespace vitral {

// Greedy matching against the last place with the same four bytes, one dynamic Huffman code per
// block: about four times as fast as a thorough search for some more bytes. Depends on nothing but
// the input.
std::string zlib_compress(std::span<const uint8_t> bytes);

}  // namespace vitral
