#include "solvers/friction/friction_newton.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "solvers/linear/unsymmetric_factor.h"

namespace taut {
namespace {

using Vector = Eigen::VectorXd;

/// Factors, parts and counts; ρ in units of the mean diagonal of a block.  Chosen, where nothing else is
/// said.
struct FrictionNewtonTuning {
  /// Bounds of ρ: below the first it does nothing but for round-off, above the second steps are too short to
  /// be of use.
  static constexpr double kLeastRho = 1e-11, kMostRho = 1e2;
  /// ρ after a matrix that is singular or a step that was not taken, after a whole one, and after one shorter
  /// than kShortStep.  kRhoAfterShort: twice fails at a pile of rocks.
  static constexpr double kRhoAfterNone = 30, kRhoAfterWhole = 0.1, kRhoAfterShort = 3;
  /// Part of a step below which ρ grows, so that the next one is not cut down that far.
  static constexpr double kShortStep = 0.25;
  /// Steps are halved so often, at most.  Half: up to twice the sweeps.
  static constexpr int kHalvings = 6;
  /// Part of |G| that a whole step should take away.
  static constexpr double kDecrease = 0.1;
  /// A step to less than this part of the least residual is no idle one.
  static constexpr double kGain = 0.9;
  /// |G| below this part of the largest entry of q is round-off, and any step is taken.
  static constexpr double kRoundOff = 1e-15;
};

/// A(x) of a cone and its derivative; where nothing presses both are 0.
struct AlartCurnier {
  Vec3 y = Vec3::Zero();
  Mat3 D = Mat3::Zero();

  AlartCurnier(const Vec3& x, double mu) {
    if (!(x[0] > 0)) return;
    const double radius = mu * x[0], size = std::hypot(x[1], x[2]);
    y = x;
    D = Mat3::Identity();
    if (size <= radius) return;
    const double s = radius / size;
    const Eigen::Vector2d t = x.tail<2>() / size;
    y.tail<2>() *= s;
    D.bottomRightCorner<2, 2>() = s * (Eigen::Matrix2d::Identity() - t * t.transpose());
    D.bottomLeftCorner<2, 1>() = mu * t;
  }
};

/// One linearisation of G, of the rows that carry.
class Linearisation {
 public:
  explicit Linearisation(const ScaledFriction& problem)
      : problem_(problem), D_(problem.blocks().size()), row_(problem.rows()) {}

  /// G at x = r − γ u, with its derivative if that is wanted.
  Vector residual(const Vector& r, const Vector& x) {
    using Law = ScaledFriction::Law;
    Vector g = r;
    for (std::size_t b = 0; b < D_.size(); ++b) {
      const auto& [law, first, size, mu] = problem_.blocks()[b];
      if (law == Law::kCone) {
        const AlartCurnier at(x.segment<3>(first), mu);
        g.segment<3>(first) -= at.y;
        D_[b] = at.D;
      } else {
        const bool carries = law == Law::kEquality || x[first] > 0;
        if (carries) g[first] -= x[first];
        D_[b].setZero();
        D_[b](0, 0) = carries ? 1 : 0;
      }
    }
    return g;
  }

  /// Solves (1 − D + γ D (W + ρ)) δ = −G for δ.
  bool step(const Vector& g, double gamma, double rho, Vector& delta) {
    int n = 0;
    for (std::size_t b = 0; b < D_.size(); ++b) {
      const auto& block = problem_.blocks()[b];
      for (int i = 0; i < block.size; ++i) row_[block.first + i] = D_[b](0, 0) != 0 ? n++ : -1;
    }
    delta = -g;
    if (n == 0) return true;
    matrix_.row_start.assign(1, 0);
    matrix_.column.clear();
    matrix_.values.clear();
    right_.clear();
    for (std::size_t b = 0; b < D_.size(); ++b)
      if (row_[problem_.blocks()[b].first] >= 0) append(static_cast<int>(b), g, gamma, rho);
    solution_.resize(n);
    if (!factor_.factorize(matrix_) || !factor_.solve(right_, solution_)) return false;
    for (int i = 0; i < problem_.rows(); ++i)
      if (row_[i] >= 0) delta[i] = solution_[row_[i]];
    return true;
  }

 private:
  void append(int b, const Vector& g, double gamma, double rho) {
    const auto& block = problem_.blocks()[b];
    const auto columns = problem_.columns(block.first);
    const int diagonal = problem_.diagonal(block);
    std::array<std::span<const double>, 3> W;
    for (int i = 0; i < block.size; ++i) W[i] = problem_.values(block.first + i);
    for (int i = 0; i < block.size; ++i) {
      double right = -g[block.first + i];
      for (std::size_t k = 0; k < columns.size(); ++k) {
        double value = 0;
        for (int j = 0; j < block.size; ++j) value += D_[b](i, j) * W[j][k];
        value *= gamma;
        if (row_[columns[k]] < 0) {  // comes to rest at 0 in this step
          right += value * g[columns[k]];
          continue;
        }
        if (const int j = static_cast<int>(k) - diagonal; j >= 0 && j < block.size)
          value += (i == j ? 1 : 0) + (gamma * rho - 1) * D_[b](i, j);
        matrix_.column.push_back(row_[columns[k]]);
        matrix_.values.push_back(value);
      }
      matrix_.row_start.push_back(static_cast<int>(matrix_.column.size()));
      right_.push_back(right);
    }
  }

  const ScaledFriction& problem_;
  std::vector<Mat3> D_;
  std::vector<int> row_;
  RowMatrix matrix_;
  UnsymmetricFactor factor_;
  std::vector<double> right_, solution_;
};

}  // namespace

Vector FrictionNewton::solve(const ScaledFriction& problem, Vector r, BestImpulses& best) const {
  using Tuning = FrictionNewtonTuning;
  Linearisation linear(problem);
  const auto argument = [&](const Vector& at) -> Vector { return at - gamma * problem.rates(at); };
  const double enough = best.fully();
  double shift = rho, off = best.offer(r), least = off;
  std::vector<double> sizes{linear.residual(r, argument(r)).norm()};
  const double round_off = Tuning::kRoundOff * problem.largest_q();
  int idle = 0;
  for (int i = 0; i < steps && off > enough && idle < patience; ++i) {
    const Vector g = linear.residual(r, argument(r));
    Vector delta;
    ++best.factorisations;
    const bool regular = linear.step(g, gamma, shift, delta);
    const double bound =
        *std::max_element(sizes.end() - std::min<std::ptrdiff_t>(memory, std::ssize(sizes)), sizes.end());
    double part = 1, size = 0;
    Vector next;
    bool taken = false;
    for (int k = 0; regular && k < Tuning::kHalvings && !taken; ++k, part /= taken ? 1 : 2) {
      next = r + part * delta;
      size = linear.residual(next, argument(next)).norm();
      taken = size <= (1 - Tuning::kDecrease * part) * bound || size <= round_off;
    }
    if (!taken) {
      shift = std::min(Tuning::kRhoAfterNone * shift, Tuning::kMostRho);
      ++idle;
      continue;
    }
    r = next;
    sizes.push_back(size);
    shift *= part == 1 ? Tuning::kRhoAfterWhole : part < Tuning::kShortStep ? Tuning::kRhoAfterShort : 1;
    shift = std::max(shift, Tuning::kLeastRho);
    off = best.offer(r);
    idle = off < Tuning::kGain * least ? 0 : idle + 1;
    least = std::min(least, off);
  }
  return r;
}

}  // namespace taut
