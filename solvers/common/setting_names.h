#pragma once

#include <utility>

#include "solvers/common/settings.h"

/// Names of the choices among the Settings, as scene files and the options of the program have them.
namespace taut {

inline constexpr std::pair<const char*, Integrator> kIntegratorNames[] = {
    {"rattle", Integrator::kRattle},
    {"rattle4", Integrator::kRattle4},
    {"rattle6", Integrator::kRattle6},
    {"rattle8", Integrator::kRattle8},
    {"force-euler", Integrator::kForceEuler},
    {"force-runge-kutta", Integrator::kForceRungeKutta},
    {"moreau-jean", Integrator::kMoreauJean},
    {"recursive", Integrator::kRecursive},
    {"recursive-midpoint", Integrator::kRecursiveMidpoint},
    {"lagrangian", Integrator::kLagrangian},
    {"lagrangian-midpoint", Integrator::kLagrangianMidpoint},
};
inline constexpr std::pair<const char*, TensionPolicy> kTensionNames[] = {
    {"substep", TensionPolicy::kSubstep},
    {"implicit", TensionPolicy::kImplicit},
    {"ignore", TensionPolicy::kIgnore},
};
inline constexpr std::pair<const char*, DriftCure> kDriftCureNames[] = {
    {"auto", DriftCure::kAuto},
    {"none", DriftCure::kNone},
    {"baumgarte", DriftCure::kBaumgarte},
    {"velocity-impulse", DriftCure::kVelocityImpulse},
    {"position-push", DriftCure::kPositionPush},
    {"penalty", DriftCure::kPenalty},
};
inline constexpr std::pair<const char*, FactorChoice> kFactorNames[] = {
    {"auto", FactorChoice::kAuto},
    {"cholmod", FactorChoice::kCholmod},
    {"simplicial", FactorChoice::kSimplicial},
    {"supernodal", FactorChoice::kSupernodal},
    {"multifrontal", FactorChoice::kMultifrontal},
    {"dense", FactorChoice::kDense},
};

inline constexpr std::pair<const char*, Solver> kSolverNames[] = {
    {"direct", Solver::kDirect},
    {"gauss-seidel", Solver::kGaussSeidel},
    {"pairwise", Solver::kPairwise},
    {"propagation", Solver::kPropagation},
};

/// The name of a value in its table, or "".
template <typename Choice, std::size_t count>
const char* name_of(Choice choice, const std::pair<const char*, Choice> (&names)[count]) {
  for (const auto& [name, value] : names)
    if (value == choice) return name;
  return "";
}

}  // namespace taut
