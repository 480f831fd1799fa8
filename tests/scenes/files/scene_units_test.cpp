#include <gtest/gtest.h>

#include "core/constraints/rows.h"
#include "scenes/files/scene_file.h"
#include "scenes/files/state_file.h"
#include "tests/scenes/files/scene_bad_cases.h"

/// Angles in degrees, and directions of another length than 1.
namespace taut::scene_units_test {
namespace {

using namespace scene_file_cases;

/// Two values of the same curve, or none of both.
void expect_same(const std::optional<Curve>& one, const std::optional<Curve>& other, const char* what) {
  ASSERT_EQ(one.has_value(), other.has_value()) << what;
  if (!one) return;
  for (double x : {-1.0, -0.2, 0.0, 0.3, 1.0})
    EXPECT_NEAR(one->extended(x), other->extended(x), 1e-13) << what;
}

TEST(SceneFile, AnglesInDegreesAreThoseInRadians) {
  const Scene degrees = parse_scene(every_angle(true), "a.json"),
              radians = parse_scene(every_angle(false), "a.json");
  // 1e-14: round-off of one product.
  EXPECT_NEAR(degrees.settings.max_rotation, radians.settings.max_rotation, 1e-14);
  const World &one = degrees.world, &other = radians.world;
  ASSERT_EQ(one.body_count(), other.body_count());
  for (int b = 0; b < one.body_count(); ++b)
    EXPECT_TRUE(one.twist(BodyId{b}).w.isApprox(other.twist(BodyId{b}).w, 1e-14) || b == 0 || b == 3) << b;
  EXPECT_NEAR(one.twist(one.body("p")).w.z(), std::numbers::pi / 2, 1e-14);
  for (const auto& [joint, axis] : std::vector<std::pair<const char*, const char*>>{
           {"hinge", "angle"}, {"other", "angle"}, {"third", "angle"}, {"third", "displacement"}}) {
    const AxisId id = one.axis(one.joint(joint), axis);
    EXPECT_NEAR(one.state().axes[one.axis_index(id)], other.state().axes[other.axis_index(id)], 1e-14);
    const AxisProperties &p = one.axis_properties(id), &q = other.axis_properties(id);
    ASSERT_EQ(p.limits.has_value(), q.limits.has_value());
    if (p.limits) {
      EXPECT_NEAR(p.limits->lower, q.limits->lower, 1e-14) << joint;
      EXPECT_NEAR(p.limits->upper, q.limits->upper, 1e-14) << joint;
    }
    ASSERT_EQ(p.motor.has_value(), q.motor.has_value());
    if (p.motor) {
      EXPECT_NEAR(p.motor->target, q.motor->target, 1e-14) << joint;
      EXPECT_EQ(p.motor->max_force, q.motor->max_force) << joint;
      if (std::isfinite(q.motor->max_speed)) {
        EXPECT_NEAR(p.motor->max_speed, q.motor->max_speed, 1e-14) << joint;
      }
      expect_same(p.motor->force_of_speed, q.motor->force_of_speed, "force of speed");
    }
    ASSERT_EQ(p.spring.has_value(), q.spring.has_value());
    if (p.spring) {
      EXPECT_NEAR(p.spring->rest, q.spring->rest, 1e-14) << joint;
      EXPECT_EQ(p.spring->stiffness, q.spring->stiffness) << joint;
      expect_same(p.spring->table, q.spring->table, "table");
      expect_same(p.spring->damping_table, q.spring->damping_table, "damping table");
    }
  }
  EXPECT_EQ(one.axis_properties(one.axis(one.joint("third"), "displacement")).limits->lower, -90);  // metres
  // Thresholds of events.
  ASSERT_EQ(degrees.events.size(), 7U);
  ASSERT_EQ(radians.events.size(), 7U);
  for (std::size_t e = 0; e < 7; ++e)
    EXPECT_NEAR(std::get<WhenPasses>(degrees.events[e].when).threshold,
                std::get<WhenPasses>(radians.events[e].when).threshold, 1e-14)
        << e;
  EXPECT_NEAR(std::get<WhenPasses>(degrees.events[0].when).threshold, 100 * std::numbers::pi / 180, 1e-14);
  EXPECT_NEAR(*std::get<SetMotor>(degrees.events[3].actions[0]).target, std::numbers::pi / 3, 1e-14);
  // Drivers of all kinds of motion.
  const Rows rows(one), other_rows(other);
  for (double time : {0.1, 0.4, 0.9}) {
    State state = one.state();
    state.time = time;
    std::vector<double> phi(rows.row_count()), other_phi(other_rows.row_count());
    rows.residual(state, phi);
    other_rows.residual(state, other_phi);
    double largest = 0;
    for (std::size_t i = 0; i < phi.size(); ++i) {
      EXPECT_NEAR(phi[i], other_phi[i], 1e-13) << i;
      largest = std::max(largest, std::abs(phi[i]));
    }
    EXPECT_GT(largest, 0.1);  // the motions are not all at rest
  }
}

Scene with_axis(const std::string& axis) {
  return parse_scene(sound_body(R"("name": "b", "orientation": {"angle_deg": 180,
    "axis": )" + axis + "}"),
                     "test.json");
}

TEST(SceneFile, DirectionsOfAnyLengthAreNormalised) {
  const auto axis_of = [](const Scene& scene) { return Vec3(scene.world.pose(BodyId{1}).q.vec()); };
  const Vec3 diagonal = Vec3(0, 1, 1).normalized();
  for (const char* silent :
       {"[0, 0.707, 0.707]", "[0, 0.7071, 0.7071]", "[0, 0.70710678118, 0.70710678118]"}) {
    const Scene scene = with_axis(silent);
    EXPECT_TRUE(scene.warnings.empty()) << silent;
    EXPECT_TRUE(axis_of(scene).isApprox(diagonal, 1e-10)) << silent;
  }
  const Scene long_axis = with_axis("[0, 1, 1]");
  ASSERT_EQ(long_axis.warnings.size(), 1U);
  EXPECT_EQ(
      long_axis.warnings[0],
      "test.json:2:13: /bodies/0/orientation/axis of \"b\": has length 1.41421 and is taken with length 1 "
      "(value: [0,1,1])");
  EXPECT_TRUE(axis_of(long_axis).isApprox(diagonal, 1e-15));
  // Lengths whose squares are no numbers.
  for (const char* extreme : {"[0, 1e300, 1e300]", "[0, 1e-300, 1e-300]"})
    EXPECT_TRUE(axis_of(with_axis(extreme)).isApprox(diagonal, 1e-15)) << extreme;
}

TEST(SceneFile, QuaternionsOfAnyLengthAreNormalised) {
  const Scene scene = parse_scene(sound_body(R"("orientation": [1, 1, 0, 0])"), "test.json");
  EXPECT_EQ(scene.warnings.size(), 1U);
  EXPECT_TRUE(scene.world.pose(BodyId{1}).q.isApprox(Quat(std::sqrt(0.5), std::sqrt(0.5), 0, 0), 1e-15));
  const Scene rounded = parse_scene(sound_body(R"("orientation": [0.707, 0.707, 0, 0])"), "test.json");
  EXPECT_TRUE(rounded.warnings.empty());
  EXPECT_NEAR(rounded.world.pose(BodyId{1}).q.norm(), 1, 1e-15);
}

/// A state is written by a program: a length that is not 1 is a mistake.
TEST(StateFile, RefusesQuaternionsOfAnotherLength) {
  Scene scene = parse_scene(sound_body(R"("name": "b")"), "test.json");
  const std::string state =
      R"({"format": "taut-state/1", "time": 0, "bodies": [{"name": "b", "position": [0, 0, 0],
    "orientation": [2, 0, 0, 0], "velocity": [0, 0, 0], "angular_velocity": [0, 0, 0]}]})";
  EXPECT_THROW(apply_state(scene.world, state, "state.json"), SceneFileError);
}

}  // namespace
}  // namespace taut::scene_units_test
