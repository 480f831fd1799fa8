#include "solvers/complementarity/contact_stage.h"

#include <Eigen/SparseCore>
#include <vector>

namespace taut {
namespace {

using SparseRows = FrictionProblem::Matrix;

/// What a row of the stage is in the problem: u = w + softness λ − target, r = λ + given.
struct StageRow {
  int row;
  double target = 0, softness = 0, given = 0;
};

/// Rows of the problem, equalities first, with the friction of the contacts behind them.
struct StageRows {
  std::vector<StageRow> rows;
  std::vector<double> mu;
  int equalities = 0;

  StageRows(const StageModel& model, const StageSolution& solution) {
    add_joints(model, solution);
    add_contacts(model, solution);
  }

 private:
  void add_joints(const StageModel& model, const StageSolution& solution) {
    for (int r = 0; r < model.system.rows().first_contact_row(); ++r)
      if (!solution.laws[r].bounded()) rows.push_back({.row = r, .target = solution.laws[r].at[0]});
    equalities = static_cast<int>(rows.size());
  }

  void add_contacts(const StageModel& model, const StageSolution& solution) {
    const ContactForces& contacts = model.contacts;
    std::vector<double> target(model.system.row_count());
    contacts.targets(target);
    for (int k = 0; k < contacts.count(); ++k) {
      const ContactCone cone = contacts.cone(k);
      const int normal = contacts.first_row(k), tangent = normal + ContactRows::kSlidingRow;
      if (!cone.works || cone.normal_given + solution.lambda[normal] >= cone.most) continue;
      rows.push_back({normal, target[normal], cone.softness, cone.normal_given});
      for (int i : {0, 1})
        rows.push_back({tangent + i, target[tangent + i], cone.slip_softness, cone.sliding_given[i]});
      mu.push_back(cone.sliding);
    }
  }
};

/// The rows of W = J A that are in the problem.
SparseRows weighted_rows(ConstraintSystem& system, const std::vector<StageRow>& chosen) {
  std::vector<int> place(system.row_count(), -1);
  for (int i = 0; i < std::ssize(chosen); ++i) place[chosen[i].row] = i;
  std::vector<Eigen::Triplet<double>> entries;
  const std::span<const double> W = system.weighted();
  for (const Rows::JointRows& block : system.rows().joints())
    for (int s = block.first_side; s < block.first_side + block.side_count; ++s) {
      const Rows::Side& side = system.rows().sides()[s];
      for (int i = 0; i < side.row_count; ++i)
        for (int j = 0; j < 6 && place[side.first_row + i] >= 0; ++j)
          if (const double value = W[side.whole + 6 * i + j]; value != 0)
            entries.emplace_back(place[side.first_row + i], 6 * side.body + j, value);
    }
  SparseRows weighted(std::ssize(chosen), 6 * system.rows().body_count());
  weighted.setFromTriplets(entries.begin(), entries.end());
  return weighted;
}

ContactStage contact_stage(const StageModel& model, const StageSolution& solution, const StageRows& chosen,
                           bool met) {
  const auto n = std::ssize(chosen.rows);
  const SparseRows weighted = weighted_rows(model.system, chosen.rows);
  ContactStage stage{.problem = {},
                     .found = Eigen::VectorXd(n),
                     .kind = model.contacts.table().in_velocities ? ContactStage::Kind::kVelocities
                                                                  : ContactStage::Kind::kPositions,
                     .met = met};
  FrictionProblem& problem = stage.problem;
  problem.equalities = chosen.equalities;
  problem.mu = Eigen::Map<const Eigen::VectorXd>(chosen.mu.data(), std::ssize(chosen.mu));
  problem.W = weighted * weighted.transpose();
  Eigen::VectorXd u(n);
  for (int i = 0; i < n; ++i) {
    const auto& [row, target, soft, given] = chosen.rows[i];
    u[i] = solution.w[row] + soft * solution.lambda[row] - target;
    stage.found[i] = solution.lambda[row] + given;
    if (soft > 0) problem.W.coeffRef(i, i) += soft;
  }
  problem.q = u - problem.W * stage.found;
  return stage;
}

thread_local const detail::StageWatchScope::Watch* present_watch = nullptr;

}  // namespace

namespace detail {

StageWatchScope::StageWatchScope(const Watch* watch) : outer_(present_watch) {
  present_watch = watch && *watch ? watch : nullptr;
}
StageWatchScope::~StageWatchScope() { present_watch = outer_; }

void StageWatchScope::tell(const StageModel& model, const StageSolution& solution, bool met) {
  if (!present_watch || !model.contacts.any()) return;
  const StageRows chosen(model, solution);
  if (!chosen.mu.empty()) (*present_watch)(contact_stage(model, solution, chosen, met));
}

}  // namespace detail
}  // namespace taut
