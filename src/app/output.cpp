#include "app/commands.h"
#include "app/progress.h"
#include "io/image_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

namespace vitral {

namespace fs = std::filesystem;

void report_warnings(Warnings& warnings, const Options& options) {
  for (const std::string& warning : std::exchange(warnings, {})) {
    if (!options.quiet) std::fprintf(stderr, "vitral: warning: %s\n", warning.c_str());
  }
}

void check_output(const std::string& path, const std::vector<std::string>& inputs) {
  if (path == "-") {
    if (is_terminal(STDOUT_FILENO))
      throw UsageError("standard output is a terminal: send it to a file or a pipe");
    return;
  }
  for (const char* other :
       {".jpg", ".jpeg", ".bmp", ".tga", ".gif", ".ppm", ".exr", ".hdr", ".webp", ".tif"}) {
    if (fs::path(path).extension() == other) throw UsageError(path + ": pictures are written as PNG only");
  }
  for (const std::string& input : inputs) {
    std::error_code code;
    if (fs::equivalent(path, input, code)) throw UsageError(path + " is an input: it would be overwritten");
  }
  check_writable(path);
}

void print(std::string_view text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    fail("standard output", std::strerror(errno));
  }
}

}  // namespace vitral
