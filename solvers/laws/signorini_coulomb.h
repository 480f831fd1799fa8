#pragma once

#include "solvers/laws/contact_cone.h"
#include "solvers/laws/contact_rows.h"

// The law of one contact in the present stage: Signorini, Newton and Coulomb, or a spring.
//                                                                                 (solvers/laws, "Contacts")
namespace taut {

/// Along its normal: Signorini's law and Newton's of impact, or that of a spring.
ContactConstraints::NormalLaw normal_law(const ContactRows& contacts, int k);
/// Where its tangents are at rest.
ContactConstraints::SlipLaw sliding_law(const ContactRows& contacts, int k);
/// Its friction proportional to the rate of turning.
LinearFriction linear_friction(const ContactRows& contacts, int k);
/// What its impulses may be.
ContactCone contact_cone(const ContactRows& contacts, int k);

}  // namespace taut
