#include <gtest/gtest.h>

#include "core/constraints/rows.h"
#include "core/joints/joints.h"
#include "scenes/files/scene_file.h"
#include "tests/scenes/files/scene_file_cases.h"

/// Joints over points, curves and motions in scene files against the same made in C++, and their properties.
namespace taut::scene_joints_test {
namespace {

using namespace scene_file_cases;

TEST(SceneJoints, HaveThePropertiesOfTheFile) {
  const World world = parse_scene(kEverything, "test.json").world;
  const JointId ball = world.joint("ball"), hinge = world.joint("hinge");
  const auto of = [&](JointId joint, const char* axis) {
    return world.axis_properties(world.axis(joint, axis));
  };
  EXPECT_EQ(world.compliance(ball)->translation, 1e-6);
  EXPECT_EQ(world.compliance(ball)->translation_damping, 3);
  EXPECT_EQ(world.compliance(ball)->rotation, 0);
  EXPECT_EQ(world.compliance(hinge)->rotation, kUnlimited);
  EXPECT_EQ(world.compliance(hinge)->rotation_damping, 2);
  ASSERT_EQ(world.breakable().size(), 1U);
  EXPECT_EQ(world.breakable()[0].first, ball);
  EXPECT_EQ(world.breakable()[0].second.force, 100);
  EXPECT_EQ(world.breakable()[0].second.torque, 30);
  EXPECT_FALSE(world.is_attached(world.joint("framed")));
  EXPECT_FALSE(world.is_attached(world.joint("clamp")));
  EXPECT_EQ(world.detached_count(), 2);

  EXPECT_EQ(of(ball, "swing").limits->compliance, 1e-3);
  EXPECT_EQ(of(ball, "swing").limits->damping, 2);
  EXPECT_EQ(of(ball, "turn_x").friction->per_load, 0.01);
  EXPECT_EQ(of(ball, "turn_x").friction->dynamic_friction, 1);
  EXPECT_EQ(of(hinge, "angle").motor->mode, AxisMotor::Mode::kTrajectory);
  EXPECT_EQ(of(hinge, "angle").motor->trajectory(3).value, 6);
  // z of the frames lies along world x at the start, so both directions agree: no swing, no twist.
  EXPECT_NEAR(world.axis_value(world.axis(ball, "swing")), 0, 1e-7);  // √ε, as acos at 1
  EXPECT_NEAR(world.axis_value(world.axis(ball, "twist")), 0, 1e-14);
  // With the frames of both bodies: that of B is turned by 90° about x.
  EXPECT_EQ(world.axis_count(world.joint("framed")), 7);
}

/// P lies at (1, 0, 0), turned by 90° about z; Q at (2, 0, 0), unturned.
World base() { return parse_scene(two_bodies(R"("assemble": true)"), "test.json").world; }

struct Twin {
  const char *name, *file;
  void (*add)(World& world, BodyId P, BodyId Q);
};
const Twin kTwins[] = {
    {"pulley in the world",
     R"("type": "pulley", "frame": "world", "ratio": 2, "points": [{"body": "P", "point": [1, 1, 0]},
        {"body": "ground", "point": [1, 0, 4]}, {"body": "ground", "point": [2, 0, 4]}, {"body": "Q", "point": [2, 1, 0]}])",
     [](World& world, BodyId P, BodyId Q) {
       world.add("j", Pulley::at(world, P, Vec3(1, 1, 0), kGround, Vec3(1, 0, 4), Vec3(2, 0, 4), Q,
                                 Vec3(2, 1, 0), 2));
     }},
    {"pulley in bodies",
     R"("type": "pulley", "frame": "body", "length": 7, "points": [{"body": "P", "point": [1, 1, 0]},
        {"body": "ground", "point": [1, 0, 4]}, {"body": "ground", "point": [2, 0, 4]}, {"body": "Q", "point": [2, 1, 0]}])",
     [](World& world, BodyId P, BodyId Q) {
       world.add("j", Pulley({P, Vec3(1, 1, 0)}, {kGround, Vec3(1, 0, 4)}, {kGround, Vec3(2, 0, 4)},
                             {Q, Vec3(2, 1, 0)}, 7));
     }},
    {"rope over points",
     R"("type": "rope", "frame": "body", "length": 5, "restitution": 0.25, "points": [{"body": "P", "point": [1, 0, 0]},
        {"body": "ground", "point": [0, 0, 3]}, {"body": "Q", "point": [0, 1, 0]}])",
     [](World& world, BodyId P, BodyId Q) {
       world.add("j", Rope({{P, Vec3(1, 0, 0)}, {kGround, Vec3(0, 0, 3)}, {Q, Vec3(0, 1, 0)}}, 5, 0.25));
     }},
    {"curve in the world",
     R"("type": "point_on_curve", "a": "P", "b": "Q", "anchor": [2, 0.5, 0],
        "points": [[0, 0, 0], [1, 2, 0], [3, 1, 1], [4, 0, 0]])",
     [](World& world, BodyId P, BodyId Q) {
       world.add("j", PointOnCurve::through(world, P, Q, {{0, 0, 0}, {1, 2, 0}, {3, 1, 1}, {4, 0, 0}},
                                            Vec3(2, 0.5, 0)));
     }},
    {"closed curve in the bodies",
     R"("type": "point_on_curve", "a": "P", "b": "Q", "frame": "body", "anchor_b": [0, 0.5, 0], "closed": true,
        "parameters": [0, 1, 3, 4], "points": [[0, 0, 0], [1, 2, 0], [3, 1, 1], [0, 0, 0]])",
     [](World& world, BodyId P, BodyId Q) {
       const CubicSpline<3> curve({0, 1, 3, 4}, {{0, 0, 0}, {1, 2, 0}, {3, 1, 1}, {0, 0, 0}}, true);
       world.add("j", PointOnCurve(P, Q, curve, Vec3(0, 0.5, 0)));
     }},
    {"pose driver",
     R"("type": "pose_driver", "a": "P", "b": "Q", "position": [{"linear": {"rate": 2, "value": 1}}, -1, 0.5],
        "turns": [{"axis": [0, 1, 0], "angle": {"harmonic": {"amplitude": 1, "omega": 2}}}], "orientation": [0, 1, 0, 0])",
     [](World& world, BodyId P, BodyId Q) {
       world.add("j", PoseDriver(P, Q, [](double t) {
                   const Quat q = exp_so3(std::sin(2 * t) * Vec3::UnitY()) * Quat(0, 1, 0, 0);
                   return PosePoint{{q, Vec3(1 + 2 * t, -1, 0.5)},
                                    {2 * std::cos(2 * t) * Vec3::UnitY(), Vec3(2, 0, 0)},
                                    {-4 * std::sin(2 * t) * Vec3::UnitY(), Vec3::Zero()}};
                 }));
     }},
    {"ball with frames",
     R"("type": "ball", "a": "P", "b": "Q", "anchor": [2, 1, 0], "orientation_a": [0, 1, 0, 0],
        "orientation_b": [0, 0, 1, 0], "axes": {"swing": {"limits": {"upper": 1}}, "turn_z": {"friction": {"static": 1}}})",
     [](World& world, BodyId P, BodyId Q) {
       const JointId j =
           world.add("j", Ball::at(world, P, Q, Vec3(2, 1, 0)).with_axes(Quat(0, 1, 0, 0), Quat(0, 0, 1, 0)));
       world.set_limits(world.axis(j, "swing"), AxisLimits{.upper = 1});
       world.set_friction(world.axis(j, "turn_z"), AxisFriction{1, 1});
     }},
    {"six_dof with frames",
     R"("type": "six_dof", "a": "P", "b": "Q", "anchor": [2, 1, 0], "locked": ["x", "y", "angle_z"],
        "orientation_a": [0, 1, 0, 0], "orientation_b": [0, 0, 1, 0])",
     [](World& world, BodyId P, BodyId Q) {
       SixDof::Locks locks;
       locks.translation = {true, true, false};
       locks.rotation = {false, false, true};
       world.add("j", SixDof(P, Q, world.pose(P).local(Vec3(2, 1, 0)), Quat(0, 1, 0, 0),
                             world.pose(Q).local(Vec3(2, 1, 0)), Quat(0, 0, 1, 0), locks));
     }},
};

/// Residual, J V + φ_t and γ of all rows.
Eigen::VectorXd values_of(const World& world) {
  const Rows rows(world);
  const int n = rows.row_count();
  Eigen::VectorXd out = Eigen::VectorXd::Zero(3 * n);
  const std::span<double> phi(out.data(), n), rate(out.data() + n, n), gamma(out.data() + 2 * n, n);
  std::vector<double> J(rows.jacobian_size());
  rows.residual(world.state(), phi);
  rows.jacobian(world.state(), J);
  rows.apply(J, world.state().twists, rate);
  rows.add_rate(world.state(), rate);
  rows.bias(world.state(), world.state().twists, gamma);
  return out;
}

TEST(SceneJoints, AreThoseMadeByHand) {
  for (const Twin& twin : kTwins) {
    World read = parse_scene(two_bodies(R"("assemble": true, "joints": [{"name": "j", )" +
                                        std::string(twin.file) + "}]"),
                             "test.json")
                     .world;
    World made = base();
    const BodyId P = made.body("P"), Q = made.body("Q");
    twin.add(made, P, Q);
    for (World* world : {&read, &made}) {  // away from the start, where every number shows
      world->set_pose(Q, {exp_so3(Vec3(0.3, -0.2, 0.5)), Vec3(2.1, 0.2, -0.3)});
      world->set_twist(P, {Vec3(0.1, 0.2, 0.3), Vec3(1, -1, 0.5)});
      world->set_twist(Q, {Vec3(-0.3, 0.4, 0.1), Vec3(0.2, 0.6, -0.7)});
      world->set_time(0.4);
    }
    const Eigen::VectorXd expected = values_of(made), found = values_of(read);
    ASSERT_EQ(found.size(), expected.size()) << twin.name;
    EXPECT_GT(expected.norm(), 0.1) << twin.name;
    // 1e-13: round-off of some products of numbers up to 10.
    EXPECT_LT((found - expected).norm(), 1e-13 * (1 + expected.norm())) << twin.name;
    const JointId j = read.joint("j");
    EXPECT_EQ(read.joint(j).type(), made.joint(j).type());
    EXPECT_EQ(read.joint(j).course().size(), made.joint(j).course().size()) << twin.name;
    for (int k = 0; k < made.axis_count(j); ++k)
      EXPECT_EQ(read.axis_properties({j, k}).any(), made.axis_properties({j, k}).any()) << twin.name;
  }
}

/// What is not given is as at the start, also with turns that are not 0 then.
TEST(SceneJoints, APoseDriverIsClosedByDefault) {
  const World world =
      parse_scene(two_bodies(R"("time": 0.3, "joints": [{"type": "pose_driver", "a": "P", "b": "Q",
      "turns": [{"axis": [0, 0, 1], "angle": {"linear": {"rate": 2}}}, {"axis": [1, 0, 0], "angle": 0.4}]}])"),
                  "test.json")
          .world;
  EXPECT_TRUE(world.validate(1e-14).empty());
}

}  // namespace
}  // namespace taut::scene_joints_test
