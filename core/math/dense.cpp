#include "core/math/dense.h"

#include <Eigen/Dense>

namespace taut::dense {

Eigenpairs symmetric_eigenpairs(const Matrix& A) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(A);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

Eigenpairs3 symmetric_eigenpairs3(const Mat3& A) {
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(A);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

Vec3 symmetric_eigenvalues3(const Mat3& A) {
  return Eigen::SelfAdjointEigenSolver<Mat3>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

Eigenpairs generalized_eigenpairs(const Matrix& K, const Matrix& M) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> eigen(K, M);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

SingularValues singular_values(const Matrix& A, double part) {
  Eigen::JacobiSVD<Matrix> svd(A, Eigen::ComputeThinU | Eigen::ComputeFullV);
  if (part > 0) svd.setThreshold(part);
  return {svd.matrixU(), svd.matrixV(), svd.singularValues(), svd.rank()};
}

Matrix pseudo_inverse(const SingularValues& A) {
  return A.V.leftCols(A.rank) * A.values.head(A.rank).cwiseInverse().asDiagonal() *
         A.U.leftCols(A.rank).transpose();
}

Matrix product(const Matrix& A, const Matrix& B) { return A * B; }

Matrix solve(const Matrix& A, const Matrix& B) { return A.partialPivLu().solve(B); }

Vec3 solve_symmetric3(const Mat3& A, const Vec3& b) { return A.ldlt().solve(b); }

}  // namespace taut::dense
