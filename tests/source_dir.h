#pragma once

#include <string>

namespace taut::testing {

/// The folder of the checkout, for files that tests read.
std::string source_dir();

}  // namespace taut::testing
