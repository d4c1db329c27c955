#include "io/deflate.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <utility>
#include <vector>

namespace vitral {
namespace {

constexpr size_t kWindow = 32768, kMinMatch = 4, kMaxMatch = 258;
constexpr size_t kBlockSymbols = 32768;
constexpr int kLiterals = 286, kDistances = 30, kEndOfBlock = 256;
constexpr int kMaxCodeBits = 15;

// Bits go into bytes from the low end (RFC 1951, 3.1.1).
class BitWriter {
 public:
  explicit BitWriter(std::string& out) : out_(out) {}
  void put(uint32_t bits, int count) {
    pending_ |= static_cast<uint64_t>(bits) << filled_;
    filled_ += count;
    while (filled_ >= 8) {
      out_ += static_cast<char>(pending_ & 0xff);
      pending_ >>= 8;
      filled_ -= 8;
    }
  }
  void flush() {
    if (filled_ > 0) put(0, 8 - filled_);
  }

 private:
  std::string& out_;
  uint64_t pending_ = 0;
  int filled_ = 0;
};

// Lengths 3..258 and distances 1..32768 are a code and some extra bits (RFC 1951, 3.2.5). Each power
// of two has four codes of lengths and two of distances.
struct Coded {
  int code, extra_bits;
  uint32_t extra;
};

Coded code_length(uint32_t length) {
  if (length == 258) return {285, 0, 0};
  const uint32_t n = length - 3;
  if (n < 8) return {257 + static_cast<int>(n), 0, 0};
  const int bits = static_cast<int>(std::bit_width(n)) - 3;
  return {257 + 4 * bits + static_cast<int>(n >> bits), bits, n & ((1u << bits) - 1)};
}

Coded code_distance(uint32_t distance) {
  const uint32_t n = distance - 1;
  if (n < 4) return {static_cast<int>(n), 0, 0};
  const int bits = static_cast<int>(std::bit_width(n)) - 2;
  return {2 * bits + static_cast<int>(n >> bits), bits, n & ((1u << bits) - 1)};
}

struct HuffmanCode {
  std::vector<uint8_t> bits;   // length of each symbol's code; 0: not used
  std::vector<uint16_t> code;  // reversed, as the writer wants it
};

// Lengths of an optimal prefix code. Where one would exceed `max_bits`, the counts are flattened
// until none does.
std::vector<uint8_t> code_lengths(std::vector<uint32_t> counts, int max_bits) {
  std::vector<uint8_t> bits(counts.size(), 0);
  for (;;) {
    // Merge the two lightest trees until one is left (Huffman 1952). Leaves, sorted by weight, and
    // inner nodes, made in that order, are two queues.
    std::vector<std::pair<uint32_t, uint32_t>> leaves;  // weight, symbol
    for (uint32_t s = 0; s < counts.size(); ++s) {
      if (counts[s] > 0) leaves.emplace_back(counts[s], s);
    }
    if (leaves.empty()) return bits;
    if (leaves.size() == 1) {
      bits[leaves[0].second] = 1;
      return bits;
    }
    std::sort(leaves.begin(), leaves.end());
    const size_t n = leaves.size();
    std::vector<uint64_t> weight(2 * n - 1);
    std::vector<size_t> parent(2 * n - 1);
    for (size_t i = 0; i < n; ++i) weight[i] = leaves[i].first;
    size_t leaf = 0, inner = n;
    for (size_t made = n; made < 2 * n - 1; ++made) {
      for (int side = 0; side < 2; ++side) {
        const bool take_leaf = leaf < n && (inner == made || weight[leaf] <= weight[inner]);
        const size_t child = take_leaf ? leaf++ : inner++;
        weight[made] += weight[child];
        parent[child] = made;
      }
    }
    std::vector<int> depth(2 * n - 1, 0);
    int deepest = 0;
    for (size_t i = 2 * n - 2; i-- > 0;) {
      depth[i] = depth[parent[i]] + 1;
      deepest = std::max(deepest, depth[i]);
    }
    if (deepest <= max_bits) {
      for (size_t i = 0; i < n; ++i) bits[leaves[i].second] = static_cast<uint8_t>(depth[i]);
      return bits;
    }
    for (uint32_t& count : counts) count = (count + 1) / 2;
  }
}

// Codes in the order of their lengths and symbols (RFC 1951, 3.2.2).
HuffmanCode make_code(std::vector<uint32_t> counts, int max_bits) {
  HuffmanCode result{code_lengths(std::move(counts), max_bits), {}};
  result.code.resize(result.bits.size());
  std::array<uint32_t, kMaxCodeBits + 2> next{};
  for (const uint8_t b : result.bits) ++next[b + 1u];
  next[1] = 0;
  for (size_t b = 1; b < next.size(); ++b) next[b] = (next[b] + next[b - 1]) << 1;
  for (size_t s = 0; s < result.bits.size(); ++s) {
    const int b = result.bits[s];
    if (b == 0) continue;
    uint32_t code = next[static_cast<size_t>(b)]++, reversed = 0;
    for (int i = 0; i < b; ++i, code >>= 1) reversed = (reversed << 1) | (code & 1);
    result.code[s] = static_cast<uint16_t>(reversed);
  }
  return result;
}

// A literal (distance 0) or a copy of `length` bytes from `distance` back.
struct Symbol {
  uint16_t length, distance;
};

class Deflater {
 public:
  explicit Deflater(std::string& out) : writer_(out) {}

  void run(std::span<const uint8_t> bytes) {
    std::vector<uint32_t> last(size_t{1} << kHashBits, 0);  // position + 1 of the last such four bytes
    size_t at = 0;
    while (at < bytes.size()) {
      const size_t left = bytes.size() - at;
      size_t length = 0, distance = 0;
      if (left >= 8) {
        uint32_t& slot = last[hash(&bytes[at])];
        if (slot != 0 && at - (slot - 1) <= kWindow) {
          distance = at - (slot - 1);
          length = match(&bytes[at - distance], &bytes[at], std::min(left, kMaxMatch));
        }
        slot = static_cast<uint32_t>(at + 1);
      }
      if (length >= kMinMatch) {
        add({static_cast<uint16_t>(length), static_cast<uint16_t>(distance - 1)}, Kind::copy);
        // Every second place inside the match is enough to be found again.
        for (size_t i = at + 1; i < at + length && i + 8 <= bytes.size(); i += 2) {
          last[hash(&bytes[i])] = static_cast<uint32_t>(i + 1);
        }
        at += length;
      } else {
        add({bytes[at], 0}, Kind::literal);
        ++at;
      }
      if (symbols_.size() == kBlockSymbols) write_block(at == bytes.size() ? Block::last : Block::inner);
    }
    if (!finished_) write_block(Block::last);
    writer_.flush();
  }

 private:
  enum class Kind : uint8_t { literal, copy };
  enum class Block { inner, last };
  static constexpr int kHashBits = 15;

  static uint32_t hash(const uint8_t* p) {
    uint32_t four;
    std::memcpy(&four, p, 4);
    return (four * 2654435761u) >> (32 - kHashBits);
  }

  static size_t match(const uint8_t* a, const uint8_t* b, size_t limit) {
    size_t n = 0;
    for (uint64_t x, y; n + sizeof x <= limit; n += sizeof x) {
      std::memcpy(&x, a + n, sizeof x);
      std::memcpy(&y, b + n, sizeof y);
      if (x == y) continue;
      const uint64_t differ = x ^ y;
      const int zeros =
          std::endian::native == std::endian::little ? std::countr_zero(differ) : std::countl_zero(differ);
      return n + static_cast<size_t>(zeros / 8);
    }
    while (n < limit && a[n] == b[n]) ++n;
    return n;
  }

  void add(Symbol symbol, Kind kind) {
    symbols_.push_back(symbol);
    kinds_.push_back(kind);
  }

  void write_block(Block block) {
    std::vector<uint32_t> literals(kLiterals, 0), distances(kDistances, 0);
    for (size_t i = 0; i < symbols_.size(); ++i) {
      const Symbol s = symbols_[i];
      if (kinds_[i] == Kind::copy) {
        ++literals[static_cast<size_t>(code_length(s.length).code)];
        ++distances[static_cast<size_t>(code_distance(s.distance + 1u).code)];
      } else {
        ++literals[s.length];
      }
    }
    literals[kEndOfBlock] = 1;
    const HuffmanCode literal = make_code(literals, kMaxCodeBits);
    HuffmanCode distance = make_code(distances, kMaxCodeBits);

    writer_.put(block == Block::last ? 1 : 0, 1);
    writer_.put(2, 2);  // dynamic Huffman codes
    write_codes(literal.bits, distance.bits);
    for (size_t i = 0; i < symbols_.size(); ++i) {
      const Symbol s = symbols_[i];
      if (kinds_[i] == Kind::literal) {
        writer_.put(literal.code[s.length], literal.bits[s.length]);
        continue;
      }
      const Coded l = code_length(s.length), d = code_distance(s.distance + 1u);
      const auto lc = static_cast<size_t>(l.code), dc = static_cast<size_t>(d.code);
      writer_.put(literal.code[lc], literal.bits[lc]);
      writer_.put(l.extra, l.extra_bits);
      writer_.put(distance.code[dc], distance.bits[dc]);
      writer_.put(d.extra, d.extra_bits);
    }
    writer_.put(literal.code[kEndOfBlock], literal.bits[kEndOfBlock]);
    symbols_.clear();
    kinds_.clear();
    finished_ = block == Block::last;
  }

  // Both codes' lengths in one row, itself Huffman coded (RFC 1951, 3.2.7). Runs of zeros are
  // shortened, others are not worth it.
  void write_codes(std::vector<uint8_t> lengths, std::vector<uint8_t> distances) {
    while (lengths.size() > 257 && lengths.back() == 0) lengths.pop_back();
    while (distances.size() > 1 && distances.back() == 0) distances.pop_back();
    writer_.put(static_cast<uint32_t>(lengths.size()) - 257, 5);
    writer_.put(static_cast<uint32_t>(distances.size()) - 1, 5);
    lengths.insert(lengths.end(), distances.begin(), distances.end());

    std::vector<std::pair<uint8_t, uint32_t>> row;  // symbol, length of a run of zeros
    for (size_t i = 0; i < lengths.size();) {
      size_t run = 0;
      while (i + run < lengths.size() && lengths[i + run] == 0 && run < 138) ++run;
      if (run >= 3) {
        row.emplace_back(run < 11 ? 17 : 18, run);
        i += run;
      } else {
        row.emplace_back(lengths[i++], 0);
      }
    }
    std::vector<uint32_t> counts(19, 0);
    for (const auto& [symbol, run] : row) ++counts[symbol];
    const HuffmanCode code = make_code(counts, 7);

    constexpr std::array<uint8_t, 19> kOrder = {16, 17, 18, 0, 8,  7, 9,  6, 10, 5,
                                                11, 4,  12, 3, 13, 2, 14, 1, 15};
    size_t used = kOrder.size();
    while (used > 4 && code.bits[kOrder[used - 1]] == 0) --used;
    writer_.put(static_cast<uint32_t>(used) - 4, 4);
    for (size_t i = 0; i < used; ++i) writer_.put(code.bits[kOrder[i]], 3);
    for (const auto& [symbol, run] : row) {
      writer_.put(code.code[symbol], code.bits[symbol]);
      if (symbol == 17) writer_.put(run - 3, 3);
      if (symbol == 18) writer_.put(run - 11, 7);
    }
  }

  BitWriter writer_;
  std::vector<Symbol> symbols_;
  std::vector<Kind> kinds_;
  bool finished_ = false;
};

uint32_t adler32(std::span<const uint8_t> bytes) {
  constexpr uint32_t kPrime = 65521;
  constexpr size_t kNoOverflow = 5552;  // bytes that can be summed before the remainder is taken
  uint32_t a = 1, b = 0;
  for (size_t i = 0; i < bytes.size();) {
    for (const size_t end = std::min(bytes.size(), i + kNoOverflow); i < end; ++i) {
      a += bytes[i];
      b += a;
    }
    a %= kPrime;
    b %= kPrime;
  }
  return (b << 16) | a;
}

}  // namespace

std::string zlib_compress(std::span<const uint8_t> bytes) {
  std::string out;
  out.reserve(bytes.size() / 2 + 64);
  out += "\x78\x01";  // deflate with a window of 32 KiB, fast
  Deflater(out).run(bytes);
  const uint32_t sum = adler32(bytes);
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>((sum >> shift) & 0xff);
  return out;
}

}  // namespace vitral
