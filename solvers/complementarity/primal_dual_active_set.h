#pragma once

#include <span>
#include <vector>

#include "solvers/laws/natural_residual.h"
#include "solvers/laws/row_law.h"
#include "solvers/system/constraint_system.h"

namespace taut {

class Archive;

/// Constants of PrimalDualActiveSet: parts and counts.  Chosen, where nothing else is said.
struct PrimalDualTuning {
  /// Iterations go on until they take away less than half of what is left; so many in a row that do not are
  /// given up.  kProgress: twice takes up to 4 times the factorisations of walls and stacks;
  /// kStuck: half takes 2.2 times the back-solves of a card house.
  static constexpr double kProgress = 0.5;
  static constexpr int kStuck = 2;
  /// An earlier factor serves as long as it leaves less than this part, and W has changed by less than that.
  static constexpr double kServes = 0.3, kNearby = 1e-6;
  /// Better than this part of the impulses is round-off.
  static constexpr double kExact = 1e-14;
  /// Iterations, at most.
  static constexpr int kMostIterations = 8;
  /// Σ of rows on a vertical over S_rr: it acts on the change of an iteration only.
  static constexpr double kSoftness = 1e-6;
};

/// When it ends.
struct PrimalDualLimits {
  double tolerance = ResidualTuning::kMet;  ///< of the natural residual over the size of impulses
  double rate_tolerance = 0;                ///< errors of rates below this do not count [m/s or rad/s]
  int iterations = PrimalDualTuning::kMostIterations;
  double softness = PrimalDualTuning::kSoftness;  ///< Σ over S_rr
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
  using Tuning = PrimalDualTuning;

  /// The natural residual over all rows [√J].
  struct Error {
    LargestResidual largest, counted;  ///< of all rows, and of those beyond the tolerance of rates
    double scale = 0;                  ///< size of impulses
  };

  void begin(std::size_t rows);
  Error choose_segments(std::span<const RowLaw> laws, std::span<const double> lambda,
                        std::span<const double> w, double rate_tolerance);
  void correct(std::span<const RowLaw> laws, std::span<double> lambda, std::span<const double> w);
  bool factorize(std::span<const RowLaw> laws, double softness, bool serves, StageTimes& times);
  bool is_near(std::span<const RowLaw> laws) const;

  ConstraintSystem& system_;
  std::vector<int> segments_, factored_segments_;
  std::vector<double> diagonal_, stiffness_, change_, rates_, v_;  // S_rr, D, g and δλ, W v
  std::vector<double> factored_stiffness_, factored_weighted_;
  long version_ = -1;  // of the factor
};

}  // namespace taut
