#pragma once

#include <functional>
#include <memory>
#include <string_view>
#include <thread>

namespace taut::detail {

/// More are refused.
inline constexpr int kMostThreads = 1024;
/// @throws std::invalid_argument for a negative number, or more than kMostThreads.
void check_threads(std::string_view name, int wanted);
/// As many as are wanted, or, for 0, as the machine has.
int thread_count(int wanted);

/// Starts a thread that does the work. @throws std::system_error if it cannot be started.
using ThreadStarter = std::function<std::jthread(std::function<void()> work)>;
std::jthread start_thread(std::function<void()> work);

/// Threads that wait for work.  The caller is worker 0 and works, too.
///
/// In a process that was forked from that which made the pool its threads are not there: run() then does all
/// tasks by itself, and the destructor waits for nobody.
class ThreadPool {
 public:
  /// Where one cannot be started, the pool goes on with those before it.
  /// @param threads with the caller; 1: none are started.
  explicit ThreadPool(int threads, const ThreadStarter& start = start_thread);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int size() const;
  /// Those that could not be started.
  int missing() const;
  /// Its threads are in this process.
  bool is_here() const;
  /// Calls work(task, worker) once for each task in [0, tasks), in any order and on any worker, and returns
  /// when all are done.  What the tasks compute must not depend on either.  The first exception is thrown
  /// again here.  Workers round as the caller's thread does, and between tasks they ask what it would
  /// (core/base/interruption.h).
  /// @param workers take part, at most: those with the numbers below
  void run(int tasks, const std::function<void(int task, int worker)>& work, int workers = kMostThreads);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A pool that is made when there is work for it.
class LazyPool {
 public:
  /// @param wanted threads; 0: as many as the machine has.
  explicit LazyPool(int wanted, ThreadStarter start = start_thread);
  ~LazyPool();
  LazyPool(const LazyPool&) = delete;
  LazyPool& operator=(const LazyPool&) = delete;

  int wanted() const { return wanted_; }
  ThreadPool& get();
  /// Threads that could not be started.
  int missing() const { return pool_ ? pool_->missing() : 0; }

 private:
  int wanted_;
  ThreadStarter start_;
  std::unique_ptr<ThreadPool> pool_;
};

}  // namespace taut::detail
