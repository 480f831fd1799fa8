#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace taut {

/// Results of `taut bench`: "schema", "machine", "quick", "engines", "runs", "profiles".
using BenchResults = nlohmann::ordered_json;
constexpr const char* kBenchSchema = "taut-bench/2";

/// Processor, cores, memory, compiler, BLAS, load.
nlohmann::ordered_json machine_description();

/// The page for reading: best peer per scene with and without contact, where a peer is ahead, growth with
/// size, shares, all runs.
std::string bench_page(const BenchResults& results, const std::string& command);

/// A gnuplot script that draws errors against time, one picture per scene, and time against size.
/// @param folder for the pictures
std::string bench_plots(const BenchResults& results, const std::string& folder);

/// Ratios to an earlier run, taut's only.
struct BenchComparison {
  std::string text;
  std::vector<std::size_t> worse;  ///< indices of runs that take longer by more than the factor, or are open
  int compared = 0;
};
BenchComparison compare_bench(const BenchResults& now, const BenchResults& then, double factor);

/// Whether a run is the better measurement of the two: it moved, and took less processor time.  What else the
/// machine does only adds time.
bool is_better_measurement(const nlohmann::ordered_json& run, const nlohmann::ordered_json& other);

}  // namespace taut
