#include "core/joints/six_dof.h"

#include "core/base/check.h"
#include "core/constraints/parallel_part.h"

namespace taut {

SixDof::SixDof(BodyId a, BodyId b, const Vec3& p_AF, const Quat& q_AF, const Vec3& p_BG, const Quat& q_BG,
               const Locks& locks)
    : Joint(a, b), p_AF_(p_AF), p_BG_(p_BG), q_AF_(q_AF), q_BG_(q_BG), locks_(locks) {
  require_all_finite("six-DOF anchor on A", p_AF);
  require_all_finite("six-DOF anchor on B", p_BG);
  require_unit("six-DOF orientation on A", q_AF.coeffs());
  require_unit("six-DOF orientation on B", q_BG.coeffs());
}

SixDof SixDof::at(const World& world, BodyId a, BodyId b, const Vec3& p_W, const Quat& q_WF,
                  const Locks& locks) {
  require_unit("six-DOF orientation", q_WF.coeffs());
  const Pose &A = world.pose(a), &B = world.pose(b);
  return {a, b, A.local(p_W), relative(A.q, q_WF), B.local(p_W), relative(B.q, q_WF), locks};
}

void SixDof::append_rows(RowSink& rows) const {
  for (int i = 0; i < 3; ++i)
    if (locks_.translation[i]) rows.add(row_parts::PointInPlane{p_AF_, F(i), p_BG_});
  const int locked = locked_rotations();
  if (locked == 3) rows.add(row_parts::Orientation{q_AF_, q_BG_});
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    if (locked == 2 && !locks_.rotation[k]) rows.add(row_parts::Parallel{F(i), F(j), G(k)});
    if (locked == 1 && locks_.rotation[k]) rows.add(row_parts::Perpendicular{F(i), G(j)});
  }
}

void SixDof::append_axes(AxisSink& axes) const {
  static constexpr const char* kAlong[] = {"x", "y", "z"};
  static constexpr const char* kAbout[] = {"angle_x", "angle_y", "angle_z"};
  for (int i = 0; i < 3; ++i)
    if (!locks_.translation[i]) axes.add(kAlong[i], row_parts::Displacement{{p_AF_, F(i), p_BG_}});
  const int locked = locked_rotations();
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    if (locked == 2 && !locks_.rotation[k]) axes.add(kAbout[k], row_parts::Angle{F(k), F(i), G(i)});
    if (locked == 1 && locks_.rotation[k]) {
      axes.add(kAbout[i], row_parts::Angle{F(i), F(j), G(j)});
      axes.add(kAbout[j], row_parts::Angle{-G(j), G(i), F(i)}, {1, 0});
    }
  }
}

int SixDof::locked_rotations() const {
  return int{locks_.rotation[0]} + int{locks_.rotation[1]} + int{locks_.rotation[2]};
}

Vec3 SixDof::F(int i) const { return q_AF_ * Vec3::Unit(i); }

Vec3 SixDof::G(int i) const { return q_BG_ * Vec3::Unit(i); }

}  // namespace taut
