#pragma once

#include <functional>
#include <memory>

namespace taut::detail {

/// As many as are wanted, or, for 0, as the machine has.
int thread_count(int wanted);

/// Threads that wait for work.  The caller is worker 0 and works, too.
class ThreadPool {
 public:
  /// @param threads with the caller; 1: none are started.
  explicit ThreadPool(int threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int size() const;
  /// Calls work(task, worker) once for each task in [0, tasks), in any order and on any worker, and returns
  /// when all are done.  What the tasks compute must not depend on either.  The first exception is thrown
  /// again here.  Between tasks, each worker asks what the caller's thread would (core/interruption.h).
  void run(int tasks, const std::function<void(int task, int worker)>& work);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace taut::detail
