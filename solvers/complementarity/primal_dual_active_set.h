#pragma once

#include <span>
#include <vector>

#include "solvers/laws/row_law.h"
#include "solvers/system/constraint_system.h"

namespace taut {

class Archive;

/// When it ends.
struct PrimalDualLimits {
  double tolerance = 1e-9;    ///< of the natural map over the size of impulses
  double rate_tolerance = 0;  ///< errors of rates below this do not count [m/s or rad/s]
  int iterations = 8;
  double softness = 1e-6;  ///< Σ over S_rr
};

/// How it went.
struct PrimalDualOutcome {
  int iterations = 0;  ///< two products with S and a back-solve each
  double residual = 0;
  bool converged = false;  ///< else λ is what it came to
};

/// w = S λ + b with λ_r ∈ L_r(w_r) − c_r w_r from a guess whose segments are nearly right, through the
/// bodies: a row on a vertical w_k is to get w_k, one on a level l has λ = l − c w,
///
///     P v = Wᵀ g,   δλ = g − D W v,    D = 1/Σ, g = (w_k − w)/Σ   or   D = c, g = l − λ − c w.
///
/// Then the segments are those that each row by itself would take [HintermullerItoKunisch2003].  Σ is a
/// small part of S_rr and acts on δλ only.  The factor is kept as long as W and the segments are the same,
/// from velocities of a step to positions of the next.  (solvers/complementarity, "Many axes with friction")
class PrimalDualActiveSet {
 public:
  explicit PrimalDualActiveSet(ConstraintSystem& system) : system_(system) {}

  /// S = W Wᵀ with the W that the system has; contacts must have laws of rows.  `lambda`: a guess, then the
  /// result; `w`: its rates.
  PrimalDualOutcome solve(std::span<const RowLaw> laws, std::span<const double> b, std::span<double> lambda,
                          std::span<double> w, const PrimalDualLimits& limits, StageTimes& times);

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  /// A factor that still serves is made again.
  void transfer(Archive& archive);
  void forget_factor() { version_ = -1; }

 private:
  bool factorize(std::span<const RowLaw> laws, double softness, bool serves, StageTimes& times);
  bool is_near(std::span<const RowLaw> laws) const;

  ConstraintSystem& system_;
  std::vector<int> segments_, factored_segments_;
  std::vector<double> own_, stiffness_, change_, rates_, v_;  // S_rr, D, g and δλ, W v
  std::vector<double> factored_stiffness_, factored_weighted_;
  long version_ = -1;  // of the factor
};

}  // namespace taut
