#include "collision/thread_pool.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "core/flush_to_zero.h"
#include "core/interruption.h"

namespace taut::detail {

struct ThreadPool::Impl {
  std::mutex mutex;
  std::condition_variable wake, done;
  const std::function<void(int, int)>* work = nullptr;
  const InterruptScope::Question* question = nullptr;  // of the caller
  std::atomic<int> next{0};
  int tasks = 0, busy = 0;
  long round = 0;
  bool stop = false;
  std::exception_ptr error;
  std::vector<std::jthread> threads;

  /// In the same mode as the caller of a step, so that results have the same bits on all threads.
  void take_tasks(int worker) {
    const FlushToZero mode;
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

  void loop(int worker) {
    long seen = 0;
    while (true) {
      std::unique_lock lock(mutex);
      wake.wait(lock, [&] { return stop || round != seen; });
      if (stop) return;
      seen = round;
      lock.unlock();
      take_tasks(worker);
      lock.lock();
      if (--busy == 0) done.notify_one();
    }
  }
};

int thread_count(int wanted) {
  return wanted > 0 ? wanted : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

ThreadPool::ThreadPool(int threads) : impl_(std::make_unique<Impl>()) {
  for (int worker = 1; worker < threads; ++worker)
    impl_->threads.emplace_back([impl = impl_.get(), worker] { impl->loop(worker); });
}

ThreadPool::~ThreadPool() {
  {
    const std::scoped_lock lock(impl_->mutex);
    impl_->stop = true;
  }
  impl_->wake.notify_all();
  impl_->threads.clear();
}

int ThreadPool::size() const { return static_cast<int>(impl_->threads.size()) + 1; }

void ThreadPool::run(int tasks, const std::function<void(int, int)>& work) {
  if (tasks <= 1 || impl_->threads.empty()) {
    for (int task = 0; task < tasks; ++task) poll_interrupt(), work(task, 0);
    return;
  }
  {
    const std::scoped_lock lock(impl_->mutex);
    impl_->work = &work;
    impl_->question = InterruptScope::current();
    impl_->tasks = tasks;
    impl_->next = 0;
    impl_->busy = static_cast<int>(impl_->threads.size());
    impl_->error = nullptr;
    ++impl_->round;
  }
  impl_->wake.notify_all();
  impl_->take_tasks(0);
  std::unique_lock lock(impl_->mutex);
  impl_->done.wait(lock, [&] { return impl_->busy == 0; });
  if (impl_->error) std::rethrow_exception(impl_->error);
}

}  // namespace taut::detail
