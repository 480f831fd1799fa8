#include "core/base/thread_pool.h"

#ifndef _WIN32
#include <unistd.h>
#endif

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/check.h"
#include "core/base/flush_to_zero.h"
#include "core/base/interruption.h"

namespace taut::detail {
namespace {

/// Another one in a child of fork(), which has the memory of its parent and none of its threads.
long process_id() {
#ifdef _WIN32
  return 0;
#else
  return getpid();
#endif
}

}  // namespace

struct ThreadPool::Impl {
  const long process = process_id();
  std::mutex mutex;
  std::unique_ptr<std::condition_variable[]> wake;  // of each thread
  std::condition_variable done;
  const std::function<void(int, int)>* work = nullptr;
  const InterruptScope::Question* question = nullptr;  // of the caller
  std::atomic<int> next{0};
  unsigned mode = 0;  // of the caller
  int tasks = 0, workers = 0, busy = 0;
  long round = 0;
  bool open = false;  // a thread may still join the round
  bool stop = false;
  std::exception_ptr error;
  int missing = 0;
  std::vector<std::jthread> threads;

  /// Also of a pool that was not made to its end: threads that wait must be told before they are joined.
  ~Impl() {
    {
      const std::scoped_lock lock(mutex);
      stop = true;
    }
    for (std::size_t k = 0; k < threads.size(); ++k) wake[k].notify_one();
    threads.clear();
  }

  /// As the caller's thread would, so that results have the same bits on all threads.
  void take_tasks(int worker) {
    const RoundingScope rounding(mode);
    const InterruptScope scope(question);
    for (int task = next++; task < tasks; task = next++) {
      try {
        poll_interrupt();
        (*work)(task, worker);
      } catch (...) {
        const std::scoped_lock lock(mutex);
        if (!error) error = std::current_exception();
      }
    }
  }

  /// A thread that wakes after a round has ended, as on a busy machine, has missed it: nobody waits for it.
  void loop(int worker) {
    long seen = 0;
    std::unique_lock lock(mutex);
    while (true) {
      wake[worker - 1].wait(lock, [&] { return stop || (open && round != seen && worker < workers); });
      if (stop) return;
      seen = round;
      ++busy;
      lock.unlock();
      take_tasks(worker);
      lock.lock();
      if (--busy == 0) done.notify_one();
    }
  }
};

void check_threads(std::string_view name, int wanted) {
  if (wanted < 0) fail(name, "must not be negative", wanted);
  if (wanted > kMostThreads) fail(name, "must be at most 1024", wanted);
}

int thread_count(int wanted) {
  if (wanted > 0) return wanted;
  return std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, kMostThreads);
}

std::jthread start_thread(std::function<void()> work) { return std::jthread(std::move(work)); }

ThreadPool::ThreadPool(int threads, const ThreadStarter& start) : impl_(std::make_unique<Impl>()) {
  const auto others = static_cast<std::size_t>(std::max(threads - 1, 0));
  impl_->wake = std::make_unique<std::condition_variable[]>(others);
  impl_->threads.reserve(others);  // what is thrown between would leave a thread that waits for ever
  for (int worker = 1; worker < threads; ++worker) {
    try {
      impl_->threads.push_back(start([impl = impl_.get(), worker] { impl->loop(worker); }));
    } catch (const std::system_error&) {  // a limit of the user or of memory
      impl_->missing = threads - worker;
      return;
    }
  }
}

/// Threads of another process cannot be told to stop, nor can what they wait for be destroyed.
ThreadPool::~ThreadPool() {
  if (!is_here()) (void)impl_.release();
}

int ThreadPool::size() const { return static_cast<int>(impl_->threads.size()) + 1; }
int ThreadPool::missing() const { return impl_->missing; }
bool ThreadPool::is_here() const { return impl_->process == process_id(); }

void ThreadPool::run(int tasks, const std::function<void(int, int)>& work, int workers) {
  workers = std::min({workers, size(), tasks});
  if (workers <= 1 || !is_here()) {
    for (int task = 0; task < tasks; ++task) poll_interrupt(), work(task, 0);
    return;
  }
  {
    const std::scoped_lock lock(impl_->mutex);
    impl_->work = &work;
    impl_->question = InterruptScope::current();
    impl_->mode = rounding_mode();
    impl_->tasks = tasks;
    impl_->workers = workers;
    impl_->next = 0;
    impl_->error = nullptr;
    impl_->open = true;
    ++impl_->round;
  }
  for (int k = 0; k < workers - 1; ++k) impl_->wake[k].notify_one();
  impl_->take_tasks(0);
  std::unique_lock lock(impl_->mutex);
  impl_->open = false;
  impl_->done.wait(lock, [&] { return impl_->busy == 0; });
  if (impl_->error) std::rethrow_exception(impl_->error);
}

LazyPool::LazyPool(int wanted, ThreadStarter start)
    : wanted_(thread_count(wanted)), start_(std::move(start)) {}
LazyPool::~LazyPool() = default;

ThreadPool& LazyPool::get() {
  if (!pool_) pool_ = std::make_unique<ThreadPool>(wanted_, start_);
  return *pool_;
}

}  // namespace taut::detail
