#pragma once

#include <Eigen/Core>
#include <cmath>
#include <span>
#include <vector>

#include "solvers/complementarity/anderson_extrapolation.h"
#include "solvers/complementarity/contact_problem.h"

namespace taut {

/// What of Coulomb's law a proximal round holds fast: the shift s = μ |u_t| of its cone, the radius μ Λ_n of
/// its disc, or nothing.
enum class Lag { kSlip, kRadius, kNothing };

/// The part of Coulomb's law that a proximal round holds fast, of all contacts, and how it follows from round
/// to round: with s = μ |u_t| along the normals the law is the normality law of the cone [DeSaxce1998]; with
/// a radius μ Λ_n it is that of a disc.  Both are extrapolated.  (solvers/complementarity, Eq. 5)
class LaggedFriction {
 public:
  /// s = 0 and the radii of the guess λ.
  void begin(const ContactProblem& problem, Lag lag);
  /// The next round holds `lag` fast: what belongs to the impulses y and rates w of the last one,
  /// extrapolated if that held the same.  Returns how far off the lagged values were [√J]; −∞ without
  /// contacts.
  /// @pre lag is not kNothing.
  double advance(const ContactProblem& problem, std::span<const double> y, Lag lag);
  /// The next round holds nothing fast.
  void hold_nothing();
  /// Rounds until now count no longer.
  void forget() { extrapolation_.forget(); }

  Lag lag() const { return lag_; }
  bool holds_nothing() const { return lag_ == Lag::kNothing; }
  /// Compliant normals are decoupled from the disc, whose metric is another one.
  bool by_radius(const ContactLaws::Cone& cone) const {
    return !cone.shares && (lag_ != Lag::kSlip || cone.softness > 0 || std::isfinite(cone.most));
  }
  /// s in the rows of normals, 0 elsewhere [m/s].
  std::span<const double> shift() const { return shift_; }
  /// Radius of the disc of contact k [N·s].
  double radius(int k) const { return radius_[k]; }

 private:
  void read(const ContactProblem& problem, Eigen::VectorXd& s) const;
  void answer(const ContactProblem& problem, std::span<const double> y, Eigen::VectorXd& s) const;
  double extrapolate();
  void take(const ContactProblem& problem);

  Lag lag_ = Lag::kSlip;
  std::vector<double> shift_, radius_;
  Eigen::VectorXd s_, f_, next_;  // of contacts, what a round makes of it less that, the next one [√J]
  AndersonExtrapolation extrapolation_;
  int rounds_ = 0;
};

}  // namespace taut
