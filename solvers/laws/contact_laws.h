#pragma once

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "solvers/common/settings.h"
#include "solvers/laws/contact_set.h"
#include "solvers/laws/row_law.h"
#include "solvers/system/constraint_system.h"

namespace taut {

class Archive;

using Vec2 = Eigen::Vector2d;

/// The point of the disc |x| ≤ radius that is nearest to x.
inline Vec2 into_disc(const Vec2& x, double radius) {
  const double size = x.norm();
  return size > radius ? Vec2(radius / size * x) : x;
}

/// Where the point of the cone |x_t| ≤ μ x_n is that is nearest to one with x_n = `normal` and |x_t| =
/// `size`: it is that one itself, the apex, or on the surface along the same tangent.
struct NearestOnCone {
  enum class Region { kWithin, kApex, kSurface } region;
  double normal = 0;  ///< x_n of a point on the surface
};
inline NearestOnCone nearest_on_cone(double normal, double size, double mu) {
  using Region = NearestOnCone::Region;
  if (normal >= 0 && size <= mu * normal) return {Region::kWithin};
  if (mu * size <= -normal) return {Region::kApex};
  return {Region::kSurface, (normal + mu * size) / (1 + mu * mu)};
}

/// All contacts of a world, by their places: what they are in the present stage of a step, and what they
/// remember.
struct ContactTable {
  /// Along the normal, with the impulse λ of this stage and Λ = λ + what was given before: w + softness λ ≥
  /// target, 0 ≤ Λ ≤ most; between these bounds of Λ there is equality, and at the upper one w + softness λ ≤
  /// target.
  struct NormalLaw {
    double target = 0, softness = 0, most = std::numeric_limits<double>::infinity();
  };
  /// Coulomb's law in two rows: |τ| ≤ bound, against the slip.
  struct Disc {
    double bound = std::numeric_limits<double>::infinity();  ///< a new contact is first taken to hold
    bool slips = false;
    Vec2 direction = Vec2::UnitX();  ///< of the slip
    double weight = 0;               ///< friction per slip across its direction; 0: not known
    Vec2 given = Vec2::Zero();       ///< what the first kick gave, in the tangents of now
    Vec2 target = Vec2::Zero();      ///< rate that is rest: takes back what slipped while it should hold
  };
  struct Point {
    NormalLaw soft;  ///< of a compliant contact in this stage
    bool active = false, live = false, touching = false, pressed = false;
    double gap = 0, approach = 0;
    bool fresh = true;  ///< has not been through a begin()
    double back = 0;    ///< normal impulse of the first kick
    bool stuck = false, broken = false, stick_candidate = false;
    Vec3 slipped = Vec3::Zero();                             ///< since it sticks [m]
    std::optional<Vec3> slip;                                ///< at the start of a drift in which it held
    Vec3 first = Vec3::Zero(), first_torque = Vec3::Zero();  ///< of the first kick on B
    double spin_bound = std::numeric_limits<double>::infinity(), spin_given = 0;
    Disc sliding, rolling;
    Vec3 impulse = Vec3::Zero(), torque = Vec3::Zero();  ///< since clear_reports()
    std::optional<double> impact_time;
    bool slid = false;
  };
  struct Impact {
    enum class Stage { kNone, kSought, kDue } stage = Stage::kNone;
    double rate = 0;
    bool spent = false;
  };

  ContactTable(const World& world, const Settings& settings)
      : set(world, {.margin = settings.contact_margin,
                    .threads = settings.threads,
                    .max_contacts = settings.max_contacts}),
        resting_speed(settings.resting_speed) {}

  ContactSet set;
  std::vector<char> moves;  ///< bodies
  std::vector<Point> points;
  std::vector<Impact> impacts;
  double resting_speed = 0;
  double h = 0;                                     ///< of the present step
  bool in_velocities = false, single_kick = false;  ///< which stage it is
};

/// Contacts as laws of their rows for the two stages of a RATTLE step: Signorini's law and Newton's of impact
/// along the normal, Coulomb's in the disc |Λ_t| ≤ μ Λ_n of the tangents, likewise rolling and spinning.
///
///   position stage   w = J(q₀) M⁻¹ p, Λ = λ the impulse of the first kick
///   velocity stage   w = J(q₁) M⁻¹ p₁, Λ = λ + μ that of both
///
/// The radius of a disc follows from the normal impulse, and the way in which it is crossed from the slip:
/// both are found by solving the stage again until they agree.  They are all contacts of a table, or those of
/// an island, with rows as the system that is solved has them.               (solvers/laws, "Contacts")
class ContactLaws {
 public:
  explicit ContactLaws(ContactTable& table) : table_(table) {}

  /// The contacts, by their places; `rows` has them in this order.
  void choose(std::span<const int> places, const Rows& rows);
  /// 1/S_rr of all rows.
  void set_inertia(std::span<const double> inertia);
  int count() const { return static_cast<int>(first_row_.size()); }

  /// None of them came together faster than the resting speed before the step.
  bool rest() const;
  void position_laws(std::span<RowLaw> laws) const;
  void velocity_laws(std::span<RowLaw> laws) const;
  /// All contacts that press at impulses λ stick, but for those without friction.
  bool all_stick(std::span<const double> lambda) const;
  /// In place of the laws of a stage: what presses at impulses λ holds, along its normal and across it, and
  /// the others give nothing.
  void held_laws(std::span<const double> lambda, std::span<RowLaw> laws) const;
  /// Zeroes a guess in the rows of contacts that give nothing in this stage.
  void clear_idle(std::span<double> lambda) const;
  /// The same is 0 there.
  bool is_clear(std::span<const double> lambda) const;
  /// Compares a solution of a stage with Coulomb's law.  True if radius, slip or stick of a contact is not
  /// what the laws had: then they are renewed, and the stage must be solved again.  `scale`: the size of
  /// impulses [√J], of which `tolerance` is what an error may be.
  bool adapt(std::span<const double> lambda, std::span<const double> w, double rate_tolerance);
  /// True if a contact that works is compliant: no law of a row alone.
  bool soft() const;
  /// Rates that the laws ask for.
  void targets(std::span<double> target) const;
  /// The impulses y in the laws of one place that are nearest to x.
  void project(int place, std::span<const double> x, std::span<double> y) const;
  /// What the impulses of a contact of a stage may be, about those that the first kick gave: Coulomb's cone
  /// |Λ_t| ≤ sliding Λ_n, |spin| ≤ spinning Λ_n [m] and |roll| ≤ rolling Λ_n [m].
  struct Cone {
    bool works = false, twist = false;
    bool shares = false;  ///< its slip does not open the cone (begin_stick_search)
    double sliding = 0, spinning = 0, rolling = 0;
    double softness = 0, most = std::numeric_limits<double>::infinity();  ///< of the normal (NormalLaw)
    double slip_softness = 0;                                             ///< of the tangents (SlipLaw)
    double normal_given = 0, spin_given = 0;
    Vec2 sliding_given = Vec2::Zero(), rolling_given = Vec2::Zero();
  };
  Cone cone(int place) const;
  /// Rate per impulse that the compliance of a contact adds along its normal in this stage.
  double softness(int k) const { return normal_law(k).softness; }
  /// The same across it.
  double slip_softness(int k) const { return slip_law(k, contact(k).sliding).softness; }
  /// Largest distance of impulses from what Signorini's and Coulomb's laws answer to them and the rates, the
  /// natural map [√J]; 0 where rates are met to the tolerance.
  double error(std::span<const double> lambda, std::span<const double> w, double rate_tolerance) const;
  /// The same at the end of a stage, with nothing taken off, over `scale` [√J], or what it takes to change a
  /// rate by this if that is more.
  struct RateSize {
    double angular = 0, linear = 0;
  };
  double natural_error(std::span<const double> lambda, std::span<const double> w, double scale,
                       const RateSize& least) const;
  /// The same of contact k alone.
  double natural_error(int k, std::span<const double> lambda, std::span<const double> w, double scale,
                       const RateSize& least) const;
  /// Radii and slips as they are at this solution.
  void take_over(std::span<const double> lambda, std::span<const double> w, double rate_tolerance) {
    (void)adapt(lambda, w, rate_tolerance);
    turns_.clear();
  }
  /// A rigid contact that stuck slips at the last adapt().
  bool slips_where_it_held() const;
  /// From here on contacts that stick are asked, in cone() and error(), for impulses in the cone of static
  /// friction that obey its normality law.  All impulses with which none of them slips do, however they
  /// divide the load, so there are none where one slips all the same.  (solvers/laws, "Static friction")
  /// False if none of those that slip at the rates w can be told to hold, since they are on bodies that are
  /// being struck, or slip by much of what friction at impulses λ could change: they are let go.
  bool begin_stick_search(std::span<const double> lambda, std::span<const double> w);
  /// Unless they hold, all is as it was at begin_stick_search(), but for those that were let go.
  void end_stick_search(bool hold);
  /// Not ended yet.
  void continue_stick_search() { sharing_ = true; }
  /// The largest slip of these at rates w [m/s].
  double shared_slip(std::span<const double> w) const;
  /// Of those that slipped at begin_stick_search() all that slip still, or all if it is not `judged` by the
  /// rates w, go on with dynamic friction.  True if that leaves some to share the load anew.
  bool mark_sliding(std::span<const double> w, bool judged);
  /// Static friction was more than dynamic friction where it let go since begin_stick_search().
  bool weakened() const { return weakened_; }
  /// The largest distance from Coulomb's law at the last adapt(), relative.
  double residual() const { return residual_; }
  /// Tangents that are better turned: place and the direction (cos, sin) of the new t₁ in the old frame.
  struct Turn {
    int place;
    double cos, sin;
  };
  std::span<const Turn> turns() const { return turns_; }
  /// The turns have been made in J and everything that has a row.
  void turned(ConstraintSystem& system);
  /// What is remembered from step to step, to or from bytes (checkpoint_memory.cpp).
  void transfer_residuals(Archive& archive);
  int first_row(int k) const { return first_row_[k]; }
  std::span<const int> first_rows() const { return first_row_; }

 protected:
  using NormalLaw = ContactTable::NormalLaw;
  using Disc = ContactTable::Disc;
  using Point = ContactTable::Point;
  using Impact = ContactTable::Impact;

  /// A contact is touched within this distance [m].
  static constexpr double kTouch = 1e-9;

  /// Across it: w + softness λ − target is the slip, which is 0 within the disc.
  struct SlipLaw {
    Vec2 target = Vec2::Zero();
    double softness = 0;
  };

  void disc_laws(const Disc& disc, int row, std::span<RowLaw> laws) const;
  void friction_laws(int place, std::span<RowLaw> laws) const;
  NormalLaw normal_law(int place) const;
  void set_soft_laws();
  NormalLaw soft_law(int place) const;
  SlipLaw slip_law(int place, const Disc& disc) const;
  double compliance(int k) const { return place_of(k).material.compliance; }
  bool impact_is_seen(int place) const;
  double bounce(int place) const;
  double closing_rate(int place) const;
  bool works(int k) const { return contact(k).live && impact_of(k).stage != Impact::Stage::kSought; }
  double adapt_disc(int place, Disc& disc, int row, double bound, std::span<const double> lambda,
                    std::span<const double> w, double rate_tolerance);
  double disc_error(int place, const Disc& disc, int row, double bound, std::span<const double> lambda,
                    std::span<const double> w) const;
  double spin_error(int place, double bound, std::span<const double> lambda, std::span<const double> w) const;
  double normal_error(int place, std::span<const double> lambda, std::span<const double> w) const;
  double sliding_error(int place, const Disc& disc, std::span<const double> lambda,
                       std::span<const double> w) const;
  double spinning_error(int place, std::span<const double> lambda, std::span<const double> w) const;
  double rolling_error(int place, std::span<const double> lambda, std::span<const double> w) const;
  double pressure(int place, std::span<const double> lambda) const;
  double friction_bound(int place, double normal) const;
  bool sticks(int k) const {
    return works(k) && contact(k).stuck && !contact(k).broken && compliance(k) == 0;
  }
  bool presses(int k, std::span<const double> lambda) const {
    return works(k) && contact(k).back + lambda[first_row_[k]] > 0;
  }
  bool slips_in_vain(int place) const;
  double slip_of(int place, std::span<const double> w) const;
  void release(int place);
  std::vector<int> struck_bodies() const;
  double cone_error(int place, std::span<const double> lambda, std::span<const double> w) const;
  void ask_for_turn(int place, const Disc& disc);
  bool has_twist(int k) const { return place_of(k).at.twist; }
  const ContactSet::Place& place_of(int k) const { return table_.set.places()[places_[k]]; }
  Point& contact(int k) { return table_.points[places_[k]]; }
  const Point& contact(int k) const { return table_.points[places_[k]]; }
  const Impact& impact_of(int k) const { return table_.impacts[places_[k]]; }

  ContactTable& table_;
  std::vector<int> places_, first_row_;
  std::vector<double> root_;  // √S_rr
  std::vector<Turn> turns_;

 private:
  std::vector<Point> unshared_;
  double residual_ = 0, unshared_residual_ = 0, scale_ = 0;
  bool sharing_ = false, weakened_ = false;
};

}  // namespace taut
