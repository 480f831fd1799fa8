#pragma once

#include <string>
#include <vector>

#include "solvers/common/step_report.h"

namespace taut {

/// "a, b, c": all names, or the first seven, the last and how many.
std::string list_of(const std::vector<std::string>& names);

}  // namespace taut
