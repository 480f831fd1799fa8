#pragma once

#include <memory>

#include "solvers/linear/factor.h"

namespace taut {

/// CHOLMOD [Chen2008] as a Factor: simplicial L D Lᵀ or supernodal L Lᵀ.
class CholmodFactor final : public Factor {
 public:
  enum class Method { kSimplicial, kSupernodal };

  explicit CholmodFactor(Method method);
  ~CholmodFactor() override;

  SymmetricMatrix::Triangle triangle() const override;
  void analyze(const SymmetricMatrix& A) override;
  [[nodiscard]] int factorize(const SymmetricMatrix& A) override;
  void solve(std::span<double> x) override;
  std::span<const double> relative_pivots() const override;
  std::string name() const override;
  double flops() const override;
  std::int64_t nonzeros() const override;

  /// Whether this CHOLMOD was built with its (GPL) supernodal module.
  static bool has_supernodal();

 private:
  void read_pivots(const SymmetricMatrix& A);

  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// The BLAS in use, "OpenBLAS 0.3.21 …" or "a BLAS that does not tell its name".
std::string blas_name();

}  // namespace taut
