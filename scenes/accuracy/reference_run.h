#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scenes/accuracy/reference_case.h"
#include "solvers/common/settings.h"

namespace taut::reference {

/// How a case is run and what its quantities are held to.
struct RunPlan {
  Settings settings;
  /// Takes the integrator that integrator_for() names in place of that of the settings.
  bool choose_integrator = true;
  double step = 1;              ///< as a fraction of the step that the tolerances are for
  std::optional<double> end{};  ///< quantities after it are left out [s]
  bool limit = false;           ///< hold them to the limit tolerance
};

enum class Verdict {
  kPass,
  kFail,
  kNotMeasured,
  kOrientation,  ///< the file gives the value for orientation only
};
const char* to_string(Verdict verdict);

/// Reason of a quantity that has no probe.
inline constexpr const char* kNoProbe = "the file does not say how to measure it";
/// Of a quantity without a probe.
inline std::string why_not_measured(const Quantity& quantity) {
  return quantity.orientation.empty() ? kNoProbe : quantity.orientation;
}

/// What became of one quantity.
struct Measurement {
  std::string name{};
  std::optional<double> time{};
  Verdict verdict = Verdict::kNotMeasured;
  std::vector<double> reference{}, measured{};  ///< measured where the error is largest
  double error = 0;                             ///< largest |measured − reference|
  double allowed = 0;                           ///< scaled tolerance and uncertainty of the reference
  std::string reason{};                         ///< why it was not measured or could not be met
};

struct CaseRun {
  std::string id{}, level{};
  Integrator integrator = Integrator::kRattle;
  double dt = 0;         ///< [s]
  double fraction = 1;   ///< of the case's own step
  double wall_time = 0;  ///< [s]
  double max_gap = 0;    ///< largest joint error after any step [m or rad]
  long steps = 0;        ///< done by the simulator
  std::string failed{};  ///< what the step said that failed, with its time; empty: none did
  std::vector<Measurement> quantities{};

  int count(Verdict verdict) const;
};

/// The composition of order 4, or RATTLE where something acts along free axes or between shapes, which the
/// compositions cannot have: their stages go back in time.
Integrator integrator_for(const Case& reference);

/// uncertainty + tolerance (dt/tol_dt)^p, p = 2 in smooth and 1 in nonsmooth cases, else 0; never below the
/// limit.
double allowed_error(const Case& reference, const Quantity& quantity, const RunPlan& plan);

/// Builds a case from its file, runs it and measures every quantity that has a probe.
///
/// - smooth, nonsmooth: constants of the motion are compared at every time of the case, worst of all;
/// - static: at t = 0 and again after 50 steps, which must leave an equilibrium where it is.  A start that is
///   no equilibrium is relaxed first (velocities are set to zero whenever the kinetic energy falls);
/// - impulse: just after the impulses, and in the motion that follows if the case has one;
/// - frequency: `omega_k` by swinging the simulator in mode k and, to the limit tolerance, from the
///   eigenvalues of the linearised rows; mode shapes from their eigenvectors.
///
/// What fails in a run is in the result.  @throws std::exception as load_case().
CaseRun run_case(const std::filesystem::path& file, const RunPlan& plan = {});

}  // namespace taut::reference
