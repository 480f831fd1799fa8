#pragma once

#include <vector>

#include "core/world/world.h"
#include "solvers/common/settings.h"
#include "solvers/common/step_report.h"
#include "solvers/integrators/runge_kutta.h"
#include "solvers/integrators/scheme.h"
#include "solvers/system/constraint_system.h"

namespace taut {

/// The force-level scheme: joint forces from the acceleration equation,
///
///     (S + Σ) λ = −(γ + J M⁻¹ (f − ω × Iω) + feedback),      V̇ = M⁻¹ (f − ω × Iω + Jᵀ λ),
///
/// integrated by semi-implicit Euler or the classical Runge–Kutta method of order 4.  Nothing in it closes
/// the joints, so that they drift; the cures that the literature compares are settings (DriftCure).
/// (solvers/integrators, "Force level")
class ForceLevel final : public Scheme {
 public:
  ForceLevel(const World& world, ConstraintSystem& system, const Settings& settings);

  /// It drifts from where it is.
  bool closes_joints() const override { return false; }
  bool knows_works() const override { return false; }
  void start(const State& state, Velocities /*velocities*/, SubstepReport& /*report*/) override {
    state_ = state;
  }
  /// One step of h > 0: kDone, or kNotFinite with the old state.
  [[nodiscard]] Outcome advance(double h, SubstepReport& report) override;

  void set_time(double time) override { state_.time = time; }
  const State& state() const override { return state_; }
  BodyId not_finite() const override { return {not_finite_}; }
  std::span<const Wrench> momenta() const override;
  /// Joint forces at the start of the last step, times h.
  std::span<const double> impulses() const override { return impulses_; }

  void transfer(Archive& archive) override;

 private:
  /// V̇ at a state, with multipliers λ.
  void accelerate(const State& state, double h, SubstepReport& report, std::vector<Twist>& acceleration);
  void euler(double h, SubstepReport& report);
  void runge_kutta(double h, SubstepReport& report);
  void cure_velocities(double h, SubstepReport& report);
  void cure_positions(SubstepReport& report);
  void add_penalty_forces(const State& state, std::vector<Wrench>& wrenches);
  void project_velocities(std::span<const double> target, SubstepReport& report);

  const World& world_;
  ConstraintSystem& system_;
  const Settings& settings_;
  State state_, backup_;
  RungeKutta runge_kutta_;
  int not_finite_ = 0;
  std::vector<Wrench> forces_, joint_wrenches_;
  mutable std::vector<Wrench> momenta_;  // made when they are asked for
  std::vector<Twist> acceleration_;
  std::vector<double> lambda_, impulses_, phi_, rates_, delta_, penalty_inertia_;
};

}  // namespace taut
