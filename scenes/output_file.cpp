#include "scenes/output_file.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>

#include "core/check.h"

namespace taut {
namespace {

namespace fs = std::filesystem;

/// Makes the file that is not there, and takes it away again.
bool can_make(const std::string& file) {
  if (!std::ofstream(file, std::ios::binary | std::ios::app)) return false;
  std::error_code ignored;
  fs::remove(fs::canonical(file, ignored), ignored);  // a link to nowhere stays one
  return true;
}

}  // namespace

void require_distinct(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs) {
  std::map<fs::path, const char*> taken;
  const auto place_of = [](const std::string& file) {
    std::error_code ignored;
    const fs::path place = fs::weakly_canonical(fs::absolute(file, ignored), ignored);
    return fs::is_character_file(place, ignored) ? fs::path() : place;
  };
  for (const NamedFile& input : inputs)
    if (!input.file.empty()) taken.emplace(place_of(input.file), input.option);
  taken.erase(fs::path());
  for (const NamedFile& output : outputs) {
    const fs::path place = output.file.empty() ? fs::path() : place_of(output.file);
    if (place.empty()) continue;
    if (const auto [other, is_new] = taken.emplace(place, output.option); !is_new)
      fail(output.option, std::string("must not be the file of ") + other->second, output.file);
  }
}

void require_writable(const char* option, const std::string& file) {
  if (file.empty()) return;
  std::error_code ignored;
  const fs::file_status status = fs::status(file, ignored);
  const bool good =
      fs::exists(status) ? !fs::is_directory(status) && access(file.c_str(), W_OK) == 0 : can_make(file);
  if (!good) fail(option, "cannot write the file", file);
}

void require_writable_folder(const char* option, const std::string& folder) {
  if (folder.empty()) return;
  std::error_code ignored;
  fs::path there = fs::absolute(folder, ignored);
  while (!fs::exists(there, ignored) && there.has_relative_path()) there = there.parent_path();
  if (!fs::is_directory(there, ignored) || access(there.c_str(), W_OK | X_OK) != 0)
    fail(option, "cannot write to the folder", folder);
}

}  // namespace taut
