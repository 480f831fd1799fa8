#pragma once

#include <span>

#include "core/state/state.h"
#include "solvers/laws/contact_rows.h"
#include "solvers/system/mass_matrix.h"

namespace taut {

/// Bodies that drift from poses q₀ to q₁ in h, with momenta p.
struct ContactDrift {
  const MassMatrix& mass;
  std::span<const Pose> start, end;
  std::span<const Wrench> momenta;
  double h;
};

/// Where the surfaces that face each other in a contact are at other poses.
struct MovedContact {
  double gap;   ///< [m]
  bool found;   ///< the normal along which the gap is largest
  Vec3 normal;  ///< from A to B
  Vec3 P, Q;    ///< from the centres of mass of A and of B, world axes
};

/// By the surfaces around P and Q, with these turns of the bodies since the contact was found: balls,
/// corners, edges and faces exactly, other surfaces with an error of the third order.
MovedContact moved_contact(const Contact& contact, const Pose& A, const Pose& B, const Mat3& turn_A,
                           const Mat3& turn_B);

/// Mean rates of contact rows in a drift, in place of J(q₀) M⁻¹ p: along the normal what the gap has changed,
/// across it and about it the mean of the rates at both ends.  Where bodies hardly turn and slip they stay as
/// they are.                                                                     (solvers/laws, "Contacts")
void drift_rates(ContactRows& contacts, const ContactDrift& drift, std::span<double> rates);

}  // namespace taut
