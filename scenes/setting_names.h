#pragma once

#include <string>
#include <utility>
#include <vector>

#include "solvers/settings.h"

namespace taut {

/// Names of the choices among the Settings, as options of the program have them.
template <typename Choice>
using Names = std::vector<std::pair<std::string, Choice>>;

const Names<Integrator>& integrator_names();
const Names<TensionPolicy>& tension_names();
const Names<DriftCure>& drift_cure_names();
const Names<FactorChoice>& factor_names();

std::string name_of(Integrator integrator);

}  // namespace taut
