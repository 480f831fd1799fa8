#pragma once

#include <span>

#include "core/constraints/rows.h"
#include "solvers/complementarity/stage_problem.h"
#include "solvers/complementarity/stage_tuning.h"
#include "solvers/laws/contact_forces.h"
#include "solvers/laws/contact_residual.h"
#include "solvers/system/constraint_system.h"

namespace taut {

/// How far impulses and rates of a stage are from their laws: the natural residual
///
///     max_r √S_rr |λ_r − prox_{S_rr}(λ_r − w_r/S_rr)| / scale
///
/// over the rows of axes and contacts.  The scale is the size of impulses and rates [√J], and for a row at
/// least what round-off of poses and twists makes of its rate, over 1e-9, so that nothing is not measured by
/// nothing; where contacts may be, of poses in both stages.  (solvers/complementarity, Eq. 4)
class StageResidual {
 public:
  using Noise = RateSize;  ///< of rates, angular and linear [rad/s, m/s]

  StageResidual(const ConstraintSystem& system, const ContactForces& contacts)
      : system_(system), contacts_(contacts) {}

  /// Rates are differences of poses over h in a system of this size [m]; `twists` are looked at during the
  /// stage.
  void begin_positions(double h, double size, std::span<const Twist> twists);
  /// Rates are those of twists.
  void begin_velocities(std::span<const Twist> twists);
  /// The present stage's round-off is that of worlds with contacts.
  void note_round_off() { contact_noise_ = rate_noise(); }

  /// The natural residual, with no tolerance.
  double natural(const StageSolution& solution) const;
  /// What is enough of it.
  double natural_tolerance() const;
  /// Without contacts no tolerance of rates makes up for the laws of axes.
  bool exact(const StageSolution& solution) const;
  /// Rates that laws may be missed by where the tolerances of positions and velocities have let too much
  /// pass.
  double exact_rate_tolerance() const;
  /// How far the motion is from the laws of the rows of joints and axes in a step of h [m or rad], as
  /// motion_residual() of each, with what is negligible beside the largest impulse.
  double motion(const StageSolution& solution, double h) const;

  /// Size of impulses and rates in a stage [√J]: the largest √S_rr |λ_r|, |b_r|/√S_rr, and of the rates that
  /// laws impose over √S_rr.
  double scale(const StageSolution& solution) const;
  /// The natural residual of row r, of a joint or a spring.
  double of_row(int r, const StageSolution& solution, double scale, const Noise& noise) const;

 private:
  using Tuning = StageTuning;

  Noise rate_noise() const;
  static Noise round_off_of(std::span<const Twist> twists);

  const ConstraintSystem& system_;
  const ContactForces& contacts_;
  double h_ = 0, size_ = 1;  // over which rates are differences of poses, of a system of this size [m]
  std::span<const Twist> twists_;
  Noise start_;          // of the speeds that the position stage began with
  Noise contact_noise_;  // rate_noise() of the position stage; where contacts may be, of both
};

}  // namespace taut
