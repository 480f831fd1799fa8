#pragma once

#include <span>
#include <vector>

#include "solvers/common/settings.h"
#include "solvers/complementarity/row_impulses.h"
#include "solvers/laws/contact_laws.h"
#include "solvers/laws/row_law.h"

namespace taut {

/// Constants of ImpulseIteration.  Chosen, where nothing else is said.
struct ImpulseIterationTuning {
  /// Sweeps over a level before it is taken as immovable.
  static constexpr int kLevelSweeps = 10;
  /// Joints of more rows are solved row by row: blocks of fixed capacity.
  static constexpr int kMostRows = 6;
  /// Part of S added to the diagonal of a joint's diagonal_of block, whose rows may depend on each other.
  static constexpr double kShift = 1e-12;
};

struct IterationLimits {
  Solver order = Solver::kGaussSeidel;
  int sweeps = 50;        ///< at most; as many blocks as the system has count as one
  double relaxation = 1;  ///< ω of successive over-relaxation
  double tolerance = 0;   ///< of the residual [√J]
};

struct IterationOutcome {
  int sweeps = 0;
  double residual = 0;  ///< largest √S_rr |change of λ_r| in the last sweep [√J]
  bool converged = false;
};

/// The iterative alternatives to factor and active set: w = S λ + b with the law of each row, by impulses on
/// one joint or contact after the other, each of which mends that one while all others rest.
///
///   kGaussSeidel   row by row, projected, over-relaxed by ω
///   kPairwise      a whole joint or contact at once, the one that is violated most always first
///   kPropagation   the same from the ground upwards; at last level by level, with all levels below as if of
///                  infinite mass, which take no impulse [Guendelman2003]
///
/// All but the last phase of kPropagation keep momenta.
/// (solvers/complementarity, "Iterative impulses")
class ImpulseIteration {
 public:
  /// For as long as the system keeps its rows.
  explicit ImpulseIteration(ConstraintSystem& system);

  /// `lambda`: a start, then the result; `w`: its rates.  What bodies of levels below did not take is added
  /// to `absorbed`: momenta change by Jᵀλ − absorbed.
  IterationOutcome solve(const ContactLaws& contacts, std::span<const RowLaw> laws, std::span<const double> b,
                         std::span<double> lambda, std::span<double> w, const IterationLimits& limits,
                         std::span<Wrench> absorbed);

 private:
  using Tuning = ImpulseIterationTuning;

  struct Problem {
    const ContactLaws& contacts;
    std::span<const RowLaw> laws;
    std::span<const double> b;
    std::span<double> lambda;
    double relaxation;
    std::span<Wrench> absorbed;
  };

  double rate(const Problem& problem, int row) const { return impulses_.rate(row, problem.b[row]); }
  double diagonal_of(int row) const;
  void change(const Problem& problem, int row, double by);
  double next_of(const Problem& problem, int row) const;
  double relax_row(const Problem& problem, int row);
  double relax_contact(const Problem& problem, int block);
  double relax_joint(const Problem& problem, int block);
  double relax(const Problem& problem, int block);
  double violation(const Problem& problem, int block);
  double sweep(const Problem& problem, bool by_rows);
  void work_off_queue(const Problem& problem, const IterationLimits& limits, IterationOutcome& outcome);
  void find_levels();
  int level_of(int block) const;
  void propagate(const Problem& problem);

  ConstraintSystem& system_;
  RowImpulses impulses_;
  std::vector<double> diagonal_;  // S_rr of the bodies that are not held fast
  std::vector<double> target_, scratch_, answer_;
  std::vector<ContactLaws::Cone> cones_;
  std::vector<char> frozen_;        // bodies
  std::vector<int> level_, order_;  // of bodies; blocks by level
  std::vector<int> stamp_;          // of blocks: older entries of the queue are void
};

}  // namespace taut
