#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "scenes/accuracy/reference_case.h"
#include "scenes/accuracy/reference_contacts.h"
#include "solvers/simulator/simulator.h"

namespace taut::reference {

/// There is no way to measure it, whatever the run.
class NotMeasured : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Measures what the probes of a case describe on a running Simulator.  Angles count their turns and some
/// kinds look at the whole run, so observe() must be called after every step.
class Probes {
 public:
  using Json = nlohmann::json;
  using Values = std::vector<double>;

  /// Remembers the start; the simulator must not have moved yet.
  Probes(const Case& reference, Simulator& simulator);

  void observe();
  static bool knows(const Json& probe);
  /// True for what only the whole run shows, such as a period.
  static bool is_about_the_run(const Json& probe);
  /// @throws std::runtime_error if the run has not shown it yet, such as a period before its second crossing.
  Values evaluate(const Json& probe);

 private:
  using Measure = Values (Probes::*)(const Json&);
  static const std::map<std::string, Measure>& measures();

  /// Rotation about an axis since the start; relative to another body in that body's axes.
  struct Angle {
    BodyId body, other;
    Vec3 axis;
    Quat start;
    double value = 0;
  };
  /// The last samples of a scalar, its two latest upward crossings of a level, and its extremes.
  struct Trace {
    Json of;
    double level = 0;
    std::vector<double> t, x;  ///< at most four samples
    std::vector<double> crossings;
    double minimum = 0, maximum = 0;
  };

  /// Impacts of a pair or at the limit of a joint, and values next to them.
  struct Impacts {
    std::vector<double> times;
    std::map<std::string, std::vector<Values>> before, after;  ///< by the text of what is measured
    std::map<std::string, Values> now;
  };
  /// Passages of a scalar through a level, and values on both sides of each.
  struct Crossings {
    struct Sample {
      double time = 0;
      Values values;
    };
    /// What is measured there; its limits from both sides are straight lines through two samples of that
    /// side.
    struct Measured {
      Sample last, before_last;
      std::vector<Values> before, at, after;
    };
    Json of;
    double level = 0;
    int direction = 0;  ///< 1: upwards, -1: downwards, 0: both
    double t = 0, x = 0;
    std::vector<double> times;
    std::map<std::string, Measured> measured;  ///< by its text
  };
  /// Turning points of a scalar.
  struct Turns {
    Json of;
    std::vector<double> t, x;  ///< at most three samples
    std::vector<double> times, values;
  };
  /// Since when a body is at rest.
  struct Rest {
    bool moving = true;
    double since = 0;
  };

  void subscribe(const Json& probe);
  void subscribe_events(const Json& probe);
  void observe_events();
  void observe(const std::string& where, Impacts& impacts);
  std::optional<double> last_impact(const std::string& where) const;
  void observe(Turns& turns);
  void observe(Crossings& crossings);
  /// After a step, in which the last of `times` lies if `passes`.
  static void observe(const std::vector<double>& times, bool passes, const Crossings::Sample& now,
                      Crossings::Measured& measured);
  void observe(BodyId body, Rest& rest);
  /// Times and places of all impacts of the pairs of a probe, in order.
  std::vector<std::pair<double, int>> impacts_among(const Json& probe) const;
  void sample(Trace& trace);
  const State& state() const { return simulator_.world().state(); }
  Quat relative_rotation(const Angle& angle) const;
  /// Angular and linear acceleration from the forces and the joint reactions at this instant.
  Twist acceleration(BodyId body);
  JointId joint(const Json& probe) const;
  double sign_on(const Json& probe) const;
  double multiplier_of(const std::string& joint);
  AxisReport axis_report(const Json& probe) const;
  const Pair& pair(const Json& probe) const;
  Values contact_force(const Json& probe);
  Values contact_normal_sum(const Json& probe);
  double energy_of_carriers(bool kinetic_only) const;

  Values point(const Json& probe);
  Values angular_velocity(const Json& probe);
  Values angular_acceleration(const Json& probe);
  Values rotation_matrix(const Json& probe);
  Values angle(const Json& probe);
  Values joint_force(const Json& probe);
  Values joint_torque(const Json& probe);
  Values joint_tension(const Json& probe);
  Values energy(const Json& probe);
  Values kinetic(const Json& probe);
  Values energy_drift(const Json& probe);
  Values momentum(const Json& probe);
  Values moment_of_momentum(const Json& probe);
  Values centre(const Json& probe);
  Values radial_speed(const Json& probe);
  Values crossing_period(const Json& probe);
  Values extremum_in_time(const Json& probe);
  Values multiplier(const Json& probe);
  Values motor_torque(const Json& probe);
  Values limit_torque(const Json& probe);
  Values rest_time(const Json& probe);
  Values impact_time(const Json& probe);
  Values at_impact(const Json& probe);
  Values turning_time(const Json& probe);
  Values turning_value(const Json& probe);
  Values final_value(const Json& probe);
  Values first_value(const Json& probe);
  Values initial_rate(const Json& probe);
  Values crossing_time(const Json& probe);
  Values at_crossing(const Json& probe);
  Values impact_count(const Json& probe);
  Values impact_order(const Json& probe);
  Values contact_sliding(const Json& probe);
  Values centre_of_pressure(const Json& probe);
  Values axial_force(const Json& probe);
  Values direction(const Json& probe);
  Values ratio(const Json& probe);
  Values constant(const Json& probe);
  Values time(const Json& probe);
  Values list(const Json& probe);
  Values sum(const Json& probe);
  Values extremum(const Json& probe);
  Values norm(const Json& probe);

  const Case& case_;
  Simulator& simulator_;
  State start_;
  double start_energy_;
  std::map<std::string, Angle> angles_;  ///< by the text of their probe
  std::map<std::string, Trace> traces_;
  std::map<std::string, Impacts> impacts_;      ///< by the text of the joint or pair
  std::map<std::string, Turns> turns_;          ///< by the text of their scalar
  std::map<std::string, Rest> rests_;           ///< by body
  std::map<std::string, Crossings> crossings_;  ///< by their text
  /// By the text of what is measured: at the start of the run, then after its first step.
  std::map<std::string, std::vector<Values>> firsts_;
  double first_step_ = 0;  ///< [s]
};

}  // namespace taut::reference
