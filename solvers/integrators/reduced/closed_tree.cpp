#include "solvers/integrators/reduced/closed_tree.h"

#include <algorithm>
#include <cmath>

#include "solvers/integrators/body_moves.h"

namespace taut {

ClosedTree::ClosedTree(const World& world, const Rows& rows, const MassMatrix& mass)
    : rows_(rows), mass_(mass), tree_(world, rows, mass), follows_time_(rows.depends_on_time()) {
  for (const int block : tree_.cuts())
    for (int i = 0; i < rows.joints()[block].equality_count; ++i)
      beyond_.push_back({.row = rows.joints()[block].first_row + i, .position = 0});
  cut_rows_ = static_cast<int>(beyond_.size());
  placed_ = beyond_;
  for (int r = 0; r < rows.row_count(); ++r)
    if (rows.is_equality(r)) equalities_.push_back(r);
  for (auto* of_bodies : {&a_, &bias_, &none_}) of_bodies->assign(rows.body_count(), Vector6::Zero());
  for (auto* values : {&gamma_, &phi_, &rates_}) values->assign(rows.row_count(), 0);
}

void ClosedTree::hold(std::span<const Held> rows) {
  const auto same_row = [](const Held& a, const Held& b) { return a.row == b.row; };
  if (!std::equal(beyond_.begin() + cut_rows_, beyond_.end(), rows.begin(), rows.end(), same_row))
    deficit_ = {};
  beyond_.resize(cut_rows_);
  placed_.resize(cut_rows_);
  for (const Held& held : rows) {
    beyond_.push_back(held);
    if (std::isfinite(held.position)) placed_.push_back(held);
  }
}

/// J a of a row.
double ClosedTree::rate_of(int row, std::span<const Vector6> a) const {
  double rate = 0;
  for_each_side(row, [&](int body, const Vector6& J) {
    if (tree_.moves(body)) rate += J.dot(a[body]);
  });
  return rate;
}

/// J M⁻¹ Jᵀ of a row.
double ClosedTree::free_response(int row, const State& state) const {
  double sum = 0;
  for_each_side(row, [&](int b, const Vector6& J) {
    const MassMatrix::Body& body = mass_[b];
    const Vec3 turn = mass_.principal_axes(b, state.poses[b]).transpose() * J.head<3>();
    sum += turn.cwiseAbs2().dot(body.inverse_moments) + J.tail<3>().squaredNorm() * body.inverse_mass;
  });
  return sum;
}

/// The bias of Jᵀ λ of a row, which is −Jᵀ λ.
void ClosedTree::add_bias(int row, double lambda, std::span<Vector6> bias) const {
  for_each_side(row, [&](int body, const Vector6& J) { bias[body] -= lambda * J; });
}

/// a₀ and b of (1).
void ClosedTree::find_free(Method method, std::span<const Vector6> bias, std::span<const double> rates,
                           std::span<const Held> beyond) {
  tree_.respond(method, bias, rates, a_);
  const auto count = std::ssize(beyond);
  problem_.b.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) problem_.b[i] = rate_of(beyond[i].row, a_) + rates[beyond[i].row];
}

/// R and A of (1).
void ClosedTree::find_responses(const State& state, Method method, std::span<const Held> beyond) {
  const auto count = std::ssize(beyond);
  if (std::ssize(responses_) < count) responses_.resize(count, none_);
  for (Eigen::Index i = 0; i < count; ++i) {
    std::fill(bias_.begin(), bias_.end(), Vector6::Zero());
    add_bias(beyond[i].row, 1, bias_);
    tree_.respond(method, bias_, {}, responses_[i]);
  }
  problem_.A.resize(count, count);
  problem_.alone.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) problem_.alone[i] = free_response(beyond[i].row, state);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j <= i; ++j)
      problem_.A(i, j) = problem_.A(j, i) = rate_of(beyond[i].row, responses_[j]);
}

void ClosedTree::add_responses(const dense::Vector& lambda, std::span<const Held> beyond) {
  for (std::size_t i = 0; i < beyond.size(); ++i)
    for (std::size_t b = 0; b < a_.size(); ++b)
      if (tree_.moves(static_cast<int>(b))) a_[b] += lambda[i] * responses_[i][b];
}

const BeyondRows& ClosedTree::begin_acceleration(const State& state, std::span<const Wrench> forces,
                                                 Method method) {
  rows_.bias(state, state.twists, gamma_);
  for (const Held& held : beyond_) gamma_[held.row] -= held.acceleration;
  tree_.prepare(state, method);
  find_responses(state, method, beyond_);
  tree_.biases(state, forces, bias_);
  find_free(method, bias_, gamma_, beyond_);
  return problem_;
}

void ClosedTree::end_acceleration(const dense::Vector& beyond, std::span<Twist> accelerations,
                                  std::span<double> lambda) {
  add_responses(beyond, beyond_);
  for (const int row : equalities_) lambda[row] = 0;
  for (std::size_t i = 0; i < beyond_.size(); ++i) {
    lambda[beyond_[i].row] += beyond[i];
    add_bias(beyond_[i].row, beyond[i], bias_);
  }
  tree_.add_reactions(a_, bias_, lambda);
  for (std::size_t b = 0; b < a_.size(); ++b) accelerations[b] = {a_[b].head<3>(), a_[b].tail<3>()};
}

void ClosedTree::accelerate(const State& state, std::span<const Wrench> forces, Method method,
                            std::span<Twist> accelerations, std::span<double> lambda) {
  const BeyondRows& rows = begin_acceleration(state, forces, method);
  end_acceleration(solve_equalities(rows), accelerations, lambda);
}

const BeyondRows& ClosedTree::begin_impact(const State& state) {
  tree_.prepare(state, Method::kRecursive);
  find_responses(state, Method::kRecursive, beyond_);
  std::fill(bias_.begin(), bias_.end(), Vector6::Zero());
  std::fill(a_.begin(), a_.end(), Vector6::Zero());
  rows_.apply(tree_.jacobian(), state.twists, rates_);
  if (follows_time_) rows_.add_rate(state, rates_);
  problem_.b.resize(std::ssize(beyond_));
  for (std::size_t i = 0; i < beyond_.size(); ++i) problem_.b[i] = rates_[beyond_[i].row] - beyond_[i].rate;
  return problem_;
}

void ClosedTree::end_impact(const dense::Vector& beyond, State& state, std::span<double> impulses) {
  add_responses(beyond, beyond_);
  for (std::size_t i = 0; i < beyond_.size(); ++i) {
    impulses[beyond_[i].row] += beyond[i];
    add_bias(beyond_[i].row, beyond[i], bias_);
  }
  tree_.add_reactions(a_, bias_, impulses);
  for (std::size_t b = 0; b < a_.size(); ++b) {
    state.twists[b].w += a_[b].head<3>();
    state.twists[b].v += a_[b].tail<3>();
  }
}

void ClosedTree::project_velocities(State& state) {
  rows_.apply(tree_.jacobian(), state.twists, rates_);
  if (follows_time_) rows_.add_rate(state, rates_);
  for (const Held& held : beyond_) rates_[held.row] -= held.rate;
  tree_.prepare(state, Method::kRecursive);
  find_responses(state, Method::kRecursive, beyond_);
  find_free(Method::kRecursive, none_, rates_, beyond_);
  add_responses(solve_closed(problem_, deficit_), beyond_);
  for (std::size_t b = 0; b < a_.size(); ++b) {
    if (!tree_.moves(static_cast<int>(b))) continue;
    state.twists[b].w += a_[b].head<3>();
    state.twists[b].v += a_[b].tail<3>();
  }
}

void ClosedTree::close_velocities(State& state) {
  if (is_tree())
    tree_.close_velocities(state);
  else
    project_velocities(state);
}

/// |φ| of all rows that stay, infinite if it is none; leaves φ less where they stay.
double ClosedTree::widest_gap(const Configuration& at) {
  rows_.residual(at, phi_);
  for (const Held& held : placed_) phi_[held.row] -= held.position;
  double gap = 0;
  const auto look = [&](int row) {
    gap = std::isnan(phi_[row]) ? INFINITY : std::max(gap, std::abs(phi_[row]));
  };
  for (const int row : equalities_) look(row);
  for (const Held& held : placed_) look(held.row);
  return gap;
}

bool ClosedTree::close_positions(State& state, double tolerance, int least, int& iterations) {
  if (is_tree()) return tree_.close_positions(state, tolerance, least, iterations);
  bool closed = false;
  for (int pass = 0; pass <= TreeTuning::kMaxClosings; ++pass) {
    const double gap = widest_gap(state);
    closed = gap == 0 || (pass >= least && gap <= tolerance);
    if (closed || !std::isfinite(gap) || pass == TreeTuning::kMaxClosings || !move(state)) break;
    ++iterations;
  }
  return closed;
}

/// q ← q ⊕ the least move that makes φ + J δ = 0.
bool ClosedTree::move(State& state) {
  tree_.linearize(state);
  tree_.prepare(state, Method::kRecursive);
  find_responses(state, Method::kRecursive, placed_);
  find_free(Method::kRecursive, none_, phi_, placed_);
  const bool all = placed_.size() == beyond_.size();
  add_responses(solve_equalities(problem_, all ? deficit_ : RankDeficit{}), placed_);
  double turn = 0;
  for (const Vector6& a : a_) turn = std::max(turn, a.head<3>().norm());
  const double part = part_of_step(turn);
  for (std::size_t b = 0; b < a_.size(); ++b) {
    if (!tree_.moves(static_cast<int>(b))) continue;
    if (!a_[b].allFinite()) return false;
    move_pose(state.poses[b], part * a_[b].head<3>(), part * a_[b].tail<3>());
  }
  return true;
}

}  // namespace taut
