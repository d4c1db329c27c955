#include "io/file.h"

#include "io/image_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

namespace vitral {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail_errno(const std::string& path, int error) {
  fail(path, std::strerror(error));
}

// Writes everything, across interruptions and short writes. Returns 0 or the error number.
int write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(descriptor, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno;
    if (n == 0) return EIO;
    bytes.remove_prefix(static_cast<size_t>(n));
  }
  return 0;
}

// Where a write to `path` really goes: the end of a chain of symbolic links.
fs::path follow_links(const fs::path& path) {
  fs::path at = path;
  for (int i = 0; i < 40; ++i) {
    std::error_code error;
    if (!fs::is_symlink(fs::symlink_status(at, error))) return at;
    const fs::path next = fs::read_symlink(at, error);
    if (error) return at;
    at = next.is_absolute() ? next : at.parent_path() / next;
  }
  fail(path.string(), std::strerror(ELOOP));
}

enum class Target { regular, special };

// Checks what can be checked before anything is written.
Target check_target(const std::string& path, const fs::path& real) {
  if (path.empty()) fail("output", "the file name is empty");
  struct stat info;
  if (::stat(real.c_str(), &info) != 0) {
    if (errno != ENOENT) fail_errno(path, errno);
    return Target::regular;
  }
  if (S_ISDIR(info.st_mode)) fail_errno(path, EISDIR);
  if (::access(real.c_str(), W_OK) != 0) fail_errno(path, errno);
  return S_ISREG(info.st_mode) ? Target::regular : Target::special;
}

// A new file beside its target: the name is free, the folder the same, so that it can be renamed.
// It removes itself unless it was renamed.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& path, const fs::path& real) : path_(path), real_(real) {
    const fs::path folder = real.has_parent_path() ? real.parent_path() : fs::path(".");
    std::string stem = ".";
    stem += real.filename().string().substr(0, 200) + "." + std::to_string(::getpid());
    for (int i = 0; i < 1000 && descriptor_ < 0; ++i) {
      name_ = folder / (stem + "." + std::to_string(i) + ".tmp");
      descriptor_ = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (descriptor_ < 0 && errno != EEXIST && errno != EINTR) break;
    }
    if (descriptor_ < 0) fail_errno(path, errno);
  }
  ~TemporaryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!renamed_) ::unlink(name_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  void write(std::string_view bytes) {
    if (const int error = write_all(descriptor_, bytes)) fail_errno(path_, error);
  }
  // The bytes reach the disk before the name does. Some file systems cannot sync, and say so.
  void finish() {
    if (::fsync(descriptor_) != 0 && errno != EINVAL && errno != ENOTSUP) fail_errno(path_, errno);
    const int descriptor = descriptor_;
    descriptor_ = -1;
    if (::close(descriptor) != 0) fail_errno(path_, errno);
    if (::rename(name_.c_str(), real_.c_str()) != 0) fail_errno(path_, errno);
    renamed_ = true;
  }

 private:
  std::string path_;
  fs::path real_, name_;
  int descriptor_ = -1;
  bool renamed_ = false;
};

// A pipe or a device keeps its identity: it is opened and written as it stands.
void write_special(const std::string& path, std::string_view bytes) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) fail_errno(path, errno);
  const int write_error = write_all(descriptor, bytes);
  const int close_error = ::close(descriptor) != 0 ? errno : 0;
  if (write_error != 0 || close_error != 0) fail_errno(path, write_error != 0 ? write_error : close_error);
}

}  // namespace

InputFile::InputFile(const std::string& path) : path_(path) {
  // Without O_NONBLOCK a pipe nobody writes to would hold us here for ever.
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor_ < 0) fail_errno(path, errno);
  struct stat info;
  const int error = ::fstat(descriptor_, &info) != 0 ? errno : S_ISDIR(info.st_mode) ? EISDIR : 0;
  if (error != 0 || !S_ISREG(info.st_mode)) {
    ::close(descriptor_);
    fail(path, error != 0 ? std::strerror(error) : "not a regular file");
  }
  size_ = static_cast<uint64_t>(info.st_size);
}

InputFile::~InputFile() {
  ::close(descriptor_);
}

void InputFile::read(uint64_t offset, std::span<char> bytes) const {
  while (!bytes.empty()) {
    const ssize_t n = ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail_errno(path_, errno);
    if (n == 0) fail(path_, "the file became shorter while it was read");
    bytes = bytes.subspan(static_cast<size_t>(n));
    offset += static_cast<uint64_t>(n);
  }
}

std::string read_file(const std::string& path, uint64_t max_bytes) {
  const InputFile file(path);
  if (file.size() > max_bytes) {
    fail(path, "larger than " + std::to_string(max_bytes >> 20) + " MiB");
  }
  std::string bytes;
  bytes.reserve(static_cast<size_t>(file.size()) + 1);  // a reader may add a sentinel
  bytes.resize(static_cast<size_t>(file.size()));
  file.read(0, bytes);
  return bytes;
}

void write_file(const std::string& path, std::string_view bytes) {
  if (path == "-") {
    if (const int error = write_all(STDOUT_FILENO, bytes)) fail_errno("standard output", error);
    return;
  }
  const fs::path real = follow_links(path);
  if (check_target(path, real) == Target::special) return write_special(path, bytes);
  TemporaryFile file(path, real);
  file.write(bytes);
  file.finish();
}

void check_writable(const std::string& path) {
  if (path == "-") return;
  const fs::path real = follow_links(path);
  if (check_target(path, real) == Target::regular) TemporaryFile(path, real);
}

}  // namespace vitral
