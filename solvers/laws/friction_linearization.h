#pragma once

#include <span>
#include <vector>

#include "solvers/laws/contact_residual.h"
#include "solvers/laws/contact_rows.h"
#include "solvers/system/constraint_system.h"

namespace taut {

class Archive;

/// Radii of discs, which follow from normal impulses, and how discs are crossed, which follows from the slip:
/// both are taken from each solution of a stage into the table of contacts, for geometric stiffness, for laws
/// of rows where all contacts hold, and for what a contact remembers.
class FrictionLinearization {
 public:
  explicit FrictionLinearization(ContactRows& contacts) : contacts_(contacts) {}

  /// Radii and slips as they are at this solution of a stage.
  void take_over(std::span<const double> lambda, std::span<const double> w, double rate_tolerance);
  /// How far the solution before was from Coulomb's law with the radii and slips of then, relative.
  double residual() const { return residual_; }
  /// After the table was put back to what it was when the residual was this.
  void restore(double residual) { residual_ = residual; }

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);

 private:
  double size_of(std::span<const double> lambda) const;
  double renew(int k, std::span<const double> lambda, std::span<const double> w, double rate_tolerance);
  double renew_disc(ContactConstraints::Disc& disc, const DiscState& state, double bound, bool stuck,
                    double rate_tolerance);
  void mark_stretched();

  ContactRows& contacts_;
  double residual_ = 0, scale_ = 0;
};

}  // namespace taut
