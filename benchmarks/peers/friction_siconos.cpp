#include <memory>

#include "benchmarks/peers/friction_peer.h"
#include "benchmarks/peers/siconos_friction.h"
#include "scenes/files/friction_file.h"

/// Siconos' solvers of local problems: vi, prox, nsn, nsgs, admm, each as it comes but for its tolerance.
/// That depends on units, so it is lowered until the residual is what is asked for, or the last is reached.
namespace {

using namespace taut;
using namespace taut::peers;

FrictionSolve take(const FrictionProblem& problem, const std::string& method) {
  const auto there = std::make_shared<SiconosFriction>(friction_text(problem));
  return [there, method](const Eigen::VectorXd& start, double tolerance) {
    std::vector<double> r(start.begin(), start.end());
    const SiconosFrictionOutcome outcome = there->solve({.solver = method, .tolerance = tolerance}, r);
    return FrictionTry{.r = Eigen::Map<const Eigen::VectorXd>(r.data(), std::ssize(r)),
                       .counts = {{"iterations", outcome.iterations}, {"info", outcome.info}}};
  };
}

}  // namespace

int main(int argc, char** argv) {
  return friction_peer_main(argc, argv,
                            {.solver = "siconos", .tolerances = {1e-8, 1e-10, 1e-12, 1e-14}, .take = take});
}
