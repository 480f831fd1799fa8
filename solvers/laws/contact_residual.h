#pragma once

#include <span>

#include "solvers/laws/contact_rows.h"

// The natural residual of contacts, ‖λ − prox(λ − (w − t)/Σ)‖ √S with Σ = S_rr + compliance [√J]: how far
// impulses are from what Signorini's and Coulomb's laws answer to them and their rates.
namespace taut {

/// A disc of a contact at a solution of a stage.
struct DiscState {
  Vec2 tau = Vec2::Zero(), slip = Vec2::Zero();  ///< impulse of both kicks and rate off the law's target
  double root = 1, softness = 0;                 ///< √S of its rows, the larger one, and compliance

  /// Distance of τ from Coulomb's answer to it and the slip, P(τ − u/S) [√J].
  double residual(double bound) const;
};
DiscState sliding_state(const ContactRows& contacts, int k, std::span<const double> lambda,
                        std::span<const double> w);
DiscState rolling_state(const ContactRows& contacts, int k, std::span<const double> lambda,
                        std::span<const double> w);

/// Of the spinning row of contact k [√J].
double spinning_residual(const ContactRows& contacts, int k, std::span<const double> lambda,
                         std::span<const double> w);

/// Largest natural residual of contacts [√J]; 0 where rates are met to the tolerance.  Of contacts that share
/// (stick_search.h) it is the distance from the normality law of their cone.
double contact_residual(const ContactRows& contacts, std::span<const double> lambda,
                        std::span<const double> w, double rate_tolerance);

/// Rates that are as good as none [rad/s], [m/s].
struct RateSize {
  double angular = 0, linear = 0;
};
/// The same at the end of a stage, with nothing taken off, over `scale` [√J], or what it takes to change a
/// rate by `least` if that is more.
double relative_contact_residual(const ContactRows& contacts, std::span<const double> lambda,
                                 std::span<const double> w, double scale, const RateSize& least);
/// The same of contact k alone.
double relative_contact_residual(const ContactRows& contacts, int k, std::span<const double> lambda,
                                 std::span<const double> w, double scale, const RateSize& least);

}  // namespace taut
