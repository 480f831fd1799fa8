#include "tests/fuzz/input_file.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace taut::fuzz {

std::string source_dir() { return TAUT_SOURCE_DIR; }

InputFile::InputFile(const std::string& extension)
    : descriptor_(memfd_create("input", 0)),
      path_("/proc/self/fd/" + std::to_string(descriptor_)),
      is_link_(!extension.empty()) {
  if (descriptor_ < 0) found("no file in memory can be had");
  if (!is_link_) return;
  const std::filesystem::path link =
      std::filesystem::temp_directory_path() / ("taut-fuzz-" + std::to_string(getpid()) + extension);
  std::filesystem::remove(link);
  std::filesystem::create_symlink(path_, link);
  path_ = link;
}

InputFile::~InputFile() {
  std::error_code ignored;
  if (is_link_) std::filesystem::remove(path_, ignored);
  close(descriptor_);
}

void InputFile::set(std::string_view bytes) {
  if (ftruncate(descriptor_, 0) != 0 ||
      pwrite(descriptor_, bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    found("the file in memory cannot be written");
}

bool is_finite(const World& world) {
  for (int b = 0; b < world.body_count(); ++b) {
    const Pose& pose = world.pose(BodyId{b});
    const Twist& twist = world.twist(BodyId{b});
    if (!pose.p.allFinite() || !pose.q.coeffs().allFinite() || !twist.v.allFinite() || !twist.w.allFinite())
      return false;
  }
  return std::isfinite(world.time());
}

void found(const std::string& what) {
  std::fprintf(stderr, "FOUND: %s\n", what.c_str());
  std::abort();
}

}  // namespace taut::fuzz
