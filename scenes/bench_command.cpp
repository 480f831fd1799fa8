#include "scenes/bench_command.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <iostream>

#include "scenes/run_command.h"

namespace taut {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> benchmarks_in(const fs::path& folder, const std::string& only) {
  std::vector<fs::path> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with("_benchmark") && name.find(only) != std::string::npos) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// Runs a program to its end.  @returns true if it could be started and exited with 0.
bool run(const fs::path& program, const std::vector<std::string>& arguments) {
  std::string path = program.string();
  std::vector<std::string> copies = arguments;
  std::vector<char*> argv{path.data()};
  for (std::string& argument : copies) argv.push_back(argument.data());
  argv.push_back(nullptr);
  pid_t child = 0;
  if (const int error = posix_spawn(&child, path.c_str(), nullptr, nullptr, argv.data(), environ)) {
    std::cerr << "taut bench: cannot start " << path << ": " << std::strerror(error) << '\n';
    return false;
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

int bench_command(const std::string& build_dir, const std::string& only,
                  const std::vector<std::string>& arguments) {
  const fs::path build =
      build_dir.empty() ? fs::read_symlink("/proc/self/exe").parent_path() : fs::path(build_dir);
  const std::vector<fs::path> programs = benchmarks_in(build / "benchmarks", only);
  if (programs.empty()) {
    std::cerr << "taut bench: no benchmark" << (only.empty() ? "" : " named like " + only) << " in "
              << (build / "benchmarks").string() << "; `./taut bench` builds them\n";
    return kExitFailure;
  }
  int failed = 0;
  for (const fs::path& program : programs) {
    std::cerr << "== " << program.filename().string() << '\n';
    if (!run(program, arguments)) {
      std::cerr << "taut bench: " << program.filename().string() << " failed\n";
      ++failed;
    }
  }
  return failed == 0 ? kExitSuccess : kExitFailure;
}

}  // namespace taut
