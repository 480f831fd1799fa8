#include "scenes/support/temporary_folder.h"

#include <cerrno>
#include <cstdio>
#include <random>
#include <string_view>
#include <system_error>

#include "core/base/check.h"

// By the standard library alone, on every system alike.
namespace taut {
namespace {

constexpr int kAttempts = 100;

/// Six letters and digits, which nobody foresees.
std::string random_letters() {
  static constexpr std::string_view kLetters =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";
  std::random_device device;
  std::uniform_int_distribution<std::size_t> place(0, kLetters.size() - 1);
  std::string letters;
  for (int i = 0; i < 6; ++i) letters += kLetters[place(device)];
  return letters;
}

}  // namespace

TemporaryFolder::TemporaryFolder(const char* option) {
  std::error_code error;
  const std::filesystem::path parent = std::filesystem::temp_directory_path(error);
  for (int attempt = 0; !error && attempt < kAttempts; ++attempt) {
    path_ = parent / ("taut-" + random_letters());
    if (!std::filesystem::create_directory(path_, error)) continue;  // someone has this name
    std::filesystem::permissions(path_, std::filesystem::perms::owner_all, error);
    return;
  }
  fail(option, "cannot make a temporary folder", (parent / "taut-XXXXXX").string());
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string free_temporary_name(const std::string& start, const std::string& end) {
  std::error_code error;
  const std::filesystem::path parent = std::filesystem::temp_directory_path(error);
  for (int attempt = 0; !error && attempt < kAttempts; ++attempt) {
    const std::string name = (parent / (start + "-" + random_letters() + end)).string();
    if (std::FILE* file = std::fopen(name.c_str(), "wbx")) {  // x: only if nobody has this name
      (void)std::fclose(file);
      std::filesystem::permissions(
          name, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write, error);
      return name;
    }
    if (errno != EEXIST) break;
  }
  fail("temporary file", "cannot be made", (parent / (start + "-XXXXXX" + end)).string());
}

}  // namespace taut
