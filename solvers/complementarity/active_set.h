#pragma once

#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "solvers/complementarity/projected_gauss_seidel.h"
#include "solvers/laws/natural_residual.h"
#include "solvers/laws/row_law.h"
#include "solvers/system/constraint_system.h"
#include "solvers/system/row_updates.h"

namespace taut {

class Archive;

enum class ActiveSetStatus {
  kSolved,
  kContradiction,  ///< some rows cannot take their rates together, whatever their impulses
  kNotConverged,   ///< neither pivoting nor its fall-back came to the tolerance
  kNotFinite,      ///< the matrix, b or the guess is not finite; λ is set to 0
};
std::string_view to_string(ActiveSetStatus status);

/// Constants of the active set and its descent: parts and counts.  Chosen, where nothing else is said.  Half
/// and twice of each: benchmarks/results/tuning.md.
struct ActiveSetTuning {
  /// Block rounds without fewer wrong rows before one row at a time is moved [JudicePires1994].
  static constexpr int kBlockTrials = 10;
  /// Rounds of one search: this many, and one more for every so many bounded rows.
  static constexpr int kMaxRounds = 60, kRowsOfARound = 4;
  /// A multiplier or rate outside its segment by less than this part of the scale stays: a tenth of the
  /// default tolerance of the residual.
  static constexpr double kDecision = 1e-10;
  /// Free rows are refined until they are this near to their targets, as a part of the scale, or stay where
  /// they are.
  static constexpr double kRefined = 1e-12;
  static constexpr int kMaxPasses = 10;
  /// A pass of the refinement that leaves more than this is the last.
  static constexpr double kPassProgress = 0.5;
  /// Sweeps of Gauss–Seidel before each minimisation of the descent.
  static constexpr int kSweeps = 2;
  /// Minimisations of the descent, at most.
  static constexpr int kMostDescents = 1000;
  /// Bisections of its line search: to round-off.
  static constexpr int kBisections = 60;
  /// Columns of an update of the factor in place of a new one: the first number, and one more for every so
  /// many flops per entry of L.  Measured: a factorisation costs 6 back-solves for chains (9 flops per
  /// entry), 8 to 10 for nets (30 to 80); a column costs a little more than its back-solve.
  /// kLeastColumns: half takes 3 times the factorisations of a small mechanism; it twice, or kFlopsOfAColumn
  /// half, takes 4.3 times the back-solves of a car.
  static constexpr int kLeastColumns = 4;
  static constexpr double kFlopsOfAColumn = 16;
};

struct ActiveSetSettings {
  double tolerance = ResidualTuning::kMet;  ///< of the natural residual, see ActiveSetOutcome
  double rate_tolerance = 0;  ///< rates that are off by less than this [m/s or rad/s] count as right
  bool update_factor = true;  ///< a few changed rows go through RowUpdates instead of a new factor
  /// Impulses in the null space of dependent rows stay as in the guess, instead of those of least norm.
  bool keep_null_space = false;
  int max_rounds = -1;  ///< of pivoting; −1: 60, and one more for every fourth bounded row
  int max_descent_rounds = ActiveSetTuning::kMostDescents;  ///< of the fall-back
};

/// How one solve went.
struct ActiveSetOutcome {
  ActiveSetStatus status = ActiveSetStatus::kSolved;
  int rounds = 0;              ///< sets that were tried after the first
  int pivots = 0;              ///< rows that changed their segment, summed over the rounds
  int least_index_rounds = 0;  ///< of the rounds, those that moved one row only (Murty)
  int descent_rounds = 0;      ///< of the fall-back, 0 if pivoting found the solution
  int factorizations = 0;
  /// The largest natural residual over the largest of √S_rr |λ_r|, |b_r| / √S_rr and |w_k| / √S_rr [√J]. Rows
  /// whose rate is off by no more than ActiveSetSettings::rate_tolerance do not count.
  double residual = 0;
  int worst_row = -1;  ///< the row with that residual

  bool ok() const { return status == ActiveSetStatus::kSolved; }
};

/// Finds λ and w = S λ + b with λ_r ∈ L_r(w_r) − c_r w_r for every row, by block principal pivoting on the
/// segments of the laws, starting from the segments that the last solve ended with.
/// (solvers/complementarity, "The active set")
///
/// w is unique; so are the impulses on the bodies Jᵀλ.  Where rows are dependent, λ is the one of least norm
/// among those with the same free rows.
class ActiveSet {
 public:
  /// The system must outlive it.
  explicit ActiveSet(ConstraintSystem& system);

  /// Tells the system which rows it will have to factor if the segments stay what they are: call it before
  /// ConstraintSystem::factorize().  `lambda` and `b` choose the segments of rows that have no history.
  void prepare(std::span<const RowLaw> laws, std::span<const double> b, std::span<const double> lambda);
  /// The system must have been factored for its present Jacobian.
  /// `lambda`: a first guess, then the result; `w`: result.  All spans have one entry a row.
  [[nodiscard]] ActiveSetOutcome solve(std::span<const RowLaw> laws, std::span<const double> b,
                                       std::span<double> lambda, std::span<double> w, StageTimes& times,
                                       const ActiveSetSettings& settings = {});

  /// x ← (S + Σ)⁺ x for the segments that solve() ended with: 0 for rows on a level without slope.  Only
  /// until the next ConstraintSystem::factorize().
  void solve_linear(std::span<double> x) { updates_.solve(x); }

  /// Segment of each row, as RowLaw counts them.
  std::span<const int> segments() const { return segments_; }
  /// The segments that a set for other rows ended with, for these laws; −1: no history.
  void set_segments(std::span<const int> segments, std::span<const RowLaw> laws);
  /// Forget all segments: the next solve starts from its guess.
  void reset();

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer(Archive& archive);

 private:
  using Tuning = ActiveSetTuning;

  struct Problem {
    std::span<const RowLaw> laws;
    std::span<const double> b;
    std::span<double> lambda, w;
    const ActiveSetSettings& settings;
  };
  enum class Search { kFound, kStalled, kNotFinite };

  void choose_segments(std::span<const RowLaw> laws, std::span<const double> b,
                       std::span<const double> lambda);
  void states_from_segments(std::span<const RowLaw> laws);
  Search search(const Problem& problem, StageTimes& times, ActiveSetOutcome& outcome);
  bool solve_trial(const Problem& problem, bool struggles, StageTimes& times, ActiveSetOutcome& outcome);
  void move_wrong_rows(bool only_first, ActiveSetOutcome& outcome);
  enum class Start { kLeastNorm, kKeep };
  bool solve_segments(const Problem& problem, Start start, int budget, StageTimes& times,
                      ActiveSetOutcome& outcome);
  Search descend(const Problem& problem, StageTimes& times, ActiveSetOutcome& outcome);
  bool step_towards_decision(const Problem& problem);
  std::pair<double, double> line_search(const Problem& problem) const;
  double read_segment_residuals(const Problem& problem);
  bool impulses_to_decide_by(const Problem& problem);
  int find_wrong_rows(const Problem& problem);
  void take_residual(const Problem& problem, ActiveSetOutcome& outcome);
  void keep_best(const Problem& problem);
  int update_budget() const;

  ConstraintSystem& system_;
  RowUpdates updates_;
  ProjectedGaussSeidel gauss_seidel_;
  std::vector<int> segments_, steps_;  ///< −1 segments: no history; K of the law that a segment belongs to
  std::vector<signed char> moves_;
  std::vector<double> states_, effective_mass_, root_diagonal_, residual_, decision_, best_lambda_;
  std::vector<double> start_lambda_, start_w_, slope_;  ///< of a descent
  double best_residual_ = 0;
  double scale_ = 0;
  double segment_residual_ = 0;  ///< the last of read_segment_residuals()
};

}  // namespace taut
