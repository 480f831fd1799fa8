#include "core/joints/joints.h"

#include <functional>
#include <ostream>

#include "tests/core/constraints/row_checker.h"

namespace taut::joints_test {
namespace {

using testing::kA;
using testing::kB;
using testing::pair_of_bodies;
using testing::Random;
using testing::RowChecker;

/// Turning a pose by the world rotation R about world point p.
Pose turned(const Pose& pose, const Quat& R, const Vec3& p_W) {
  return {R * pose.q, p_W + R * (pose.p - p_W)};
}

/// What the tests below know of a joint type: how to make one that holds the bodies in their present poses,
/// and how B may then move against a resting A.
struct JointCase {
  struct Made {
    std::shared_ptr<const Joint> joint;
    std::function<Pose(const Pose& B, Random&)> allowed_motion;
    bool regular = true;  ///< bias exact while open, axes 0 where made
  };
  const char* type;
  int freedoms;
  std::function<Made(const World&, Random&)> make;

  friend void PrintTo(const JointCase& c, std::ostream* out) { *out << c.type; }
};

/// The example of core/joints/README.md: a type that the library does not know.
class PointOnPlane final : public Joint {
 public:
  /// @throws std::invalid_argument if a point is not finite or the normal not of unit length.
  PointOnPlane(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& normal_A, const Vec3& p_BQ)
      : Joint(a, b), p_AP_(p_AP), normal_A_(normal_A), p_BQ_(p_BQ) {
    require_all_finite("point-on-plane anchor on A", p_AP);
    require_all_finite("point-on-plane anchor on B", p_BQ);
    require_unit("point-on-plane normal on A", normal_A);
  }
  std::string_view type() const override { return "point_on_plane"; }
  void append_rows(RowSink& rows) const override {
    rows.add(row_parts::PointInPlane{p_AP_, normal_A_, p_BQ_});
  }
  void append_axes(AxisSink& axes) const override {
    Vec3 u, v;
    complete_frame(normal_A_, u, v);
    axes.add("x", row_parts::Displacement{{p_AP_, u, p_BQ_}});
    axes.add("y", row_parts::Displacement{{p_AP_, v, p_BQ_}});
  }
  Vec3 reaction_point_B() const override { return p_BQ_; }

 private:
  Vec3 p_AP_, normal_A_, p_BQ_;
};

template <typename AnyJoint>
std::shared_ptr<const Joint> shared(const AnyJoint& joint) {
  return std::make_shared<const AnyJoint>(joint);
}

/// A generic joint with bits 0–2 of the mask for locked translations and 3–5 for locked rotations.
JointCase six_dof(int mask) {
  SixDof::Locks locks;
  int locked = 0;
  for (int i = 0; i < 3; ++i) {
    locks.translation[i] = mask >> i & 1;
    locks.rotation[i] = mask >> (3 + i) & 1;
    locked += locks.translation[i] + locks.rotation[i];
  }
  const auto make = [=](const World& world, Random& random) -> JointCase::Made {
    const Vec3 p = random.vector(2);
    const Quat F = random.rotation();
    const auto motion = [=](const Pose& B, Random& r) {
      Quat turn = Quat::Identity();
      const auto free = [&](int i) { return locks.rotation[i] ? 0 : 1; };
      const int free_rotations = free(0) + free(1) + free(2);
      if (free_rotations == 3) turn = r.rotation();
      if (free_rotations == 1) turn = exp_so3(r.uniform(-3, 3) * (F * Vec3(free(0), free(1), free(2))));
      if (free_rotations == 2) {  // about e_i of A, then g_j of B, (i, j, locked) cyclic
        const int k = locks.rotation[0] ? 0 : locks.rotation[1] ? 1 : 2;
        turn = exp_so3(r.uniform(-3, 3) * (F * Vec3::Unit((k + 1) % 3))) *
               exp_so3(r.uniform(-3, 3) * (F * Vec3::Unit((k + 2) % 3)));
      }
      Pose moved_B = turned(B, turn, p);
      for (int i = 0; i < 3; ++i)
        if (!locks.translation[i]) moved_B.p += r.uniform(-3, 3) * (F * Vec3::Unit(i));
      return moved_B;
    };
    return {std::make_shared<const SixDof>(SixDof::at(world, kA, kB, p, F, locks)), motion};
  };
  return {"six_dof", 6 - locked, make};
}

const JointCase kCases[] = {
    {"ball", 3,
     [](const World& world, Random& random) -> JointCase::Made {
       const Vec3 p = random.vector(2);
       return {shared(Ball::at(world, kA, kB, p)),
               [=](const Pose& B, Random& r) { return turned(B, r.rotation(), p); }};
     }},
    {"hinge", 1,
     [](const World& world, Random& random) -> JointCase::Made {
       const Vec3 p = random.vector(2), axis = random.unit();
       return {shared(Hinge::at(world, kA, kB, p, axis)),
               [=](const Pose& B, Random& r) { return turned(B, exp_so3(r.uniform(-3, 3) * axis), p); }};
     }},
    {"slider", 1,
     [](const World& world, Random& random) -> JointCase::Made {
       const Vec3 p = random.vector(2), axis = random.unit();
       return {shared(Slider::at(world, kA, kB, p, axis)), [=](const Pose& B, Random& r) {
                 return Pose{B.q, B.p + r.uniform(-3, 3) * axis};
               }};
     }},
    {"universal", 2,
     [](const World& world, Random& random) -> JointCase::Made {
       const Vec3 p = random.vector(2), a = random.unit();
       Vec3 b, unused;
       complete_frame(a, b, unused);
       return {shared(Universal::at(world, kA, kB, p, a, b)), [=](const Pose& B, Random& r) {
                 const Pose about_b = turned(B, exp_so3(r.uniform(-3, 3) * b), p);
                 return turned(about_b, exp_so3(r.uniform(-3, 3) * a), p);
               }};
     }},
    {"fixed", 0,
     [](const World& world, Random& random) -> JointCase::Made {
       return {shared(Fixed::at(world, kA, kB, random.vector(2))), [](const Pose& B, Random&) { return B; }};
     }},
    {"distance", 5,
     [](const World& world, Random& random) -> JointCase::Made {
       const Vec3 p = random.vector(2), q = p + random.uniform(1, 3) * random.unit();
       return {shared(Distance::between(world, kA, kB, p, q)),
               [=](const Pose& B, Random& r) { return turned(turned(B, r.rotation(), q), r.rotation(), p); }};
     }},
    {"point_on_line", 4,
     [](const World& world, Random& random) -> JointCase::Made {
       const Vec3 p = random.vector(2), axis = random.unit();
       return {shared(PointOnLine::at(world, kA, kB, p, axis)), [=](const Pose& B, Random& r) {
                 const Pose on = turned(B, r.rotation(), p);
                 return Pose{on.q, on.p + r.uniform(-3, 3) * axis};
               }};
     }},
    {"point_on_curve", 4,
     [](const World& world, Random& random) -> JointCase::Made {
       // A helix-like spline in A with B's point on it.
       std::vector<Vec3> points;
       std::vector<double> parameters;
       for (int i = 0; i < 8; ++i) {
         parameters.push_back(i);
         points.push_back(Vec3(2 * std::cos(i), 2 * std::sin(i), 0.5 * i) + random.vector(0.1));
       }
       const CubicSpline<3> curve(parameters, points);
       const Pose &A = world.pose(kA), &B = world.pose(kB);
       const Vec3 p_BQ = B.local(A.point(curve.at(random.uniform(0.5, 6.5)).value));
       return {shared(PointOnCurve(kA, kB, curve, p_BQ)),
               [=](const Pose& now, Random& r) {
                 const Vec3 to = A.point(curve.at(r.uniform(0.5, 6.5)).value);
                 const Quat q = (r.rotation() * now.q).normalized();
                 return Pose{q, to - q * p_BQ};
               },
               false};
     }},
    {"point_on_plane", 5,
     [](const World& world, Random& random) -> JointCase::Made {
       const Vec3 p = random.vector(2), n = random.unit();
       const Pose &A = world.pose(kA), &B = world.pose(kB);
       return {shared(PointOnPlane(kA, kB, A.local(p), A.q.conjugate() * n, B.local(p))),
               [=](const Pose& now, Random& r) {
                 const Pose on = turned(now, r.rotation(), p);
                 return Pose{on.q, on.p + 3 * n.cross(r.vector())};
               }};
     }},
    {"cylindrical", 2,
     [](const World& world, Random& random) -> JointCase::Made {
       const Vec3 p = random.vector(2), axis = random.unit();
       return {shared(Cylindrical::at(world, kA, kB, p, axis)), [=](const Pose& B, Random& r) {
                 const Pose on = turned(B, exp_so3(r.uniform(-3, 3) * axis), p);
                 return Pose{on.q, on.p + r.uniform(-3, 3) * axis};
               }};
     }},
    {"screw", 1,
     [](const World& world, Random& random) -> JointCase::Made {
       const Vec3 p = random.vector(2), axis = random.unit();
       const double pitch = random.uniform(0.2, 2) * (random.uniform(-1, 1) < 0 ? -1 : 1);
       return {shared(Screw::at(world, kA, kB, p, axis, pitch)), [=](const Pose& B, Random& r) {
                 const double angle = r.uniform(-20, 20);  // three turns either way
                 const Pose on = turned(B, exp_so3(angle * axis), p);
                 return Pose{on.q, on.p + pitch / 6.283185307179586477 * angle * axis};
               }};
     }},
    {"planar", 3,
     [](const World& world, Random& random) -> JointCase::Made {
       const Vec3 p = random.vector(2), n = random.unit();
       Vec3 u, v;
       complete_frame(n, u, v);
       return {shared(Planar::at(world, kA, kB, p, n, u)), [=](const Pose& B, Random& r) {
                 const Pose on = turned(B, exp_so3(r.uniform(-3, 3) * n), p);
                 return Pose{on.q, on.p + r.uniform(-3, 3) * u + r.uniform(-3, 3) * v};
               }};
     }},
    {"hinge2", 3,
     [](const World& world, Random& random) -> JointCase::Made {
       const Vec3 p = random.vector(2), steering = random.unit();
       Vec3 spin, unused;
       complete_frame(steering, spin, unused);
       return {shared(Hinge2::at(world, kA, kB, p, steering, spin)), [=](const Pose& B, Random& r) {
                 const Pose spun = turned(B, exp_so3(r.uniform(-3, 3) * spin), p);
                 const Pose steered = turned(spun, exp_so3(r.uniform(-3, 3) * steering), p);
                 return Pose{steered.q, steered.p + r.uniform(-3, 3) * steering};
               }};
     }},
    six_dof(0b000000),
    six_dof(0b000111),
    six_dof(0b010011),
    six_dof(0b101101),
    six_dof(0b111010),
    six_dof(0b001100),
    six_dof(0b111000),
    six_dof(0b111111),
};

/// A joint as it is known to World::add, from the shared pointer that the cases hold.
class Same final : public Joint {
 public:
  explicit Same(std::shared_ptr<const Joint> joint)
      : Joint(joint->a(), joint->b()), joint_(std::move(joint)) {}
  std::string_view type() const override { return joint_->type(); }
  void append_rows(RowSink& rows) const override { joint_->append_rows(rows); }
  void append_axes(AxisSink& axes) const override { joint_->append_axes(axes); }
  Vec3 reaction_point_B() const override { return joint_->reaction_point_B(); }

 private:
  std::shared_ptr<const Joint> joint_;
};

class Joints : public ::testing::TestWithParam<JointCase> {
 protected:
  static constexpr int kTrials = 20;
  /// Runs the test on joints closed in random poses.
  template <typename Test>
  void on_random_joints(unsigned seed, Test&& test) {
    Random random(seed);
    for (int i = 0; i < kTrials; ++i) {
      const Pose A = random.pose(), B = random.pose();
      const JointCase::Made made = GetParam().make(pair_of_bodies(A, B), random);
      test(made, A, B, random);
    }
  }
};

TEST_P(Joints, KnowsItsTypeAndBodies) {
  on_random_joints(11, [&](const JointCase::Made& made, const Pose&, const Pose&, Random&) {
    EXPECT_EQ(made.joint->type(), GetParam().type);
    EXPECT_EQ(made.joint->a(), kA);
    EXPECT_EQ(made.joint->b(), kB);
  });
}

TEST_P(Joints, IsClosedWhereItIsMade) {
  on_random_joints(12, [&](const JointCase::Made& made, const Pose& A, const Pose& B, Random&) {
    const Gap gap = RowChecker(Same(made.joint)).gap(A, B);
    EXPECT_LT(gap.metres, 1e-14);  // some roundings of coordinates of order one
    EXPECT_LT(gap.radians, 1e-14);
  });
}

TEST_P(Joints, TakesAsManyFreedomsAsItHasRows) {
  on_random_joints(13, [&](const JointCase::Made& made, const Pose& A, const Pose& B, Random&) {
    const RowChecker rows(Same(made.joint));
    EXPECT_EQ(rows.row_count(), 6 - GetParam().freedoms);
    if (rows.row_count() == 0) return;
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(rows.jacobian(A, B));
    EXPECT_GT(svd.singularValues().minCoeff(), 0.1);  // rows of order one, none dependent
  });
}

TEST_P(Joints, LeavesItsFreedomsFree) {
  on_random_joints(14, [&](const JointCase::Made& made, const Pose& A, const Pose& B, Random& random) {
    const Gap gap = RowChecker(Same(made.joint)).gap(A, made.allowed_motion(B, random));
    EXPECT_LT(gap.metres, 1e-13);  // as above, through one or two more rotations
    EXPECT_LT(gap.radians, 1e-13);
  });
}

TEST_P(Joints, RowsAreConsistentWhereClosed) {
  on_random_joints(15, [&](const JointCase::Made& made, const Pose& A, const Pose& B, Random& random) {
    testing::check_rows(Same(made.joint), A, B, random);
    // The stiffness of orientation rows has no symmetric part along the free motions either.
    testing::check_rows(Same(made.joint), A, made.allowed_motion(B, random), random);
  });
}

TEST_P(Joints, RowsAreConsistentWhereOpen) {
  on_random_joints(16, [&](const JointCase::Made& made, const Pose& A, const Pose& B, Random& random) {
    const Vec3 turn = 0.5 * random.unit(), shift = 0.3 * random.unit();
    if (!made.regular) {
      const Pose open = testing::moved(B, Vec3::Zero(), 0.1 * random.unit());
      EXPECT_LT(RowChecker(Same(made.joint)).jacobian_error(A, open), testing::kDifferenceTolerance);
      return;
    }
    testing::check_rows(Same(made.joint), A, testing::moved(B, turn, shift), random,
                        {.stiffness = false, .third_law = false});
  });
}

/// Free axes are 0 where the joint is made, move B as their rows say, and hold their own rows against
/// differences.
TEST_P(Joints, AxesStartAtZeroAndTheirRowsAreConsistent) {
  on_random_joints(18, [&](const JointCase::Made& made, const Pose& A, const Pose& B, Random& random) {
    World world = pair_of_bodies(A, B);
    const JointId joint = world.add_joint("joint", made.joint);
    for (int k = 0; k < world.axis_count(joint) && made.regular; ++k)
      EXPECT_NEAR(world.axis_value({joint, k}), 0, 1e-14) << world.axis_info({joint, k}).name;
    const RowChecker rows(Same(made.joint), true);
    EXPECT_EQ(rows.row_count(), 6 - GetParam().freedoms + world.axis_count(joint));
    if (rows.row_count() == 0) return;
    const Pose there = made.allowed_motion(B, random);
    EXPECT_LT(rows.jacobian_error(A, there), testing::kDifferenceTolerance);
    EXPECT_LT(rows.bias_error(A, there, random.twist(), random.twist()), testing::kDifferenceTolerance);
    EXPECT_LT(rows.stiffness_error(A, there, random.multipliers(rows.row_count())),
              testing::kDifferenceTolerance);
    EXPECT_LT(rows.third_law_error(A, there, random.multipliers(rows.row_count())),
              testing::kRoundOffTolerance);
    // Axis rows are no combination of the equality rows, and together they are no more than six; but a swing
    // is one of two angles.
    if (GetParam().type == std::string("universal")) return;
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(rows.jacobian(A, there));
    EXPECT_GT(svd.singularValues().minCoeff(), 1e-3);
  });
}

TEST_P(Joints, EveryRowHasANameAndAKind) {
  Random random(17);
  const RowChecker rows(Same(GetParam().make(pair_of_bodies(), random).joint));
  for (int r = 0; r < rows.row_count(); ++r) {
    EXPECT_EQ(rows.rows().joint_of(r), JointId{0});
    const std::string name = rows.rows().row_name(r);
    EXPECT_EQ(name.find("rotation") != std::string::npos, rows.rows().row(r).angular) << name;
  }
}

/// Every subset of locks, each on a few closed joints.
TEST(SixDofLocks, AnySubsetCanBeLocked) {
  Random random(19);
  for (int mask = 0; mask < 64; ++mask) {
    const JointCase locked = six_dof(mask);
    for (int trial = 0; trial < 4; ++trial) {
      const Pose A = random.pose(), B = random.pose();
      World world = pair_of_bodies(A, B);
      const JointCase::Made made = locked.make(world, random);
      const RowChecker rows(Same(made.joint)), with_axes(Same(made.joint), true);
      ASSERT_EQ(rows.row_count(), 6 - locked.freedoms) << mask;
      const Pose there = made.allowed_motion(B, random);
      const Gap gap = rows.gap(A, there);
      EXPECT_LT(std::max(gap.metres, gap.radians), 1e-13) << mask;
      if (rows.row_count() > 0) {
        testing::check_rows(Same(made.joint), A, there, random);
        const Eigen::JacobiSVD<Eigen::MatrixXd> svd(rows.jacobian(A, there));
        EXPECT_GT(svd.singularValues().minCoeff(), 0.1) << mask;
      }
      // Three free rotations are no coordinates; all other freedoms are axes.
      const JointId joint = world.add_joint("joint", made.joint);
      EXPECT_EQ(world.axis_count(joint), locked.freedoms - (mask >> 3 == 0 ? 3 : 0)) << mask;
      if (with_axes.row_count() == 0) continue;
      EXPECT_LT(with_axes.jacobian_error(A, there), testing::kDifferenceTolerance) << mask;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(AllTypes, Joints, ::testing::ValuesIn(kCases), [](const auto& test_case) {
  return std::string(test_case.param.type) + "_" + std::to_string(test_case.index);
});

}  // namespace
}  // namespace taut::joints_test
