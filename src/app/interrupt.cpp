#include "app/interrupt.h"

#include <unistd.h>

#include <csignal>

namespace vitral {
namespace {

constexpr int kExitCode = 130;

// A handler can reach nothing but this: where to say "stop", or null.
std::atomic<std::atomic<bool>*> stop_flag{nullptr};
static_assert(std::atomic<std::atomic<bool>*>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

void on_interrupt(int) {
  std::atomic<bool>* const stop = stop_flag.load();
  if (!stop) _exit(kExitCode);
  stop->store(true);
}

}  // namespace

void install_signal_handlers() {
  struct sigaction action {};
  sigemptyset(&action.sa_mask);
  action.sa_handler = on_interrupt;
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  action.sa_handler = SIG_IGN;
  sigaction(SIGPIPE, &action, nullptr);
}

InterruptGuard::InterruptGuard(std::atomic<bool>& stop) {
  stop_flag = &stop;
}
InterruptGuard::~InterruptGuard() {
  stop_flag = nullptr;
}

}  // namespace vitral
