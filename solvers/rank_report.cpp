#include "solvers/rank_report.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "solvers/constraint_system.h"
#include "solvers/max_abs.h"

namespace taut {
namespace {

/// Joints with less than this part of the largest share are not named among those that hold a row.
constexpr double kShare = 0.05;
constexpr std::size_t kMaxHolders = 4;
/// For worlds with more dependent rows than this only the first ones get their holders named: each costs a
/// solve.
constexpr std::size_t kMaxExplained = 200;
/// Impulses below this part of the largest are no part of a self-stress.
constexpr double kNoShare = 1e-6;

/// Joints with a part in null vectors of S.  S_ε⁻¹ D, with the D of the shift, multiplies a null vector by
/// 1/ε and the rest by at most 1/σ: twice applied to numbers at random, nothing but a mixture of all null
/// vectors is left.
std::vector<JointId> find_self_stressed(const World& world, ConstraintSystem& system) {
  std::mt19937_64 random(1);
  const int n = system.row_count();
  std::vector<double> y(n), inertia(n);
  std::vector<char> stressed(world.joint_count(), 0);
  system.row_inertias(inertia);
  for (int mixture = 0; mixture < 2; ++mixture) {
    for (double& v : y) v = static_cast<double>(random() >> 11) * 0x1p-53 - 0.5;
    for (int pass = 0; pass < 3; ++pass) {
      if (pass > 0)
        for (int r = 0; r < n; ++r) y[r] /= inertia[r];
      system.solve_shifted(y);
      const double size = max_abs(y);
      for (double& v : y) v /= size;
    }
    double largest = 0;
    for (int r = 0; r < n; ++r) largest = std::max(largest, std::abs(y[r]) / std::sqrt(inertia[r]));
    for (int r = 0; r < n; ++r)
      if (std::abs(y[r]) / std::sqrt(inertia[r]) > kNoShare * largest)
        stressed[system.rows().row(r).joint] = 1;
  }
  std::vector<JointId> joints;
  for (int j = 0; j < world.joint_count(); ++j)
    if (stressed[j]) joints.push_back({j});
  return joints;
}

}  // namespace

/// A dependent row r leaves a pivot of about ε: its part that no earlier row holds has length² ≈ 0.  With y =
/// S_ε⁻¹ e_r, which is dominated by null vectors of S that contain r, the other rows with large |y| are those
/// that hold it.
RankReport analyze_rank(const World& world, const Settings& settings) {
  ConstraintSystem system(world, settings.factor, kCountingTolerance, Rows::AxisRows::kLeftOut);
  StageTimes times;
  system.linearize(world.state());
  system.set_mass(world.state().poses);
  system.factorize_for_counting(times);

  RankReport report;
  report.rows = system.row_count();
  report.rank = report.rows - system.rank_deficiency();
  report.freedoms = 6 * world.moving_body_count() - report.rank;
  std::vector<double> y(system.row_count()), share(world.joint_count());
  std::vector<int> dependent(system.dependent_rows().begin(), system.dependent_rows().end());
  std::sort(dependent.begin(), dependent.end());
  if (!dependent.empty()) report.not_unique = find_self_stressed(world, system);
  for (int row : dependent) {
    const int joint = system.rows().row(row).joint;
    RedundantRow redundant{
        {joint}, row - system.rows().joints()[joint].first_row, system.rows().row_name(row), {}};
    if (report.redundant.size() < kMaxExplained) {
      std::fill(y.begin(), y.end(), 0.0);
      y[row] = 1;
      system.solve_shifted(y);
      std::fill(share.begin(), share.end(), 0.0);
      for (int r = 0; r < system.row_count(); ++r)
        if (r != row)
          share[system.rows().row(r).joint] = std::max(share[system.rows().row(r).joint], std::abs(y[r]));
      std::vector<int> holders;
      const double largest = *std::max_element(share.begin(), share.end());
      for (int j = 0; j < world.joint_count(); ++j)
        if (share[j] > kShare * largest && largest > 0) holders.push_back(j);
      std::stable_sort(holders.begin(), holders.end(), [&](int a, int b) { return share[a] > share[b]; });
      if (holders.size() > kMaxHolders) holders.resize(kMaxHolders);
      for (int j : holders) redundant.held_by.push_back({j});
    }
    report.redundant.push_back(std::move(redundant));
  }
  return report;
}

}  // namespace taut
