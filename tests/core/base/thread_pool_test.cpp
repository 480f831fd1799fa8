#include "core/base/thread_pool.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <memory>

namespace taut::thread_pool_test {
namespace {

constexpr int kTasks = 1000;

/// Of tasks that were each done once.
int done_by(detail::ThreadPool& pool) {
  std::atomic<int> done = 0;
  pool.run(kTasks, [&](int, int) { ++done; });
  return done;
}

/// What is waited for there never comes: its threads are those of the parent.
TEST(RobustThreads, AForkedProcessDoesAllTasksAndEndsThePool) {
  auto pool = std::make_unique<detail::ThreadPool>(4);
  ASSERT_EQ(done_by(*pool), kTasks);
  const pid_t child = fork();
  if (child == 0) {
    alarm(30);
    const bool done = !pool->is_here() && done_by(*pool) == kTasks;
    pool.reset();
    detail::ThreadPool own(2);
    _exit(done && own.is_here() && done_by(own) == kTasks ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  EXPECT_TRUE(pool->is_here());
  EXPECT_EQ(done_by(*pool), kTasks);
}

}  // namespace
}  // namespace taut::thread_pool_test
