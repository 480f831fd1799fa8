#pragma once

#include <chrono>
#include <csignal>
#include <string>
#include <vector>

namespace taut::testing {

/// What a program left behind.
struct Outcome {
  int exit_status = -1;  ///< 128 + the signal if one killed it
  std::string out, err;
};

/// Runs the taut program with these arguments to its end, without a terminal.
/// @param interrupt_at send the signal this long after this file has appeared; empty: never
Outcome run_program(const std::vector<std::string>& arguments, const std::string& interrupt_at = "",
                    int signal = SIGINT, std::chrono::milliseconds wait = std::chrono::milliseconds(200));

/// The same with what it prints going to this file, which is not read.
Outcome run_program_into(const std::string& file, const std::vector<std::string>& arguments);

/// The same started without this standard stream, as by `>&-`.
Outcome run_program_without(int stream, const std::vector<std::string>& arguments);

}  // namespace taut::testing
