#pragma once

#include <optional>
#include <string>
#include <vector>

namespace taut {

struct FrictionOptions {
  std::vector<std::string> files;
  double accuracy = 1e-8;
  std::optional<std::string> json;  ///< "-": in place of the table
  std::string solution_folder;      ///< empty: none
};

/// `taut friction`: solves problems of frictional contact from files, a line of a table for each.
/// @returns kExitSuccess if all are solved; kExitFailure if one is not, or cannot be read, or an output could
/// not be written.
/// @throws std::invalid_argument if none can be read, options exclude each other, or an output cannot be
/// written; nothing is written then.
int friction_command(const FrictionOptions& options);

}  // namespace taut
