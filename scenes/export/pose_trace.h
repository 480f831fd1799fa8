#pragma once

#include <string>

#include "core/world/world.h"
#include "scenes/support/output_file.h"

namespace taut {

/// Poses of all moving bodies over time in a CSV file: time, body, px, py, pz, qw, qx, qy, qz.
class PoseTrace {
 public:
  /// Opens the file and writes the header.
  /// @throws std::invalid_argument if the file cannot be written or the interval is negative.
  PoseTrace(const std::string& file, double interval);

  /// Writes the present poses if the next instant k · interval has come (within half a microsecond).
  void record(const World& world);
  /// @returns what could not be written; "" as a rule.
  std::string finish() { return out_.finish() ? "" : out_.error(); }

 private:
  OutputFile out_;
  double interval_;
  double next_ = 0;
};

}  // namespace taut
