#include "core/joints/driver.h"

#include "core/base/check.h"

namespace taut {

Driver::Driver(const World& world, AxisId axis, Motion motion) : AxisCoupling(world, "driver", {{axis, 1}}) {
  if (!motion) fail("driver of " + world.axis_label(axis), "needs a motion", "null");
  coupling_.offset = 0;
  driven_ = {coupling_, std::move(motion)};
}

void Driver::append_rows(RowSink& rows) const { rows.add(driven_); }

PoseDriver::PoseDriver(BodyId a, BodyId b, PoseMotion motion) : Joint(a, b), motion_(std::move(motion)) {
  if (!motion_) fail("pose driver", "needs a motion", "null");
}

void PoseDriver::append_rows(RowSink& rows) const {
  rows.add(row_parts::DrivenPosition{a().index, b().index, motion_});
  rows.add(row_parts::DrivenOrientation{a().index, b().index, motion_});
}

Vec3 PoseDriver::reaction_point_B() const { return Vec3::Zero(); }

}  // namespace taut
