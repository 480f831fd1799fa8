#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/constraints/rows.h"
#include "solvers/common/settings.h"
#include "solvers/common/step_report.h"
#include "solvers/linear/factor.h"
#include "solvers/system/delassus_matrix.h"
#include "solvers/system/mass_matrix.h"
#include "solvers/system/primal_matrix.h"

namespace taut {

class Archive;

/// How often the expensive things were done.
struct WorkCounters {
  int analyses = 0, factorizations = 0, backsolves = 0;
};

/// When a row counts as dependent, both relative to its own S_rr.
struct RankTolerance {
  double shift;      ///< ε of S_ε: dependent rows leave a pivot of about this size
  double dependent;  ///< pivots below this count as dependent
};
/// For stepping: directions that are softer than 1e-8 of a row's own are left alone.  Multipliers along them
/// would be huge forces that mend gaps far below the tolerance, as in a flat grid of joints that has just
/// begun to bend.
inline constexpr RankTolerance kSteppingTolerance{1e-8, 1e-6};
/// For counting freedoms in one pose.
inline constexpr RankTolerance kCountingTolerance{1e-11, 1e-8};

/// State of a row whose multiplier is given from outside; see ConstraintSystem::set_row_states().
inline constexpr double kMasked = std::numeric_limits<double>::infinity();

/// Some joints and contacts of a system with their bodies, as indices there, ascending; rows follow from the
/// joints.
struct SystemPart {
  std::vector<int> bodies, joints, rows;
  std::vector<int> places;  ///< of contacts: the last of the joints

  friend bool operator==(const SystemPart&, const SystemPart&) = default;
};

/// The joints of a world as one linear system: Jacobian, S = J M⁻¹ Jᵀ, its factor, and solves that survive
/// dependent rows.
///
/// If S is singular to working precision, S_ε = S + ε diag(S) is factored instead and solve() applies
///     z = S_ε⁻¹ S S_ε⁻¹ r,
/// which agrees with the pseudo-inverse to O(ε) on the range of S and is O(round-off / ε) of r on its null
/// space: the multipliers are those of least norm and dependent rows get no share that grows like 1/ε.
/// (solvers/system, "Dependent rows")
///
/// Where contacts are so many that S is denser than the system of the bodies, or many axes have friction,
/// that one is factored in its place (primal_matrix.h): the same solves, with ε on the rows that are free.
class ConstraintSystem {
 public:
  ConstraintSystem(const World& world, FactorChoice choice, RankTolerance tolerance = kSteppingTolerance,
                   Rows::AxisRows axis_rows = Rows::AxisRows::kIncluded, Springs springs = Springs::kLeftOut);
  /// A part of a system by itself, to be solved through its bodies with values from there.  `new_body`:
  /// scratch.
  ConstraintSystem(const ConstraintSystem& whole, const SystemPart& part, std::vector<int>& new_body);
  /// J, W and the roots of that part.
  void take_values(ConstraintSystem& whole, const SystemPart& part);

  /// Other places for contacts from now on: a new pattern, order and analysis.  The world must have the
  /// topology that it had.  Row states are forgotten; J and S must be made anew.
  void set_contact_places(const World& world, std::span<const Rows::ContactPlace> places);
  /// Contact `place` from the next linearize() on.
  void set_contact(int place, const row_parts::ContactPoint& point) { rows_.set_contact(place, point); }
  /// Turns the tangents of a contact place by an angle (cos, sin) about its normal, in J and from now on.
  void turn_tangents(int place, row_parts::ContactPoint& point, double cos, double sin);

  const Rows& rows() const { return rows_; }
  const MassMatrix& mass() const { return mass_; }
  int row_count() const { return rows_.row_count(); }

  /// J at these poses, for drivers at this time.
  void linearize(const Configuration& at);
  /// J given from outside, for instance a mean of two: to be written to.
  std::span<double> change_jacobian() {
    weighted_current_ = assembled_ = false;
    return jacobian_;
  }
  std::span<const double> jacobian() const { return jacobian_; }
  /// The roots of M⁻¹ at these poses …
  void set_mass(std::span<const Pose> poses);
  /// … or J and the roots at once, and where joints alone make S, that too: for a factorize() right behind.
  void linearize_and_assemble(const Configuration& at);
  std::span<const InverseMassRoot> mass_roots() const { return roots_; }
  const InverseMassRoot& inverse_mass(int body) const { return roots_[body]; }
  /// … and until the next set_mass(), others for S in their place, one a body, for the caller to fill.
  std::span<FullMassRoot> use_full_roots();
  /// Compliance of all rows as a fraction of their own S_rr (constraint force mixing); 0 at first.
  void set_compliance(double fraction) { compliance_ = fraction; }
  /// ε of S_ε from now on.
  void set_shift(double shift) { tolerance_.shift = shift; }
  /// One number per row: 0 for a free row, kMasked for one that leaves the system, Σ_r > 0 (rate per impulse)
  /// for a compliant one.  From the next factorize() on, solve() solves (S + Σ)⁺ x on the rows that are not
  /// masked and gives 0 on the others; neither pattern nor analysis changes.  An empty span: all rows free.
  void set_row_states(std::span<const double> states);
  /// All axis and contact rows masked: the joints alone.
  void release_bounded_rows();
  /// Zeroes the entries of axis and contact rows.
  void clear_bounded_rows(std::span<double> values) const;
  /// States of the present factor; empty if all rows are free.
  std::span<const double> factored_states() const { return factored_states_; }
  /// False after linearize(), until the next factorize(): there is no factor of the present S.
  bool factored() const { return factored_; }
  /// S from J and the roots, and its factor.  Sets rank_deficiency() and condition_estimate().
  void factorize(StageTimes& times);

  /// The same with an exact count of dependent rows, for two factorisations.
  void factorize_for_counting(StageTimes& times);
  /// False if not even S_ε could be factored (values that are not finite); solve() then gives NaN.
  bool usable() const { return usable_; }

  /// x ← S⁺ x, one entry per row.  Entries of masked rows are not read.
  void solve(std::span<double> x);
  /// x ← S_ε⁻¹ S x, the second half of solve() where rows are dependent: what S_ε⁻¹ r is in the range of S.
  void project(std::span<double> x);
  /// x ← S_ε⁻¹ x: one back-solve with whatever was factored.
  void solve_shifted(std::span<double> x) { backsolve(x); }
  /// out = S x through W: (W Wᵀ) x, with all rows whatever their state.
  void multiply(std::span<const double> x, std::span<double> out);
  /// w = S λ + b: the rates of the rows, b without λ.
  void rates(std::span<const double> lambda, std::span<const double> b, std::span<double> w);

  /// v = Wᵀ λ, six numbers a body, 0 for fixed ones.
  void to_bodies(std::span<const double> lambda, std::span<double> v);
  /// out = W v.
  void to_rows(std::span<const double> v, std::span<double> out) const;
  /// P = 1 + W'ᵀ D W' of the bodies with D ≥ 0 (primal_matrix.h) and its factor, in place of the present one
  /// through bodies.  False for values that are not finite.
  [[nodiscard]] bool factorize_bodies(std::span<const double> weighted, std::span<const double> D,
                                      StageTimes& times);
  /// Grows with every factor of P.
  long body_factor_version() const { return body_factor_version_; }
  /// v ← P⁻¹ v.
  void solve_bodies(std::span<double> v);

  /// W = J A, laid out like the Jacobian: made here if it is not known, as factorize() makes it of joints
  /// alone only where rows are dependent.
  std::span<const double> weighted() {
    if (!weighted_current_) weight();
    return weighted_;
  }
  /// The diagonal was multiplied by one plus this before the last factorisation.
  double factored_shift() const { return std::max(compliance_, shifted_ ? tolerance_.shift : 0.0); }
  /// Grows with every factorisation, never falls.
  long factor_version() const { return factor_version_; }

  /// Changes with W.
  long weight_version() const { return weight_version_; }
  /// 1 / S_rr of each row: the inertia that it feels on its own.
  void effective_masses(std::span<double> out);

  /// True if S is not formed, but solved through the bodies: decided for each pattern.
  bool uses_primal_system() const { return through_bodies_; }
  /// Dependent rows that the last factorisation met, and which (row indices).  Through bodies: not known, 0.
  int rank_deficiency() const { return static_cast<int>(dependent_rows_.size()); }
  std::span<const int> dependent_rows() const { return dependent_rows_; }
  /// Multipliers are not unique.
  bool singular() const { return shifted_ || through_bodies_; }
  /// The factor is that of S_ε.
  bool shifted() const { return shifted_; }
  /// (largest / smallest pivot) of the independent rows, each relative to its S_ii: a lower bound of the
  /// condition of the scaled S.  Through bodies: not known, 0.
  double condition_estimate() const { return condition_; }

  const WorkCounters& counters() const { return counters_; }
  void reset_counters() { counters_ = {}; }
  /// Adds what the system of a part has done since this was last asked.
  void take_counters(ConstraintSystem& part);
  double analysis_time() const { return analysis_time_; }
  /// S, not to be asked for through bodies.
  const SymmetricMatrix& matrix() const { return system_->matrix(); }
  const Factor& factor() const { return through_bodies_ ? *body_factor_ : *factor_; }

  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  /// The state of the bodies is that of the last linearize(); J and the factor are made again.
  void transfer(Archive& archive, const Configuration& at);

 private:
  void analyze();
  void set_mass(std::span<const Pose> poses, int begin, int end);
  bool joints_alone() const;
  void weight();
  void sum_inertias();
  bool bodies_pay();
  void analyze_rows();
  void analyze_bodies();
  void make_room();
  double flops_of_rows() const;
  void compliance_of_bodies();
  void solve_primal(std::span<double> x);
  void assemble_and_factorize(StageTimes& times);
  void inspect_pivots();
  void keep_count(StageTimes& times);
  void backsolve(std::span<double> x);
  void mask_weighted();
  void multiply_factored(std::span<const double> x, std::span<double> out);

  FactorChoice choice_;
  Rows::AxisRows axis_rows_;
  Springs springs_;
  Rows rows_;
  MassMatrix mass_;
  RankTolerance tolerance_;
  std::unique_ptr<DelassusMatrix> system_;  // not through bodies
  std::unique_ptr<Factor> factor_;
  std::unique_ptr<PrimalMatrix> bodies_;  // made when it is wanted
  std::unique_ptr<Factor> body_factor_;
  std::optional<BlockOrdering> body_ordering_;  // not analysed yet
  std::vector<int> body_of_node_;
  bool through_bodies_ = false;
  int rubbing_axes_ = 0;                              // with Coulomb friction
  std::vector<double> inverse_compliance_;            // 1/Σ_r, with ε
  std::vector<double> ordered_bodies_, body_values_;  // six numbers a body, of them all in the latter
  std::vector<double> jacobian_, weighted_;
  std::vector<double> inertias_;   // 1/S_rr of that W, if inertias_current_
  bool weighted_current_ = false;  // W is that of J and the roots
  bool inertias_current_ = false;
  bool assembled_ = false;  // S is that of J and the roots, not shifted
  std::vector<InverseMassRoot> roots_;
  std::vector<FullMassRoot> full_roots_;  // empty: not in use
  std::vector<double> ordered_, scratch_;
  std::vector<double> states_, factored_states_, masked_weighted_;
  std::vector<int> row_at_position_, dependent_rows_;
  std::vector<int> counted_rows_;  // the dependent rows when small_pivots_ last changed
  std::vector<double> large_pivots_;
  int small_pivots_ = 0;
  double counted_shift_ = 0;
  bool usable_ = false;
  bool factored_ = false;    // since the last linearize()
  bool shifted_ = false;     // the present factor is that of S_ε
  bool shift_next_ = false;  // start the next factorisation with the shift
  int full_rank_streak_ = 0;
  double condition_ = 1, compliance_ = 0;
  double analysis_time_ = 0;
  long factor_version_ = 0, body_factor_version_ = 0, weight_version_ = 0;
  WorkCounters counters_;
};

std::unique_ptr<Factor> make_factor(FactorChoice choice, const BlockOrdering& ordering);

}  // namespace taut
