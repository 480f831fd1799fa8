#include "solvers/complementarity/anderson_extrapolation.h"

#include <algorithm>

namespace taut {

void AndersonExtrapolation::begin(int n) {
  for (auto* values : {&last_s_, &last_f_, &next_}) values->setZero(n);
  for (auto* values : {&steps_, &changes_}) values->setZero(n, Tuning::kMemory);
  remembered_ = 0;
}

const Eigen::VectorXd& AndersonExtrapolation::extrapolate(const Eigen::VectorXd& s, const Eigen::VectorXd& f,
                                                          double mixing) {
  next_ = s + mixing * f;
  if (remembered_ > 0) {
    const int column = (remembered_ - 1) % Tuning::kMemory;
    steps_.col(column) = s - last_s_;
    changes_.col(column) = f - last_f_;
    subtract_combination(f, mixing);
  }
  last_s_ = s;
  last_f_ = f;
  ++remembered_;
  return next_;
}

/// next −= Σ γ_i (δs_i + mixing δf_i) with the γ of the least |f − Σ γ_i δf_i|, by normal equations.
void AndersonExtrapolation::subtract_combination(const Eigen::VectorXd& f, double mixing) {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, Tuning::kMemory, Tuning::kMemory>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, Tuning::kMemory, 1>;
  const int m = std::min(remembered_, Tuning::kMemory);
  Matrix normal = Matrix::Zero(m, m);
  Vector gamma = Vector::Zero(m);
  for (int i = 0; i < m; ++i) {
    gamma[i] = changes_.col(i).dot(f);
    for (int j = 0; j <= i; ++j) normal(i, j) = normal(j, i) = changes_.col(i).dot(changes_.col(j));
  }
  normal.diagonal().array() += Tuning::kRegularization * normal.trace();
  gamma = normal.ldlt().solve(gamma);
  if (!gamma.allFinite()) gamma.setZero();
  for (int i = 0; i < m; ++i) next_ -= gamma[i] * (steps_.col(i) + mixing * changes_.col(i));
}

}  // namespace taut
