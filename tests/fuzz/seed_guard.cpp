#include "tests/fuzz/seed_guard.h"

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

namespace taut::fuzz {

void* shared_memory(std::size_t bytes) {
  void* memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  return memory;
}

bool SeedRange::takes(const std::string& key, const std::function<std::string()>& value) {
  if (key == "--from")
    from = std::strtoull(value().c_str(), nullptr, 10);
  else if (key == "--count")
    count = std::strtoull(value().c_str(), nullptr, 10);
  else if (key == "--seconds")
    seconds = std::atof(value().c_str());
  else
    return false;
  return true;
}

long run_guarded(SeedRange& range, const SeedWork& work) {
  using Clock = std::chrono::steady_clock;
  static auto* now = static_cast<std::uint64_t*>(shared_memory(sizeof(std::uint64_t)));
  long crashes = 0;
  const auto start = Clock::now();
  const std::uint64_t end = range.from + range.count;
  std::uint64_t next = range.from;
  while (next < end) {
    if (range.seconds > 0 && std::chrono::duration<double>(Clock::now() - start).count() > range.seconds)
      break;
    const std::uint64_t to = std::min(end, next + 100);
    std::fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
      for (std::uint64_t seed = next; seed < to; ++seed) work.run(*now = seed);
      std::fflush(stdout);
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    next = to;
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) continue;
    ++crashes;
    const bool hung = WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM;
    work.crashed(
        *now, hung ? "hang: a step takes too long"
                   : (WIFSIGNALED(status) ? std::string("crash: ") + strsignal(WTERMSIG(status)) : "crash"));
    next = *now + 1;
  }
  range.count = next - range.from;
  return crashes;
}

}  // namespace taut::fuzz
