#include "solvers/complementarity/impulse_iteration.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>

#include "core/base/interruption.h"
#include "solvers/laws/natural_residual.h"

namespace taut {
namespace {

constexpr int kMostBlockRows = ImpulseIterationTuning::kMostRows;
using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostBlockRows, kMostBlockRows>;
using BlockVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostBlockRows, 1>;
using SixRow = Eigen::Map<const Eigen::Matrix<double, 1, 6>>;

}  // namespace

ImpulseIteration::ImpulseIteration(ConstraintSystem& system) : system_(system), impulses_(system) {
  const int rows = system.row_count();
  for (auto* values : {&diagonal_, &target_, &scratch_, &answer_}) values->assign(rows, 0.0);
  order_.resize(system.rows().joints().size());
  std::iota(order_.begin(), order_.end(), 0);
}

IterationOutcome ImpulseIteration::solve(const ContactLaws& contacts, std::span<const RowLaw> laws,
                                         std::span<const double> b, std::span<double> lambda,
                                         std::span<double> w, const IterationLimits& limits,
                                         std::span<Wrench> absorbed) {
  const bool by_rows = limits.order == Solver::kGaussSeidel;
  const Problem problem{contacts, laws, b, lambda, by_rows ? limits.relaxation : 1, absorbed};
  impulses_.gather(lambda);
  for (int r = 0; r < system_.row_count(); ++r) diagonal_[r] = impulses_.diagonal(r);
  frozen_.assign(system_.rows().body_count(), 0);
  std::fill(target_.begin(), target_.end(), 0.0);
  contacts.targets(target_);
  cones_.clear();
  for (int k = 0; k < system_.rows().contact_count(); ++k) cones_.push_back(contacts.cone(k));
  IterationOutcome outcome;
  if (limits.order == Solver::kPropagation && level_.empty()) find_levels();
  if (limits.order == Solver::kPairwise) {
    work_off_queue(problem, limits, outcome);
  } else {
    while (outcome.sweeps < limits.sweeps && !outcome.converged) {
      detail::poll_interrupt();
      outcome.residual = sweep(problem, by_rows);
      ++outcome.sweeps;
      outcome.converged = outcome.residual <= limits.tolerance;
    }
    if (limits.order == Solver::kPropagation && !outcome.converged && system_.rows().contact_count() > 0)
      propagate(problem);
  }
  for (int r = 0; r < system_.row_count(); ++r) w[r] = rate(problem, r);
  return outcome;
}

/// S_rr of the bodies that are not held fast.
double ImpulseIteration::diagonal_of(int row) const {
  const double* W = system_.weighted().data();
  double sum = 0;
  for (const RowImpulses::Side& side : impulses_.sides(row))
    if (!frozen_[side.body]) sum += SixRow(W + side.offset).squaredNorm();
  return sum;
}

void ImpulseIteration::change(const Problem& problem, int row, double by) {
  problem.lambda[row] += by;
  for (const RowImpulses::Side& side : impulses_.sides(row)) {
    if (!frozen_[side.body]) {
      impulses_.add(side, by);
      continue;
    }
    const Rows::Side& of_joint = system_.rows().sides()[side.side];
    const Eigen::Matrix<double, 6, 1> J =
        Rows::block_row(of_joint, system_.jacobian(), row - of_joint.first_row);
    problem.absorbed[side.body].torque += by * J.head<3>();
    problem.absorbed[side.body].force += by * J.tail<3>();
  }
}

/// What a row by itself answers, relaxed.
double ImpulseIteration::next_of(const Problem& problem, int row) const {
  const double s = diagonal_[row] / problem.relaxation;
  return problem.laws[row].project(s, problem.lambda[row], rate(problem, row));
}

/// Each relax…() returns the largest change √S_rr |δλ_r|.
double ImpulseIteration::relax_row(const Problem& problem, int row) {
  if (!(diagonal_[row] > 0)) return 0;
  const double by = next_of(problem, row) - problem.lambda[row];
  if (by != 0) change(problem, row, by);
  return NaturalResidual(diagonal_[row], by).size;
}

/// Normal, sliding, spinning and rolling friction in turn, each with the normal impulse of then.
double ImpulseIteration::relax_contact(const Problem& problem, int block) {
  const Rows::JointRows& rows = system_.rows().joints()[block];
  const ContactLaws::Cone& cone = cones_[block - system_.rows().contact_joint(0)];
  const int row = rows.first_row;
  double largest = 0;
  const auto give = [&](int r, double s, double to) {
    const double by = (cone.works ? to : 0) - problem.lambda[r];
    if (by != 0) change(problem, r, by);
    largest = std::max(largest, NaturalResidual(s, by).size);
  };
  const auto asked = [&](int r, double s, double softness) {
    const double off = rate(problem, r) + softness * problem.lambda[r] - target_[r];
    return problem.lambda[r] - problem.relaxation * off / (s + softness);
  };
  const auto part_of = [&](double slope, double s) { return part_of_slope(slope, s / problem.relaxation); };
  const auto in_disc = [&](int first, const Vec2& given, double bound, double softness, double slope) {
    const double s = std::max(diagonal_[first], diagonal_[first + 1]);
    if (!(s > 0)) return;
    const Vec2 tau(asked(first, s, softness), asked(first + 1, s, softness));
    const Vec2 to = into_disc(given + tau, bound, part_of(slope, s)) - given;
    give(first, s, to[0]);
    give(first + 1, s, to[1]);
  };
  if (diagonal_[row] > 0) {
    const double to = std::max(-cone.normal_given, asked(row, diagonal_[row], cone.softness));
    give(row, diagonal_[row], std::min(to, cone.most - cone.normal_given));
  }
  const double normal = std::max(0.0, cone.normal_given + problem.lambda[row]);
  in_disc(row + ContactLaws::kSlidingRow, cone.sliding_given, cone.sliding * normal, cone.slip_softness, 0);
  if (!cone.twist) return largest;
  const int spin = row + ContactLaws::kSpinRow;
  if (const double s = diagonal_[spin]; s > 0) {
    const double given = cone.spin_about(normal), part = part_of(cone.linear.spinning * normal, s);
    give(spin, s, into_interval(given + asked(spin, s, 0), cone.spinning * normal, part) - given);
  }
  in_disc(row + ContactLaws::kRollingRow, cone.rolling_about(normal), cone.rolling * normal, 0,
          cone.linear.rolling * normal);
  return largest;
}

/// Its equality rows at once, S_jj δ = target − w, then the rows of its axes one by one.
double ImpulseIteration::relax_joint(const Problem& problem, int block) {
  const Rows::JointRows& rows = system_.rows().joints()[block];
  const int first = rows.first_row, count = rows.equality_count;
  const bool together = count <= Tuning::kMostRows &&
                        std::none_of(problem.laws.begin() + first, problem.laws.begin() + first + count,
                                     [](const RowLaw& law) { return law.bounded(); });
  double largest = 0;
  if (together && count > 0) {
    const double* W = system_.weighted().data();
    Block S = Block::Zero(count, count);
    BlockVector off(count);
    for (int i = 0; i < count; ++i) {
      off[i] = problem.laws[first + i].rate(1) - rate(problem, first + i);
      for (int j = 0; j <= i; ++j)
        for (std::size_t s = 0; s < impulses_.sides(first + i).size(); ++s) {
          const auto [body, offset, side] = impulses_.sides(first + i)[s];
          const int other = impulses_.sides(first + j)[s].offset;
          if (!frozen_[body]) S(i, j) += SixRow(W + offset).dot(SixRow(W + other));
        }
    }
    if (!(S.diagonal().minCoeff() > 0)) return 0;  // nothing moves
    const BlockVector root = S.diagonal().cwiseSqrt();
    S.diagonal() *= 1 + Tuning::kShift;
    const BlockVector by = S.ldlt().solve(off);
    if (!by.allFinite()) return std::numeric_limits<double>::quiet_NaN();
    for (int i = 0; i < count; ++i) change(problem, first + i, by[i]);
    largest = root.cwiseProduct(by).cwiseAbs().maxCoeff();
  }
  for (int r = first + (together ? count : 0); r < first + rows.row_count; ++r)
    largest = std::max(largest, relax_row(problem, r));
  return largest;
}

double ImpulseIteration::relax(const Problem& problem, int block) {
  return system_.rows().is_contact(system_.rows().joints()[block].first_row) ? relax_contact(problem, block)
                                                                             : relax_joint(problem, block);
}

double ImpulseIteration::sweep(const Problem& problem, bool by_rows) {
  double largest = 0;
  for (int block : order_) {
    const Rows::JointRows& rows = system_.rows().joints()[block];
    if (rows.row_count == 0) continue;
    double size = 0;
    if (by_rows && !system_.rows().is_contact(rows.first_row)) {
      for (int r = rows.first_row; r < rows.first_row + rows.row_count; ++r)
        size = std::max(size, relax_row(problem, r));
    } else {
      size = relax(problem, block);
    }
    if (!(size <= largest)) largest = size;
    if (std::isnan(largest)) break;
  }
  return largest;
}

/// How far a joint or contact is from its laws: the largest √S_rr |δλ_r| that its rows by themselves ask for.
double ImpulseIteration::violation(const Problem& problem, int block) {
  const Rows::JointRows& rows = system_.rows().joints()[block];
  const int first = rows.first_row;
  LargestResidual largest;
  if (!system_.rows().is_contact(first)) {
    for (int r = first; r < first + rows.row_count; ++r)
      if (diagonal_[r] > 0)
        largest.add(
            natural_residual(problem.laws[r], diagonal_[r], problem.lambda[r], rate(problem, r)).size);
    return largest.size();
  }
  for (int r = first; r < first + rows.row_count; ++r) {
    const double s = diagonal_[r] > 0 ? diagonal_[r] : 1;
    scratch_[r] = problem.lambda[r] - (rate(problem, r) - target_[r]) / s;
  }
  const auto of_block = [&](std::span<double> values) { return values.subspan(first, rows.row_count); };
  cones_[block - system_.rows().contact_joint(0)].project(of_block(scratch_), of_block(diagonal_),
                                                          of_block(answer_));
  for (int r = first; r < first + rows.row_count; ++r)
    largest.add(NaturalResidual(diagonal_[r], answer_[r] - problem.lambda[r]).size);
  return largest.size();
}

/// The most violated first; an impulse changes what its neighbours ask for.
void ImpulseIteration::work_off_queue(const Problem& problem, const IterationLimits& limits,
                                      IterationOutcome& outcome) {
  struct Entry {
    double violation;
    int block, stamp;
    bool operator<(const Entry& other) const { return violation < other.violation; }
  };
  const Rows& rows = system_.rows();
  std::priority_queue<Entry> queue;
  stamp_.assign(order_.size(), 0);
  const auto enter = [&](int block) {
    if (rows.joints()[block].row_count == 0) return;
    const double size = violation(problem, block);
    ++stamp_[block];
    if (size > limits.tolerance) queue.push({size, block, stamp_[block]});
  };
  for (int block : order_) enter(block);
  const long most = static_cast<long>(limits.sweeps) * static_cast<long>(order_.size());
  long impulses = 0;
  while (!queue.empty() && impulses < most) {
    detail::poll_interrupt();
    const Entry worst = queue.top();
    queue.pop();
    if (worst.stamp != stamp_[worst.block]) continue;
    outcome.residual = relax(problem, worst.block);
    ++impulses;
    if (std::isnan(outcome.residual)) break;
    const Rows::JointRows& joint = rows.joints()[worst.block];
    for (int s = joint.first_side; s < joint.first_side + joint.side_count; ++s) {
      const int body = rows.sides()[s].body;
      if (system_.mass()[body].fixed) continue;
      for (int side : rows.sides_of(body)) enter(rows.sides()[side].block);
    }
  }
  outcome.sweeps = static_cast<int>((impulses + order_.size() - 1) / std::max<std::size_t>(order_.size(), 1));
  outcome.converged = queue.empty() && !std::isnan(outcome.residual);
}

/// Least number of joints and contacts between each body and what does not move.
void ImpulseIteration::find_levels() {
  const Rows& rows = system_.rows();
  constexpr int kNoLevel = std::numeric_limits<int>::max();
  level_.assign(rows.body_count(), kNoLevel);
  std::vector<int> front;
  for (const Rows::Side& side : rows.sides())
    if (system_.mass()[side.body].fixed && level_[side.body] == kNoLevel) {
      level_[side.body] = 0;
      front.push_back(side.body);
    }
  for (std::size_t next = 0; next < front.size(); ++next)
    for (int s : rows.sides_of(front[next])) {
      const Rows::JointRows& joint = rows.joints()[rows.sides()[s].block];
      for (int t = joint.first_side; t < joint.first_side + joint.side_count; ++t) {
        const int body = rows.sides()[t].body;
        if (level_[body] != kNoLevel) continue;
        level_[body] = level_[front[next]] + 1;
        front.push_back(body);
      }
    }
  std::stable_sort(order_.begin(), order_.end(), [&](int a, int b) { return level_of(a) < level_of(b); });
}

/// The highest level of its bodies.
int ImpulseIteration::level_of(int block) const {
  const Rows::JointRows& joint = system_.rows().joints()[block];
  int level = 0;
  for (int s = joint.first_side; s < joint.first_side + joint.side_count; ++s)
    level = std::max(level, level_[system_.rows().sides()[s].body]);
  return level;
}

/// Level by level upwards, each on top of those below as if they could not move.
void ImpulseIteration::propagate(const Problem& problem) {
  const Rows& rows = system_.rows();
  for (std::size_t from = 0, to; from < order_.size(); from = to) {
    const int level = level_of(order_[from]);
    for (to = from; to < order_.size() && level_of(order_[to]) == level;) ++to;
    if (level == std::numeric_limits<int>::max()) return;  // nothing holds these
    for (std::size_t k = from; k < to; ++k) {
      const Rows::JointRows& joint = rows.joints()[order_[k]];
      for (int r = joint.first_row; r < joint.first_row + joint.row_count; ++r) diagonal_[r] = diagonal_of(r);
    }
    for (int pass = 0; pass < Tuning::kLevelSweeps; ++pass)
      for (std::size_t k = from; k < to; ++k)
        if (rows.joints()[order_[k]].row_count > 0) (void)relax(problem, order_[k]);
    for (int b = 0; b < rows.body_count(); ++b)
      if (level_[b] <= level) frozen_[b] = 1;
  }
}

}  // namespace taut
