#include "scenes/reference_contacts.h"

#include "scenes/reference_probes.h"

namespace taut::reference {

PairContact pair_contact(const Simulator&, const Pair&) { throw NotMeasured("contacts"); }

}  // namespace taut::reference
