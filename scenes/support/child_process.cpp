#include "scenes/support/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>

#include "core/base/clock.h"

#ifdef __APPLE__
extern char** environ;
#endif

namespace taut {
namespace {

/// A pipe that other programs do not inherit.  False, with errno, if there is none.
bool make_pipe(int (&ends)[2]) {
#ifdef __APPLE__
  // There is no pipe2: what another thread starts between these calls holds the pipe open until it ends.
  if (pipe(ends) != 0) return false;
  for (const int end : ends) (void)fcntl(end, F_SETFD, FD_CLOEXEC);
  return true;
#else
  return pipe2(ends, O_CLOEXEC) == 0;
#endif
}

/// Reads until the other side closes the pipe.  @returns false if the limit came first.
bool read_all(int pipe, double limit, std::string& output) {
  const Clock::time_point start = Clock::now();
  for (;;) {
    const double left = limit - seconds_since(start);
    if (limit > 0 && left <= 0) return false;
    pollfd wait{pipe, POLLIN, 0};
    const int ready = poll(&wait, 1, limit > 0 ? static_cast<int>(std::ceil(1e3 * left)) : -1);
    if (ready < 0 && errno != EINTR) return true;
    if (ready <= 0) continue;
    char buffer[4096];
    const ssize_t count = ::read(pipe, buffer, sizeof buffer);
    if (count <= 0) return true;
    output.append(buffer, static_cast<std::size_t>(count));
  }
}

void wait_for(pid_t child, ChildResult& result) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (result.end == ChildResult::End::kTimeLimit) return;
  result.end = WIFEXITED(status) ? ChildResult::End::kExited : ChildResult::End::kKilled;
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : WTERMSIG(status);
}

}  // namespace

std::string ChildResult::message() const {
  switch (end) {
    case End::kExited:
      return code == 0 ? "" : "exit status " + std::to_string(code);
    case End::kKilled:
      return "killed by signal " + std::to_string(code);
    case End::kTimeLimit:
      return "time limit";
    case End::kNotStarted:
      return std::string("cannot be started: ") + std::strerror(code);
  }
  return "";
}

ChildResult run_child(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                      bool capture, double limit) {
  std::string path = program.string();
  std::vector<std::string> copies = arguments;
  std::vector<char*> argv{path.data()};
  for (std::string& argument : copies) argv.push_back(argument.data());
  argv.push_back(nullptr);

  // The pipe tells the end of the program even if nothing is written to it.
  int ends[2];
  ChildResult result;
  if (!make_pipe(ends)) {
    result.code = errno;
    return result;
  }
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], capture ? STDOUT_FILENO : 3);
  pid_t child = 0;
  const int error = posix_spawn(&child, path.c_str(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (error == 0) {
    if (!read_all(ends[0], limit, result.output)) {
      result.end = ChildResult::End::kTimeLimit;
      kill(child, SIGKILL);
    }
    wait_for(child, result);
  } else {
    result.code = error;
  }
  close(ends[0]);
  return result;
}

}  // namespace taut
