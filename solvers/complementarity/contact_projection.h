#pragma once

#include <span>
#include <vector>

#include "solvers/complementarity/contact_problem.h"
#include "solvers/system/constraint_system.h"

namespace taut {

/// y = prox_Σ(x): the projection onto what the laws of rows and contacts allow, with its derivative ∂prox,
/// which is diagonal in rows of W that are turned: tangents along the slip and across it, and on the surface
/// of a cone the first one with the normal.  (solvers/complementarity, Eq. 3, 6)
class ContactProjection {
 public:
  explicit ContactProjection(ConstraintSystem& system) : system_(system) {}

  /// y = λ of the guess.
  void begin(std::span<const double> lambda);
  /// y and ∂prox of x, which is looked at until the next call.
  void project(const ContactProblem& problem, std::span<const double> x, std::span<const double> sigma);

  const std::vector<double>& y() const { return y_; }
  /// The diagonal of ∂prox; the caller may make D = ∂prox Σ⁻¹ of it.
  std::span<double> slope() { return slope_; }
  /// W in the rows in which ∂prox is diagonal, laid out like W.
  std::span<const double> turned() const { return turned_; }
  /// ∂y_t/∂y_n of contact k along its slip; 0 where it sticks, or shares a load by the law of the cone.
  double coupling(int k) const { return coupling_[k]; }

 private:
  static constexpr int kSlidingRow = ContactLaws::kSlidingRow, kSpinRow = ContactLaws::kSpinRow,
                       kRollingRow = ContactLaws::kRollingRow;

  void project_row(const RowLaw& law, double sigma, int row);
  void project_nothing(int k, int count);
  double project_normal(int k, const ContactLaws::Cone& cone);
  void project_cone(int k, const ContactLaws::Cone& cone);
  void project_twist(int k, const ContactLaws::Cone& cone);
  bool project_disc(int k, int first, const Vec2& given, double radius, double part = 0);
  void turn_rows(int k, double mu, int first, const Vec2& direction);
  int first_row(int k) const { return system_.rows().joints()[system_.rows().contact_joint(k)].first_row; }

  ConstraintSystem& system_;
  std::span<const double> x_, sigma_;
  std::vector<double> y_, slope_, turned_, coupling_;
};

}  // namespace taut
