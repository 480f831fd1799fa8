#include "tests/sanitized.h"

namespace taut::testing {

bool sanitized() { return TAUT_CHECKED; }

}  // namespace taut::testing
