#pragma once

#include <Eigen/SparseCore>
#include <algorithm>

namespace taut {

/// Frictional contact at one moment, given by matrices.  Of the impulses r and the rates
///     u = W r + q                                                          (solvers/friction, Eq. 1)
/// the first `equalities` rows ask for u = 0; then each contact has three, the normal and two tangents, and
///     K* ∋ u + μ |u_T| n  ⊥  r ∈ K = {|r_T| ≤ μ r_N}                       (solvers/friction, Eq. 2)
/// W is positive semidefinite but for round-off of whoever wrote it; it need not be symmetric.
struct FrictionProblem {
  using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;  ///< compressed rows

  Matrix W;            ///< n × n, n = equalities + 3 contacts; [1/kg] for impulses of points [N·s]
  Eigen::VectorXd q;   ///< n; rates without impulses [m/s]
  Eigen::VectorXd mu;  ///< coefficient of friction of each contact, not negative
  int equalities = 0;  ///< rows before those of contacts

  int rows() const { return equalities + 3 * contacts(); }      ///< n
  int contacts() const { return static_cast<int>(mu.size()); }  ///< of three rows each

  /// @throws std::invalid_argument naming what has another size, is not finite or negative.
  void require_valid() const;
  /// The contacts alone, whose joints hold:  W = W_cc − W_ce W_ee⁺ W_ec,  q = q_c − W_ce W_ee⁺ q_e,  with
  /// e the equalities, which may depend on each other.
  /// @throws std::invalid_argument naming what has another size, is not finite or negative.
  FrictionProblem without_equalities() const;
};

/// A friction problem whose bodies are not eliminated:  M v = H r + f,  u = Hᵀ v + b.
struct GlobalFrictionProblem {
  FrictionProblem::Matrix M;  ///< m × m; invertible
  FrictionProblem::Matrix H;  ///< m × n
  Eigen::VectorXd f;          ///< m
  Eigen::VectorXd b;          ///< n
  Eigen::VectorXd mu;         ///< of each contact
  int equalities = 0;         ///< the first columns of H

  /// W = Hᵀ M⁻¹ H,  q = Hᵀ M⁻¹ f + b.
  /// @throws std::invalid_argument if sizes do not agree or M is singular.
  FrictionProblem condensed() const;
};

/// How far impulses are from the laws, three measures that do not depend on units.  δ is the mean diagonal of
/// W over the rows of a contact, or that of an equality, P_K the projection onto K.
struct FrictionErrors {
  /// max √δ |F| / max(√δ |r|, |q|/√δ),  F = r − P_K(r − û/δ); of equalities F = u/δ.
  double impulses = 0;
  /// max √δ |F| / max(|q|/√δ): how far the rates are off where impulses are much larger than q needs.
  double rates = 0;
  /// |r − P_K(r − û/|W|₂)|₂ |W|₂ / |q|₂.
  double map = 0;
  /// What round-off of W r + q alone makes of `rates`, and of `map`: 16 ε |W| |r| over the same.
  double round_off = 0;
  /// The row of the problem with the largest √δ |F|; −1 if all are 0.
  int worst_row = -1;

  /// Met to the tolerance, or as far as rates can be told.
  bool met(double tolerance) const {
    return impulses <= tolerance && std::max(rates, map) <= std::max(tolerance, round_off);
  }
  double largest() const { return std::max({impulses, rates, map}); }  ///< of the three
};

/// @throws std::invalid_argument as the problem's require_valid(), or if r has another size.
FrictionErrors friction_errors(const FrictionProblem& problem, const Eigen::VectorXd& r);

}  // namespace taut
