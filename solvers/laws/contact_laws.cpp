#include "solvers/laws/contact_laws.h"

#include <algorithm>
#include <cmath>
#include <numbers>

// What contacts ask of a stage, as laws of rows and as cones, and how far a solution is from it.
namespace taut {
namespace {

/// Bodies that start inside each other come apart at no more than this speed [m/s].
constexpr double kReturnSpeed = 1;
/// A step of a law that no rate comes to.
constexpr double kNever = 1e12;
/// δ of (solvers/laws, Eq. 6) where the step resolves the spring: a face on a face then has one division of
/// its second kick for speeds that differ by round-off.
constexpr double kGivingWay = 0.1;

/// A box around `centre`, or just that if it has no width.
RowLaw box_around(double centre, double half, double w) {
  if (!(centre - half < centre + half)) return RowLaw::constant(centre);
  return RowLaw::box(centre - half, centre + half, w);
}

/// e of a spring and damper of this ratio to critical damping, let go where its force is 0.
double restitution_of(double ratio) {
  const double root = std::sqrt(1 - ratio * ratio);
  return std::exp(-ratio / root * std::atan2(2 * ratio * root, 2 * ratio * ratio - 1));
}

/// The inverse of that, at most critical damping, of which e = e⁻².
double damping_ratio(double restitution) {
  double low = 0, high = 1 - 1e-12;
  if (restitution <= restitution_of(high)) return 1;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (restitution_of(middle) > restitution ? low : high) = middle;
  }
  return low;
}

}  // namespace

void ContactLaws::choose(std::span<const int> places, const Rows& rows) {
  places_.assign(places.begin(), places.end());
  first_row_.clear();
  for (int k = 0; k < rows.contact_count(); ++k)
    first_row_.push_back(rows.joints()[rows.contact_joint(k)].first_row);
  turns_.clear();
}

void ContactLaws::set_inertia(std::span<const double> inertia) {
  root_.resize(inertia.size());
  for (std::size_t r = 0; r < inertia.size(); ++r) root_[r] = inertia[r] > 0 ? 1 / std::sqrt(inertia[r]) : 1;
}

bool ContactLaws::rest() const {
  for (int k = 0; k < count(); ++k)
    if (contact(k).live && (impact_of(k).stage != Impact::Stage::kNone ||
                            (contact(k).approach < -table_.resting_speed && compliance(k) == 0)))
      return false;
  return true;
}

void ContactLaws::turned(ConstraintSystem& system) {
  for (const Turn& turn : turns_) {
    system.turn_tangents(turn.place, table_.set.point(places_[turn.place]), turn.cos, turn.sin);
    for (Disc* disc : {&contact(turn.place).sliding, &contact(turn.place).rolling})
      for (Vec2* v : {&disc->direction, &disc->given, &disc->target})
        *v = Vec2(turn.cos * v->x() + turn.sin * v->y(), turn.cos * v->y() - turn.sin * v->x());
  }
  turns_.clear();
}

void ContactLaws::set_soft_laws() {
  for (int k = 0; k < count(); ++k)
    if (contact(k).active && compliance(k) > 0) contact(k).soft = soft_law(k);
}

void ContactLaws::position_laws(std::span<RowLaw> laws) const {
  for (int k = 0; k < count(); ++k) {
    const Point& point = contact(k);
    const int row = first_row_[k], count = has_twist(k) ? 6 : 3;
    std::fill_n(laws.begin() + row, count, RowLaw::none());
    if (!point.active || impact_of(k).stage == Impact::Stage::kSought) continue;
    laws[row] = RowLaw::lower_limit(normal_law(k).target);
    friction_laws(k, laws);
  }
}

void ContactLaws::velocity_laws(std::span<RowLaw> laws) const {
  for (int k = 0; k < count(); ++k) {
    const Point& point = contact(k);
    const int row = first_row_[k], count = has_twist(k) ? 6 : 3;
    std::fill_n(laws.begin() + row, count, RowLaw::none());
    if (!point.live) continue;
    const NormalLaw normal = normal_law(k);
    laws[row] = RowLaw::lower_limit(normal.target);
    laws[row].level[1] -= point.back;  // both kicks together are the impulse that must not pull
    laws[row].level[0] = normal.most - point.back;
    friction_laws(k, laws);
  }
}

void ContactLaws::clear_idle(std::span<double> lambda) const {
  for (int k = 0; k < count(); ++k)
    if (!works(k)) std::fill_n(lambda.begin() + first_row_[k], has_twist(k) ? 6 : 3, 0.0);
}

bool ContactLaws::is_clear(std::span<const double> lambda) const {
  for (int k = 0; k < count(); ++k) {
    const auto given = lambda.begin() + first_row_[k];
    if (!works(k) && std::any_of(given, given + (has_twist(k) ? 6 : 3), [](double l) { return l != 0; }))
      return false;
  }
  return true;
}

bool ContactLaws::soft() const {
  for (int k = 0; k < count(); ++k)
    if (contact(k).live && compliance(k) > 0) return true;
  return false;
}

ContactLaws::NormalLaw ContactLaws::normal_law(int k) const {
  if (compliance(k) > 0 && impact_of(k).stage != Impact::Stage::kDue) return contact(k).soft;
  return {.target = table_.in_velocities ? bounce(k) : closing_rate(k)};
}

/// N = max(0, −g/C) with the gap g = g₀ + a w, and h N = 2λ (Eq. 5).  With a = h/2, the middle of the step,
/// N (g₁ − g₀) is the change of g²/2C: energy is conserved while the bodies touch.  With a = h, its end,
/// N |g₁ − g₀| ≥ g₁²/C, more than the spring stores: bodies that come to touch never gain any.  More than h/2
/// is a damper, made for the mass 1/S_rr that the contact feels.  The second kick μ gives what the first
/// gave, `back`, unless the bodies then part faster than w̄, the rate of an impact and that of a spring as
/// deep as they are (Eq. 6).  As 2σλ is ω times the depth that belongs to λ, all of μ = λ is given up to
/// (1 − δ) of that rate.  Where the step does not resolve the spring δ = 1, a critical damper: with μ = λ
/// what rests would swing from step to step, and so it shrinks by (1 + eωh)/(1 + ωh) in two steps.  The law
/// is in μ: δ σ Λ = δ σ (μ + back).
/// (solvers/laws, "Compliant contacts")
ContactLaws::NormalLaw ContactLaws::soft_law(int k) const {
  const Point& point = contact(k);
  const Material& material = place_of(k).material;
  const double C = material.compliance, root = root_[first_row_[k]], period = std::sqrt(C) / root;  // 1/ω
  if (table_.in_velocities) {
    const double pressed = std::max(-point.gap, 2 * C * point.back / table_.h);
    const double rebound = std::max(-material.restitution * point.approach, point.approach);
    const double delta = impact_is_seen(k) ? kGivingWay : 1, softness = delta * C / (table_.h * period);
    return {.target = std::max(0.0, rebound) + std::max(0.0, pressed) / period - softness * point.back,
            .softness = softness,
            .most = 2 * point.back};
  }
  const double damping = damping_ratio(material.restitution);
  const double a =
      point.gap >= 0 ? table_.h : 0.5 * table_.h + damping * std::max(2 * period, 0.5 * table_.h);
  return {.target = std::clamp(-point.gap / a, -kNever, kNever), .softness = 2 * C / (table_.h * a)};
}

/// True if a step is short enough to see the impact of a compliant contact: ω h < 1.
bool ContactLaws::impact_is_seen(int k) const {
  return compliance(k) > 0 && table_.h * root_[first_row_[k]] < std::sqrt(compliance(k));
}

/// The same spring across the normal, which yields where friction does: its stretch is what slipped.  The
/// second kick gives what the first gave, less a critical damper.
ContactLaws::SlipLaw ContactLaws::slip_law(int k, const Disc& disc) const {
  const Point& point = contact(k);
  const double C = compliance(k);
  if (&disc == &point.sliding && sharing_ && sticks(k)) return {disc.target, 0};
  if (C == 0 || &disc != &point.sliding) return {disc.slips ? Vec2::Zero() : disc.target, 0};
  if (!table_.in_velocities) return {disc.target, 2 * C / (table_.h * table_.h)};
  const double softness = root_[first_row_[k] + 1] * std::sqrt(C) / table_.h;
  return {softness * disc.given, softness};
}

/// Newton's law of impact: the least normal rate after it.
double ContactLaws::bounce(int k) const {
  if (table_.single_kick) return -place_of(k).material.restitution * contact(k).approach;
  const double approach = impact_of(k).stage == Impact::Stage::kDue ? impact_of(k).rate : contact(k).approach;
  return approach < -table_.resting_speed ? -place_of(k).material.restitution * approach : 0;
}

/// Bodies may come together by their gap in a step, and bodies inside each other part slowly.
double ContactLaws::closing_rate(int k) const {
  return std::clamp(-contact(k).gap / table_.h, -kNever, std::max(kReturnSpeed, kTouch / table_.h));
}

void ContactLaws::targets(std::span<double> target) const {
  for (int k = 0; k < count(); ++k) {
    const Point& point = contact(k);
    const int row = first_row_[k];
    target[row] = normal_law(k).target;
    const SlipLaw law = slip_law(k, point.sliding);
    for (int i : {0, 1}) target[row + 1 + i] = law.target[i];
  }
}

ContactLaws::Cone ContactLaws::cone(int k) const {
  const Point& point = contact(k);
  const Material& material = place_of(k).material;
  const NormalLaw normal = normal_law(k);
  return {works(k),
          has_twist(k),
          sharing_ && sticks(k),
          friction_bound(k, 1),
          material.spinning_friction,
          material.rolling_friction,
          normal.softness,
          normal.most,
          slip_law(k, point.sliding).softness,
          point.back,
          point.spin_given,
          point.sliding.given,
          point.rolling.given};
}

void ContactLaws::project(int k, std::span<const double> x, std::span<double> y) const {
  const auto in_disc = [&](int r, const Vec2& given, double bound) {
    const Vec2 tau = into_disc(given + Vec2(x[r], x[r + 1]), bound);
    y[r] = tau[0] - given[0];
    y[r + 1] = tau[1] - given[1];
  };
  const Point& point = contact(k);
  const int row = first_row_[k], count = has_twist(k) ? 6 : 3;
  std::fill_n(y.begin() + row, count, 0.0);
  if (!works(k)) return;
  const Material& material = place_of(k).material;
  y[row] = std::min(std::max(-point.back, x[row]), normal_law(k).most - point.back);
  const double normal = point.back + y[row];
  in_disc(row + 1, point.sliding.given, friction_bound(k, normal));
  if (count == 3) return;
  const double arm = material.spinning_friction * normal;
  y[row + 3] = std::clamp(point.spin_given + x[row + 3], -arm, arm) - point.spin_given;
  in_disc(row + 4, point.rolling.given, material.rolling_friction * normal);
}

void ContactLaws::friction_laws(int k, std::span<RowLaw> laws) const {
  const Point& point = contact(k);
  const int row = first_row_[k];
  disc_laws(point.sliding, row + 1, laws);
  if (!has_twist(k)) return;
  laws[row + 3] = box_around(-point.spin_given, point.spin_bound, 0);
  disc_laws(point.rolling, row + 4, laws);
}

/// A disc that holds is a square around it, or, if a corner of that was used, one inside it that has its own
/// corner there.  A disc that slips along t₁ has the level −bound there, and across it the friction that
/// turns with the slip: the derivative of −bound w/|w|.
void ContactLaws::disc_laws(const Disc& disc, int row, std::span<RowLaw> laws) const {
  const bool holds = !disc.slips || disc.weight == 0 || !(disc.bound > 0);
  for (int i : {0, 1}) {
    const double half = disc.slips ? disc.bound * std::abs(disc.direction[i]) : disc.bound;
    laws[row + i] = box_around(-disc.given[i], half, disc.slips ? 0 : disc.target[i]);
  }
  if (holds) return;
  laws[row + 1] = RowLaw::viscous(disc.weight);
  laws[row + 1].level[0] = -disc.given[1];
}

}  // namespace taut
