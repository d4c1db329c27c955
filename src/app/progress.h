// The progress bar on standard error.
#pragma once
#include "vitral/render.h"

#include <chrono>
#include <string>

namespace vitral {

// Draws one line and keeps redrawing it, for each pass at once and then at most ten times a second;
// erases it when it goes. Used by one thread at a time.
class ProgressBar {
 public:
  ProgressBar() = default;
  ~ProgressBar() { erase(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(const Progress& progress);
  void erase();

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point drawn_{};  // when the line was last drawn
  Clock::time_point start_{};  // of the pass
  std::string pass_;
  uint64_t rays_before_ = 0;
  bool on_screen_ = false;
};

// The line itself: pass, bar, percent, Mrays/s and the time left after `seconds` of this pass.
std::string progress_line(const Progress& progress, uint64_t rays_of_pass, double seconds, int columns);

// "0.8 s", "45 s", "3:05 min", "2:10 h".
std::string in_words(double seconds);

bool is_terminal(int descriptor);

}  // namespace vitral
