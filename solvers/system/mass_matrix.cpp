#include "solvers/system/mass_matrix.h"

#include <cmath>

namespace taut {
namespace {

/// The axis about which the inertia is symmetric, to round-off.
std::int8_t symmetry_axis(const Vec3& moments) {
  const auto equal = [&](int i, int j) { return std::abs(moments[i] - moments[j]) <= 4e-16 * moments[i]; };
  if (equal(1, 2)) return 0;
  if (equal(0, 2)) return 1;
  if (equal(0, 1)) return 2;
  return -1;
}

}  // namespace

MassMatrix::MassMatrix(const World& world) {
  bodies_.resize(world.body_count());
  inertias_.resize(world.body_count());
  for (int i = 0; i < world.body_count(); ++i) {
    const MassProperties& mass = world.mass_properties(BodyId{i});
    Body& body = bodies_[i];
    body.fixed = !world.moves(BodyId{i});
    Inertia& inertia = inertias_[i];
    inertia = {mass.mass(), mass.principal_moments(), mass.q_BP()};
    body.principal = mass.body_axes_are_principal();
    body.symmetry_axis = symmetry_axis(inertia.moments);
    if (body.fixed) continue;
    body.inverse_mass = 1 / inertia.mass;
    body.inverse_moments = inertia.moments.cwiseInverse();
    body.root_inverse_moments = body.inverse_moments.cwiseSqrt();
  }
}

MassMatrix::MassMatrix(const MassMatrix& whole, std::span<const int> bodies) {
  for (int b : bodies) {
    bodies_.push_back(whole[b]);
    inertias_.push_back(whole.inertias_[b]);
  }
}

Mat3 MassMatrix::principal_axes(int body, const Pose& pose) const {
  return bodies_[body].principal ? pose.q.toRotationMatrix()
                                 : (pose.q * inertias_[body].q_BP).toRotationMatrix();
}

Vec3 MassMatrix::angular_velocity(int body, const Pose& pose, const Vec3& L) const {
  const Mat3 R = principal_axes(body, pose);
  return R * bodies_[body].inverse_moments.cwiseProduct(R.transpose() * L);
}

Vec3 MassMatrix::angular_momentum(int body, const Pose& pose, const Vec3& w) const {
  const Mat3 R = principal_axes(body, pose);
  return R * inertias_[body].moments.cwiseProduct(R.transpose() * w);
}

Wrench MassMatrix::momentum(int body, const Pose& pose, const Twist& V) const {
  if (bodies_[body].fixed) return {};
  return {angular_momentum(body, pose, V.w), inertias_[body].mass * V.v};
}

}  // namespace taut
