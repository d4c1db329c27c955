// A pseudo-terminal that a test watches a program on.
#pragma once
#include <gtest/gtest.h>

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <chrono>
#include <string>

namespace vitral::test {

// Our side, and the side a program takes for a terminal.
struct Terminal {
  int ours = -1, theirs = -1;
  std::string seen;

  Terminal() {
    ours = posix_openpt(O_RDWR | O_NOCTTY);
    EXPECT_TRUE(ours >= 0 && grantpt(ours) == 0 && unlockpt(ours) == 0);
    theirs = open(ptsname(ours), O_RDWR | O_NOCTTY);
    EXPECT_GE(theirs, 0);
  }
  ~Terminal() {
    close(ours);
    close(theirs);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  // Reads what has come within `ms` milliseconds; false when nothing has.
  bool read_some(int ms) {
    pollfd stream{ours, POLLIN, 0};
    if (poll(&stream, 1, ms) <= 0 || !(stream.revents & POLLIN)) return false;
    char bytes[1024];
    const ssize_t count = read(ours, bytes, sizeof bytes);
    if (count > 0) seen.append(bytes, static_cast<size_t>(count));
    return count > 0;
  }
  // Reads on until `text` has been seen; false after half a minute.
  bool wait_for(const std::string& text) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (seen.find(text) == std::string::npos) {
      if (std::chrono::steady_clock::now() > end) return false;
      read_some(100);
    }
    return true;
  }
};

}  // namespace vitral::test
