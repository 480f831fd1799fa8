#pragma once

#include <span>
#include <vector>

#include "solvers/integrators/impact_search.h"
#include "solvers/integrators/implicit_tension.h"
#include "solvers/integrators/impulse_scheme.h"
#include "solvers/integrators/position_projection.h"
#include "solvers/integrators/start_jacobian.h"

namespace taut {

/// RATTLE [Andersen1983] on rigid bodies, the default integrator.  One step of length h from (q₀, p₀), where
/// p = M V are the momenta in world axes and S(q₀) is already factored:
///
///   kick        p  = p₀ + h/2 f(q₀) + J(q₀)ᵀ λ
///   drift       q₁ = free flow of (q₀, p) over h, with λ such that φ(q₁) = 0     (simplified Newton, S(q₀))
///   factor      S(q₁)
///   kick        p₁ = p + h/2 f(q₁) + J(q₁)ᵀ μ, with μ such that J(q₁) M⁻¹ p₁ = 0               (one solve)
///
/// The next step starts with the factor of S(q₁): one factorisation a step.   (solvers/integrators, "RATTLE")
class Rattle : public ImpulseScheme {
 public:
  Rattle(const World& world, ConstraintSystem& system, const Settings& settings);

  void start(const State& state, Velocities velocities, SubstepReport& report) override;
  [[nodiscard]] Outcome advance(double h, SubstepReport& report) override;
  double time_to_event() const override { return time_to_event_; }
  void transfer(Archive& archive) override;

 protected:
  void begin_step(double h, std::span<double> lambda, SubstepReport& report);
  bool exceeds_tension_limit(double h, std::span<const double> lambda);
  void accept_positions(double h, std::span<const double> lambda, std::span<const Pose> q1,
                        SubstepReport& report);
  void factorize_end(std::span<const double> lambda, SubstepReport& report);
  void finish(double h, std::span<const double> lambda, std::span<const double> mu, SubstepReport& report);
  Outcome reject(Outcome outcome, SubstepReport& report);
  Outcome take_back(Outcome outcome, SubstepReport& report);

  // The position stage: from λ as it is predicted to the one with φ(q₁) = 0.
  void predict_multipliers(double h, std::span<double> lambda);
  bool close_joint_positions(double h, std::span<double> lambda, std::span<Pose> q1, SubstepReport& report);
  double correct_multipliers(double h, bool from_closure, std::span<double> lambda);
  bool close_bounded_positions(double h, std::span<double> lambda, std::span<Pose> q1, SubstepReport& report);
  struct PositionError;
  PositionError position_error(double h, std::span<const double> lambda, int iteration);
  bool give_up(std::span<const double> lambda, std::span<const double> rates);
  void finish_position_laws(std::span<const double> lambda);
  bool stabilize_positions(double h, std::span<double> lambda, std::span<Pose> q1, SubstepReport& report);
  void begin_bounds(double h);
  void try_positions(double h, std::span<const double> lambda, std::span<Pose> q1, bool near);
  void kick_and_drift(double h, std::span<const double> lambda, std::span<Pose> q1, const Configuration& end,
                      std::span<double> phi);
  void contact_rates(double h, std::span<const Pose> q1, bool near, std::span<double> rates);
  bool keep_pace(double error, double last, double h, std::span<const Pose> q1, SubstepReport& report);
  double time_of_impact(double h, std::span<double> lambda, std::span<Pose> q1, SubstepReport& report);

  // The velocity stage: μ with J(q₁) V₁ = 0.
  bool close_velocities(double h, std::span<const double> lambda, std::span<double> mu,
                        SubstepReport& report);
  bool project_bounded_momenta(double h, bool exact, std::span<double> mu, SubstepReport& report);
  bool give_second_kick(double h, std::span<const double> guess, bool anew, std::span<double> mu,
                        SubstepReport& report);
  bool second_kick_gives(std::span<const double> mu);
  bool velocities_hold(std::span<const double> mu, SubstepReport& report);
  bool strike(double h, std::span<double> mu, SubstepReport& report);

  // The end of the step.
  bool break_joints(double h, std::span<const double> lambda, std::span<const double> mu,
                    SubstepReport& report);
  void release_overloaded();
  void keep_multipliers(double h, std::span<const double> lambda, std::span<const double> mu);
  void keep_first_kick(std::span<const double> lambda);
  void account_for_kick(double h, std::span<const double> lambda, StepWorks& works);
  void restore(SubstepReport& report);

  ImplicitTension tension_;
  StartJacobian start_jacobian_;
  PositionProjection weak_directions_;
  ImpactSearch impacts_;
  double size_ = 1;                    // of the whole system at the start [m]
  double slack_ = 0;                   // of gaps and places where friction holds, which is left [m or rad]
  bool prediction_missed_ = false;     // multipliers were far from their prediction
  std::vector<Wrench> raw_kick_;       // before the filter of implicit stiffness
  std::vector<Wrench> absorbed_;       // momentum that bodies held fast did not take in this stage
  std::vector<double> broken_states_;  // of rows, for the system without laws
  double time_to_event_ = 0;
};

}  // namespace taut
