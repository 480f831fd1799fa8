#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "solvers/common/settings.h"
#include "solvers/common/step_report.h"
#include "solvers/system/delassus_system.h"
#include "solvers/system/linearized_rows.h"
#include "solvers/system/primal_choice.h"
#include "solvers/system/primal_system.h"
#include "solvers/system/rank_estimate.h"
#include "solvers/system/row_states.h"

namespace taut {

class Archive;

/// How often the expensive things were done, and how long the analyses took [s].
struct WorkCounters {
  int analyses = 0, factorizations = 0, backsolves = 0;
  double analysis_time = 0;
};

/// The joints of a world as one linear system: its linearised rows, the factor of S = J M⁻¹ Jᵀ, and solves
/// that survive dependent rows.
///
/// If S is singular to working precision, S_ε = S + ε diag(S) is factored instead and solve() applies
///     z = S_ε⁻¹ S S_ε⁻¹ r,
/// which agrees with the pseudo-inverse to O(ε) on the range of S and is O(round-off / ε) of r on its null
/// space: the multipliers are those of least norm and dependent rows get no share that grows like 1/ε.
/// (solvers/system, "Dependent rows")
///
/// Where contacts are so many that S is denser than the system of the bodies, or many axes have friction,
/// that one is factored in its place (primal_choice.h): the same solves, with ε on the rows that are free.
class ConstraintSystem : public LinearizedRows {
 public:
  ConstraintSystem(const World& world, FactorChoice choice, RankTolerance tolerance = RankTuning::kStepping,
                   Rows::AxisRows axis_rows = Rows::AxisRows::kIncluded, Springs springs = Springs::kLeftOut,
                   const FactorMeans& means = {});
  /// A part of a system by itself, to be solved through its bodies with values from there, on one thread.
  /// `new_body`: scratch.
  ConstraintSystem(const ConstraintSystem& whole, const SystemPart& part, std::vector<int>& new_body);

  /// Other slots for contacts from now on: a new pattern, order and analysis.  The world must have the
  /// topology that it had.  Row states are forgotten; J and S must be made anew.
  void set_contact_slots(const World& world, std::span<const Rows::ContactSlot> slots);
  /// J and the roots at once, and where joints alone make S, that too: for a factorize() right behind.
  void linearize_and_assemble(const Configuration& at);

  /// Compliance of all rows as a fraction of their own S_rr (constraint force mixing); 0 at first.
  void set_compliance(double fraction) { compliance_ = fraction; }
  /// ε of S_ε from now on.
  void set_shift(double shift) { rank_.set_shift(shift); }
  /// One number per row: 0 for a free row, kMasked for one that leaves the system, Σ_r > 0 (rate per impulse)
  /// for a compliant one.  From the next factorize() on, solve() solves (S + Σ)⁺ x on the rows that are not
  /// masked and gives 0 on the others; neither pattern nor analysis changes.  An empty span: all rows free.
  void set_row_states(std::span<const double> states);
  /// All axis and contact rows masked: the joints alone.
  void release_bounded_rows() { states_.mask_bounded(rows()); }

  /// S from J and the roots, and its factor.  Sets rank_deficiency() and condition_estimate().
  void factorize(StageTimes& times);
  /// factorize() with an exact count of dependent rows, which costs a second factorisation.
  void factorize_for_counting(StageTimes& times);
  /// False after linearize(), until the next factorize(): there is no factor of the present S.
  bool factored() const { return factored_.linearization == linearization(); }
  /// False if not even S_ε could be factored (values that are not finite); solve() then gives NaN.
  bool usable() const { return factored_.usable; }
  /// States of the present factor; empty if all rows are free.
  std::span<const double> factored_states() const { return factored_.states.values(); }
  /// The diagonal was multiplied by one plus this before the last factorisation.
  double factored_shift() const { return std::max(compliance_, factored_.shifted ? rank_.shift() : 0.0); }
  /// Grows with every factorisation, never falls.
  long factor_version() const { return factored_.version; }

  /// x ← S⁺ x, one entry per row.  Entries of masked rows are not read.
  void solve(std::span<double> x);
  /// x ← S_ε⁻¹ S x, the second half of solve() where rows are dependent: what S_ε⁻¹ r is in the range of S.
  void project(std::span<double> x);
  /// x ← S_ε⁻¹ x: one back-solve with whatever was factored.
  void solve_shifted(std::span<double> x);

  /// P = 1 + W'ᵀ D W' of the bodies with D ≥ 0 (primal_system.h) and its factor, in place of the present one
  /// through bodies.  False for values that are not finite.
  [[nodiscard]] bool factorize_bodies(std::span<const double> weighted, std::span<const double> D,
                                      StageTimes& times);
  /// Grows with every factor of P.
  long body_factor_version() const { return primal_.version(); }
  /// v ← P⁻¹ v.
  void solve_bodies(std::span<double> v);

  /// True if S is not formed, but solved through the bodies: decided for each pattern.
  bool uses_primal_system() const { return choice_.primal(); }
  /// solve() is S⁻¹ by a factor of S itself.
  bool has_delassus_factor() const;
  /// Dependent rows that the last factorisation met, and which (row indices).  Through bodies: not known, 0.
  int rank_deficiency() const { return rank_.deficiency(); }
  std::span<const int> dependent_rows() const { return rank_.dependent_rows(); }
  /// Multipliers are not unique.
  bool singular() const { return factored_.shifted || uses_primal_system(); }
  /// (largest / smallest pivot) of the independent rows, each relative to its S_ii: a lower bound of the
  /// condition of the scaled S.  Through bodies: not known, 0.
  double condition_estimate() const { return rank_.condition(); }

  const WorkCounters& counters() const { return counters_; }
  void reset_counters() { counters_ = {}; }
  /// Adds what the system of a part has done since this was last asked.
  void take_counters(ConstraintSystem& part);
  /// S, not to be asked for through bodies.
  const SymmetricMatrix& matrix() const { return delassus_->matrix(); }
  const Factor& factor() const { return uses_primal_system() ? primal_.factor() : delassus_->factor(); }

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  /// The state of the bodies is that of the last linearize(); J and the factor are made again.
  void transfer(Archive& archive, const Configuration& at);

 private:
  /// What the present factor is of.
  struct Factored {
    RowStates states;
    bool shifted = false;     ///< it is that of S_ε
    bool usable = false;      ///< there is one
    long linearization = -1;  ///< of the rows; −1: a factor of something else has taken its place
    long version = 0;
  };

  void analyze();
  void analyze_primal();
  bool joints_alone() const;
  void factorize_once(StageTimes& times);
  void factorize_primal(StageTimes& times);
  void factorize_delassus(StageTimes& times);
  void update_count(StageTimes& times);

  FactorChoice factor_choice_;
  FactorMeans means_;
  PrimalChoice choice_;
  std::unique_ptr<DelassusSystem> delassus_;  // where it is chosen
  PrimalSystem primal_;
  RankEstimate rank_;
  RowStates states_;  // of the next factorisation
  double compliance_ = 0;
  Factored factored_;
  std::vector<double> scratch_;
  WorkCounters counters_;
};

}  // namespace taut
