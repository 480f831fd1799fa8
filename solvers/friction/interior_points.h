#pragma once

#include <vector>

#include "solvers/friction/scaled_friction.h"
#include "solvers/linear/unsymmetric_factor.h"

namespace taut {

/// Parts.  Chosen, where nothing else is said.
struct InteriorPointsTuning {
  /// Part of the way to the boundary of the cones that a step goes.  Chosen.  Half and twice: 3.7 and 2.4
  /// times the factorisations of spheres in a box.
  static constexpr double kBoundary = 0.9;
  /// y and z at the start, as parts of the largest |q|.  With both 1, two of 81 problems less are solved,
  /// with both 0.1 twelve in place of six need the path.
  static constexpr double kFirstImpulse = 1, kFirstRate = 0.1;
  /// Compliance that keeps the matrix regular, of equalities and of all, as a part of the mean diagonal of W.
  /// Chosen.
  static constexpr double kEqualityCompliance = 1e-10, kCompliance = 1e-12;
};

/// Impulses y = D⁻¹ r and opened rates z within the cones |y_T| ≤ y_N, |z_T| ≤ z_N, D = diag(1/μ, 1, 1).
/// Equalities have z = 0.                                                   (solvers/friction, Eq. 5)
struct InteriorPoints {
  /// Within all cones, of the size of q.
  explicit InteriorPoints(const ScaledFriction& problem);

  Eigen::VectorXd y, z, P;

  Eigen::VectorXd impulses() const { return y.cwiseProduct(P); }
  /// How many blocks have cones.
  int cones() const { return cones_; }
  /// The mean of y·z over the cones, now or after a part of a step.  @{
  double gap() const;
  double gap_after(double part, const Eigen::VectorXd& dy, const Eigen::VectorXd& dz) const;  /// @}
  /// Dᵀ (W D y + q) − z + n √(z_T² + smooth²).
  Eigen::VectorXd residual(double smooth = 0) const;
  /// How far y ∘ z is from centre·1: the largest |eigenvalue/centre − 1|.
  double off_centre(double centre) const;
  /// The part of a step that goes so far to the boundary of the first cone that it meets, at most `most`.
  double way(const Eigen::VectorXd& dy, const Eigen::VectorXd& dz, double boundary, double most) const;
  void go(double part, const Eigen::VectorXd& dy, const Eigen::VectorXd& dz) {
    y += part * dy;
    z += part * dz;
  }

  const ScaledFriction& problem;

 private:
  int cones_ = 0;
};

/// Newton's equations of  y ∘ z → target,  residual → 0  at one pair, scaled by Nesterov and Todd.
class InteriorNewton {
 public:
  /// `smooth` as in InteriorPoints::residual().
  explicit InteriorNewton(const InteriorPoints& at, double smooth = 0);

  /// False if the matrix is singular.
  [[nodiscard]] bool factorize() { return factor_.factorize(matrix_); }
  /// δy, δz that make of the residual res − part·res and add `right` to λ ∘ λ = y ∘ z in scaled variables.
  [[nodiscard]] bool direction(const Eigen::VectorXd& right, const Eigen::VectorXd& residual, double part,
                               Eigen::VectorXd& dy, Eigen::VectorXd& dz);

  /// centre·1 − λ ∘ λ.
  Eigen::VectorXd to_centre(double centre) const;
  /// centre·1.
  Eigen::VectorXd unit(double centre) const;
  /// (T⁻¹ δy) ∘ (T δz), what Newton's equations leave out.
  Eigen::VectorXd second_order(const Eigen::VectorXd& dy, const Eigen::VectorXd& dz) const;
  /// (T⁻¹ δy)·(T⁻¹ εy) + (T δz)·(T εz), the product that measures steps by their way to the boundary.
  double inner(const Eigen::VectorXd& dy, const Eigen::VectorXd& dz, const Eigen::VectorXd& ey,
               const Eigen::VectorXd& ez) const;

 private:
  /// T z = T⁻¹ y = λ of a block, and G = 1 − n z_Tᵀ/√(z_T² + smooth²).
  struct Scaling {
    Mat3 T = Mat3::Zero(), inverse = Mat3::Zero(), inverse_squared = Mat3::Zero(), G = Mat3::Identity();
    Vec3 lambda = Vec3::Zero();
  };
  void scale(int b, double smooth);
  void assemble();
  template <typename Function>
  void each_cone(const Function& function) const;

  const ScaledFriction& problem_;
  const InteriorPoints& at_;
  std::vector<Scaling> scaling_;
  RowMatrix matrix_;
  UnsymmetricFactor factor_;
};

}  // namespace taut
