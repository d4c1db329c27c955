// Errors at the edges. Inside the renderer nothing throws.
#pragma once
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

namespace vitral {

// A file that cannot be read, understood or written: exit code 1. The text is one line, written
// `file:line: reason` where a line is known, `file: reason` where not.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// A command line that makes no sense, or a value out of its range: exit code 2.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The person asked to stop (Ctrl-C): exit code 130.
struct Interrupted : std::runtime_error {
  Interrupted() : std::runtime_error("interrupted") {}
};

[[noreturn]] inline void fail(const std::string& file, const std::string& reason) {
  throw InputError(file + ": " + reason);
}
[[noreturn]] inline void fail(const std::string& file, size_t line, const std::string& reason) {
  throw InputError(file + ":" + std::to_string(line) + ": " + reason);
}

// What a reader noticed and went on from; one line each, same form as the errors.
using Warnings = std::vector<std::string>;

}  // namespace vitral
