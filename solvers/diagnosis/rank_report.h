#pragma once

#include "core/world/world.h"
#include "solvers/common/settings.h"
#include "solvers/common/step_report.h"

namespace taut {

/// See Simulator::analyze_rank.
RankReport analyze_rank(const World& world, const Settings& settings);

}  // namespace taut
