// Independent tasks on a few threads.
#pragma once
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace vitral {

// 0 means one thread per processor.
inline size_t thread_count(int threads) {
  if (threads > 0) return static_cast<size_t>(threads);
  return std::max<size_t>(1, std::thread::hardware_concurrency());
}

// Calls task(worker, index) for every index in [0, count), handed out in increasing order, with
// worker in [0, thread_count(threads)). After an exception no further index is handed out; the one
// of the lowest index that threw is thrown again here. Since all lower indices were handed out
// before and run to their end, that exception is the same for any number of threads.
template <class Task>
void run_tasks(size_t count, int threads, const Task& task) {
  std::atomic<size_t> next{0};
  std::atomic<bool> stop{false};
  std::mutex mutex;
  std::exception_ptr failure;
  size_t failed_index = count;

  const auto work = [&](size_t worker) {
    while (!stop.load(std::memory_order_relaxed)) {
      const size_t index = next.fetch_add(1, std::memory_order_relaxed);
      if (index >= count) return;
      try {
        task(worker, index);
      } catch (...) {
        const std::lock_guard lock(mutex);
        stop = true;
        if (index < failed_index) {
          failed_index = index;
          failure = std::current_exception();
        }
      }
    }
  };
  {
    // The caller works too; a thread that the system refuses is done without.
    std::vector<std::jthread> helpers;
    try {
      for (size_t i = 1; i < std::min(thread_count(threads), count); ++i) helpers.emplace_back(work, i);
    } catch (const std::system_error&) {
    }
    work(0);
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace vitral
