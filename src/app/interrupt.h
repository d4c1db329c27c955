// Ctrl-C (SIGINT) and SIGTERM.
#pragma once
#include <atomic>

namespace vitral {

// Makes an interruption end the program at once with exit code 130, and a reader that went away an
// error of the write instead of a signal.
void install_signal_handlers();

// While one lives, an interruption only sets `stop`, however often it comes: for work that looks at
// `stop` often, or that is short and would leave something behind. There is one at a time.
class InterruptGuard {
 public:
  explicit InterruptGuard(std::atomic<bool>& stop);
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
};

}  // namespace vitral
