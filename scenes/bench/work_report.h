#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scenes/bench/bench_report.h"

namespace taut {

/// Exponent of a least-squares line through log(y) over log(x); none through fewer than two places.
std::optional<double> growth_exponent(const std::vector<std::pair<double, double>>& points);

/// Links of the chains of "Methods on a chain".
std::vector<int> method_sizes(bool quick);
/// Where the first of two curves through the same places x, in their order, has come to be above the other
/// for good, by straight lines through their logarithms: 0 if it is from the start; none if it is not at the
/// end.
std::optional<double> crossing(const std::vector<std::pair<double, double>>& first,
                               const std::vector<std::pair<double, double>>& second);

/// "Work of a step": of each profile time of a step, factor beside a bare CHOLMOD, fill, operations, stages,
/// joints, energy and memory; then exponents of growth by family of scenes, what threads gain, and from where
/// on one method is faster than another.
std::string work_tables(const BenchResults& results);

}  // namespace taut
