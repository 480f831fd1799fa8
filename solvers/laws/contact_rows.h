#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/constraints/rows.h"
#include "solvers/laws/contact_constraints.h"
#include "solvers/laws/contact_spring.h"

namespace taut {

/// Contacts of a table, all or those of an island, in the rows of the system that is solved, and what they
/// are in the present stage: which work, press, stick and slip.  Contact k has row_count(k) rows from
/// first_row(k) on: the normal, two tangents and, with rolling or spinning friction, the turn about the
/// normal and two about the tangents.
class ContactRows {
 public:
  using NormalLaw = ContactConstraints::NormalLaw;
  using SlipLaw = ContactConstraints::SlipLaw;
  using Disc = ContactConstraints::Disc;
  using Point = ContactConstraints::Point;
  static constexpr int kSlidingRow = 1, kSpinRow = 3, kRollingRow = 4;  ///< behind first_row()

  explicit ContactRows(ContactConstraints& table) : table_(table) {}

  /// The contacts, by their slots; `rows` has them in this order.
  void choose(std::span<const int> slots, const Rows& rows);
  /// 1/S_rr of all rows.
  void set_effective_masses(std::span<const double> effective_mass);

  int count() const { return static_cast<int>(first_row_.size()); }
  int first_row(int k) const { return first_row_[k]; }
  std::span<const int> first_rows() const { return first_row_; }
  int row_count(int k) const { return slot(k).at.row_count(); }
  bool has_twist(int k) const { return slot(k).at.twist; }
  double root_diagonal(int row) const { return root_diagonal_[row]; }  ///< √S_rr

  const ContactConstraints& table() const { return table_; }
  const ContactCache::Slot& slot(int k) const { return table_.cache.slots()[slots_[k]]; }
  Point& point(int k) { return table_.points[slots_[k]]; }
  const Point& point(int k) const { return table_.points[slots_[k]]; }
  const ImpactState& impact(int k) const { return table_.impacts[slots_[k]]; }
  /// Its impacts are located: it has restitution, or all are.
  bool locates_impacts(int k) const { return table_.locates_plastic || slot(k).material.restitution > 0; }
  double compliance(int k) const { return slot(k).material.compliance; }
  /// Along row r of the contact.
  ContactSpring spring(int k, int r = 0) const {
    return {compliance(k), root_diagonal_[first_row_[k] + r], table_.h};
  }

  bool works(int k) const { return point(k).live; }
  bool presses(int k, std::span<const double> lambda) const {
    return works(k) && point(k).back + lambda[first_row_[k]] > 0;
  }
  /// Λ_n at impulses λ, 0 if they pull.
  double pressure(int k, std::span<const double> lambda) const {
    return std::max(0.0, point(k).back + lambda[first_row_[k]]);
  }
  /// μ_c Λ_n
  double friction_bound(int k, double normal) const;
  /// It is rigid and is held by static friction.
  bool sticks(int k) const { return works(k) && point(k).stuck && !point(k).slipping && compliance(k) == 0; }
  /// It sticks, and its disc was passed.
  bool slips_in_vain(int k) const {
    return sticks(k) && point(k).sliding.slips && point(k).sliding.cross_slope > 0;
  }
  /// |w_t − target| at rates w [m/s]
  double slip_of(int k, std::span<const double> w) const;
  /// The normality law is what a contact that sticks is asked for, instead of Coulomb's (stick_search.h).
  bool obeys_normality(int k) const { return normality_ && sticks(k); }
  void set_normality(bool normality) { normality_ = normality; }

  /// The largest restitution of contacts that work and approach.
  double restitution() const;
  /// Between ContactForces::begin_impulses() and set_laws(): a part of each restitution.
  void weaken_restitution(double part);
  /// Impulses μ of the second kick take back some of what rigid contacts gave in the first.
  bool take_back(std::span<const double> mu) const;
  /// None of them came together faster than the resting speed before the step.
  bool rest() const;
  /// True if a contact that works is compliant: no law of a row alone.
  bool soft() const;
  /// All contacts that press at impulses λ stick, but for those without friction.
  bool all_stick(std::span<const double> lambda) const;
  /// A rigid contact that stuck slips at the last solution that was taken over.
  bool slips_where_it_held() const;
  /// The largest slip of those that stick at rates w [m/s].
  double sticking_slip(std::span<const double> w) const;
  /// Of rates w of contacts that press or hold, how far they are from the linear ones that a stage was solved
  /// with [m/s]; 0 where that is enough.
  double curved_off(std::span<const double> lambda, std::span<const double> w,
                    std::span<const double> linear) const;
  /// Zeroes a guess in the rows of contacts that give nothing in this stage.
  void clear_idle(std::span<double> lambda) const;
  /// Whether a guess is 0 in the rows of contacts that give nothing in this stage.
  bool is_clear(std::span<const double> lambda) const;

 private:
  ContactConstraints& table_;
  std::vector<int> slots_, first_row_;
  std::vector<double> root_diagonal_;
  bool normality_ = false;
};

}  // namespace taut
