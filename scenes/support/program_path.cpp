#include "scenes/support/program_path.h"

#ifdef __APPLE__
#include <mach-o/dyld.h>

#include <cstdint>
#include <string>
#endif

namespace taut {

std::filesystem::path program_path() {
  std::error_code error;
#ifdef __APPLE__
  std::uint32_t size = 0;
  (void)_NSGetExecutablePath(nullptr, &size);  // says how long it is
  std::string path(size, '\0');
  if (size == 0 || _NSGetExecutablePath(path.data(), &size) != 0) return {};
  std::filesystem::path real = std::filesystem::canonical(path.c_str(), error);
  return error ? std::filesystem::path() : real;
#else
  return std::filesystem::read_symlink("/proc/self/exe", error);
#endif
}

}  // namespace taut
