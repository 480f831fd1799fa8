#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace taut {

/// λ and w of the round with the least residual among those that were offered.
class BestRound {
 public:
  /// None; room for so many rows.
  void begin(std::size_t rows) {
    lambda_.reserve(rows);
    w_.reserve(rows);
    residual_ = std::numeric_limits<double>::infinity();
  }
  void offer(std::span<const double> lambda, std::span<const double> w, double residual) {
    if (!(residual < residual_)) return;
    residual_ = residual;
    lambda_.assign(lambda.begin(), lambda.end());
    w_.assign(w.begin(), w.end());
  }
  /// Infinite if there is none.
  double residual() const { return residual_; }
  /// False if there is none.
  bool restore(std::span<double> lambda, std::span<double> w) const {
    if (!std::isfinite(residual_)) return false;
    std::copy(lambda_.begin(), lambda_.end(), lambda.begin());
    std::copy(w_.begin(), w_.end(), w.begin());
    return true;
  }

 private:
  std::vector<double> lambda_, w_;
  double residual_ = std::numeric_limits<double>::infinity();
};

}  // namespace taut
