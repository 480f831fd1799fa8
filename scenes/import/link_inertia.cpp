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

std::optional<double> inertia_along(const RobotModel& model, const AxisName& name) {
  const Link& own = model.links[name.link];
  const LinkAxis& axis = own.axes[name.axis];
  const bool turns = axis.kind == LinkAxis::Kind::kHinge;
  if (!turns && axis.kind != LinkAxis::Kind::kSlide) return std::nullopt;
  const Vec3 direction = own.X_WL.q * axis.axis, anchor = own.X_WL.point(axis.anchor);
  double inertia = axis.armature;
  std::vector<char> moves(model.links.size(), 0);
  for (std::size_t k = name.link; k < model.links.size(); ++k) {
    const Link& link = model.links[k];
    moves[k] =
        static_cast<int>(k) == name.link || (!link.free && link.parent != kWorld && moves[link.parent]);
    if (!moves[k]) continue;
    if (!link.unknown_mass.empty()) return std::nullopt;
    const LinkInertia here = in_frame(link.X_WL, link.inertia);
    const Mat3 about = here.inertia + parallel_axis(here.mass, here.centre - anchor);
    inertia += turns ? direction.dot(about * direction) : here.mass;
  }
  return inertia;
}

}  // namespace taut::model
