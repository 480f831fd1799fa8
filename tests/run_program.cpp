#include "tests/run_program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>
#include <thread>

#include "tests/temporary.h"

namespace taut::testing {
namespace {

int exit_status_of(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

pid_t start(const std::vector<std::string>& arguments, const std::string& out, const std::string& err,
            int closed = -1) {
  std::vector<std::string> words{TAUT_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (closed >= 0) posix_spawn_file_actions_addclose(&files, closed);
  pid_t child = 0;
  const int error = posix_spawn(&child, TAUT_PROGRAM, &files, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (error) throw std::runtime_error("cannot start " TAUT_PROGRAM);
  return child;
}

}  // namespace

Outcome run_program(const std::vector<std::string>& arguments, const std::string& interrupt_at, int signal,
                    std::chrono::milliseconds wait) {
  const std::string out = temporary("stdout"), err = temporary("stderr");
  const pid_t child = start(arguments, out, err);
  if (!interrupt_at.empty()) {
    using namespace std::chrono_literals;
    for (int i = 0; i < 1000 && !std::filesystem::exists(interrupt_at); ++i)
      std::this_thread::sleep_for(10ms);
    std::this_thread::sleep_for(wait);
    kill(child, signal);
  }
  const int status = exit_status_of(child);
  return {status, read_text(out), read_text(err)};
}

Outcome run_program_into(const std::string& file, const std::vector<std::string>& arguments) {
  const std::string err = temporary("stderr");
  const int status = exit_status_of(start(arguments, file, err));
  return {status, "", read_text(err)};
}

Outcome run_program_without(int stream, const std::vector<std::string>& arguments) {
  const std::string out = temporary("stdout"), err = temporary("stderr");
  const int status = exit_status_of(start(arguments, out, err, stream));
  return {status, read_text(out), read_text(err)};
}

}  // namespace taut::testing
