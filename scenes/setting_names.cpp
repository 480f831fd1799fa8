#include "scenes/setting_names.h"

namespace taut {

const Names<Integrator>& integrator_names() {
  static const Names<Integrator> names{
      {"rattle", Integrator::kRattle},          {"rattle4", Integrator::kRattle4},
      {"rattle6", Integrator::kRattle6},        {"rattle8", Integrator::kRattle8},
      {"force-euler", Integrator::kForceEuler}, {"force-runge-kutta", Integrator::kForceRungeKutta}};
  return names;
}

const Names<TensionPolicy>& tension_names() {
  static const Names<TensionPolicy> names{{"substep", TensionPolicy::kSubstep},
                                          {"implicit", TensionPolicy::kImplicit},
                                          {"ignore", TensionPolicy::kIgnore}};
  return names;
}

const Names<DriftCure>& drift_cure_names() {
  static const Names<DriftCure> names{{"none", DriftCure::kNone},
                                      {"baumgarte", DriftCure::kBaumgarte},
                                      {"velocity-impulse", DriftCure::kVelocityImpulse},
                                      {"position-push", DriftCure::kPositionPush},
                                      {"penalty", DriftCure::kPenalty}};
  return names;
}

const Names<FactorChoice>& factor_names() {
  static const Names<FactorChoice> names{{"auto", FactorChoice::kAuto},
                                         {"simplicial", FactorChoice::kSimplicial},
                                         {"supernodal", FactorChoice::kSupernodal},
                                         {"multifrontal", FactorChoice::kMultifrontal}};
  return names;
}

std::string name_of(Integrator integrator) {
  for (const auto& [name, value] : integrator_names())
    if (value == integrator) return name;
  return "";
}

}  // namespace taut
