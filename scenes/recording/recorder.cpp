#include "scenes/recording/recorder.h"

#include <algorithm>
#include <charconv>

#include "core/constraints/rows.h"

namespace taut {
namespace {

using Quantity = Probe::Quantity;

struct QuantityInfo {
  std::string_view name, unit;
  std::vector<std::string> components;
};

/// Of AxisImpulse.
const std::vector<std::string>& axis_columns() {
  static const std::vector<std::string> columns = [] {
    std::vector<std::string> found;
    for (const AxisPart& part : kAxisParts)
      if (std::find(found.begin(), found.end(), part.column) == found.end()) found.emplace_back(part.column);
    return found;
  }();
  return columns;
}

const QuantityInfo& info(Quantity quantity) {
  static const std::vector<std::string> xyz{"x", "y", "z"};
  static const std::vector<QuantityInfo> table{
      {"position", "m", xyz},
      {"velocity", "m/s", xyz},
      {"orientation", "", {"w", "x", "y", "z"}},
      {"angular-velocity", "rad/s", xyz},
      {"reaction-force", "N", xyz},
      {"reaction-torque", "N m", xyz},
      {"gap", "", {"metres", "radians"}},
      {"energy", "J", {"kinetic", "potential"}},
      {"momentum", "N s", xyz},
      {"angular-momentum", "N m s", xyz},
      {"axis", "", {"value", "rate"}},
      {"axis-force", "", axis_columns()},
      {"axis-power", "W", axis_columns()},
      {"axis-state", "", {"stuck", "saturated", "at_limit"}},
  };
  return table[static_cast<std::size_t>(quantity)];
}

}  // namespace

std::string_view to_string(Quantity quantity) { return info(quantity).name; }

const char* axis_unit(const AxisInfo& axis, bool is_rate) {
  return axis.angular ? (is_rate ? "rad/s" : "rad") : (is_rate ? "m/s" : "m");
}

std::vector<std::string> units(const World& world, const Probe& probe) {
  const auto& [name, unit, components] = info(probe.quantity);
  switch (probe.quantity) {
    case Quantity::kGap:
      return {"m", "rad"};
    case Quantity::kAxis: {
      const AxisInfo& axis = world.axis_info(probe.axis);
      return {axis_unit(axis, false), axis_unit(axis, true)};
    }
    case Quantity::kAxisForce:
      return std::vector<std::string>(components.size(), world.axis_info(probe.axis).angular ? "N m" : "N");
    default:
      return std::vector<std::string>(components.size(), std::string(unit));
  }
}

const std::vector<std::string>& components(Quantity quantity) { return info(quantity).components; }

Recorder::Recorder(std::vector<Probe> probes) : probes_(std::move(probes)) {
  for (const Probe& probe : probes_) {
    const auto namesakes = std::count_if(probes_.begin(), probes_.end(),
                                         [&](const Probe& other) { return other.name == probe.name; });
    const std::string stem =
        namesakes > 1 ? probe.name + "." + std::string(to_string(probe.quantity)) : probe.name;
    for (const std::string& component : components(probe.quantity))
      columns_.push_back(stem + "." + component);
  }
}

const std::vector<double>& Recorder::sample(Simulator& simulator) {
  values_.clear();
  for (const Probe& probe : probes_) append(probe, simulator);
  return values_;
}

void Recorder::append(const Probe& probe, Simulator& simulator) {
  const World& world = simulator.world();
  switch (probe.quantity) {
    case Quantity::kPosition:
      return append(world.pose(probe.body).point(probe.point_B));
    case Quantity::kVelocity:
      return append(world.twist(probe.body).at(world.pose(probe.body).q * probe.point_B));
    case Quantity::kOrientation:
      values_.push_back(world.pose(probe.body).q.w());
      return append(world.pose(probe.body).q.vec());
    case Quantity::kAngularVelocity:
      return append(world.twist(probe.body).w);
    case Quantity::kReactionForce:
      return append(simulator.reaction(probe.joint).force);
    case Quantity::kReactionTorque:
      return append(simulator.reaction(probe.joint).torque);
    case Quantity::kGap: {
      const Gap gap = gaps(world)[probe.joint.index];
      values_.insert(values_.end(), {gap.metres, gap.radians});
      return;
    }
    case Quantity::kEnergy:
      values_.push_back(kinetic_energy(world, world.state()));
      return values_.push_back(world.potential_energy(world.state()));
    case Quantity::kMomentum:
      return append(linear_momentum(world, world.state()));
    case Quantity::kAngularMomentum:
      return append(angular_momentum(world, world.state()));
    case Quantity::kAxis:
      values_.insert(values_.end(), {world.axis_value(probe.axis), world.axis_rate(probe.axis)});
      return;
    case Quantity::kAxisForce:
      return append(simulator.axis_report(probe.axis).force);
    case Quantity::kAxisPower:
      return append(simulator.axis_report(probe.axis).power);
    case Quantity::kAxisState: {
      const AxisReport report = simulator.axis_report(probe.axis);
      return append(Vec3(report.stuck, report.saturated, report.at_limit));
    }
  }
}

/// Soft limits with the rigid ones.
void Recorder::append(const AxisImpulse& x) {
  const std::vector<std::string>& columns = axis_columns();
  const std::size_t first = values_.size();
  for (const auto& [part, column, term] : kAxisParts) {
    const std::size_t at = first + (std::find(columns.begin(), columns.end(), column) - columns.begin());
    if (at == values_.size())
      values_.push_back(x.*part);
    else
      values_[at] += x.*part;
  }
}

std::vector<Gap> Recorder::gaps(const World& world) {
  if (rows_version_ != world.topology_version()) {
    rows_ = std::make_unique<Rows>(world);
    rows_version_ = world.topology_version();
  }
  std::vector<double> phi(rows_->row_count());
  rows_->residual(world.state(), phi);
  return joint_gaps(*rows_, phi);
}

std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string shortest(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

}  // namespace taut
