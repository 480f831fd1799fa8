#include "solvers/system/make_factor.h"

#include "solvers/linear/cholmod_factor.h"
#include "solvers/linear/dense_factor.h"
#include "solvers/linear/multifrontal_factor.h"

namespace taut {
namespace {

struct CholmodTuning {
  /// Flops per entry of L from which on dense kernels pay: CHOLMOD's own switch [Chen2008].
  static constexpr double kFlopsOfSupernodes = 40;
};

std::unique_ptr<Factor> make_chosen(FactorChoice choice, const BlockOrdering& ordering, int rows,
                                    detail::LazyPool* threads) {
  using Method = CholmodFactor::Method;
  if (choice == FactorChoice::kCholmod)
    choice = ordering.flops >= CholmodTuning::kFlopsOfSupernodes * ordering.nonzeros
                 ? FactorChoice::kSupernodal
                 : FactorChoice::kSimplicial;
  if (choice == FactorChoice::kDense && rows > kMostDenseRows) choice = FactorChoice::kMultifrontal;
  switch (choice) {
    case FactorChoice::kDense:
      return std::make_unique<DenseFactor>();
    case FactorChoice::kSimplicial:
      return std::make_unique<CholmodFactor>(Method::kSimplicial);
    case FactorChoice::kSupernodal:
      // Without CHOLMOD's GPL modules its simplicial factor does the same work; name() tells which it is.
      return std::make_unique<CholmodFactor>(CholmodFactor::has_supernodal() ? Method::kSupernodal
                                                                             : Method::kSimplicial);
    default:
      return std::make_unique<MultifrontalFactor>(threads);
  }
}

}  // namespace

std::unique_ptr<Factor> make_factor(FactorChoice choice, const BlockOrdering& ordering, int rows,
                                    const FactorMeans& means) {
  std::unique_ptr<Factor> factor = make_chosen(choice, ordering, rows, means.threads);
  factor->set_ordering(ordering.method);
  return factor;
}

}  // namespace taut
