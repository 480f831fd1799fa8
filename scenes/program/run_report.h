#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "scenes/program/run_record.h"
#include "scenes/recording/recorder.h"

namespace taut {

/// The report of a run as one JSON object; scenes/program/REPORT.md lists its keys.
/// @param values last sample of the recorder, empty if there was none
/// @param world in its final state
nlohmann::ordered_json run_report(const RunRecord& record, const Recorder& recorder,
                                  const std::vector<double>& values, const World& world);

/// What the summary (run_summary.h) leaves out, as a table of two columns: sizes, methods, times, counts.
std::string run_details(const RunRecord& record);

}  // namespace taut
