#pragma once

#include <string>
#include <vector>

namespace taut {

/// A file of a command, and the option that says which; no name: none.
struct NamedFile {
  const char* option;
  std::string file;
};
/// @throws std::invalid_argument, naming both options, if one of two is to be written and they are the same
/// file, however they spell it.  Devices take any number.
void require_distinct(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs);

/// Asks whether a file can be written, before anything is: one that is there stays as it is, and none is
/// made. An empty name asks for nothing.
/// @throws std::invalid_argument naming the option and the file if it cannot.
void require_writable(const char* option, const std::string& file);
/// The same for a folder that files are written to, which need not be there.
void require_writable_folder(const char* option, const std::string& folder);

}  // namespace taut
