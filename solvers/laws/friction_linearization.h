#pragma once

#include <span>
#include <vector>

#include "solvers/laws/contact_residual.h"
#include "solvers/laws/contact_rows.h"
#include "solvers/system/constraint_system.h"

namespace taut {

class Archive;

/// Coulomb's law as laws of rows: squares for discs that hold, and for discs that slip a level along the slip
/// and a slope across it.  The radius of a disc follows from the normal impulse, and the way in which it is
/// crossed from the slip: both are renewed by each solution of a stage, in the table of contacts, until they
/// agree.                                                        (solvers/complementarity, "The active set")
class FrictionLinearization {
 public:
  explicit FrictionLinearization(ContactRows& contacts) : contacts_(contacts) {}

  /// Compares a solution of a stage with Coulomb's law.  True if radius, slip or stick of a contact is not
  /// what the laws had: then they are renewed, and the stage must be solved again.
  bool adapt(std::span<const double> lambda, std::span<const double> w, double rate_tolerance);
  /// Radii and slips as they are at this solution.
  void take_over(std::span<const double> lambda, std::span<const double> w, double rate_tolerance) {
    (void)adapt(lambda, w, rate_tolerance);
    turns_.clear();
  }
  /// The largest distance from Coulomb's law at the last adapt(), relative.
  double residual() const { return residual_; }
  /// After the table was put back to what it was when the residual was this.
  void restore(double residual) {
    residual_ = residual;
    turns_.clear();
  }

  /// Tangents that are better turned: place and the direction (cos, sin) of the new t₁ in the old frame.
  struct Turn {
    int place;
    double cos, sin;
  };
  const std::vector<Turn>& turns() const { return turns_; }
  /// The turns have been made in everything that has a row: now in J and in the discs.
  void turned(ConstraintSystem& system);

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);

 private:
  double size_of(std::span<const double> lambda) const;
  double renew(int k, std::span<const double> lambda, std::span<const double> w, double rate_tolerance);
  double renew_disc(int k, ContactTable::Disc& disc, const DiscState& state, double bound, bool stuck,
                    double rate_tolerance);
  void ask_for_turn(int k, const ContactTable::Disc& disc);
  void mark_stretched();

  ContactRows& contacts_;
  std::vector<Turn> turns_;
  double residual_ = 0, scale_ = 0;
};

}  // namespace taut
