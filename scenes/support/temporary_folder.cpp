#include "scenes/support/temporary_folder.h"

#include <unistd.h>

#include <cstdlib>

#include "core/base/check.h"

namespace taut {

TemporaryFolder::TemporaryFolder(const char* option) {
  std::error_code error;
  std::string pattern = (std::filesystem::temp_directory_path(error) / "taut-XXXXXX").string();
  if (error || !mkdtemp(pattern.data())) fail(option, "cannot make a temporary folder", pattern);
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string free_temporary_name(const std::string& start, const std::string& end) {
  std::error_code error;
  std::string pattern = (std::filesystem::temp_directory_path(error) / (start + "-XXXXXX" + end)).string();
  const int fd = error ? -1 : mkstemps(pattern.data(), static_cast<int>(end.size()));
  if (fd < 0) fail("temporary file", "cannot be made", pattern);
  close(fd);
  return pattern;
}

}  // namespace taut
