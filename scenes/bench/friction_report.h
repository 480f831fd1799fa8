#pragma once

#include <string>
#include <vector>

#include "scenes/bench/bench_report.h"

namespace taut {

/// A solver of friction problems as `taut bench --friction` runs it.
struct FrictionRun {
  std::string peer;    ///< program peer_friction_<peer>
  std::string method;  ///< which of its solvers
  std::string start;   ///< "cold", or "warm": q moved by 1 %, from what it found before

  std::string label() const;  ///< "taut cold", "siconos vi"
};

/// Those that take part, taut's first.
std::vector<FrictionRun> friction_plan();

/// The page for reading: shares solved, factorisations, times, goals, where taut loses first, all runs.
/// `results`: "schema", "machine", "limit_s" and "runs", lines of the peers' JSON.
std::string friction_page(const BenchResults& results, const std::string& command);

/// Where taut loses first: what a peer solves and taut does not, then by how much it is slower.
std::string friction_losses(const BenchResults& results);

/// A gnuplot script of the performance profiles of Dolan and Moré, of all problems and of the large ones: the
/// share of problems that a solver has solved within a factor of the time of whoever was fastest.
/// @param folder for the pictures
std::string friction_plots(const BenchResults& results, const std::string& folder);

}  // namespace taut
