#pragma once

#include <limits>
#include <span>
#include <vector>

#include "solvers/laws/contact_cache.h"
#include "solvers/system/constraint_system.h"

namespace taut {

/// What one member of a mechanism (a joint, a limit, a motor, a contact) asks of a row:  lower ≤ x ≤ upper,
/// with x = φ of an equality, θ of an axis or the gap of a contact.
struct Demand {
  int row = 0, member = 0;
  double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();

  /// How far x is beyond: ≤ 0 below, ≥ 0 above, 0 between.
  double excess(double x) const { return x > upper ? x - upper : x < lower ? x - lower : 0; }
};

/// Looks for poses that meet demands c, from given ones on: Levenberg–Marquardt on
///     f(q) = ½ Σ c_r² / S_rr,    (δ + Wᵀ D W) v = −Wᵀ D c,    q ← q ⊕ A v,    D = 1 / S_rr where c_r ≠ 0.
/// At a minimum with f > 0 the impulses λ = D c keep each other in balance, Wᵀ λ = 0, each with the sign that
/// its demand allows, while λ·c > 0: Farkas' certificate that no motion meets the demands to first order.
/// (solvers/diagnosis, "Contradiction")
class ViolationSearch {
 public:
  enum class Verdict {
    kHolds,     ///< all demands are met to SearchTuning::kMet
    kExcluded,  ///< they are not, and balance
    kUnknown,   ///< neither was reached
  };
  ViolationSearch(const World& world, std::span<const ContactCache::Slot> contacts);

  const Rows& rows() const { return system_.rows(); }
  /// Row of the normal of a contact, by its slot.
  int contact_row(int slot) const { return rows().joints()[rows().contact_joint(slot)].first_row; }
  /// x of all rows at a state.
  void values(const State& state, std::span<double> x) const { rows().residual(state, x); }

  /// The demands, the poses and turns from which each search starts, and the time of drivers.
  void begin(std::vector<Demand> demands, int members, const State& from, double time);
  /// With the demands of these members only; one entry a member.
  Verdict search(std::span<const char> wanted);

  /// Where the last search ended: the largest |c| [m or rad], and √Σ c²/S_rr of each member.
  double largest() const { return largest_; }
  std::span<const double> blame();

 private:
  Configuration configuration(std::span<const Pose> poses) const {
    return {poses, time_, start_.axes, start_.poses};
  }
  double evaluate(std::span<const Pose> poses, std::span<const char> wanted);
  void gather();
  bool step();
  bool try_step();

  ConstraintSystem system_;
  std::vector<Demand> demands_;
  State start_;
  double time_ = 0;
  std::vector<double> effective_mass_;  // 1 / S_rr at the start
  std::span<const char> wanted_;
  std::vector<Pose> poses_, trial_;
  std::vector<double> x_, excess_, trial_excess_, stiffness_, scaled_, force_;
  std::vector<double> gradient_, v_, blame_;
  double damping_ = 0, f_ = 0, largest_ = 0, trial_largest_ = 0, steepness_ = 0;
};

}  // namespace taut
