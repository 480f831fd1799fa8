#pragma once

#include <filesystem>

#include "scenes/program/bench_command.h"

namespace taut {

/// `taut bench --friction`: friction problems, those in tests/friction, random ones and files named as
/// arguments, in taut and in the solvers of Siconos, if that is installed.  Writes friction.json and
/// friction.md with pictures into `out`, prints where taut loses first.
/// @returns how many problems taut has not solved cold.
int bench_friction(const BenchOptions& options, const std::filesystem::path& peers,
                   const std::filesystem::path& out, const std::string& command);

}  // namespace taut
