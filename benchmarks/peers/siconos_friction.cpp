#include "benchmarks/peers/siconos_friction.h"

#include <FrictionContactProblem.h>
#include <Friction_cst.h>
#include <NonSmoothDrivers.h>
#include <NumericsVerbose.h>
#include <SolverOptions.h>

#include <cstdio>
#include <stdexcept>

namespace taut::peers {
namespace {

int solver_id(const std::string& name) {
  if (name == "vi") return SICONOS_FRICTION_3D_VI_EG;
  if (name == "prox") return SICONOS_FRICTION_3D_PROX;
  if (name == "nsn") return SICONOS_FRICTION_3D_NSN_AC;
  if (name == "nsgs") return SICONOS_FRICTION_3D_NSGS;
  if (name == "admm") return SICONOS_FRICTION_3D_ADMM;
  throw std::invalid_argument("solver: must be vi, prox, nsn, nsgs or admm (value: " + name + ")");
}

}  // namespace

SiconosFriction::SiconosFriction(const std::string& text) {
  std::string kept = text;
  std::FILE* file = fmemopen(kept.data(), kept.size(), "r");
  if (!file) throw std::runtime_error("no memory for a file");
  problem_ = frictionContact_newFromFile(file);
  std::fclose(file);
  if (!problem_) throw std::runtime_error("Siconos cannot read the problem");
  numerics_set_verbose(0);
}

SiconosFriction::~SiconosFriction() { frictionContactProblem_free(problem_); }

SiconosFrictionOutcome SiconosFriction::solve(const SiconosFrictionSettings& settings,
                                              std::vector<double>& r) {
  SolverOptions* options = solver_options_create(solver_id(settings.solver));
  options->dparam[SICONOS_DPARAM_TOL] = settings.tolerance;
  options->iparam[SICONOS_IPARAM_MAX_ITER] = settings.iterations;
  // Of its line searches the one that solves most.
  if (settings.solver == "nsn")
    options->iparam[SICONOS_FRICTION_3D_NSN_LINESEARCH] = SICONOS_FRICTION_3D_NSN_LINESEARCH_GOLDSTEINPRICE;
  std::vector<double> velocity(r.size(), 0.0);
  SiconosFrictionOutcome outcome;
  outcome.info = fc3d_driver(problem_, r.data(), velocity.data(), options);
  outcome.iterations = options->iparam[SICONOS_IPARAM_ITER_DONE];
  solver_options_delete(options);
  return outcome;
}

}  // namespace taut::peers
