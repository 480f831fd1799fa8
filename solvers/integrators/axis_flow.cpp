#include "solvers/integrators/axis_flow.h"

#include <algorithm>
#include <cmath>

#include "solvers/laws/axes/axis_motor_law.h"
#include "solvers/laws/axes/axis_smooth_law.h"

namespace taut {
namespace {

/// What a motor with gains gives without its bounds.
double servo_force(const AxisMotor& motor, double time, double theta, double rate) {
  const MotionPoint target = target_at(motor, time);
  const double stretch = motor.stiffness > 0 ? target.value - theta : 0;
  return motor.stiffness * stretch + motor.damping * (target.rate - rate);
}

/// What acts along an axis; `saturated`: the motor gives all it has.
AxisImpulse axis_forces(const AxisProperties& p, double time, double theta, double rate, bool& saturated) {
  AxisImpulse force;
  saturated = false;
  if (p.spring) {
    force.spring = spring_force(*p.spring, theta);
    force.damping = damping_force(*p.spring, rate);
  }
  if (p.friction) force.damping -= p.friction->viscous * rate;
  if (p.limits && p.limits->compliance > 0)
    if (const double excess = beyond(*p.limits, theta); excess != 0) {
      force.elastic_limit = -excess / p.limits->compliance;
      force.damping -= p.limits->damping * rate;
    }
  p.each([&]<typename Property>(const Property& property) {
    if constexpr (SmoothAxisProperty<Property>) {
      const double stored = stored_force(property, theta), given = property.force(theta, rate);
      force.*kAxisPartOf<Property> = stored;
      force.*loss_part<Property>() += given - stored;
    }
  });
  if (p.motor && p.motor->has_gains()) {
    const double wanted = servo_force(*p.motor, time, theta, rate);
    const double available = available_force(*p.motor, std::abs(rate));
    saturated = std::abs(wanted) > available;
    force.motor = saturated ? std::copysign(available, wanted) : wanted;
  }
  return force;
}

}  // namespace

AxisFlow::AxisFlow(const World& world, const Rows& rows) : table_(world, rows) {
  reports_.resize(table_.size());
  forces_.resize(table_.size());
  rates_.resize(table_.size());
  table_.refresh();
}

void AxisFlow::begin() {
  table_.refresh();
  std::fill(reports_.begin(), reports_.end(), AxisReport{});
}

double AxisFlow::work() const {
  double sum = 0;
  for (const AxisReport& axis : reports_) sum += axis.work.total();
  return sum;
}

void AxisFlow::begin_substep() { before_ = reports_; }

void AxisFlow::roll_back() { reports_ = before_; }

void AxisFlow::find(double time, std::span<const double> theta, std::span<const double> rates,
                    std::span<double> tau) {
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const int row = table_.row(i);
    forces_[i] = axis_forces(table_.properties(i), time, theta[row], rates[row], reports_[i].saturated);
    rates_[i] = rates[row];
    tau[row] = forces_[i].total();
  }
}

void AxisFlow::add(double time) {
  for (std::size_t i = 0; i < table_.size(); ++i)
    for (const auto& [part, column, term] : kAxisParts) {
      const double impulse = time * forces_[i].*part;
      reports_[i].force.*part += impulse;
      reports_[i].work.*part += impulse * rates_[i];
    }
}

}  // namespace taut
