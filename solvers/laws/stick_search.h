#pragma once

#include <span>
#include <vector>

#include "solvers/laws/contact_rows.h"
#include "solvers/laws/friction_linearization.h"

namespace taut {

/// Contacts that stick hold as long as any division of the load among them does.
///
/// "Assume it locked, solve, keep it within the static limit" is a question to the system, not to each
/// contact: one point that passes its disc and goes on with dynamic friction would take the others along.
/// The normality law of the cone of static friction is a convex minimum with one w.  Impulses within the
/// cones with which nothing slips meet it, whatever they are; so if there are any it has w = t, which is
/// Coulomb's law, too, and if it slips there are none.  Then those are released that slip in both solutions.
///                                                                         (solvers/laws, "Static friction")
class StickSearch {
 public:
  StickSearch(ContactRows& contacts, FrictionLinearization& friction)
      : contacts_(contacts), friction_(friction) {}

  /// From here on contacts that stick are asked, in their cones and residuals, for impulses in the cone of
  /// static friction that obey its normality law.  False if none of those that slip at the rates w can be
  /// told to hold, since they are on bodies that are being struck, or slip by much of what friction at
  /// impulses λ could change: they are let go.
  bool begin(std::span<const double> lambda, std::span<const double> w);
  /// Unless they hold, all is as it was at begin(), but for those that were let go.
  void end(bool hold);
  /// Not ended yet.
  void go_on() { contacts_.set_normality(true); }
  /// Of those that slipped at begin() all that slip still, or all if it is not `judged` by the rates w, go on
  /// with dynamic friction.  True if that leaves some to share the load anew.
  bool mark_sliding(std::span<const double> w, bool judged);
  /// Static friction was more than dynamic friction where it let go since begin().
  bool weakened() const { return weakened_; }

 private:
  std::vector<int> struck_bodies() const;
  std::vector<double> friction_of_bodies(std::span<const double> lambda) const;
  bool is_far(int k, std::span<const double> w, std::span<const double> friction) const;
  bool choose_candidates(std::span<const double> lambda, std::span<const double> w);
  void release(int k);

  ContactRows& contacts_;
  FrictionLinearization& friction_;
  std::vector<ContactConstraints::Point> before_;  // of begin()
  double residual_before_ = 0;
  bool weakened_ = false;
};

}  // namespace taut
