#include "benchmarks/peers/friction_peer.h"
#include "solvers/friction/friction_solver.h"

/// solve_friction().  Its tolerance is the residual itself, so that one is enough.
namespace {

using namespace taut;
using namespace taut::peers;

FrictionSolve take(const FrictionProblem& problem, const std::string&) {
  return [&problem](const Eigen::VectorXd& start, double tolerance) {
    const bool cold = start.isZero(0);
    const FrictionResult result = solve_friction(problem, {.accuracy = tolerance}, cold ? nullptr : &start);
    return FrictionTry{.r = result.r,
                       .excluded = result.status == FrictionStatus::kNoSolution,
                       .counts = {{"rung", kFrictionRungNames[static_cast<std::size_t>(result.rung)]},
                                  {"factorisations", result.factorisations},
                                  {"sweeps", result.sweeps}}};
  };
}

}  // namespace

int main(int argc, char** argv) {
  return friction_peer_main(argc, argv, {.solver = "taut", .tolerances = {1e-8}, .take = take});
}
