#include "solvers/integrators/reduced/beyond_rows.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/interruption.h"
#include "solvers/complementarity/active_set.h"

namespace taut {
namespace {

/// Chosen, where nothing else is said.
struct BeyondTuning {
  /// Of A over that of free bodies: an eigenvalue below which rows depend on each other; its root is what
  /// gaps may make of such rows where joints are closed.
  static constexpr double kDependent = 1e-12;
  /// In the same scale, pivots of its Cholesky factor above which no such eigenvalue is looked for.
  static constexpr double kSafePivot = 1e-8;
  /// Of the largest λ or w of a row, both in that scale: what may be missed without a move to another
  /// segment.
  static constexpr double kDecision = 1e-12;
  /// In the same scale, by how much rows of a free set may miss their rates and not contradict each other.
  static constexpr double kContradiction = 1e-6;
  /// Of all rows where rounds do not end, in that scale.
  static constexpr double kCompliance = 1e-9;
  /// Sweeps before rounds are tried again, four times as many each time.
  static constexpr int kSweeps = 50, kMostSweeps = 4000;
  /// Rounds of pivoting in all, and more for each row.
  static constexpr int kRounds = 50, kRoundsOfARow = 2;
};

/// A λ = −b by Cholesky's L Lᵀ; false, and nothing is written, where a pivot is small.
bool solve_by_pivots(const dense::Matrix& A, const dense::Vector& b, dense::Vector& lambda) {
  const Eigen::Index n = A.rows();
  dense::Matrix L = A;
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index k = 0; k < j; ++k) L.col(j).tail(n - j) -= L(j, k) * L.col(k).tail(n - j);
    if (!(L(j, j) > BeyondTuning::kSafePivot)) return false;
    L.col(j).tail(n - j) /= std::sqrt(L(j, j));
  }
  lambda = -b;
  for (Eigen::Index j = 0; j < n; ++j) {
    lambda[j] /= L(j, j);
    lambda.tail(n - j - 1) -= lambda[j] * L.col(j).tail(n - j - 1);
  }
  for (Eigen::Index j = n; j-- > 0;)
    lambda[j] = (lambda[j] - L.col(j).tail(n - j - 1).dot(lambda.tail(n - j - 1))) / L(j, j);
  return true;
}

/// λ = −A⁺ b, with a rank that is known or found.
dense::Vector solve_least_norm(const dense::Matrix& A, const dense::Vector& b, RankDeficit& deficit) {
  if (!A.allFinite()) return dense::Vector::Constant(b.size(), NAN);
  const dense::Eigenpairs pairs = dense::symmetric_eigenpairs(A);  // ascending
  if (deficit.rows < 0)
    deficit.rows = static_cast<int>(std::count_if(pairs.values.begin(), pairs.values.end(), [](double value) {
      return !(value > BeyondTuning::kDependent);
    }));
  dense::Vector parts = -(pairs.vectors.transpose() * b);
  for (Eigen::Index i = 0; i < parts.size(); ++i)
    parts[i] = i >= deficit.rows && pairs.values[i] > 0 ? parts[i] / pairs.values[i] : 0;
  return pairs.vectors * parts;
}

dense::Vector solve_scaled(const dense::Matrix& A, const dense::Vector& b, RankDeficit& deficit) {
  dense::Vector lambda;
  if (deficit.rows > 0 || !solve_by_pivots(A, b, lambda)) return solve_least_norm(A, b, deficit);
  deficit.rows = 0;
  return lambda;
}

/// Pivoting on rows in the scale of free bodies: λ̄ = λ/s, w̄ = s w with s = 1/√S_rr.
class BeyondPivoting {
 public:
  BeyondPivoting(const BeyondRows& rows, const dense::Vector& scale, std::span<const RowLaw> laws,
                 std::span<int> segments)
      : scale_(scale),
        laws_(laws),
        segments_(segments),
        A_(scale.asDiagonal() * rows.A * scale.asDiagonal()),
        b_(scale.cwiseProduct(rows.b)),
        lambda_(dense::Vector::Zero(b_.size())),
        w_(b_),
        moves_(b_.size()) {}

  /// Where rows depend on each other, or are many, rounds may not end: then, in the limit of a vanishing
  /// compliance of all rows, from where sweeps row by row have come to.
  bool solve() {
    if (pivot()) return true;
    A_.diagonal().array() += BeyondTuning::kCompliance;
    lambda_.setZero();
    w_ = b_;
    bool found = false;
    for (int sweeps = BeyondTuning::kSweeps; !found && sweeps <= BeyondTuning::kMostSweeps; sweeps *= 4) {
      for (int sweep = 0; sweep < sweeps; ++sweep) sweep_rows();
      const dense::Vector swept = lambda_;
      found = pivot();
      if (!found) w_ = A_ * (lambda_ = swept) + b_;
    }
    A_.diagonal().array() -= BeyondTuning::kCompliance;
    if (found) solve_segments();
    return found && lambda_.allFinite();
  }
  dense::Vector lambda() const { return scale_.cwiseProduct(lambda_); }
  dense::Vector rates() const { return w_.cwiseQuotient(scale_); }

 private:
  bool pivot() {
    const int most = BeyondTuning::kRounds + BeyondTuning::kRoundsOfARow * static_cast<int>(b_.size());
    auto fewest = b_.size() + 1;
    for (int round = 0, in_vain = 0; round < most; ++round) {
      detail::poll_interrupt();
      solve_segments();
      if (!lambda_.allFinite()) return false;
      const auto wrong = find_moves();
      if (wrong == 0) return true;
      in_vain = wrong < fewest ? 0 : in_vain + 1;
      fewest = std::min(fewest, wrong);
      for (Eigen::Index r = 0; r < b_.size(); ++r) {
        if (moves_[r] == 0) continue;
        segments_[r] += moves_[r];
        if (in_vain > ActiveSetTuning::kBlockTrials) break;
      }
    }
    return false;
  }
  /// Each row in turn takes the λ that its law allows while the others stay.
  void sweep_rows() {
    for (Eigen::Index r = 0; r < b_.size(); ++r) {
      const double s = scale_[r], S = A_(r, r) / (s * s), lambda = s * lambda_[r];
      const RowLaw::Point point = laws_[r].resolve(S, w_[r] / s - S * lambda);
      const double change = (point.lambda - lambda) / s;
      segments_[r] = point.segment;
      lambda_[r] += change;
      w_ += change * A_.col(r);
    }
  }
  bool is_free(Eigen::Index r) const { return RowLaw::is_vertical(segments_[r]); }
  /// Rates of rows on vertical segments are theirs, the λ of the others that of their levels.
  void solve_segments() {
    std::vector<Eigen::Index> free;
    for (Eigen::Index r = 0; r < b_.size(); ++r) {
      if (is_free(r)) free.push_back(r);
      lambda_[r] = is_free(r) ? 0 : laws_[r].force(segments_[r]) / scale_[r];
    }
    w_ = A_ * lambda_ + b_;
    const auto count = std::ssize(free);
    dense::Matrix A(count, count);
    dense::Vector b(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      b[i] = w_[free[i]] - scale_[free[i]] * laws_[free[i]].rate(segments_[free[i]]);
      for (Eigen::Index j = 0; j < count; ++j) A(i, j) = A_(free[i], free[j]);
    }
    RankDeficit found;
    if (count > 0) b = solve_scaled(A, b, found);
    for (Eigen::Index i = 0; i < count; ++i) lambda_[free[i]] = b[i];
    w_ = A_ * lambda_ + b_;
  }
  Eigen::Index find_moves() {
    const double near_lambda = BeyondTuning::kDecision * lambda_.cwiseAbs().maxCoeff();
    const double largest_w = std::max(b_.cwiseAbs().maxCoeff(), w_.cwiseAbs().maxCoeff());
    const double near_w = BeyondTuning::kDecision * largest_w;
    Eigen::Index wrong = 0;
    for (Eigen::Index r = 0; r < b_.size(); ++r) {
      const RowLaw& law = laws_[r];
      const int segment = segments_[r];
      const double s = scale_[r];
      if (is_free(r)) {
        moves_[r] = lambda_[r] > law.high(segment) / s + near_lambda  ? -1
                    : lambda_[r] < law.low(segment) / s - near_lambda ? 1
                                                                      : 0;
        // Where dependent rows ask for rates that exclude each other, one gives way that can.
        const double off = w_[r] - s * law.rate(segment);
        const int way = off > 0 ? 1 : -1;
        if (moves_[r] == 0 && std::abs(off) > BeyondTuning::kContradiction * largest_w &&
            law.exists(segment + way))
          moves_[r] = way;
      } else {
        moves_[r] = w_[r] < s * law.first(segment) - near_w  ? -1
                    : w_[r] > s * law.last(segment) + near_w ? 1
                                                             : 0;
      }
      wrong += moves_[r] != 0;
    }
    return wrong;
  }

  const dense::Vector& scale_;
  std::span<const RowLaw> laws_;
  std::span<int> segments_;
  dense::Matrix A_;
  dense::Vector b_, lambda_, w_;
  std::vector<int> moves_;
};

/// 1/√S_rr; of what nothing moves, 1.
dense::Vector scale_of(const BeyondRows& rows) {
  dense::Vector scale = rows.alone;
  for (double& s : scale) s = s > 0 ? 1 / std::sqrt(s) : 1;
  return scale;
}

}  // namespace

dense::Vector solve_closed(const BeyondRows& rows, RankDeficit& found) {
  const dense::Vector scale = scale_of(rows);
  found = {};
  return scale.cwiseProduct(
      solve_scaled(scale.asDiagonal() * rows.A * scale.asDiagonal(), scale.cwiseProduct(rows.b), found));
}

dense::Vector solve_equalities(const BeyondRows& rows, const RankDeficit& known) {
  const dense::Vector scale = scale_of(rows);
  RankDeficit deficit = known;
  return scale.cwiseProduct(
      solve_scaled(scale.asDiagonal() * rows.A * scale.asDiagonal(), scale.cwiseProduct(rows.b), deficit));
}

bool solve_laws(const BeyondRows& rows, std::span<const RowLaw> laws, std::span<int> segments,
                dense::Vector& lambda, dense::Vector& w) {
  if (rows.b.size() == 0) return true;
  const dense::Vector scale = scale_of(rows);
  BeyondPivoting pivoting(rows, scale, laws, segments);
  const bool found = pivoting.solve();
  lambda = pivoting.lambda();
  w = pivoting.rates();
  return found;
}

}  // namespace taut
