#include "core/world/rigid_body.h"

#include <numbers>

#include "core/base/check.h"
#include "core/math/dense.h"

namespace taut {
namespace {

constexpr double kPi = std::numbers::pi;
/// A thin plate has I₁ + I₂ = I₃ exactly; round-off of the user's numbers must not reject it.
constexpr double kTriangleTolerance = 1e-9;

void check_moments(const Vec3& moments) {
  if (!moments.allFinite() || moments.minCoeff() <= 0)
    fail_with("inertia", "principal moments must be finite and positive", moments);
  if (2 * moments.maxCoeff() > moments.sum() * (1 + kTriangleTolerance))
    fail_with("inertia", "principal moments must obey the triangle inequality", moments);
}

/// The axis of a solid of revolution turned from body z to body x.
Vec3 about_x(const Vec3& about_z) { return {about_z.z(), about_z.x(), about_z.y()}; }

/// The shape of mass one comes first, so that a wrong length is named before its volume is used.
MassProperties scaled(const MassProperties& unit, double volume, Density density) {
  require_positive("density", density.value);
  const double mass = density.value * volume;
  return {mass, Vec3(mass * unit.principal_moments())};
}

}  // namespace

MassProperties::MassProperties(double mass, const Vec3& principal_moments)
    : mass_(mass), inertia_B_(principal_moments.asDiagonal()), moments_(principal_moments) {
  require_positive("mass", mass);
  check_moments(moments_);
}

MassProperties::MassProperties(double mass, const Mat3& inertia_B)
    : mass_(mass), inertia_B_(0.5 * (inertia_B + inertia_B.transpose())) {
  require_positive("mass", mass);
  require_all_finite("inertia", inertia_B);
  const double scale = inertia_B.cwiseAbs().maxCoeff();
  if ((inertia_B - inertia_B.transpose()).cwiseAbs().maxCoeff() > 1e-9 * scale)
    fail_with("inertia", "must be symmetric", inertia_B);
  if (inertia_B_.isDiagonal(0)) {
    moments_ = inertia_B_.diagonal();
  } else {
    const dense::Eigenpairs3 eigen = dense::symmetric_eigenpairs3(inertia_B_);
    Mat3 R_BP = eigen.vectors;
    if (R_BP.determinant() < 0) R_BP.col(2) = -R_BP.col(2);
    moments_ = eigen.values;
    q_BP_ = Quat(R_BP).normalized();
    body_axes_are_principal_ = false;
  }
  check_moments(moments_);
}

MassProperties MassProperties::box(const Vec3& size, double mass) {
  if (!size.allFinite() || size.minCoeff() <= 0) fail_with("box size", "must be finite and positive", size);
  const Vec3 s = size.cwiseAbs2();
  return {mass, Vec3(mass / 12 * Vec3(s.y() + s.z(), s.x() + s.z(), s.x() + s.y()))};
}

MassProperties MassProperties::sphere(double radius, double mass) {
  require_positive("sphere radius", radius);
  return {mass, Vec3(Vec3::Constant(0.4 * mass * radius * radius))};
}

MassProperties MassProperties::ellipsoid(const Vec3& radii, double mass) {
  if (!radii.allFinite() || radii.minCoeff() <= 0)
    fail_with("ellipsoid radii", "must be finite and positive", radii);
  const Vec3 s = radii.cwiseAbs2();
  return {mass, Vec3(mass / 5 * Vec3(s.y() + s.z(), s.x() + s.z(), s.x() + s.y()))};
}

MassProperties MassProperties::cylinder(double radius, double length, double mass) {
  require_positive("cylinder radius", radius);
  require_positive("cylinder length", length);
  const double across = mass / 12 * (3 * radius * radius + length * length);
  return {mass, Vec3(across, across, 0.5 * mass * radius * radius)};
}

MassProperties MassProperties::rod(double length, double radius, double mass) {
  require_positive("rod length", length);
  require_positive("rod radius", radius);
  return {mass, about_x(cylinder(radius, length, mass).principal_moments())};
}

MassProperties MassProperties::capsule(double radius, double length, double mass) {
  require_positive("capsule radius", radius);
  require_not_negative("capsule length", length);
  const double core = mass * (cylinder_volume(radius, length) / capsule_volume(radius, length)),
               caps = mass - core, r2 = radius * radius;
  // A half-sphere's centre of mass lies 3r/8 from its face.
  const double across = core * (length * length / 12 + r2 / 4) +
                        caps * (0.4 * r2 + length * length / 4 + 3 * length * radius / 8);
  return {mass, Vec3(across, across, 0.5 * core * r2 + 0.4 * caps * r2)};
}

MassProperties MassProperties::cone(double radius, double height, double mass) {
  require_positive("cone radius", radius);
  require_positive("cone height", height);
  const double across = mass * (3.0 / 20 * radius * radius + 3.0 / 80 * height * height);
  return {mass, Vec3(across, across, 0.3 * mass * radius * radius)};
}

MassProperties MassProperties::box(const Vec3& size, Density density) {
  return scaled(box(size, 1.0), box_volume(size), density);
}
MassProperties MassProperties::sphere(double radius, Density density) {
  return scaled(sphere(radius, 1.0), sphere_volume(radius), density);
}
MassProperties MassProperties::ellipsoid(const Vec3& radii, Density density) {
  return scaled(ellipsoid(radii, 1.0), ellipsoid_volume(radii), density);
}
MassProperties MassProperties::rod(double length, double radius, Density density) {
  return scaled(rod(length, radius, 1.0), cylinder_volume(radius, length), density);
}
MassProperties MassProperties::cylinder(double radius, double length, Density density) {
  return scaled(cylinder(radius, length, 1.0), cylinder_volume(radius, length), density);
}
MassProperties MassProperties::capsule(double radius, double length, Density density) {
  return scaled(capsule(radius, length, 1.0), capsule_volume(radius, length), density);
}
MassProperties MassProperties::cone(double radius, double height, Density density) {
  return scaled(cone(radius, height, 1.0), cone_volume(radius, height), density);
}

double box_volume(const Vec3& size) { return size.prod(); }
double sphere_volume(double radius) { return 4.0 / 3 * kPi * radius * radius * radius; }
double ellipsoid_volume(const Vec3& radii) { return 4.0 / 3 * kPi * radii.prod(); }
double cylinder_volume(double radius, double length) { return kPi * radius * radius * length; }
double capsule_volume(double radius, double length) {
  return cylinder_volume(radius, length) + sphere_volume(radius);
}
double cone_volume(double radius, double height) { return kPi / 3 * radius * radius * height; }

}  // namespace taut
