// Files as bytes: bounded reading, and writing that never leaves half a file behind.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace vitral {

// A regular file open for reading. Positions are absolute, so that several threads may read from it
// at once. Nothing is mapped: a file cut short by somebody else while it is read is an error here and
// not a fault signal.
class InputFile {
 public:
  explicit InputFile(const std::string& path);  // throws InputError: not there, a directory, ...
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::string& path() const { return path_; }
  uint64_t size() const { return size_; }

  // Fills `bytes` from `offset` on; throws InputError when the file ends before.
  void read(uint64_t offset, std::span<char> bytes) const;

 private:
  std::string path_;
  int descriptor_ = -1;
  uint64_t size_ = 0;
};

// The whole file. Throws InputError when it is larger than `max_bytes`.
std::string read_file(const std::string& path, uint64_t max_bytes);

// Writes `bytes` to `path` as image_file.h promises: "-" and everything that is no regular file (a
// pipe, a device) is written directly; a regular file appears complete or not at all, and a symbolic
// link stays one. Throws InputError.
void write_file(const std::string& path, std::string_view bytes);

}  // namespace vitral
