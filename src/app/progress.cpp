#include "app/progress.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace vitral {
namespace {

int terminal_columns() {
  constexpr int kUsual = 80;
  winsize size{};
  const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : kUsual;
}

}  // namespace

bool is_terminal(int descriptor) {
  return isatty(descriptor) == 1;
}

std::string in_words(double seconds) {
  char text[32];
  if (seconds < 9.95) {
    std::snprintf(text, sizeof text, "%.1f s", seconds);
    return text;
  }
  const long whole = static_cast<long>(std::min(seconds, 3.6e8) + 0.5);
  if (whole < 60) {
    std::snprintf(text, sizeof text, "%ld s", whole);
  } else if (whole < 3600) {
    std::snprintf(text, sizeof text, "%ld:%02ld min", whole / 60, whole % 60);
  } else {
    std::snprintf(text, sizeof text, "%ld:%02ld h", whole / 3600, whole / 60 % 60);
  }
  return text;
}

std::string progress_line(const Progress& progress, uint64_t rays_of_pass, double seconds, int columns) {
  const double done = std::clamp(progress.fraction, 0.0, 1.0);
  char figures[64];
  std::snprintf(figures, sizeof figures, " %3d%%", static_cast<int>(done * 100));
  std::string right = figures;
  if (rays_of_pass > 0 && seconds > 0) {
    std::snprintf(figures, sizeof figures, "  %.1f Mrays/s",
                  static_cast<double>(rays_of_pass) / seconds * 1e-6);
    right += figures;
  }
  // The first moments of a pass say nothing about its end.
  if (done > 0.01 && seconds > 0.2) right += "  " + in_words(seconds / done * (1 - done)) + " left";

  std::string left = progress.pass;
  left.resize(std::max<size_t>(left.size(), 10), ' ');
  const int room = columns - 1 - static_cast<int>(left.size() + right.size()) - 3;
  if (room >= 10) {
    const auto width = static_cast<size_t>(std::min(room, 40));
    const auto filled = static_cast<size_t>(done * static_cast<double>(width));
    left += " [" + std::string(filled, '#') + std::string(width - filled, '.') + "]";
  }
  std::string line = left + right;
  line.resize(std::min(line.size(), static_cast<size_t>(std::max(columns - 1, 1))));
  return line;
}

void ProgressBar::update(const Progress& progress) {
  const Clock::time_point now = Clock::now();
  const bool same_pass = pass_ == progress.pass;
  if (!same_pass) {
    pass_ = progress.pass;
    start_ = now;
    rays_before_ = progress.rays;
  }
  if (on_screen_ && same_pass && now - drawn_ < std::chrono::milliseconds(100)) return;
  drawn_ = now;
  on_screen_ = true;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  const std::string line = progress_line(progress, progress.rays - rays_before_, seconds, terminal_columns());
  std::fprintf(stderr, "\r%s\x1b[K", line.c_str());
  std::fflush(stderr);
}

void ProgressBar::erase() {
  if (!on_screen_) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
  on_screen_ = false;
}

}  // namespace vitral
