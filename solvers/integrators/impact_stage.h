#pragma once

#include <functional>
#include <span>
#include <vector>

#include "solvers/integrators/kick_works.h"
#include "solvers/integrators/phase.h"
#include "solvers/integrators/row_values.h"
#include "solvers/laws/axes/axis_forces.h"
#include "solvers/laws/contact_forces.h"
#include "solvers/system/constraint_system.h"

namespace taut {

/// Impacts of axes and contacts at the end of a step of RATTLE, after its velocity stage, which they were
/// left out of: impulses Jᵀ(q₁) Λ in no time, with which all limits and contacts that are touched obey
/// Newton's law against the rates w⁻ at the end of that stage.  Those at one time are simultaneous; what
/// comes together by them strikes in a next round.No round gives energy by limits and contacts: without
/// friction by the law itself, with friction of contacts by a lesser restitution where Newton's would.
/// (solvers/laws, "Impacts")
class ImpactStage {
 public:
  /// All of them must outlive it.
  ImpactStage(const ConstraintSystem& system, AxisForces& axes, ContactForces& contacts, Phase& phase,
              RowValues& values, KickWorks& works)
      : system_(system), axes_(axes), contacts_(contacts), phase_(phase), values_(values), works_(works) {}

  /// Renews the laws of velocities, meets them from μ and its rates on, and follows with the momenta and
  /// rates that μ leads to.  False if that fails.
  using Solve = std::function<bool()>;

  /// A velocity stage begins.
  void begin() { struck_ = false; }
  /// An axis or a contact strikes at the end of this step.
  bool due() const { return axes_.impacts().any_due() || contacts_.strikes(); }
  /// Strikes what is due, from momenta p⁻, impulses μ and rates w⁻ of the velocity stage.
  bool strike(const Solve& solve);

  /// Works of a velocity stage of a step of h, and of the impacts after it.
  void add_works(double h, StepWorks& works);
  /// Records μ of the velocity stage, unless strike() has, and adds the works of axes in both.
  void record(std::span<const double> mu);

 private:
  /// Momenta between the velocity stage and the impacts; those of the end if there are none.
  std::span<const Wrench> momenta() const { return struck_ ? momenta_ : phase_.momenta; }
  /// Impulses μ of the velocity stage, and those that impacts add to them.
  std::span<const double> mu() const { return struck_ ? mu_ : values_.mu; }
  std::span<const double> impulses_since(std::span<const double> before);
  bool solve_round(double part, const Solve& solve);
  bool limit_restitution(const Solve& solve);
  void record_round();
  bool come_together() const;
  double energy();
  void mean_rates_of_round();

  const ConstraintSystem& system_;
  AxisForces& axes_;
  ContactForces& contacts_;
  Phase& phase_;
  RowValues& values_;
  KickWorks& works_;
  bool struck_ = false;
  std::vector<Wrench> momenta_;
  std::vector<double> mu_, impulses_, mean_rates_;
  std::vector<double> round_rates_, round_mu_;
  double restitution_ = 0;  // the largest of the round
};

}  // namespace taut
