#include <algorithm>
#include <cmath>

#include "solvers/complementarity/contact_newton.h"

// What Newton's method for contacts projects onto: the laws of rows and contacts, and the slopes of that.
namespace taut {

/// x and y = P(x) at the present velocities and `length` of the step, with the slopes of P.
void ContactNewton::project(const Problem& problem, double length) {
  const Rows& rows = system_.rows();
  for (std::size_t r = 0; r < x_.size(); ++r)
    x_[r] = carry_[r] * last_[r] -
            (base_[r] + rates_[r] + length * rates_of_step_[r] - target_[r] + shift_[r]) / sigma_[r];
  for (int r = 0; r < rows.first_contact_row(); ++r) project_row(problem.laws[r], r);
  for (int k = 0; k < rows.contact_count(); ++k) project_contact(problem, k);
}

void ContactNewton::project_row(const RowLaw& law, int r) {
  if (!law.bounded()) {
    y_[r] = x_[r];
    slope_[r] = 1;
    return;
  }
  const RowLaw::Point point = law.resolve(sigma_[r], -sigma_[r] * x_[r]);
  y_[r] = point.lambda;
  slope_[r] = RowLaw::is_vertical(point.segment) ? 1 : law.slope * sigma_[r] / (1 + law.slope * sigma_[r]);
}

/// The nearest point of Coulomb's cone |Λ_t| ≤ μ Λ_n, of the spin's interval and of the rolling disc.
void ContactNewton::project_contact(const Problem& problem, int k) {
  const ContactLaws::Cone cone = problem.contacts.cone(k);
  const int row = problem.contacts.first_row(k), count = problem.contacts.row_count(k);
  if (!cone.works) {
    std::fill_n(y_.begin() + row, count, 0.0);
    std::fill_n(slope_.begin() + row, count, 0.0);
    coupling_[k] = 0;
    return;
  }
  const double mu = cone.sliding, normal = cone.normal_given + x_[row];
  const Vec2 tangent = cone.sliding_given + Vec2(x_[row + 1], x_[row + 2]);
  coupling_[k] = 0;
  if (by_radius(cone)) {
    const double total = std::clamp(normal, 0.0, cone.most);
    y_[row] = total - cone.normal_given;
    slope_[row] = total == normal ? 1 : 0;
    if (mode_ == Mode::kCoupled) {
      bound_[row + 1] = mu * total;
      if (tangent.norm() > bound_[row + 1]) coupling_[k] = mu * slope_[row];
    }
    project_disc(k, 1, cone.sliding_given);
  } else {
    project_cone(k, cone, normal, tangent);
  }
  if (!cone.twist) return;
  // Arms follow the normal impulse of this round where nothing is lagged, else that of the round before.
  const double pressing = std::max(0.0, cone.normal_given + (mode_ == Mode::kCoupled ? y_ : last_)[row]);
  bound_[row + 3] = cone.spinning * pressing;
  bound_[row + 4] = cone.rolling * pressing;
  const double spin = cone.spin_given + x_[row + 3];
  y_[row + 3] = std::clamp(spin, -bound_[row + 3], bound_[row + 3]) - cone.spin_given;
  slope_[row + 3] = std::abs(spin) < bound_[row + 3] ? 1 : 0;
  project_disc(k, 4, cone.rolling_given);
}

/// The cone itself, in three rows of a contact whose impulses with what was given are these.
void ContactNewton::project_cone(int k, const ContactLaws::Cone& cone, double normal, const Vec2& tangent) {
  const int row = system_.rows().joints()[system_.rows().contact_joint(k)].first_row;
  const double mu = cone.sliding, size = tangent.norm();
  const auto [region, on] = nearest_on_cone(normal, size, mu);
  if (region != NearestOnCone::Region::kSurface) {
    const bool within = region == NearestOnCone::Region::kWithin;
    for (int i = 0; i < 3; ++i) slope_[row + i] = within ? 1 : 0;
    if (within) {
      std::copy_n(x_.begin() + row, 3, y_.begin() + row);
    } else {
      y_[row] = -cone.normal_given;
      y_[row + 1] = -cone.sliding_given[0];
      y_[row + 2] = -cone.sliding_given[1];
    }
    turn_rows(k, 0, 1, Vec2::UnitX());
    return;
  }
  const Vec2 direction = size > 0 ? Vec2(tangent / size) : Vec2(Vec2::UnitX());
  y_[row] = on - cone.normal_given;
  y_[row + 1] = mu * on * direction[0] - cone.sliding_given[0];
  y_[row + 2] = mu * on * direction[1] - cone.sliding_given[1];
  slope_[row] = 1;  // along the generator
  slope_[row + 1] = 0;
  slope_[row + 2] = size > 0 ? mu * on / size : 0;  // across it
  turn_rows(k, mu, 1, direction);
}

/// The disc of radius bound_ in two rows of a contact.
void ContactNewton::project_disc(int k, int first, const Vec2& given) {
  const int row = system_.rows().joints()[system_.rows().contact_joint(k)].first_row + first;
  const Vec2 x = given + Vec2(x_[row], x_[row + 1]);
  const double size = x.norm(), most = bound_[row];
  const bool slips = size > most;
  const Vec2 answer = into_disc(x, most) - given;
  y_[row] = answer[0];
  y_[row + 1] = answer[1];
  slope_[row] = slips ? 0 : 1;
  slope_[row + 1] = slips ? most / size : 1;
  turn_rows(k, 0, first, slips ? Vec2(x / size) : Vec2(Vec2::UnitX()));
}

/// Rows of W in which P' is diagonal: tangents along `direction` and across it, the first one with the normal
/// along the generator (1, μ) of the cone.
void ContactNewton::turn_rows(int place, double mu, int first, const Vec2& direction) {
  const Rows& rows = system_.rows();
  const Rows::JointRows& contact = rows.joints()[rows.contact_joint(place)];
  const double length = 1 / std::sqrt(1 + mu * mu);
  for (int s = contact.first_side; s < contact.first_side + contact.side_count; ++s) {
    const double* W = system_.weighted().data() + rows.sides()[s].whole;
    double* turned = turned_.data() + rows.sides()[s].whole;
    for (int k = 0; k < 6; ++k) {
      const double a = W[6 * first + k], b = W[6 * first + 6 + k];
      const double along = direction[0] * a + direction[1] * b;
      turned[6 * first + k] = along;
      turned[6 * first + 6 + k] = direction[0] * b - direction[1] * a;
      if (first == 1) turned[k] = length * (W[k] + mu * along);
    }
  }
}

}  // namespace taut
