#include "scenes/import/link_inertia.h"

#include "core/world/solid.h"

namespace taut::model {
namespace {

/// About a point at r from the centre.
Mat3 parallel_axis(double mass, const Vec3& r) {
  return mass * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
}

}  // namespace

LinkInertia in_frame(const Pose& X_AL, const LinkInertia& inertia_L) {
  const Mat3 R = X_AL.q.toRotationMatrix();
  return {inertia_L.mass, X_AL.point(inertia_L.centre), R * inertia_L.inertia * R.transpose()};
}

LinkInertia sum(const LinkInertia& a, const LinkInertia& b) {
  LinkInertia both;
  both.mass = a.mass + b.mass;
  both.centre = both.mass > 0 ? Vec3((a.mass * a.centre + b.mass * b.centre) / both.mass) : a.centre;
  both.inertia = a.inertia + b.inertia + parallel_axis(a.mass, a.centre - both.centre) +
                 parallel_axis(b.mass, b.centre - both.centre);
  return both;
}

LinkInertia difference(const LinkInertia& whole, const LinkInertia& part) {
  return sum(whole, {-part.mass, part.centre, -part.inertia});
}

bool is_solid(const LinkInertia& inertia) {
  try {
    (void)MassProperties(inertia.mass, inertia.inertia);
    return true;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

LinkInertia inertia_of_shape(const Shape& shape) {
  const SolidProperties solid = solid_properties(shape);
  return {solid.volume, solid.centre, solid.inertia};
}

LinkInertia scaled(const LinkInertia& inertia, double factor) {
  return {factor * inertia.mass, inertia.centre, factor * inertia.inertia};
}

}  // namespace taut::model
