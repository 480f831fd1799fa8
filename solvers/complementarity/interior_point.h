#pragma once

#include <span>
#include <vector>

#include "solvers/laws/natural_residual.h"
#include "solvers/laws/row_law.h"
#include "solvers/system/constraint_system.h"

namespace taut {

/// Constants of InteriorPoint: parts.  Chosen, where nothing else is said.
struct InteriorPointTuning {
  /// Compliance of equalities over S_rr: it acts on the change of an iteration only.
  static constexpr double kEqualityRho = 1e-7;
  /// κ at the start over the mean power of the elements, and the least over the largest energy of one.
  static constexpr double kFirstMu = 0.1, kLeastMu = 1e-6;
  /// Part of the way to the boundary that is gone.  Half: 3.5 times the factorisations of a net with
  /// friction; twice fails.
  static constexpr double kInside = 0.995;
  /// Steps at most, a factorisation each.
  static constexpr int kMostSteps = 60;
};

/// When it ends.
struct InteriorLimits {
  double tolerance = ResidualTuning::kMet;  ///< of the natural residual over the size of impulses
  int iterations = InteriorPointTuning::kMostSteps;
};

/// How it went.
struct InteriorOutcome {
  int iterations = 0;  ///< a factorisation and two back-solves each
  double residual = 0;
  bool converged = false;
};

/// w = S λ + b with λ_r ∈ L_r(w_r) − c_r w_r for every row, by a primal–dual interior point method with
/// predictor and corrector [Mehrotra1992], through the bodies (primal_matrix.h).  Each step of a law is an
/// element with an impulse e of its own, λ_r = l + Σ e_k − c w_r, and
///
///     w − w_k = z − z',    (e − lo) z = κ,  (hi − e) z' = κ,    lo ≤ e ≤ hi,  z, z' ≥ 0,   κ → 0.
///
/// The number of iterations hardly depends on how many rows there are or how many of them stick, and S may be
/// singular.  (solvers/complementarity, "Many axes with friction")
class InteriorPoint {
 public:
  explicit InteriorPoint(ConstraintSystem& system) : system_(system) {}

  /// S = W Wᵀ with the W that the system has; there must be no contacts.  `lambda`: a guess, then the result;
  /// `w`: its rates.
  InteriorOutcome solve(std::span<const RowLaw> laws, std::span<const double> b, std::span<double> lambda,
                        std::span<double> w, const InteriorLimits& limits, StageTimes& times);

 private:
  using Tuning = InteriorPointTuning;

  /// One step of the law of a row.
  struct Element {
    int row;
    double at, lo, hi;     // w_k and the range of e
    double p = 0, q = 0;   // e − lo and hi − e, each without cancellation
    double z = 0, z2 = 0;  ///< z and z'
    double de = 0, dz = 0, dz2 = 0;
    double target_z = 0, target_z2 = 0;
    double stiffness = 0, off = 0;  // δe = −stiffness (δw + off)
  };
  struct Problem {
    std::span<const RowLaw> laws;
    std::span<const double> b;
    std::span<double> lambda, w;
  };

  void begin(const Problem& problem);
  void add_elements(const RowLaw& law, int row);
  void center(Element& element, double w, double kappa) const;
  void update_impulses(const Problem& problem);
  void set_stiffness(const Problem& problem, double kappa, bool correct);
  void direction(const Problem& problem);
  double longest(double most) const;
  double mean_product(double length) const;
  void move(const Problem& problem, double length);
  double relative_residual(const Problem& problem);

  ConstraintSystem& system_;
  std::vector<Element> elements_;
  std::vector<double> diagonal_, base_, stiffness_, off_, change_;  // S_rr, l, of rows, δw
  std::vector<double> rates_;                                       // b + W v
  std::vector<double> v_, step_;
};

}  // namespace taut
