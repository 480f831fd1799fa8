#include "tests/source_dir.h"

namespace taut::testing {

std::string source_dir() { return TAUT_SOURCE_DIR; }

}  // namespace taut::testing
