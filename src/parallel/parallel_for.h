// Worker threads that share out numbered pieces of work.
#pragma once
#include <cstddef>
#include <functional>
#include <memory>

namespace vitral {

// Runs body(index, worker) once for every index in [0, count), on all workers. Workers claim indices
// one by one, in increasing order, from one atomic counter; nothing may depend on who gets which.
// `worker` is below workers(): a slot for scratch memory that no other running body uses. The first
// exception that leaves a body stops the claiming and is thrown again to the caller.
class ThreadPool {
 public:
  using Body = std::function<void(size_t index, size_t worker)>;

  explicit ThreadPool(int threads);  // 0: one per processor
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  size_t workers() const;
  void parallel_for(size_t count, const Body& body);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vitral
