#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace taut::fuzz {

/// Blind mutations of what a corpus has, for builds without libFuzzer: optimised ones try a hundred times as
/// many inputs in the same time as those with checks, and see what ends the process, takes 10 s of processor
/// time, or breaks what the harness promises.
struct MutantOptions {
  double seconds = 0;
  std::uint32_t seed = 1;
  std::size_t longest = 8192;         ///< bytes of an input
  std::filesystem::path dictionary;   ///< as libFuzzer reads it; empty: none
  std::filesystem::path finds = ".";  ///< folder for the input that ended the process
};

/// @returns how many were tried.
long try_mutants(const std::vector<std::string>& corpus, const MutantOptions& options);

}  // namespace taut::fuzz
