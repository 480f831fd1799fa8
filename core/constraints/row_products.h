#pragma once

#include "core/constraints/rows.h"
#include "core/constraints/six_vector.h"

// J V of a joint and Jᵀ λ on a body for loops over bodies, inline: each is no longer than a call of it.
namespace taut {
namespace detail {

/// Of a body at arm r, in the order of the operations that a row of numbers would take.
inline Vec3 rate_at(const double* r, const Twist& V) {
  return {(V.w[1] * r[2] + V.v[0]) - V.w[2] * r[1], (V.w[2] * r[0] - V.w[0] * r[2]) + V.v[1],
          V.w[0] * r[1] + (V.v[2] - V.w[1] * r[0])};
}
inline void add_force_at(const double* r, const Vec3& f, Eigen::Matrix<double, 6, 1>& wrench) {
  wrench[0] = (wrench[0] - f[1] * r[2]) + f[2] * r[1];
  wrench[1] = (wrench[1] + f[0] * r[2]) - f[2] * r[0];
  wrench[2] = (wrench[2] - f[0] * r[1]) + f[1] * r[0];
  for (int i = 0; i < 3; ++i) wrench[3 + i] += f[i];
}

/// J V of the rows of one joint, as Rows::apply().
[[gnu::always_inline]] inline void rates_of(const Rows& rows, const Rows::JointRows& joint,
                                            std::span<const double> jacobian, std::span<const Twist> twists,
                                            std::span<double> out) {
  double* rates = out.data() + joint.first_row;
  for (int s = joint.first_side; s < joint.first_side + joint.side_count; ++s) {
    const Rows::Side& side = rows.sides()[s];
    const Twist& twist = twists[side.body];
    const double* J = jacobian.data() + side.offset;
    const bool first = s == joint.first_side;
    if (side.arm != 0) {
      const Vec3 rate = side.arm * rate_at(J, twist);
      for (int i = 0; i < 3; ++i) rates[i] = rate[i] + (first ? 0 : rates[i]);
      continue;
    }
    const SixVector V(twist.w, twist.v);
    for (int i = 0; i < joint.row_count; ++i, J += 6) rates[i] = V.dot(J) + (first ? 0 : rates[i]);
  }
}

/// Jᵀ λ on one body.
[[gnu::always_inline]] inline Wrench wrench_on(const Rows& rows, int body, std::span<const double> jacobian,
                                               std::span<const double> lambda) {
  using Six = Eigen::Matrix<double, 6, 1>;
  Six sum = Six::Zero();
  for (int s : rows.sides_of(body)) {
    const Rows::Side& side = rows.sides()[s];
    const double *J = jacobian.data() + side.offset, *force = lambda.data() + side.first_row;
    if (side.arm != 0)
      add_force_at(J, side.arm * Vec3(force[0], force[1], force[2]), sum);
    else
      for (int i = 0; i < side.row_count; ++i, J += 6) sum += force[i] * Eigen::Map<const Six>(J);
  }
  return {Vec3(sum[0], sum[1], sum[2]), Vec3(sum[3], sum[4], sum[5])};
}

}  // namespace detail
}  // namespace taut
