#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scenes/bench/bench_report.h"

namespace taut {

/// Exponent of a least-squares line through log(y) over log(x); none through fewer than two places.
std::optional<double> growth_exponent(const std::vector<std::pair<double, double>>& points);

/// "Work of a step": of each profile time of a step, factor beside a bare CHOLMOD, fill, operations, stages,
/// joints, energy and memory; then exponents of growth by family of scenes.
std::string work_tables(const BenchResults& results);

}  // namespace taut
