#include "parallel/parallel_for.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace vitral {

namespace {

// Pieces of work follow each other closely, and a thread that sleeps can take milliseconds to be put on a
// processor of its own again: so it first looks around for a while, giving way to whoever has work.
template <class Condition>
void wait_awake(const Condition& arrived) {
  constexpr auto kWhile = std::chrono::microseconds(500);
  const auto end = std::chrono::steady_clock::now() + kWhile;
  while (!arrived() && std::chrono::steady_clock::now() < end) std::this_thread::yield();
}

}  // namespace

struct ThreadPool::State {
  std::mutex mutex;
  std::condition_variable work_ready, work_done;
  std::vector<std::thread> threads;
  const Body* body = nullptr;
  size_t count = 0;
  std::atomic<size_t> next{0};
  std::atomic<size_t> busy{0};        // threads that have not finished the current piece of work
  std::atomic<size_t> generation{0};  // of the current piece of work
  std::atomic<bool> quit{false};
  std::exception_ptr error;

  void claim(size_t worker) {
    try {
      for (size_t i; (i = next.fetch_add(1, std::memory_order_relaxed)) < count;) (*body)(i, worker);
    } catch (...) {
      next.store(count, std::memory_order_relaxed);
      const std::lock_guard<std::mutex> lock(mutex);
      if (!error) error = std::current_exception();
    }
  }

  void run(size_t worker) {
    size_t seen = 0;
    for (;;) {
      wait_awake([&] { return quit || generation != seen; });
      {
        std::unique_lock<std::mutex> lock(mutex);
        work_ready.wait(lock, [&] { return quit || generation != seen; });
        if (quit) return;
        seen = generation;
      }
      claim(worker);
      const std::lock_guard<std::mutex> lock(mutex);
      if (--busy == 0) work_done.notify_one();
    }
  }
};

ThreadPool::ThreadPool(int threads) : state_(std::make_unique<State>()) {
  const unsigned all = std::max(1u, std::thread::hardware_concurrency());
  const size_t n = threads > 0 ? static_cast<size_t>(threads) : all;
  // The caller is worker 0.
  for (size_t i = 1; i < n; ++i) state_->threads.emplace_back([this, i] { state_->run(i); });
}

ThreadPool::~ThreadPool() {
  {
    const std::lock_guard<std::mutex> lock(state_->mutex);
    state_->quit = true;
  }
  state_->work_ready.notify_all();
  for (std::thread& t : state_->threads) t.join();
}

size_t ThreadPool::workers() const {
  return state_->threads.size() + 1;
}

void ThreadPool::parallel_for(size_t count, const Body& body) {
  State& s = *state_;
  {
    const std::lock_guard<std::mutex> lock(s.mutex);
    s.body = &body;
    s.count = count;
    s.next.store(0, std::memory_order_relaxed);
    s.busy = s.threads.size();
    s.error = nullptr;
    ++s.generation;
  }
  s.work_ready.notify_all();
  s.claim(0);
  wait_awake([&] { return s.busy == 0; });
  std::unique_lock<std::mutex> lock(s.mutex);
  s.work_done.wait(lock, [&] { return s.busy == 0; });
  if (s.error) std::rethrow_exception(s.error);
}

}  // namespace vitral
