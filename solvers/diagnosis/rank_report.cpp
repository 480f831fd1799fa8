#include "solvers/diagnosis/rank_report.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "solvers/common/max_abs.h"
#include "solvers/system/constraint_system.h"

namespace taut {
namespace {

/// Of words alone; chosen.
struct RankReportTuning {
  /// Joints with less than this part of the largest share are not named among those that hold a row.
  static constexpr double kRowShare = 0.05;
  /// In worlds with more dependent rows than this only the first ones get their holders named: each costs a
  /// solve.
  static constexpr std::size_t kMaxExplained = 200;
  /// Impulses below this part of the largest are no part of a self-stress.
  static constexpr double kUnstressed = 1e-6;
};

/// The system has joints only: neither springs nor contacts.
JointId joint_of(const ConstraintSystem& system, int row) {
  return std::get<JointId>(system.rows().owner(row));
}

/// Joints with a part in null vectors of S.  S_ε⁻¹ D, with the D of the shift, multiplies a null vector by
/// 1/ε and the rest by at most 1/σ: twice applied to numbers at random, nothing but a mixture of all null
/// vectors is left.
std::vector<JointId> find_self_stressed(const World& world, ConstraintSystem& system) {
  std::mt19937_64 random(1);
  const int n = system.row_count();
  std::vector<double> y(n), effective_mass(n);
  std::vector<char> stressed(world.joint_count(), 0);
  system.effective_masses(effective_mass);
  for (int mixture = 0; mixture < 2; ++mixture) {
    for (double& v : y) v = static_cast<double>(random() >> 11) * 0x1p-53 - 0.5;
    for (int pass = 0; pass < 3; ++pass) {
      if (pass > 0)
        for (int r = 0; r < n; ++r) y[r] /= effective_mass[r];
      system.solve_shifted(y);
      const double size = max_abs(y);
      for (double& v : y) v /= size;
    }
    double largest = 0;
    for (int r = 0; r < n; ++r) largest = std::max(largest, std::abs(y[r]) / std::sqrt(effective_mass[r]));
    for (int r = 0; r < n; ++r)
      if (std::abs(y[r]) / std::sqrt(effective_mass[r]) > RankReportTuning::kUnstressed * largest)
        stressed[joint_of(system, r).index] = 1;
  }
  std::vector<JointId> joints;
  for (int j = 0; j < world.joint_count(); ++j)
    if (stressed[j]) joints.push_back({j});
  return joints;
}

/// Who holds a dependent row r: with I the rows that are independent, S_II a = S_Ir gives the combination of
/// them that is row r, and joints with a large part in it, over the sizes of rows, hold it.
std::vector<JointId> find_holders(const World& world, ConstraintSystem& system,
                                  std::span<const int> dependent, int row,
                                  std::span<const double> effective_mass) {
  std::vector<double> unit(system.row_count(), 0.0), part(system.row_count());
  unit[row] = 1;
  system.multiply(unit, part);
  for (int r : dependent) part[r] = 0;
  system.solve(part);
  std::vector<double> share(world.joint_count(), 0.0);
  for (int r = 0; r < system.row_count(); ++r) {
    double& s = share[joint_of(system, r).index];
    s = std::max(s, std::abs(part[r]) / std::sqrt(effective_mass[r]));
  }
  const int joint = joint_of(system, row).index;
  const double largest = max_abs(share);
  std::vector<JointId> holders;
  for (int j = 0; j < world.joint_count(); ++j)
    if (share[j] > RankReportTuning::kRowShare * largest && j != joint) holders.push_back({j});
  if (holders.empty() && share[joint] > 0) return {{joint}};  // its other rows
  std::stable_sort(holders.begin(), holders.end(),
                   [&](JointId a, JointId b) { return share[a.index] > share[b.index]; });
  return holders;
}

}  // namespace

RankReport analyze_rank(const World& world, const Settings& settings) {
  ConstraintSystem system(world, settings.factor, RankTuning::kCounting, Rows::AxisRows::kLeftOut);
  StageTimes times;
  system.linearize(world.state());
  system.set_mass(world.state().poses);
  system.factorize_for_counting(times);

  RankReport report;
  report.rows = system.row_count();
  report.rank = report.rows - system.rank_deficiency();
  report.freedoms = 6 * world.moving_body_count() - report.rank;
  std::vector<int> dependent(system.dependent_rows().begin(), system.dependent_rows().end());
  std::sort(dependent.begin(), dependent.end());
  if (dependent.empty()) return report;
  report.not_unique = find_self_stressed(world, system);
  std::vector<double> effective_mass(system.row_count()), states(system.row_count(), 0.0);
  system.effective_masses(effective_mass);
  for (int row : dependent) states[row] = kMasked;
  system.set_row_states(states);
  system.factorize(times);
  for (int row : dependent) {
    const JointId joint = joint_of(system, row);
    report.redundant.push_back(
        {joint, row - system.rows().joints()[joint.index].first_row, system.rows().row_name(row), {}});
    if (report.redundant.size() <= RankReportTuning::kMaxExplained)
      report.redundant.back().held_by = find_holders(world, system, dependent, row, effective_mass);
  }
  return report;
}

}  // namespace taut
