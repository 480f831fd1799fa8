#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "core/world/world.h"
#include "scenes/accuracy/reference_run.h"
#include "solvers/simulator/simulator.h"

/// `taut accuracy --contacts`: worlds with contact against closed forms and laws.
namespace taut::reference {

/// The step of a run that gave the most of something.
struct WorstStep {
  double work = std::numeric_limits<double>::quiet_NaN();  ///< over the energy at the start
  double time = 0;                                         ///< at its end [s]
};

/// What the ledger and the status of the steps of a run say.
struct LawRecord {
  WorstStep contacts{};       ///< what contacts gave by their normal impulses: never above 0
  WorstStep with_friction{};  ///< and friction with them: never above 0
  long steps = 0, inexact = 0;
  std::string failed{};  ///< what the step said that failed, with its time; empty: none did
};

/// A run of a world that keeps a LawRecord; several may share one.
class ContactCourse {
 public:
  ContactCourse(World world, double dt, LawRecord& laws, Settings settings = {});
  ContactCourse(const ContactCourse&) = delete;
  ContactCourse& operator=(const ContactCourse&) = delete;

  /// Steps until `time` [s].  @param each runs after every step; false ends the run early
  /// @returns false if a step failed
  bool run(double time, const std::function<bool()>& each = nullptr);
  World& world() { return world_; }
  Simulator& simulator() { return simulator_; }
  const Pose& pose(int body) const { return world_.pose(BodyId{body}); }
  const Twist& twist(int body) const { return world_.twist(BodyId{body}); }
  double start_energy() const { return start_; }
  /// Kinetic energy and potential over that at the start, minus 1; recomputed from poses and twists.
  double drift() const;

 private:
  World world_;
  double dt_;
  LawRecord& laws_;
  double start_, scale_;  ///< energy at the start [J], and its size with what moves then
  Simulator simulator_;
};

/// How a measured value is compared with what is true.
enum class Comparison {
  kNear,       ///< |measured − truth| ≤ allowed
  kAtMost,     ///< measured ≤ truth + allowed
  kConverges,  ///< no truth is known: values at two successive steps differ by at most what is allowed
};

/// One row of the table.
struct Truth {
  std::string what;    ///< is measured, with its unit
  std::string source;  ///< of the truth: a formula or a law
  double value = 0;    ///< the truth
  Comparison comparison = Comparison::kNear;
  double allowed = 0;  ///< at a step of 1 ms, at others times (h/1 ms)^power
  int power = 0;
  double order = 0;  ///< least order that is to be observed; 0: none is asked for
};
/// Of the largest |E/E₀ − 1| at any time where energy stays, and of E/E₀ − 1 where it may only be lost.  @{
Truth energy_stays(const char* source, double allowed, int power, double order = 0);
Truth energy_never_grows(const char* source, double allowed, int power);  /// @}

/// A world, the steps that it is run with, longest first, and what is measured in each run.
struct ContactCase {
  std::string name, what;
  std::vector<double> steps;  ///< [s]
  std::vector<Truth> truths;
  /// A value for each truth, NaN if the run ended before.
  std::function<std::vector<double>(double dt, LawRecord& laws)> measure;
};

/// All of them, in the order of the table.
std::vector<ContactCase> contact_cases();
std::vector<ContactCase> impact_cases();    ///< the part with impacts
std::vector<ContactCase> rolling_cases();   ///< … with bodies that roll and slide on curved surfaces
std::vector<ContactCase> friction_cases();  ///< … with friction

/// A row with what was measured.
struct TruthResult {
  Truth truth;
  std::vector<double> measured{}, error{},
      allowed{};                            ///< at each step; errors of kConverges: the last change
  double order = 0;                         ///< observed at the two shortest steps; NaN: none is seen
  Verdict verdict = Verdict::kNotMeasured;  ///< kPass or kFail
  std::string note{};                       ///< where the worst was
};
struct ContactResult {
  std::string name, what;
  std::vector<double> steps;
  std::vector<TruthResult> truths{};  ///< and at their end, the laws that hold in every run
  std::vector<LawRecord> laws{};      ///< at each step
  double wall_time = 0;               ///< [s]

  bool good() const;
};

/// Runs a case at its steps, and compares.
ContactResult run_contact_case(const ContactCase& wanted);
/// The verdict on what was measured at these steps.
TruthResult judge(const Truth& truth, const std::vector<double>& steps, const std::vector<double>& measured);

}  // namespace taut::reference
