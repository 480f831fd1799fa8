#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenes/accuracy/reference_run.h"

namespace taut::reference {

/// A case at its step and at half of it.
struct CaseResult {
  std::string file{};
  std::string error{};          ///< why the file could not be read; then there are no runs
  std::vector<CaseRun> runs{};  ///< all with the same quantities
};

/// How many quantities came to which verdict; the worse of the two steps counts.
struct Totals {
  int cases = 0, unreadable = 0;
  int pass = 0, fail = 0, not_measured = 0, orientation = 0;
};
Totals totals_of(const std::vector<CaseResult>& results);

nlohmann::ordered_json accuracy_json(const std::vector<CaseResult>& results);
std::string accuracy_csv(const std::vector<CaseResult>& results);
/// For reading.  @param summary a line per case and one per quantity that failed, no others
std::string accuracy_table(const CaseResult& result, bool summary);
std::string accuracy_totals(const Totals& totals);

}  // namespace taut::reference
