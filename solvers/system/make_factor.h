#pragma once

#include <memory>

#include "solvers/common/settings.h"
#include "solvers/linear/block_ordering.h"
#include "solvers/linear/factor.h"

namespace taut {

namespace detail {
class LazyPool;
}

/// What a system may use.  Each may be null, or outlives it.
struct FactorMeans {
  OrderMemory* orders = nullptr;        ///< patterns that last get the cheapest order that is found
  detail::LazyPool* threads = nullptr;  ///< of large factors, and of loops over many bodies
};

/// The factor that is chosen, for a matrix of so many rows in this order.  FactorChoice::kCholmod takes the
/// simplicial one where dense kernels do not pay, kDense the multifrontal one where a dense matrix is too
/// large.
std::unique_ptr<Factor> make_factor(FactorChoice choice, const BlockOrdering& ordering, int rows,
                                    const FactorMeans& means = {});

}  // namespace taut
