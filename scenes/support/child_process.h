#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace taut {

/// What became of another program.
struct ChildResult {
  enum class End { kExited, kKilled, kTimeLimit, kNotStarted };
  End end = End::kNotStarted;
  int code = 0;        ///< exit status, or the signal that killed it, or errno
  std::string output;  ///< its standard output, if it was captured
  bool good() const { return end == End::kExited && code == 0; }
  /// "killed by signal 11"; "" after a good end.
  std::string message() const;
};

/// Runs a program to its end.
/// @param capture its standard output goes into the result; otherwise to ours
/// @param limit wall time after which it is killed [s]; 0: none
ChildResult run_child(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                      bool capture = false, double limit = 0);

}  // namespace taut
