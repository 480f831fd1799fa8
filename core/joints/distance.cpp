#include "core/joints/distance.h"

#include "core/base/check.h"

namespace taut {

Distance::Distance(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& p_BQ, double length)
    : Joint(a, b), p_AP_(p_AP), p_BQ_(p_BQ), length_(length) {
  require_all_finite("distance anchor on A", p_AP);
  require_all_finite("distance anchor on B", p_BQ);
  require_positive("distance length", length);
}

Distance Distance::between(const World& world, BodyId a, BodyId b, const Vec3& p_a_W, const Vec3& p_b_W) {
  return {a, b, world.pose(a).local(p_a_W), world.pose(b).local(p_b_W), (p_b_W - p_a_W).norm()};
}

void Distance::append_rows(RowSink& rows) const { rows.add(row_parts::Distance{p_AP_, p_BQ_, length_}); }

std::vector<WirePoint> Distance::course() const { return {{a(), p_AP_}, {b(), p_BQ_}}; }

}  // namespace taut
