#pragma once

#include <span>

#include "solvers/laws/contact_rows.h"
#include "solvers/laws/natural_residual.h"

// The natural residual of contacts: how far impulses are from what Signorini's and Coulomb's laws answer to
// them and their rates, λ* = prox(λ − (w − t)/(S + c)) with the compliance c of the contact.
//                                                           (solvers/complementarity, "Natural residual")
namespace taut {

/// A disc of a contact at a solution of a stage.
struct DiscState {
  Vec2 tau = Vec2::Zero(), slip = Vec2::Zero();  ///< impulse of both kicks and rate off the law's target
  double root = 1, softness = 0;                 ///< √S_rr of its rows, the larger one, and compliance
  double slope = 0;                              ///< of friction proportional to the slip, beside the disc

  /// Of τ at the slip.
  NaturalResidual residual(double bound) const {
    const double diagonal = root * root + softness;
    return {root, diagonal,
            (tau - into_disc(tau - slip / diagonal, bound, part_of_slope(slope, diagonal))).norm()};
  }
  /// What the disc gives of τ.
  Vec2 within() const { return tau + slope * slip; }
};
DiscState sliding_state(const ContactRows& contacts, int k, std::span<const double> lambda,
                        std::span<const double> w);
DiscState rolling_state(const ContactRows& contacts, int k, std::span<const double> lambda,
                        std::span<const double> w);

/// Of each law of a contact.
struct ContactResidual {
  NaturalResidual normal, sliding, spinning, rolling;
  NaturalResidual cone;  ///< in place of normal and sliding where it obeys the normality law (stick_search.h)
};
/// Of contact k; of one that does not work, 0.
ContactResidual natural_residual(const ContactRows& contacts, int k, std::span<const double> lambda,
                                 std::span<const double> w);

/// Of the spinning row of contact k alone.
NaturalResidual spinning_residual(const ContactRows& contacts, int k, std::span<const double> lambda,
                                  std::span<const double> w);

/// Adds those of all contacts [√J], 0 where rates are met to the tolerance, but for those of the normality
/// law.
void add_contacts(const ContactRows& contacts, std::span<const double> lambda, std::span<const double> w,
                  double rate_tolerance, LargestResidual& largest);

/// Rates that are as good as none [rad/s], [m/s].
struct RateSize {
  double angular = 0, linear = 0;
};
/// The largest of contact k at the end of a stage, with nothing taken off, over `scale` [√J], or what it
/// takes to change a rate by `least` if that is more.
double relative_contact_residual(const ContactRows& contacts, int k, std::span<const double> lambda,
                                 std::span<const double> w, double scale, const RateSize& least);

}  // namespace taut
