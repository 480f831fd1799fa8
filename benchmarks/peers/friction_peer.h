#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "solvers/friction/friction_problem.h"

/// Friction problems in one solver, measured in one way.  Each solver is a program of its own, as engines
/// are.
namespace taut::peers {

/// What a solver has made of a problem.
struct FrictionTry {
  Eigen::VectorXd r;
  bool excluded = false;          ///< shown to have no solution
  nlohmann::ordered_json counts;  ///< of its own work
};

/// A solver that has taken a problem up: solves it from a start to a tolerance.
using FrictionSolve = std::function<FrictionTry(const Eigen::VectorXd& start, double tolerance)>;

/// A solver's program.
struct FrictionPeer {
  std::string solver;              ///< its name
  std::vector<double> tolerances;  ///< tried in turn until the residual is 1e-8; the last one alone is timed
  /// Takes up a problem without equalities; what that takes is not timed.
  std::function<FrictionSolve(const FrictionProblem& problem, const std::string& method)> take;
};

/// main() of it: options --problem (a file, or stage:NUMBER, or stage:NUMBER:SIZE), --method, --start (cold
/// or warm: q is moved by 1 %, the guess is what it found before), --limit [s of processor time].  After each
/// tolerance a line of JSON is printed, with the residuals of solvers/friction; whoever is killed at the
/// limit leaves the lines before.  With --list N the files in the tree and N random stages, one a line.
/// @returns 0 unless the options are wrong.
int friction_peer_main(int argc, char** argv, const FrictionPeer& peer);

}  // namespace taut::peers
