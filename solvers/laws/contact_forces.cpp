#include "solvers/laws/contact_forces.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/math/so3.h"

namespace taut {
namespace {

struct ContactForcesTuning {
  /// A contact that sticks has not slipped by less than this in a step [m]: what the slips of before, which
  /// several contacts of a body take back, disagree by.  They do so by the round-off of positions, and steps
  /// that are short make a rate of it.  None of it, and a box on a belt of 0.2 m/s lets go at 0.83 to 1 of
  /// its limit, at steps of 0.25 ms and less; half and twice of it hold as well.
  static constexpr double kStillWay = 1e-11;
  /// Tangents slower than this at the start of a step are first tried as sticking [m/s].  Chosen.
  static constexpr double kRestingSlip = 1e-9;
};

/// Bodies may come together by their gap in a step, and bodies inside each other part slowly.
double closing_rate(double gap, double h) {
  return std::clamp(-gap / h, -kUnreachedRate, std::max(LawTuning::kReturnRate, LawTuning::kTouch / h));
}

/// What the first kick gave along the normal of then and across it, in the directions of now.
void take_first_kick(const row_parts::ContactFrame& frame, ContactConstraints::Point& point) {
  const auto across = [&](const Vec3& v) {
    const Vec3& n = point.first_normal;
    const Vec3 now = carried(tangential(v, n), n, frame.n);
    return Vec2(frame.t1.dot(now), frame.t2.dot(now));
  };
  point.back = std::max(0.0, point.first_normal.dot(point.first));
  point.spin_given = point.first_normal.dot(point.first_torque);
  point.sliding.given = across(point.first);
  point.rolling.given = across(point.first_torque);
}

/// The laws are those of what impulses add to these, in the rows of the contact.
void count_from(std::span<const double> before, ContactConstraints::Point& point) {
  constexpr int kSliding = ContactRows::kSlidingRow, kSpin = ContactRows::kSpinRow,
                kRolling = ContactRows::kRollingRow;
  point.back = -before[0];
  point.present = 1;
  point.sliding.given = -Vec2(before[kSliding], before[kSliding + 1]);
  if (std::ssize(before) == 3) return;
  point.spin_given = -before[kSpin];
  point.rolling.given = -Vec2(before[kRolling], before[kRolling + 1]);
}

/// What a contact has given on B, from the impulses of its rows.
void keep_impulse(std::span<const double> lambda, const row_parts::ContactFrame& frame,
                  ContactConstraints::Point& point) {
  const bool twist = std::ssize(lambda) > 3;
  point.first = point.first_torque = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    point.first += lambda[i] * frame.direction(i);
    if (twist) point.first_torque += lambda[ContactRows::kSpinRow + i] * frame.direction(i);
  }
  point.first_normal = frame.n;
  point.impulse += point.first;
  point.torque += point.first_torque;
}

/// Of the rates that linear friction follows in the second kick the part that is of its end: half, so that
/// both kicks follow the mean rate of the step, and are of order 2.  Where a kick might turn the rate round,
/// being large or that of an impact, or the first one did not press, that of the end alone.
double present_part(const ContactRows& contacts, int k) {
  const Material& material = contacts.slot(k).material;
  const ContactConstraints::Point& point = contacts.point(k);
  if (!resists_turning_linearly(material) || !point.pressed) return 1;
  if (contacts.compliance(k) == 0 && point.approach < -contacts.table().resting_speed) return 1;
  const int row = contacts.first_row(k) + ContactRows::kSpinRow;
  const double across = std::max(contacts.root_diagonal(row + 1), contacts.root_diagonal(row + 2));
  const double spin =
      material.spinning_friction_linear * contacts.root_diagonal(row) * contacts.root_diagonal(row);
  const double roll = material.rolling_friction_linear * across * across;
  return point.back * std::max(spin, roll) <= 1 ? 0.5 : 1;
}

}  // namespace

ContactForces::ContactForces(const World& world, const Settings& settings)
    : ContactLaws(table_), wanted_(settings.contacts), table_(world, settings) {
  for (int b = 0; b < world.body_count(); ++b) table_.moves.push_back(world.moves({b}));
}

void ContactForces::inherit(ContactForces& old, const World& world) {
  const ContactCache::SlotOrigins from = table_.cache.inherit(old.table_.cache, world);
  const int slots = static_cast<int>(old.table_.points.size());
  const auto point = [&](int k) { return k < slots ? old.table_.points[k] : old.resting_points_[k - slots]; };
  for (int k : from.slots) {
    inherited_.push_back(k < slots ? k : -1);
    table_.points.push_back(point(k));
  }
  for (int k : from.resting) resting_points_.push_back(point(k));
  table_.impacts.resize(table_.points.size());
  before_ = table_.points;
  impacts_before_ = table_.impacts;
}

void ContactForces::keep_memory() {
  inherited_.resize(table_.points.size());
  std::iota(inherited_.begin(), inherited_.end(), 0);
}

void ContactForces::forget(std::span<const char> moved) {
  for (int k = 0; k < std::ssize(table_.points); ++k) {
    const Rows::ContactSlot& at = table_.cache.slots()[k].at;
    if (!moved[at.a] && !moved[at.b]) continue;
    const bool active = table_.points[k].active;
    table_.points[k] = {};
    table_.points[k].active = active;
  }
  for (std::size_t k = 0; k < resting_points_.size(); ++k) {
    const Rows::ContactSlot& at = table_.cache.resting()[k].at;
    if (moved[at.a] || moved[at.b]) resting_points_[k] = {};
  }
}

bool ContactForces::start(const World& world, const State& state, double horizon) {
  const bool changed = table_.cache.find(world, state, horizon);
  if (inherited_.empty())
    table_.points.assign(table_.cache.slots().size(), {});
  else
    remap();
  table_.impacts.assign(table_.cache.slots().size(), {});
  for (int k = 0; k < std::ssize(table_.points); ++k)
    table_.points[k].active = table_.cache.slots()[k].active;
  take_up_recalled(world);
  before_ = table_.points;
  impacts_before_ = table_.impacts;
  return changed;
}

void ContactForces::take_up_recalled(const World& world) {
  for (const ContactStretch& known : recalled_) {
    const int k = table_.cache.slot_near(world, known.a, known.b, known.p_AP);
    if (k < 0 || table_.cache.slots()[k].material.compliance == 0) continue;
    Point& point = table_.points[k];
    point.slipped = known.stretch;
    point.stuck = known.holds;
    point.fresh = false;
  }
  recalled_.clear();
}

std::vector<ContactStretch> ContactForces::stretches() const {
  std::vector<ContactStretch> stretches;
  const auto add = [&](const ContactCache::Slot& slot, const Point& point) {
    if (slot.active && slot.material.compliance > 0 && !point.slipped.isZero(0))
      stretches.push_back({slot.contact.a, slot.contact.b, slot.contact.p_AP, point.slipped, point.stuck});
  };
  for (std::size_t k = 0; k < table_.points.size(); ++k) add(table_.cache.slots()[k], table_.points[k]);
  for (std::size_t k = 0; k < resting_points_.size(); ++k) add(table_.cache.resting()[k], resting_points_[k]);
  return stretches;
}

bool ContactForces::move_on(const World& world, const State& state, double horizon) {
  const bool changed = table_.cache.find(world, state, horizon);
  remap();
  for (int k = 0; k < std::ssize(table_.points); ++k) {
    const ContactCache::Slot& slot = table_.cache.slots()[k];
    Point& point = table_.points[k];
    point.active = slot.active;
    point.gap = slot.contact.gap;
    point.touching =
        slot.active && (point.gap <= LawTuning::kTouch || point.pressed || table_.impacts[k].due());
    // A first guess: both kicks alike, and the slip along t₁.
    for (Disc* disc : {&point.sliding, &point.rolling}) {
      disc->bound *= 2;
      disc->cross_slope *= 2;
      disc->direction = Vec2::UnitX();
    }
    point.spin_bound *= 2;
    point.borne *= 2;
    const Vec3 &m = point.first_normal, &n = slot.point.frame.n;
    if (slot.active && resists_turning_linearly(slot.material))
      point.turning = carried(tangential(point.turning, m), m, n) + m.dot(point.turning) * n;
  }
  return changed;
}

/// Memory follows the contacts to their slots.
void ContactForces::remap() {
  const std::span<const int> origin = table_.cache.origin(), moved = table_.cache.moved();
  std::vector<char>& goes_on = goes_on_;
  goes_on.assign(table_.points.size(), 0);
  for (int from : origin)
    if (from >= 0) goes_on[from] = 1;
  for (int k = 0; k < std::ssize(table_.points); ++k)
    if (!goes_on[k]) keep_report(k);
  const auto map = [](auto& values, std::span<const int> from, auto& scratch) {
    scratch.clear();
    for (int k : from)
      scratch.push_back(k >= 0 ? values[k] : typename std::decay_t<decltype(values)>::value_type{});
    values.swap(scratch);
  };
  map(table_.points, origin, point_scratch_);
  map(table_.impacts, origin, impact_scratch_);
  map(before_, moved, point_scratch_);
  map(impacts_before_, moved, impact_scratch_);
}

void ContactForces::set_rows(const Rows& rows) {
  std::vector<int> slots(rows.contact_count());
  std::iota(slots.begin(), slots.end(), 0);
  choose(slots, rows);
}

/// Also of slots that are not in use, whose rows are left out but have rates all the same.
void ContactForces::give_points(ConstraintSystem& system) const {
  for (int k = 0; k < std::ssize(table_.points); ++k) system.set_contact(k, table_.cache.slots()[k].point);
}

/// What roll_back() needs.
void ContactForces::remember(double h) {
  table_.h = h;
  table_.in_velocities = false;
  table_.still_rate = ContactForcesTuning::kStillWay / h;
  before_ = table_.points;
  impacts_before_ = table_.impacts;
  works_.keep();
  departed_before_ = departed_.size();
}

void ContactForces::begin(double h, std::span<const double> rates, std::span<const double> effective_mass) {
  remember(h);
  set_effective_masses(effective_mass);
  for (int k = 0; k < std::ssize(table_.points); ++k) {
    Point& point = table_.points[k];
    const ContactCache::Slot& slot = table_.cache.slots()[k];
    point.live = point.active && !table_.impacts[k].let_through();
    if (point.active) point.gap = slot.contact.gap;
    point.least_rate = closing_rate(point.gap, h);
    if (!point.active) continue;
    point.approach = rates[first_row(k)];
    const int row = first_row(k);
    // What starts at rest holds with static friction.
    const bool rests = std::hypot(rates[row + 1], rates[row + 2]) <= ContactForcesTuning::kRestingSlip;
    point.stuck = point.stuck || (point.fresh && point.gap <= LawTuning::kTouch && rests);
    point.fresh = point.slipping = point.pressed = false;
    point.back = point.spin_given = point.yield = 0;
    point.sliding.given = point.rolling.given = Vec2::Zero();
    // What it has slipped since it sticks is taken back.
    const row_parts::ContactFrame& frame = slot.point.frame;
    point.sliding.target = -Vec2(frame.t1.dot(point.slipped), frame.t2.dot(point.slipped)) / h;
    point.rolling.target = Vec2::Zero();
    aim_discs(k, rates);
    point.present = 1;
    if (!resists_turning_linearly(slot.material)) continue;
    point.turning = Vec3::Zero();
    for (int i : {0, 1, 2}) point.turning += rates[row + kSpinRow + i] * frame.direction(i);
  }
  set_position_springs();
}

/// A first guess: what slips goes on slipping.
void ContactForces::aim_discs(int k, std::span<const double> rates) {
  Point& point = table_.points[k];
  const auto aim = [&](Disc& disc, int first) {
    const Vec2 slip(rates[first], rates[first + 1]);
    disc.slips = !point.stuck && slip.norm() > ContactForcesTuning::kRestingSlip && std::isfinite(disc.bound);
    if (disc.slips) {
      disc.direction = slip.normalized();
      disc.cross_slope = disc.bound / slip.norm();
    }
  };
  aim(point.sliding, first_row(k) + kSlidingRow);
  if (has_twist(k)) aim(point.rolling, first_row(k) + kRollingRow);
}

void ContactForces::begin_single_kick(double h) {
  remember(h);
  table_.single_kick = true;
  for (Point& point : table_.points) {
    point.slipping = point.pressed = false;
    point.back = point.spin_given = point.yield = 0;
    point.present = 1;
    point.first = point.first_torque = point.slipped = Vec3::Zero();
    for (Disc* disc : {&point.sliding, &point.rolling}) disc->given = disc->target = Vec2::Zero();
  }
}

void ContactForces::begin_impulses(std::span<const double> rates, std::span<const double> effective_mass) {
  set_effective_masses(effective_mass);
  table_.in_velocities = true;
  table_.still_rate = 0;
  for (int k = 0; k < std::ssize(table_.points); ++k) {
    Point& point = table_.points[k];
    point.live = point.active && point.touching;
    point.yield = 0;
    if (!point.active) continue;
    const int row = first_row(k);
    point.approach = rates[row];
    point.least_rate = -table_.cache.slots()[k].material.restitution * point.approach;
    const bool rests = std::hypot(rates[row + 1], rates[row + 2]) <= ContactForcesTuning::kRestingSlip;
    point.stuck = point.stuck || (point.fresh && rests);
    point.fresh = false;
    aim_discs(k, rates);
  }
}

void ContactForces::roll_back(bool moved_on) {
  if (moved_on) {
    table_.cache.undo();
    table_.impacts = impacts_before_;
  }
  table_.points = before_;
  works_.roll_back();
  departed_.resize(departed_before_);
}

/// Impulses of rows as world vectors, and the work of those that take energy: of normals that stop an
/// approach, and of friction that slips or comes with them.  What else contacts do is the work of ideal
/// constraints.
void ContactForces::record_first_kick(std::span<const double> lambda, std::span<const double> w,
                                      std::span<const double> rates) {
  works_.record_kick(lambda, rates);
  for (int k = 0; k < std::ssize(table_.points); ++k) {
    Point& point = table_.points[k];
    if (!point.active) continue;
    const int row = first_row(k);
    keep_impulse(lambda.subspan(row, row_count(k)), slot(k).point.frame, point);
    point.pressed = lambda[row] > 0;
    // The slip of this step while it holds: what is left of the target.
    if (!point.sliding.slips && point.pressed) {
      const row_parts::ContactFrame& frame = table_.cache.slots()[k].point.frame;
      const Vec3 slip = w[row + 1] * frame.t1 + w[row + 2] * frame.t2;
      point.slipped += table_.h * slip;
    } else if (const double C = compliance(k); C > 0 && point.pressed) {
      const row_parts::ContactFrame& frame = table_.cache.slots()[k].point.frame;
      point.slipped = -2 * C / table_.h * (lambda[row + 1] * frame.t1 + lambda[row + 2] * frame.t2);
    } else {
      point.slipped = Vec3::Zero();
    }
  }
}

void ContactForces::begin_velocities(std::span<const double> rates, std::span<const double> effective_mass,
                                     bool anew) {
  set_effective_masses(effective_mass);
  table_.in_velocities = true;
  table_.still_rate = 0;
  for (int k = 0; k < std::ssize(table_.points); ++k) {
    Point& point = table_.points[k];
    ImpactState& impact = table_.impacts[k];
    // Also what has met unseen, as where faces turn.
    if (point.active && locates_impacts(k) && compliance(k) == 0 && point.touching && !point.pressed &&
        rates[first_row(k)] < -table_.resting_speed)
      impact.set_due(true);
    point.live = point.active && point.touching && !impact.let_through();
    point.least_rate = point.yield = 0;
    if (!point.active) continue;
    if (point.fresh) point.approach = rates[first_row(k)];
    take_first_kick(slot(k).point.frame, point);
    point.sliding.target = point.rolling.target = Vec2::Zero();
    point.present = present_part(*this, k);
    if (!anew || compliance(k) > 0) continue;
    point.present = 1;
    point.back = point.spin_given = 0;
    point.sliding.given = point.rolling.given = Vec2::Zero();
  }
  set_velocity_springs();
}

bool ContactForces::any_hold() const {
  return std::any_of(table_.points.begin(), table_.points.end(),
                     [](const Point& point) { return point.active && point.stuck; });
}

void ContactForces::hold_again() {
  for (Point& point : table_.points) point.slipping = false;
}

bool ContactForces::strikes() const {
  for (int k = 0; k < std::ssize(table_.points); ++k)
    if (impact(k).due() && point(k).active && point(k).touching) return true;
  return false;
}

bool ContactForces::come_together(std::span<const double> rates) const {
  for (int k = 0; k < std::ssize(table_.points); ++k)
    if (point(k).live && compliance(k) == 0 && rates[first_row(k)] < -table_.resting_speed) return true;
  return false;
}

double ContactForces::begin_impact(std::span<const double> rates, std::span<const double> before,
                                   double part) {
  double largest = 0;
  for (int k = 0; k < std::ssize(table_.points); ++k) {
    Point& point = table_.points[k];
    point.live = point.active && point.touching;
    if (!point.live) continue;
    if (compliance(k) == 0 || impact(k).due()) count_from(before.subspan(first_row(k), row_count(k)), point);
    if (compliance(k) > 0) set_velocity_slip(k);
    point.approach = rates[first_row(k)];
    const double restitution = slot(k).material.restitution;
    const bool slow = point.approach >= -table_.resting_speed;
    point.least_rate = -(point.approach > 0 ? 1 : slow ? 0 : part * restitution) * point.approach;
    if (impact(k).due()) largest = std::max(largest, restitution);
  }
  return largest;
}

void ContactForces::end_impacts() {
  for (int k = 0; k < std::ssize(table_.points); ++k) {
    if (!point(k).active) continue;
    take_first_kick(slot(k).point.frame, point(k));
    if (compliance(k) > 0) set_velocity_slip(k);
  }
}

void ContactForces::finish(std::span<const double> mu, double time) {
  struck_ = false;
  for (int k = 0; k < std::ssize(table_.points); ++k) {
    Point& point = table_.points[k];
    ImpactState& impact = table_.impacts[k];
    if (impact.due()) {
      struck_ = true;
      point.impact_time = time;
    }
    impact.forget(false);
    if (!point.active) continue;
    if (point.touching && point.approach < -table_.resting_speed && compliance(k) == 0) {
      struck_ = true;
      point.impact_time = time;
    }
    const int row = first_row(k);
    keep_impulse(mu.subspan(row, row_count(k)), slot(k).point.frame, point);
    const bool pressed = point.touching && point.back + mu[row] > 0;
    const bool held = pressed && !point.sliding.slips;
    const bool stretched = compliance(k) > 0 ? pressed : held && point.stuck;
    if (!stretched) point.slipped = Vec3::Zero();
    point.stuck = held;
    point.slid = pressed && !held;
    // The next first kick gives half of it.
    for (Disc* disc : {&point.sliding, &point.rolling}) {
      disc->bound *= 0.5;
      disc->given = Vec2::Zero();
    }
    point.spin_bound *= 0.5;
    point.borne *= 0.5;
    point.spin_given = 0;
  }
}

void ContactForces::keep_report(int k) {
  const Point& point = table_.points[k];
  if (point.impulse.isZero(0) && point.torque.isZero(0)) return;
  // table_.cache has moved on; the contact that was there is still known under its old slot.
  ContactReport report;
  report.contact = table_.cache.contact_before(k);
  report.force = point.impulse;
  report.torque = point.torque;
  report.normal_force = report.contact.normal.dot(point.impulse);
  report.impact_time = point.impact_time;
  departed_.push_back(report);
}

std::vector<ContactReport> ContactForces::reports() const {
  std::vector<ContactReport> reports = departed_;
  for (int k = 0; k < std::ssize(table_.points); ++k) {
    const Point& point = table_.points[k];
    if (!point.active) continue;
    const Contact& contact = table_.cache.slots()[k].contact;
    reports.push_back({contact, point.impulse, point.torque, contact.normal.dot(point.impulse), point.slid,
                       point.impact_time});
  }
  return reports;
}

void ContactForces::clear_reports() {
  departed_.clear();
  works_.clear();
  for (Point& point : table_.points) {
    point.impulse = point.torque = Vec3::Zero();
    point.impact_time.reset();
  }
  impacts_.clear();
}

}  // namespace taut
