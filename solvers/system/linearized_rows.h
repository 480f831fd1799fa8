#pragma once

#include <span>
#include <vector>

#include "core/base/loop_threads.h"
#include "core/base/thread_pool.h"
#include "core/constraints/rows.h"
#include "core/world/world.h"
#include "solvers/system/inverse_mass_root.h"
#include "solvers/system/mass_matrix.h"
#include "solvers/system/system_part.h"

namespace taut {

/// The rows of a World at one configuration: their Jacobian J, roots A of M⁻¹ = A Aᵀ, and W = J A, by which
/// S = J M⁻¹ Jᵀ = W Wᵀ acts without being formed.
///
/// J has the layout of Rows; W has row_count × 6 values of each side (Rows::whole_size()).  W and what
/// follows from it are made when they are asked for and kept until J or A changes.  (solvers/system,
/// "Delassus matrix")
class LinearizedRows {
 public:
  /// `threads`, for loops over bodies and joints, may be null, or outlive it.
  LinearizedRows(const World& world, Rows::AxisRows axis_rows, Springs springs,
                 detail::LazyPool* threads = nullptr);
  /// The rows of a part by themselves, with values from take_values().  `new_body`: scratch.
  LinearizedRows(const LinearizedRows& whole, const SystemPart& part, std::vector<int>& new_body);
  /// J, A and W of that part.
  void take_values(LinearizedRows& whole, const SystemPart& part);

  const Rows& rows() const { return rows_; }
  const MassMatrix& mass() const { return mass_; }
  int row_count() const { return rows_.row_count(); }
  /// The pattern stays: that of joints, all of which have rows. Contacts, and joints that are detached or
  /// asleep, come and go.
  bool lasts() const;
  /// Axis rows or contact rows: those whose multipliers have bounds.
  bool has_bounded_rows() const { return !rows_.axis_rows().empty() || rows_.contact_count() > 0; }
  /// Zeroes the entries of axis and contact rows.
  void clear_bounded_rows(std::span<double> values) const;

  /// For loops over bodies or joints.
  const detail::LoopThreads& loop_threads() const { return loop_threads_; }

  /// The contact of a slot from the next linearize() on.
  void set_contact(int slot, const row_parts::ContactPoint& point) { rows_.set_contact(slot, point); }

  /// J at these poses, for drivers at this time.
  void linearize(const Configuration& at);
  /// J and the roots at once, chunk by chunk of bodies; visit(chunk) after each, while it is near.
  template <typename Visit>
  void linearize_by_chunks(const Configuration& at, Visit visit) {
    full_roots_.clear();
    ++linearization_, ++version_;
    for (const Rows::BodyChunk& chunk : rows_.chunks()) {
      rows_.jacobian(at, jacobian_, chunk);
      set_mass(at.poses, chunk.begin, chunk.end);
      visit(chunk);
    }
  }
  std::span<const double> jacobian() const { return jacobian_; }
  /// J V + φ_t of all rows, with the twists and the time of a state.
  void rates_of(const State& state, std::span<double> out) const;
  /// J given from outside, for instance a mean of two: to be written to.
  std::span<double> change_jacobian() {
    ++version_;
    return jacobian_;
  }
  /// The roots of M⁻¹ at these poses.
  void set_mass(std::span<const Pose> poses);
  const std::vector<InverseMassRoot>& mass_roots() const { return roots_; }
  const InverseMassRoot& inverse_mass(int body) const { return roots_[body]; }
  /// Until the next set_mass() S has these roots, one a body, which the caller fills, in place of
  /// mass_roots().
  std::span<FullMassRoot> use_full_roots();
  /// Those of use_full_roots(); empty: not in use.
  const std::vector<FullMassRoot>& full_roots() const { return full_roots_; }

  /// W = J A.
  std::span<const double> weighted() {
    if (weighted_version_ != version_) mass_weight();
    return weighted_;
  }
  /// 1 / S_rr of each row: the mass that it feels on its own.
  void effective_masses(std::span<double> out);
  /// v = Wᵀ λ, six numbers a body, 0 for fixed ones.
  void apply_Wt(std::span<const double> lambda, std::span<double> v);
  /// out = W v.
  void apply_W(std::span<const double> v, std::span<double> out) const;
  /// out = S x through W: (W Wᵀ) x, with all rows whatever their state.
  void multiply(std::span<const double> x, std::span<double> out);
  /// w = S λ + b: the rates of the rows, b without λ.
  void rates(std::span<const double> lambda, std::span<const double> b, std::span<double> w);

  /// Changes with J or A, and so with W.
  long weight_version() const { return version_; }
  /// Grows with every linearize().
  long linearization() const { return linearization_; }

 protected:
  /// Rows with other slots of contacts; J, A and W must be made anew.
  void remake_rows(const World& world, std::span<const Rows::ContactSlot> slots);

 private:
  void make_room();
  void set_mass(std::span<const Pose> poses, int begin, int end);
  void mass_weight();
  void sum_effective_masses();

  Rows::AxisRows axis_rows_;
  Springs springs_;
  detail::LazyPool* threads_ = nullptr;
  detail::LoopThreads loop_threads_;
  Rows rows_;
  MassMatrix mass_;
  std::vector<double> jacobian_, weighted_;
  std::vector<InverseMassRoot> roots_;
  std::vector<FullMassRoot> full_roots_;  // empty: not in use
  std::vector<double> effective_masses_;
  std::vector<double> body_values_;  // six numbers a body
  long linearization_ = 0, version_ = 0;
  long weighted_version_ = -1, masses_version_ = -1;  // those that W and the effective masses are of
};

}  // namespace taut
