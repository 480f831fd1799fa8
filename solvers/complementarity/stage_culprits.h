#pragma once

#include <span>
#include <utility>
#include <vector>

#include "core/world/world.h"
#include "solvers/common/step_report.h"
#include "solvers/complementarity/stage_attempt.h"
#include "solvers/complementarity/stage_residual.h"
#include "solvers/complementarity/stage_tuning.h"

namespace taut {

/// Who was furthest from the laws of a stage that could not be solved, or was solved inexactly, and who jams:
/// for messages.
class StageCulprits {
 public:
  StageCulprits(const World& world, const StageModel& model) : named_(&world), model_(model) {}

  /// Shapes of contacts belong to the bodies of this world.
  void name_by(const World& world) { named_ = &world; }
  void clear();
  /// The first few by their natural residual, with no allowance for round-off.
  void find(const StageResidual& residual, const StageSolution& solution);
  /// Others, which the caller knows.
  void set(std::vector<Culprit> culprits) { culprits_ = std::move(culprits); }
  /// Who jams at these impulses: friction and loads that make each other grow have outgrown all others.
  void find_jam(std::span<const double> lambda, std::span<const double> effective_mass);

  std::vector<Culprit>::const_iterator begin() const { return culprits_.begin(); }
  std::vector<Culprit>::const_iterator end() const { return culprits_.end(); }
  /// Into the report of a sub-step.
  void report(SubstepReport& report) const;
  /// Who jams, if a stage failed because friction grows with a load that it makes grow: the rows of that
  /// friction, and those of motors without bound and of joints that follow the time whose impulses are as
  /// large.
  std::span<const int> jammed() const { return jammed_; }

 private:
  using Tuning = StageTuning;

  void add_rows(const StageResidual& residual, const StageSolution& solution, double scale);
  void add_contacts(const StageSolution& solution, double scale);
  Culprit owner_of(int row, const Rows::AxisRow* axis) const;
  bool counts(double off) const;
  void add(Culprit culprit);

  const World* named_;
  StageModel model_;
  std::vector<Culprit> culprits_;  // furthest first
  std::vector<int> jammed_;
};

}  // namespace taut
