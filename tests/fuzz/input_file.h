#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/world/world.h"

namespace taut::fuzz {

/// The checkout: its scene files name mesh files beside them.
std::string source_dir();

/// A file in memory, for what reads from paths only.
class InputFile {
 public:
  /// With an extension such as ".obj" its path has that.
  explicit InputFile(const std::string& extension = "");
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  /// All that it holds from now on.
  void set(std::string_view bytes);
  const std::filesystem::path& path() const { return path_; }

 private:
  int descriptor_ = -1;
  std::filesystem::path path_;
  bool is_link_ = false;
};

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

bool is_finite(const World& world);

/// Ends the process with the message, so that libFuzzer keeps the input.
[[noreturn]] void found(const std::string& what);

}  // namespace taut::fuzz
