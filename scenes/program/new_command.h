#pragma once

#include <string>

namespace taut {

struct NewOptions {
  std::string file;
  std::string name = "machine";  ///< of the template
  bool list = false, force = false;
  std::string program = "taut";  ///< as it was called, for what is printed to be typed
};

/// `taut new`: writes a commented scene to begin with, or lists the templates.
/// @throws std::invalid_argument if the file is there and `force` is not given, if it does not end in .json
/// or cannot be written, and for an unknown template.  @returns the exit status.
int new_command(const NewOptions& options);

/// `taut schema`: prints the JSON Schema of scene files.  @returns the exit status.
int schema_command();

}  // namespace taut
