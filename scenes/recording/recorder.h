#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/constraints/rows.h"
#include "core/world/diagnostics.h"
#include "scenes/builders/scene.h"
#include "solvers/simulator/simulator.h"

namespace taut {

/// Its name, as scene files have it.
std::string_view to_string(Probe::Quantity quantity);
/// "rad" or "m" of a coordinate, "rad/s" or "m/s" of its rate.
const char* axis_unit(const AxisInfo& axis, bool is_rate);
/// Units of the components of what a probe reads, "m", "N", …: of an axis as it turns or slides.
std::vector<std::string> units(const World& world, const Probe& probe);
/// Names of the numbers that a quantity consists of: x y z, w x y z, metres radians, value rate, ….
const std::vector<std::string>& components(Probe::Quantity quantity);

/// Reads the probes of a scene from a simulator.
class Recorder {
 public:
  explicit Recorder(std::vector<Probe> probes);

  const std::vector<Probe>& probes() const { return probes_; }  ///< as given
  /// One name per number: tip.x, or tip.velocity.x where several probes are called tip.
  const std::vector<std::string>& columns() const { return columns_; }
  /// The present values, one per column.
  const std::vector<double>& sample(Simulator& simulator);

 private:
  void append(const Probe& probe, Simulator& simulator);
  void append(const Vec3& v) { values_.insert(values_.end(), {v.x(), v.y(), v.z()}); }
  void append(const AxisImpulse& x);
  std::vector<Gap> gaps(const World& world);

  std::vector<Probe> probes_;
  std::vector<std::string> columns_;
  std::vector<double> values_;
  std::unique_ptr<Rows> rows_;  // for gaps, of topology version rows_version_
  int rows_version_ = -1;
};

/// A field of a CSV line, quoted if it has to be [RFC 4180].
std::string csv_field(std::string_view text);
/// The shortest decimal text that reads back as the same double; nan, inf, -inf.
std::string shortest(double value);

}  // namespace taut
