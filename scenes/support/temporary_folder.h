#pragma once

#include <filesystem>
#include <string>

namespace taut {

/// A folder of our own, which goes with all that is in it.
class TemporaryFolder {
 public:
  /// @throws std::invalid_argument, naming what needs it, if it cannot be made.
  explicit TemporaryFolder(const char* option);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }  ///< of the folder

 private:
  std::filesystem::path path_;
};

/// An empty file of a new name in the folder for temporary files.
/// @throws std::invalid_argument if none can be made.
std::string free_temporary_name(const std::string& start, const std::string& end);

}  // namespace taut
