#pragma once

#include <filesystem>
#include <fstream>

#include "core/world.h"

namespace taut {

/// Poses of all moving bodies over time in a CSV file: time, body, px, py, pz, qw, qx, qy, qz.
class PoseTrace {
 public:
  /// Opens the file and writes the header.
  /// @throws std::invalid_argument if the file cannot be written or the interval is negative.
  PoseTrace(const std::filesystem::path& file, double interval);

  /// Writes the present poses if the next instant k · interval has come (within half a microsecond).
  void record(const World& world);
  /// @returns false if something could not be written.
  bool flush() { return static_cast<bool>(out_.flush()); }

 private:
  std::ofstream out_;
  double interval_;
  double next_ = 0;
};

}  // namespace taut
