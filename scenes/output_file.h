#pragma once

#include <string>

namespace taut {

/// Asks whether a file can be written, before anything is: one that is there stays as it is, and none is
/// made. An empty name asks for nothing.
/// @throws std::invalid_argument naming the option and the file if it cannot.
void require_writable(const char* option, const std::string& file);
/// The same for a folder that files are written to, which need not be there.
void require_writable_folder(const char* option, const std::string& folder);

}  // namespace taut
