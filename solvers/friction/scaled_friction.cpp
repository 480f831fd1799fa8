#include "solvers/friction/scaled_friction.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/check.h"
#include "solvers/laws/contact_cone.h"
#include "solvers/laws/natural_residual.h"

namespace taut {
namespace {

using Vector = Eigen::VectorXd;

/// W x or Wᵀ x on this thread: Eigen's own product of a large matrix in rows starts threads for it, which
/// takes longer than the product where other work keeps them waiting.
Vector product(const FrictionProblem::Matrix& W, const Vector& x, bool transposed) {
  Vector y = Vector::Zero(transposed ? W.cols() : W.rows());
  for (int i = 0; i < W.outerSize(); ++i)
    for (FrictionProblem::Matrix::InnerIterator at(W, i); at; ++at)
      if (transposed)
        y[at.col()] += at.value() * x[i];
      else
        y[i] += at.value() * x[at.col()];
  return y;
}

/// The largest singular value.
double spectral_norm(const FrictionProblem::Matrix& W) {
  Vector x = Vector::Ones(W.cols());
  for (int i = 0; i < x.size(); ++i) x[i] += 0.5 * std::sin(1.7 * i);  // along no symmetry
  double norm = 0;
  for (int k = 0; k < ScaledFrictionTuning::kPowerSteps; ++k) {
    const double size = x.norm();
    if (!(size > 0)) return norm;
    const Vector y = product(W, x / size, false);
    const double now = y.norm();
    if (std::abs(now - norm) <= ScaledFrictionTuning::kPowerAccuracy * now) return now;
    norm = std::max(norm, now);
    x = product(W, y, true);
  }
  return norm;
}

/// (x_n + μ |x_T|, x_T), as û of u.
Vec3 opened(const Vec3& u, double mu) { return {u[0] + mu * std::hypot(u[1], u[2]), u[1], u[2]}; }

}  // namespace

ScaledFriction::ScaledFriction(const FrictionProblem& problem) : given_rows_(problem.rows()) {
  problem.require_valid();
  lay_out(problem);
  find_units(problem);
  take_matrix(problem);
  const double norm = spectral_norm(problem.W);
  norm_ = norm > 0 ? norm : 1;
  given_norm_of_q_ = problem.q.norm();
}

void ScaledFriction::lay_out(const FrictionProblem& problem) {
  const auto add = [&](Law law, int size, int given, double mu) {
    blocks_.push_back({law, static_cast<int>(given_row_.size()), size, mu});
    for (int i = 0; i < size; ++i) given_row_.push_back(given + i);
  };
  for (int i = 0; i < problem.equalities; ++i) add(Law::kEquality, 1, i, 0);
  for (const bool smooth : {true, false})
    for (int k = 0; k < problem.contacts(); ++k)
      if ((problem.mu[k] < ScaledFrictionTuning::kNoFriction) == smooth)
        add(smooth ? Law::kUnilateral : Law::kCone, smooth ? 1 : 3, problem.equalities + 3 * k,
            problem.mu[k]);
}

void ScaledFriction::find_units(const FrictionProblem& problem) {
  root_diagonal_.assign(given_row_.size(), 0);
  double largest = 0;
  for (const Block& block : blocks_) {
    double d = 0;
    for (int i = block.first; i < block.first + block.size; ++i)
      d += problem.W.coeff(given_row_[i], given_row_[i]) / block.size;
    largest = std::max(largest, d);
    std::fill_n(root_diagonal_.begin() + block.first, block.size, d);
  }
  for (double& d : root_diagonal_)
    d = std::sqrt(std::max(d, largest > 0 ? ScaledFrictionTuning::kLeastOwnPart * largest : 1.0));
}

/// The blocks that each block meets, itself among them.
std::vector<std::vector<int>> ScaledFriction::neighbours(const FrictionProblem& problem,
                                                         const std::vector<int>& row_of) const {
  std::vector<int> block_of(given_row_.size());
  for (int b = 0; b < std::ssize(blocks_); ++b)
    for (int i = 0; i < blocks_[b].size; ++i) block_of[blocks_[b].first + i] = b;
  std::vector<std::vector<int>> met(blocks_.size());
  for (int b = 0; b < std::ssize(blocks_); ++b) {
    met[b] = {b};
    for (int i = blocks_[b].first; i < blocks_[b].first + blocks_[b].size; ++i)
      for (FrictionProblem::Matrix::InnerIterator at(problem.W, given_row_[i]); at; ++at)
        if (const int row = row_of[at.col()]; row >= 0) met[b].push_back(block_of[row]);
    std::sort(met[b].begin(), met[b].end());
    met[b].erase(std::unique(met[b].begin(), met[b].end()), met[b].end());
  }
  return met;
}

void ScaledFriction::take_matrix(const FrictionProblem& problem) {
  const int n = static_cast<int>(given_row_.size());
  std::vector<int> row_of(problem.rows(), -1), place(n);
  for (int i = 0; i < n; ++i) row_of[given_row_[i]] = i;
  const std::vector<std::vector<int>> met = neighbours(problem, row_of);
  start_.assign(1, 0);
  diagonal_.assign(n, 0);
  for (int b = 0; b < std::ssize(blocks_); ++b)
    for (int i = blocks_[b].first; i < blocks_[b].first + blocks_[b].size; ++i) {
      for (const int other : met[b])
        for (int j = blocks_[other].first; j < blocks_[other].first + blocks_[other].size; ++j) {
          place[j] = static_cast<int>(columns_.size());
          columns_.push_back(j);
        }
      diagonal_[i] = place[blocks_[b].first] - start_.back();
      values_.resize(columns_.size(), 0.0);
      for (FrictionProblem::Matrix::InnerIterator at(problem.W, given_row_[i]); at; ++at)
        if (const int row = row_of[at.col()]; row >= 0)
          values_[place[row]] += at.value() / (root_diagonal_[i] * root_diagonal_[row]);
      start_.push_back(static_cast<int>(columns_.size()));
    }
  q_.resize(n);
  for (int i = 0; i < n; ++i) q_[i] = problem.q[given_row_[i]] / root_diagonal_[i];
  largest_q_ = n > 0 ? q_.cwiseAbs().maxCoeff() : 0;
}

Mat3 ScaledFriction::diagonal_block(const Block& cone) const {
  Mat3 B;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) B(i, j) = values(cone.first + i)[diagonal(cone) + j];
  return B;
}

Vector ScaledFriction::rates(const Vector& r) const {
  Vector u = q_;
  for (int i = 0; i < rows(); ++i) {
    double sum = 0;
    for (int k = start_[i]; k < start_[i + 1]; ++k) sum += values_[k] * r[columns_[k]];
    u[i] += sum;
  }
  return u;
}

Vector ScaledFriction::scale(const Vector& r) const {
  Vector scaled(rows());
  for (int i = 0; i < rows(); ++i) scaled[i] = root_diagonal_[i] * r[given_row_[i]];
  return scaled;
}

Vector ScaledFriction::unscale(const Vector& r) const {
  Vector unscaled = Vector::Zero(given_rows_);
  for (int i = 0; i < rows(); ++i) unscaled[given_row_[i]] = r[i] / root_diagonal_[i];
  return unscaled;
}

Vector ScaledFriction::project(const Vector& x) const {
  Vector y = x;
  for (const Block& block : blocks_)
    if (block.law == Law::kUnilateral)
      y[block.first] = std::max(0.0, x[block.first]);
    else if (block.law == Law::kCone)
      y.segment<3>(block.first) = into_cone(x.segment<3>(block.first), block.mu);
  return y;
}

Vector ScaledFriction::units() const {
  Vector units = Vector::Ones(given_rows_);
  for (int i = 0; i < rows(); ++i) units[given_row_[i]] = root_diagonal_[i] * root_diagonal_[i];
  return units;
}

FrictionErrors ScaledFriction::errors(const Vector& r) const {
  if (rows() == 0) return {};
  const Vector u = rates(r);
  double off = 0, map = 0, lost = 0, lost_map = 0;
  int worst = -1;
  const auto note = [&](double F, int row) {
    if (std::abs(F) > off) {
      off = std::abs(F);
      worst = given_row_[row];
    }
  };
  for (const Block& block : blocks_) {
    const double root = root_diagonal_[block.first], rho = 1 / norm_;
    if (block.size == 1) {
      const int i = block.first;
      const bool free = block.law == Law::kUnilateral;
      const double F = free ? r[i] - std::max(0.0, r[i] - u[i]) : u[i];
      const double g = r[i] / root, v = rho * u[i] * root;
      const double G = free ? g - std::max(0.0, g - v) : v;
      note(F, i);
      map += G * G;
    } else {
      const Vec3 x = r.segment<3>(block.first), v = opened(u.segment<3>(block.first), block.mu);
      const Vec3 F = x - into_cone(x - v, block.mu);
      for (int i = 0; i < 3; ++i) note(F[i], block.first + i);
      const Vec3 g = x / root;
      map += (g - into_cone(g - rho * root * v, block.mu)).squaredNorm();
    }
    for (int i = block.first; i < block.first + block.size; ++i) {
      double sum = 0;
      for (int k = start_[i]; k < start_[i + 1]; ++k) sum += std::abs(values_[k] * r[columns_[k]]);
      lost = std::max(lost, sum);
      lost_map += sum * sum * root * root;
    }
  }
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const auto part = [](double of, double all) { return all > 0 ? of / all : of > 0 ? kInfinite : 0; };
  FrictionErrors errors;
  errors.worst_row = worst;
  errors.impulses = part(off, std::max(largest_q_, r.cwiseAbs().maxCoeff()));
  errors.rates = part(off, largest_q_);
  errors.map = part(std::sqrt(map) * norm_, given_norm_of_q_);
  errors.round_off = ResidualTuning::kRoundOff *
                     std::max(part(lost, largest_q_), part(std::sqrt(lost_map), given_norm_of_q_));
  return errors;
}

bool ScaledFriction::excludes(const Vector& given) const {
  Vector d = scale(given);
  for (const Block& block : blocks_) {
    if (block.law != Law::kEquality) d[block.first] = std::max(0.0, d[block.first]);
    if (block.law == Law::kCone) d[block.first + 1] = d[block.first + 2] = 0;
  }
  const double size = rows() > 0 ? d.cwiseAbs().maxCoeff() : 0;
  if (!(size > 0)) return false;
  d /= size;
  Vector moved = Vector::Zero(rows());
  for (int i = 0; i < rows(); ++i)
    for (int k = start_[i]; k < start_[i + 1]; ++k) moved[columns_[k]] += values_[k] * d[i];
  const double closing = -d.dot(q_) / largest_q_;
  return closing > 0 &&
         moved.cwiseAbs().maxCoeff() <= ScaledFrictionTuning::kMovesNothing * std::min(1.0, closing);
}

}  // namespace taut
