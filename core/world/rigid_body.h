#pragma once

#include <string>

#include "core/state/state.h"

namespace taut {

/// Density of a uniform solid [kg/m³]; says in a call that the number is not a mass:
///     MassProperties::box(size, Density{7850})
struct Density {
  double value = 0;  ///< [kg/m³]
};

/// Mass [kg] and rotational inertia [kg m²] about the centre of mass in the axes of the body, with the
/// principal frame P that diagonalises it:  I_B = R_BP diag(I_P) R_BPᵀ.
class MassProperties {
 public:
  /// @throws std::invalid_argument if mass is not positive, the inertia is not symmetric (to 1e-9 of its
  /// largest entry) or not positive definite, or its principal moments break the triangle inequality I₁ + I₂
  /// ≥ I₃ that every real body obeys (to 1e-9 of their sum: a thin plate has equality).
  MassProperties(double mass, const Mat3& inertia_B);
  /// Principal moments along the body axes.
  MassProperties(double mass, const Vec3& principal_moments);

  /// Uniform solids from a mass [kg] or a density [kg/m³]; lengths [m].  The axis is body x for `rod` and
  /// body z for `cylinder`, `capsule` (length without the caps) and `cone` (apex towards +z, the centre of
  /// mass a quarter of the height above the base).
  /// @throws std::invalid_argument if a length, the mass or the density is not finite and positive; only the
  /// length of a capsule may be zero.  @{
  static MassProperties box(const Vec3& size, double mass);
  static MassProperties box(const Vec3& size, Density density);
  static MassProperties sphere(double radius, double mass);
  static MassProperties sphere(double radius, Density density);
  static MassProperties ellipsoid(const Vec3& radii, double mass);
  static MassProperties ellipsoid(const Vec3& radii, Density density);
  static MassProperties rod(double length, double radius, double mass);
  static MassProperties rod(double length, double radius, Density density);
  static MassProperties cylinder(double radius, double length, double mass);
  static MassProperties cylinder(double radius, double length, Density density);
  static MassProperties capsule(double radius, double length, double mass);
  static MassProperties capsule(double radius, double length, Density density);
  static MassProperties cone(double radius, double height, double mass);
  static MassProperties cone(double radius, double height, Density density);  /// @}

  double mass() const { return mass_; }                 ///< [kg]
  const Mat3& inertia_B() const { return inertia_B_; }  ///< about the centre of mass, body axes [kg m²]
  const Vec3& principal_moments() const { return moments_; }  ///< I_P [kg m²]
  /// Body axes to principal axes; the identity if the body axes are principal.
  const Quat& q_BP() const { return q_BP_; }
  bool body_axes_are_principal() const { return body_axes_are_principal_; }  ///< q_BP is 1

 private:
  double mass_;
  Mat3 inertia_B_;
  Vec3 moments_;
  Quat q_BP_ = Quat::Identity();
  bool body_axes_are_principal_ = true;
};

/// Volume of a uniform solid [m³], with lengths [m] as in MassProperties.  @{
double box_volume(const Vec3& size);
double sphere_volume(double radius);
double ellipsoid_volume(const Vec3& radii);
double cylinder_volume(double radius, double length);
double capsule_volume(double radius, double length);
double cone_volume(double radius, double height);  /// @}

/// A body as the user describes it.  The body frame sits at the centre of mass.
struct BodySpec {
  std::string name{};                       ///< empty: the World makes one up
  MassProperties mass{1.0, Vec3(1, 1, 1)};  ///< of a moving body
  Pose pose{};                              ///< X_WB at the start
  Twist twist{};                            ///< V_WB at the start
  /// A fixed body never moves: it is part of the ground with a pose of its own.
  bool fixed = false;
};

}  // namespace taut
