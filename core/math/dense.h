#pragma once

#include "core/math/so3.h"

/// Decompositions of dense matrices by Eigen, compiled once: each costs the source that asks for it seconds.
namespace taut::dense {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

/// A x = ω x: values ascending, vectors[:, i] the one of values[i].
struct Eigenpairs {
  Vector values;
  Matrix vectors;
};
struct Eigenpairs3 {
  Vec3 values;
  Mat3 vectors;
};

/// Of symmetric A, of which the lower triangle is read.  Vectors are of length 1.
Eigenpairs symmetric_eigenpairs(const Matrix& A);
Eigenpairs3 symmetric_eigenpairs3(const Mat3& A);
Vec3 symmetric_eigenvalues3(const Mat3& A);

/// K x = ω M x of symmetric K and positive definite M; xᵀ M x = 1.
Eigenpairs generalized_eigenpairs(const Matrix& K, const Matrix& M);

/// A = U diag(values) Vᵀ: values descending, U [m × min(m, n)], V square [n × n].
struct SingularValues {
  Matrix U, V;
  Vector values;
  Eigen::Index rank = 0;  ///< how many values are above a part of the first
};
/// With that part; 0: round-off.
SingularValues singular_values(const Matrix& A, double part = 0);

/// A⁺, which takes the values beyond the rank as 0: of all x with the least |A x − b| the shortest is A⁺ b.
Matrix pseudo_inverse(const SingularValues& A);

/// A B
Matrix product(const Matrix& A, const Matrix& B);

/// A⁻¹ B by LU with row interchanges.
Matrix solve(const Matrix& A, const Matrix& B);

/// A⁻¹ b of symmetric positive definite A.
Vec3 solve_symmetric3(const Mat3& A, const Vec3& b);

}  // namespace taut::dense
