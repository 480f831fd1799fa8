#include "solvers/complementarity/contact_projection.h"

#include <algorithm>
#include <cmath>

namespace taut {

void ContactProjection::begin(std::span<const double> lambda) {
  slope_.assign(lambda.size(), 0.0);
  y_.assign(lambda.begin(), lambda.end());
  turned_.assign(system_.weighted().begin(), system_.weighted().end());
  coupling_.assign(system_.rows().contact_count(), 0.0);
}

/// Of a contact the nearest point of an interval of the normal and of a disc whose radius follows from it, or
/// of the cone |Λ_t| ≤ μ Λ_n where contacts share a load; then of the spin's interval and the rolling disc.
void ContactProjection::project(const ContactProblem& problem, std::span<const double> x,
                                std::span<const double> sigma) {
  x_ = x;
  sigma_ = sigma;
  const Rows& rows = system_.rows();
  for (int r = 0; r < rows.first_contact_row(); ++r) project_row(problem.laws[r], sigma[r], r);
  for (int k = 0; k < rows.contact_count(); ++k) {
    const ContactLaws::Cone cone = problem.contacts.cone(k);
    coupling_[k] = 0;
    if (!cone.works)
      project_nothing(k, problem.contacts.row_count(k));
    else if (cone.normality)
      project_cone(k, cone);
    else if (project_disc(k, kSlidingRow, cone.sliding_given, cone.sliding * project_normal(k, cone)))
      coupling_[k] = cone.sliding * slope_[first_row(k)];
    if (cone.works && cone.twist) project_twist(k, cone);
  }
}

void ContactProjection::project_row(const RowLaw& law, double sigma, int r) {
  if (!law.bounded()) {
    y_[r] = x_[r];
    slope_[r] = 1;
    return;
  }
  const RowLaw::Point point = law.resolve(sigma, -sigma * x_[r]);
  y_[r] = point.lambda;
  slope_[r] = RowLaw::is_vertical(point.segment) ? 1 : law.slope * sigma / (1 + law.slope * sigma);
}

/// A contact that is let through.
void ContactProjection::project_nothing(int k, int count) {
  std::fill_n(y_.begin() + first_row(k), count, 0.0);
  std::fill_n(slope_.begin() + first_row(k), count, 0.0);
}

/// Returns the impulse with what was given.
double ContactProjection::project_normal(int k, const ContactLaws::Cone& cone) {
  const int row = first_row(k);
  const double given = cone.normal_given + x_[row], normal = std::clamp(given, 0.0, cone.most);
  y_[row] = normal - cone.normal_given;
  slope_[row] = normal == given ? 1 : 0;
  return normal;
}

/// The cone itself, in three rows of a contact.
void ContactProjection::project_cone(int k, const ContactLaws::Cone& cone) {
  const int row = first_row(k);
  const double normal = cone.normal_given + x_[row];
  const Vec2 tangent = cone.sliding_given + Vec2(x_[row + kSlidingRow], x_[row + kSlidingRow + 1]);
  const double mu = cone.sliding, size = tangent.norm();
  const auto [region, on] = nearest_on_cone(normal, size, mu);
  if (region != NearestOnCone::Region::kSurface) {
    const bool within = region == NearestOnCone::Region::kWithin;
    for (int i = 0; i < 3; ++i) slope_[row + i] = within ? 1 : 0;
    if (within) {
      std::copy_n(x_.begin() + row, 3, y_.begin() + row);
    } else {
      y_[row] = -cone.normal_given;
      y_[row + kSlidingRow] = -cone.sliding_given[0];
      y_[row + kSlidingRow + 1] = -cone.sliding_given[1];
    }
    turn_rows(k, 0, kSlidingRow, Vec2::UnitX());
    return;
  }
  const Vec2 direction = size > 0 ? Vec2(tangent / size) : Vec2(Vec2::UnitX());
  y_[row] = on - cone.normal_given;
  y_[row + kSlidingRow] = mu * on * direction[0] - cone.sliding_given[0];
  y_[row + kSlidingRow + 1] = mu * on * direction[1] - cone.sliding_given[1];
  slope_[row] = 1;  // along the generator
  slope_[row + kSlidingRow] = 0;
  slope_[row + kSlidingRow + 1] = size > 0 ? mu * on / size : 0;  // across it
  turn_rows(k, mu, kSlidingRow, direction);
}

/// Spinning and rolling friction under the normal impulse that is there.
void ContactProjection::project_twist(int k, const ContactLaws::Cone& cone) {
  const int row = first_row(k) + kSpinRow;
  const double normal = std::max(0.0, cone.normal_given + y_[first_row(k)]);
  const double given = cone.spin_about(normal), most = cone.spinning * normal, spin = given + x_[row];
  const double part = part_of_slope(cone.linear.spinning * normal, sigma_[row]);
  y_[row] = into_interval(spin, most, part) - given;
  slope_[row] = std::abs(spin) < most ? 1 : part;
  (void)project_disc(k, kRollingRow, cone.rolling_about(normal), cone.rolling * normal,
                     part_of_slope(cone.linear.rolling * normal, sigma_[row + 1]));
}

/// A disc in two rows of a contact, and a part of what is beyond it; true if x is.
bool ContactProjection::project_disc(int k, int first, const Vec2& given, double radius, double part) {
  const int row = first_row(k) + first;
  const Vec2 x = given + Vec2(x_[row], x_[row + 1]);
  const double size = x.norm();
  const bool slips = size > radius;
  const Vec2 answer = into_disc(x, radius, part) - given;
  y_[row] = answer[0];
  y_[row + 1] = answer[1];
  slope_[row] = slips ? part : 1;
  slope_[row + 1] = slips ? (radius + part * (size - radius)) / size : 1;
  turn_rows(k, 0, first, slips ? Vec2(x / size) : Vec2(Vec2::UnitX()));
  return slips;
}

/// Rows of W in which ∂prox is diagonal: tangents along `direction` and across it, the first one with the
/// normal along the generator (1, μ) of the cone.
void ContactProjection::turn_rows(int k, double mu, int first, const Vec2& direction) {
  const Rows& rows = system_.rows();
  const Rows::JointRows& contact = rows.joints()[rows.contact_joint(k)];
  const double length = 1 / std::sqrt(1 + mu * mu);
  for (int s = contact.first_side; s < contact.first_side + contact.side_count; ++s) {
    const double* W = system_.weighted().data() + rows.sides()[s].whole;
    double* turned = turned_.data() + rows.sides()[s].whole;
    for (int i = 0; i < 6; ++i) {
      const double a = W[6 * first + i], b = W[6 * first + 6 + i];
      const double along = direction[0] * a + direction[1] * b;
      turned[6 * first + i] = along;
      turned[6 * first + 6 + i] = direction[0] * b - direction[1] * a;
      if (first == kSlidingRow) turned[i] = length * (W[i] + mu * along);
    }
  }
}

}  // namespace taut
