#pragma once

#include "core/world.h"
#include "solvers/settings.h"
#include "solvers/step_report.h"

namespace taut {

/// See Simulator::analyze_rank.
RankReport analyze_rank(const World& world, const Settings& settings);

}  // namespace taut
