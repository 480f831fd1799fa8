#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenes/accuracy/contact_truths.h"

namespace taut::reference {

/// How many rows came to which verdict.
struct TruthTotals {
  int cases = 0, pass = 0, fail = 0;
};
TruthTotals totals_of(const std::vector<ContactResult>& results);

/// For reading: rows that miss their truth first, then all, by case.
/// @param summary those that miss alone, and a line per case
std::string contact_table(const std::vector<ContactResult>& results, bool summary);
nlohmann::ordered_json contact_json(const std::vector<ContactResult>& results);
/// A line per row and step.
std::string contact_csv(const std::vector<ContactResult>& results);

}  // namespace taut::reference
