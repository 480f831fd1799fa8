#pragma once

#include <string>
#include <vector>

namespace taut {

/// `taut bench`: runs every *_benchmark beside the program, or under `build_dir`, one after the other with
/// these arguments.
/// @param only run those whose name contains it; empty: all
/// @returns kExitSuccess, or kExitFailure if one failed or there is none.
int bench_command(const std::string& build_dir, const std::string& only,
                  const std::vector<std::string>& arguments);

}  // namespace taut
