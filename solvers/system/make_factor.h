#pragma once

#include <memory>

#include "solvers/common/settings.h"
#include "solvers/linear/block_ordering.h"
#include "solvers/linear/factor.h"

namespace taut {

/// The factor that is chosen, for a matrix of this order and fill.  FactorChoice::kCholmod takes the
/// simplicial one where dense kernels do not pay.
std::unique_ptr<Factor> make_factor(FactorChoice choice, const BlockOrdering& ordering);

}  // namespace taut
