#pragma once

#include <algorithm>
#include <span>
#include <vector>

namespace taut {

class Archive;

/// What the first kick's λ will be, from the steps before.  λ is the μ of the second kick at the same instant
/// plus an asymmetry of order h², which is extrapolated: the error of the prediction is of order h⁴.
/// (solvers/integrators, "RATTLE")
class MultiplierPrediction {
 public:
  explicit MultiplierPrediction(int rows);

  /// Nothing is known: loads jump.
  void restart() { history_ = 0; }
  /// Nothing is known: loads jump, and the last μ is 0.
  void start();
  bool has_history() const { return history_ > 0; }

  /// The last μ, scaled to a step of h; 0 without history.  Of the first `count` rows only; the others stay.
  void repeat(double h, int count, std::span<double> lambda) const;
  /// The last μ and its asymmetry, extrapolated.
  void extrapolate(double h, std::span<double> lambda) const;
  /// For dependent rows: whether λ may start from the last μ at all.  μ was solved from 0 with this same S
  /// and has no part in its null space; what is extrapolated over steps would have one, and let it grow.
  /// Where a direction is held so weakly that μ leans on it and still was not exact, λ starts from 0 for some
  /// steps.
  bool takes_from_dependent_rows();
  void start_from_zero();

  /// After a step of h with these impulses; `struck`: that of an impact, which no later step will have.
  void keep(double h, std::span<const double> lambda, std::span<const double> mu, bool struck);

  /// For schemes that only repeat their impulses: a step of h has been.
  void keep_step(double h) { history_ = 1, last_h_ = h; }
  double scale(double h) const { return h / last_h_; }

  /// Rows that have no impulse any more, as of joints that broke.
  void clear(std::span<const int> rows);
  void clear_from(int first_row) { std::fill(mu_.begin() + first_row, mu_.end(), 0.0); }
  /// Row r was `from[r]`; −1: new.
  void move_rows(std::span<const int> from);

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);

 private:
  std::vector<double> mu_, asymmetry_, last_asymmetry_;  // (λ − μ)/h² of the last two steps
  int history_ = 0;                                      // steps that these are from, at most 3
  int cold_start_steps_ = 0;                             // to come
  double last_h_ = 0;
};

}  // namespace taut
