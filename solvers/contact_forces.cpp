#include "solvers/contact_forces.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace taut {
namespace {

/// Tangents slower than this at the start of a step are first tried as sticking [m/s].
constexpr double kRestingSlip = 1e-9;
/// Times of impact looked for in one step; more impacts end with their sub-step.
constexpr int kMostImpacts = 16;

}  // namespace

ContactForces::ContactForces(const World& world, const Settings& settings)
    : set_(world, settings.contact_margin),
      wanted_(settings.contacts),
      resting_speed_(settings.resting_speed) {
  for (int b = 0; b < world.body_count(); ++b) moves_.push_back(world.moves({b}));
}

void ContactForces::inherit(ContactForces& old, const World& world) {
  const ContactSet::Heritage from = set_.inherit(old.set_, world);
  const int places = static_cast<int>(old.points_.size());
  const auto point = [&](int k) { return k < places ? old.points_[k] : old.resting_points_[k - places]; };
  for (int k : from.places) {
    inherited_.push_back(k < places ? k : -1);
    points_.push_back(point(k));
  }
  for (int k : from.resting) resting_points_.push_back(point(k));
  impacts_.resize(points_.size());
  before_ = points_;
  impacts_before_ = impacts_;
}

void ContactForces::keep_memory() {
  inherited_.resize(points_.size());
  std::iota(inherited_.begin(), inherited_.end(), 0);
}

void ContactForces::forget(std::span<const char> moved) {
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const Rows::ContactPlace& at = set_.places()[k].at;
    if (!moved[at.a] && !moved[at.b]) continue;
    const bool active = points_[k].active;
    points_[k] = {};
    points_[k].active = active;
  }
  for (std::size_t k = 0; k < resting_points_.size(); ++k) {
    const Rows::ContactPlace& at = set_.resting()[k].at;
    if (moved[at.a] || moved[at.b]) resting_points_[k] = {};
  }
}

bool ContactForces::start(const World& world, const State& state, double horizon) {
  const bool changed = set_.find(world, state, horizon);
  if (inherited_.empty())
    points_.assign(set_.places().size(), {});
  else
    remap();
  impacts_.assign(set_.places().size(), {});
  for (std::size_t k = 0; k < points_.size(); ++k) points_[k].active = set_.places()[k].active;
  before_ = points_;
  impacts_before_ = impacts_;
  return changed;
}

bool ContactForces::move_on(const World& world, const State& state, double horizon) {
  const bool changed = set_.find(world, state, horizon);
  remap();
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const ContactSet::Place& place = set_.places()[k];
    Point& point = points_[k];
    point.active = place.active;
    point.gap = place.contact.gap;
    // Where it ends the drift it slips at another rate than where it began it: the mean is what it slipped.
    if (point.slip && (place.slip - *point.slip).norm() > kRestingSlip)
      point.slipped += 0.5 * h_ * (place.slip - *point.slip);
    point.slip.reset();
    point.touching =
        place.active && (point.gap <= kTouch || point.pressed || impacts_[k].stage == Impact::Stage::kDue);
    // A first guess: both kicks alike, and the slip along t₁.
    for (Disc* disc : {&point.sliding, &point.rolling}) {
      disc->bound *= 2;
      disc->weight *= 2;
      disc->direction = Vec2::UnitX();
    }
    point.spin_bound *= 2;
  }
  return changed;
}

/// Memory follows the contacts to their places.
void ContactForces::remap() {
  const std::span<const int> origin = set_.origin(), moved = set_.moved();
  std::vector<char>& goes_on = goes_on_;
  goes_on.assign(points_.size(), 0);
  for (int from : origin)
    if (from >= 0) goes_on[from] = 1;
  for (std::size_t k = 0; k < points_.size(); ++k)
    if (!goes_on[k]) keep_report(static_cast<int>(k));
  const auto map = [](auto& values, std::span<const int> from, auto& scratch) {
    scratch.clear();
    for (int k : from)
      scratch.push_back(k >= 0 ? values[k] : typename std::decay_t<decltype(values)>::value_type{});
    values.swap(scratch);
  };
  map(points_, origin, point_scratch_);
  map(impacts_, origin, impact_scratch_);
  map(before_, moved, point_scratch_);
  map(impacts_before_, moved, impact_scratch_);
}

void ContactForces::set_rows(const Rows& rows) {
  first_row_.clear();
  for (int k = 0; k < rows.contact_count(); ++k)
    first_row_.push_back(rows.joints()[rows.contact_joint(k)].first_row);
}

void ContactForces::give_points(ConstraintSystem& system) const {
  for (std::size_t k = 0; k < points_.size(); ++k)
    if (points_[k].active) system.set_contact(static_cast<int>(k), set_.places()[k].point);
}

/// What roll_back() needs.
void ContactForces::remember(double h) {
  h_ = h;
  in_velocities_ = false;
  before_ = points_;
  impacts_before_ = impacts_;
  work_before_ = work_;
  departed_before_ = departed_.size();
  solves_ = 0;
}

void ContactForces::begin(double h, std::span<const double> rates, std::span<const double> inertia) {
  remember(h);
  set_roots(inertia);
  for (std::size_t k = 0; k < points_.size(); ++k) {
    Point& point = points_[k];
    const ContactSet::Place& place = set_.places()[k];
    point.live = point.active;
    if (!point.active) continue;
    point.gap = place.contact.gap;
    point.approach = rates[first_row_[k]];
    const int row = first_row_[k];
    // What starts at rest holds with static friction.
    const bool rests = std::hypot(rates[row + 1], rates[row + 2]) <= kRestingSlip;
    point.stuck = point.stuck || (point.fresh && point.gap <= kTouch && rests);
    point.fresh = point.broken = point.pressed = false;
    point.back = point.spin_given = 0;
    point.sliding.given = point.rolling.given = Vec2::Zero();
    // What it has slipped since it sticks is taken back.
    const row_parts::ContactFrame& frame = place.point.frame;
    point.sliding.target = -Vec2(frame.t1.dot(point.slipped), frame.t2.dot(point.slipped)) / h;
    point.rolling.target = Vec2::Zero();
    aim_discs(static_cast<int>(k), rates);
  }
  set_soft_laws();
}

/// A first guess: what slips goes on slipping.
void ContactForces::aim_discs(int k, std::span<const double> rates) {
  Point& point = points_[k];
  const auto aim = [&](Disc& disc, int first) {
    const Vec2 slip(rates[first], rates[first + 1]);
    disc.slips = !point.stuck && slip.norm() > kRestingSlip && std::isfinite(disc.bound);
    if (disc.slips) {
      disc.direction = slip.normalized();
      disc.weight = disc.bound / slip.norm();
    }
  };
  aim(point.sliding, first_row_[k] + 1);
  if (has_twist(k)) aim(point.rolling, first_row_[k] + 4);
}

void ContactForces::begin_single_kick(double h) {
  remember(h);
  single_kick_ = true;
  for (Point& point : points_) {
    point.broken = point.pressed = false;
    point.back = point.spin_given = 0;
    point.first = point.first_torque = point.slipped = Vec3::Zero();
    for (Disc* disc : {&point.sliding, &point.rolling}) disc->given = disc->target = Vec2::Zero();
  }
}

void ContactForces::begin_impulses(std::span<const double> rates, std::span<const double> inertia) {
  set_roots(inertia);
  in_velocities_ = true;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    Point& point = points_[k];
    point.live = point.active && point.touching;
    if (!point.active) continue;
    const int row = first_row_[k];
    point.approach = rates[row];
    const bool rests = std::hypot(rates[row + 1], rates[row + 2]) <= kRestingSlip;
    point.stuck = point.stuck || (point.fresh && rests);
    point.fresh = false;
    aim_discs(static_cast<int>(k), rates);
  }
}

void ContactForces::set_roots(std::span<const double> inertia) {
  root_.resize(inertia.size());
  for (std::size_t r = 0; r < inertia.size(); ++r) root_[r] = inertia[r] > 0 ? 1 / std::sqrt(inertia[r]) : 1;
}

void ContactForces::roll_back(bool moved_on) {
  if (moved_on) {
    set_.undo();
    impacts_ = impacts_before_;
  }
  points_ = before_;
  work_ = work_before_;
  departed_.resize(departed_before_);
}

bool ContactForces::rest() const {
  for (std::size_t k = 0; k < points_.size(); ++k)
    if (points_[k].live && (impacts_[k].stage != Impact::Stage::kNone ||
                            (points_[k].approach < -resting_speed_ && compliance(static_cast<int>(k)) == 0)))
      return false;
  return !empty();
}

void ContactForces::turned(ConstraintSystem& system) {
  for (const Turn& turn : turns_) {
    system.turn_tangents(turn.place, set_.point(turn.place), turn.cos, turn.sin);
    for (Disc* disc : {&points_[turn.place].sliding, &points_[turn.place].rolling})
      for (Vec2* v : {&disc->direction, &disc->given, &disc->target})
        *v = Vec2(turn.cos * v->x() + turn.sin * v->y(), turn.cos * v->y() - turn.sin * v->x());
  }
  turns_.clear();
}

bool ContactForces::seek_impacts(std::span<const double> w) {
  if (impact_count_ >= kMostImpacts) return false;
  bool any = false;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const Point& point = points_[k];
    Impact& impact = impacts_[k];
    if (!point.active || set_.places()[k].material.restitution == 0 || impact.spent ||
        impact.stage != Impact::Stage::kNone || point.gap <= kTouch || point.approach > -resting_speed_ ||
        impact_is_seen(static_cast<int>(k)))
      continue;
    const double stop = -point.gap / h_;
    if (w[first_row_[k]] > stop + 1e-9 * (1 + std::abs(stop))) continue;
    impact.stage = Impact::Stage::kSought;
    any = true;
  }
  if (any) ++impact_count_;
  return any;
}

/// Root of  gap + w₀ s + (w − w₀) s²/h = 0  in (0, h]; h if the points do not meet.
double ContactForces::crossing(int k, double w) const {
  const Point& point = points_[k];
  const auto gap_at = [&](double s) {
    return point.gap + point.approach * s + (w - point.approach) * s * s / h_;
  };
  double low = 0, high = h_;
  if (gap_at(high) >= 0) return h_;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (gap_at(middle) > 0 ? low : high) = middle;
  }
  return high;
}

double ContactForces::first_impact(std::span<const double> w) const {
  double first = h_;
  for (std::size_t k = 0; k < points_.size(); ++k)
    if (impacts_[k].stage == Impact::Stage::kSought)
      first = std::min(first, crossing(static_cast<int>(k), w[first_row_[k]]));
  return first;
}

void ContactForces::take_impacts(double until, std::span<const double> w) {
  for (std::size_t k = 0; k < points_.size(); ++k) {
    Impact& impact = impacts_[k];
    if (impact.stage != Impact::Stage::kSought) {
      impact.stage = Impact::Stage::kNone;
      continue;
    }
    const double mean = w[first_row_[k]], s = crossing(static_cast<int>(k), mean);
    impact.stage = s <= until ? Impact::Stage::kDue : Impact::Stage::kNone;
    impact.rate = points_[k].approach + 2 * (mean - points_[k].approach) * s / h_;
  }
}

void ContactForces::forget_impacts(bool for_good) {
  for (Impact& impact : impacts_) {
    if (for_good && impact.stage != Impact::Stage::kNone) impact.spent = true;
    impact.stage = Impact::Stage::kNone;
  }
}

/// Impulses of rows as world vectors, and their work.
void ContactForces::book(int k, std::span<const double> lambda, std::span<const double> rates) {
  Point& point = points_[k];
  const row_parts::ContactFrame& frame = set_.places()[k].point.frame;
  const int row = first_row_[k];
  Vec3 impulse = Vec3::Zero(), torque = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    impulse += lambda[row + i] * frame.direction(i);
    (i == 0 ? work_.normal : work_.friction) += lambda[row + i] * rates[row + i];
    if (!has_twist(k)) continue;
    torque += lambda[row + 3 + i] * frame.direction(i);
    work_.friction += lambda[row + 3 + i] * rates[row + 3 + i];
  }
  point.first = impulse;
  point.first_torque = torque;
  point.impulse += impulse;
  point.torque += torque;
}

void ContactForces::keep(std::span<const double> lambda, std::span<const double> w,
                         std::span<const double> rates) {
  for (std::size_t k = 0; k < points_.size(); ++k) {
    Point& point = points_[k];
    if (!point.active) continue;
    const int row = first_row_[k];
    book(static_cast<int>(k), lambda, rates);
    point.pressed = lambda[row] > 0;
    point.slip.reset();
    // The slip of this step while it holds: what is left of the target.
    if (!point.sliding.slips && point.pressed) {
      const row_parts::ContactFrame& frame = set_.places()[k].point.frame;
      const Vec3 slip = w[row + 1] * frame.t1 + w[row + 2] * frame.t2;
      point.slipped += h_ * slip;
      if (compliance(static_cast<int>(k)) == 0) point.slip = slip;
    } else if (const double C = compliance(static_cast<int>(k)); C > 0 && point.pressed) {
      const row_parts::ContactFrame& frame = set_.places()[k].point.frame;
      point.slipped = -2 * C / h_ * (lambda[row + 1] * frame.t1 + lambda[row + 2] * frame.t2);
    } else {
      point.slipped = Vec3::Zero();
    }
  }
}

void ContactForces::begin_velocities(std::span<const double> rates, std::span<const double> inertia) {
  set_roots(inertia);
  in_velocities_ = true;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    Point& point = points_[k];
    point.live = point.active && point.touching;
    if (!point.active) continue;
    if (point.fresh) point.approach = rates[first_row_[k]];
    const row_parts::ContactFrame& frame = set_.places()[k].point.frame;
    point.back = std::max(0.0, frame.n.dot(point.first));
    point.sliding.given = Vec2(frame.t1.dot(point.first), frame.t2.dot(point.first));
    point.rolling.given = Vec2(frame.t1.dot(point.first_torque), frame.t2.dot(point.first_torque));
    point.spin_given = frame.n.dot(point.first_torque);
    point.sliding.target = point.rolling.target = Vec2::Zero();
  }
  set_soft_laws();
}

void ContactForces::finish(std::span<const double> mu, std::span<const double> rates, double time) {
  struck_ = false;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    Point& point = points_[k];
    Impact& impact = impacts_[k];
    if (impact.stage == Impact::Stage::kDue) {
      struck_ = impact.spent = true;
      point.impact_time = time;
    }
    impact.stage = Impact::Stage::kNone;
    if (!point.active) continue;
    if (point.touching && point.approach < -resting_speed_ && compliance(static_cast<int>(k)) == 0) {
      struck_ = true;
      point.impact_time = time;
    }
    book(static_cast<int>(k), mu, rates);
    const int row = first_row_[k];
    const bool pressed = point.touching && point.back + mu[row] > 0;
    const bool held = pressed && !point.sliding.slips;
    const bool stretched = compliance(static_cast<int>(k)) > 0 ? pressed : held && point.stuck;
    if (!stretched) point.slipped = Vec3::Zero();
    point.stuck = held;
    point.slid = pressed && !held;
    // The next first kick gives half of it.
    for (Disc* disc : {&point.sliding, &point.rolling}) {
      disc->bound *= 0.5;
      disc->given = Vec2::Zero();
    }
    point.spin_bound *= 0.5;
    point.spin_given = 0;
  }
}

void ContactForces::keep_report(int k) {
  const Point& point = points_[k];
  if (point.impulse.isZero(0) && point.torque.isZero(0)) return;
  // set_ has moved on; the contact of before is still known under its old place.
  ContactReport report;
  report.contact = set_.contact_before(k);
  report.force = point.impulse;
  report.torque = point.torque;
  report.normal_force = report.contact.normal.dot(point.impulse);
  report.impact_time = point.impact_time;
  departed_.push_back(report);
}

std::vector<ContactReport> ContactForces::reports() const {
  std::vector<ContactReport> reports = departed_;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const Point& point = points_[k];
    if (!point.active) continue;
    const Contact& contact = set_.places()[k].contact;
    reports.push_back({contact, point.impulse, point.torque, contact.normal.dot(point.impulse), point.slid,
                       point.impact_time});
  }
  return reports;
}

void ContactForces::clear_reports() {
  departed_.clear();
  work_ = {};
  impact_count_ = 0;
  for (Point& point : points_) {
    point.impulse = point.torque = Vec3::Zero();
    point.impact_time.reset();
  }
  for (Impact& impact : impacts_) impact = {};
}

}  // namespace taut
