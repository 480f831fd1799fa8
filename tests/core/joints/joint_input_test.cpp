#include <limits>

#include "core/joints/joints.h"
#include "tests/core/constraints/row_checker.h"
#include "tests/core/expect_invalid.h"

namespace taut::joint_input_test {
namespace {

using testing::expect_invalid;
using testing::kA;
using testing::kB;
using testing::pair_of_bodies;

// Bad input is refused with the name of the thing and its value.

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
const Vec3 kGood(0, 0, 1), kNotFinite(0, kNan, 0), kLong(0, 0, 1.25);
const Quat kTurn = Quat::Identity(), kLongTurn(1.25, 0, 0, 0);

TEST(JointInput, Ball) {
  expect_invalid([] { Ball(kA, kB, kNotFinite, kGood); }, {"ball anchor on A", "finite", "nan"});
  expect_invalid([] { Ball(kA, kB, kGood, Vec3(kInfinity, 0, 0)); }, {"ball anchor on B", "finite", "inf"});
}

TEST(JointInput, Hinge) {
  expect_invalid([] { Hinge(kA, kB, kNotFinite, kGood, kGood, kGood); }, {"hinge anchor on A", "nan"});
  expect_invalid([] { Hinge(kA, kB, kGood, kLong, kGood, kGood); }, {"hinge axis on A", "length 1", "1.25"});
  expect_invalid([] { Hinge(kA, kB, kGood, kGood, kNotFinite, kGood); }, {"hinge anchor on B", "nan"});
  expect_invalid([] { Hinge(kA, kB, kGood, kGood, kGood, kLong); }, {"hinge axis on B", "length 1", "1.25"});
  expect_invalid([] { Hinge(kA, kB, kGood, kGood, kGood, Vec3(Vec3::Zero())); }, {"hinge axis on B", "0"});
  const World world = pair_of_bodies();
  expect_invalid([&] { Hinge::at(world, kA, kB, kGood, kLong); }, {"hinge axis", "1.25"});
  expect_invalid([&] { Hinge::at(world, kA, kB, kNotFinite, kGood); }, {"hinge anchor", "nan"});
}

TEST(JointInput, Slider) {
  expect_invalid([] { Slider(kA, kB, kNotFinite, kGood, kGood, kTurn); }, {"slider anchor on A", "nan"});
  expect_invalid([] { Slider(kA, kB, kGood, kLong, kGood, kTurn); }, {"slider axis on A", "1.25"});
  expect_invalid([] { Slider(kA, kB, kGood, kGood, kNotFinite, kTurn); }, {"slider anchor on B", "nan"});
  expect_invalid([] { Slider(kA, kB, kGood, kGood, kGood, kLongTurn); },
                 {"slider orientation of B in A", "1.25"});
  const World world = pair_of_bodies();
  expect_invalid([&] { Slider::at(world, kA, kB, kGood, kLong); }, {"slider axis", "1.25"});
}

TEST(JointInput, Universal) {
  expect_invalid([] { Universal(kA, kB, kNotFinite, kGood, kGood, kGood); },
                 {"universal anchor on A", "nan"});
  expect_invalid([] { Universal(kA, kB, kGood, kLong, kGood, kGood); }, {"universal axis on A", "1.25"});
  expect_invalid([] { Universal(kA, kB, kGood, kGood, kNotFinite, kGood); },
                 {"universal anchor on B", "nan"});
  expect_invalid([] { Universal(kA, kB, kGood, kGood, kGood, kLong); }, {"universal axis on B", "1.25"});
  const World world = pair_of_bodies();
  expect_invalid([&] { Universal::at(world, kA, kB, kGood, kLong, kGood); }, {"universal axis on A", "1.25"});
  expect_invalid([&] { Universal::at(world, kA, kB, kGood, kGood, kLong); }, {"universal axis on B", "1.25"});
  // Arms that are not perpendicular would make a joint that is open from the start.
  expect_invalid([&] { Universal::at(world, kA, kB, kGood, kGood, Vec3(0.6, 0, 0.8)); },
                 {"universal axes", "perpendicular", "0.8"});
}

TEST(JointInput, Fixed) {
  expect_invalid([] { Fixed(kA, kB, kNotFinite, kGood, kTurn); }, {"fixed anchor on A", "nan"});
  expect_invalid([] { Fixed(kA, kB, kGood, kNotFinite, kTurn); }, {"fixed anchor on B", "nan"});
  expect_invalid([] { Fixed(kA, kB, kGood, kGood, kLongTurn); }, {"fixed orientation of B in A", "1.25"});
}

TEST(JointInput, Distance) {
  expect_invalid([] { Distance(kA, kB, kNotFinite, kGood, 1); }, {"distance anchor on A", "nan"});
  expect_invalid([] { Distance(kA, kB, kGood, kNotFinite, 1); }, {"distance anchor on B", "nan"});
  expect_invalid([] { Distance(kA, kB, kGood, kGood, 0); }, {"distance length", "positive", "0"});
  expect_invalid([] { Distance(kA, kB, kGood, kGood, -2.5); }, {"distance length", "positive", "-2.5"});
  expect_invalid([] { Distance(kA, kB, kGood, kGood, kNan); }, {"distance length", "nan"});
  const World world = pair_of_bodies();
  expect_invalid([&] { Distance::between(world, kA, kB, kGood, kGood); }, {"distance length", "0"});
}

TEST(JointInput, Cylindrical) {
  expect_invalid([] { Cylindrical(kA, kB, kNotFinite, kGood, kGood, kGood); },
                 {"cylindrical anchor on A", "nan"});
  expect_invalid([] { Cylindrical(kA, kB, kGood, kGood, kGood, kLong); }, {"cylindrical axis on B", "1.25"});
  const World world = pair_of_bodies();
  expect_invalid([&] { Cylindrical::at(world, kA, kB, kGood, kLong); }, {"cylindrical axis", "1.25"});
}

TEST(JointInput, Screw) {
  const Vec3 x = Vec3::UnitX();
  expect_invalid([&] { Screw(kA, kB, kGood, kGood, x, kGood, kGood, x, 0); }, {"screw pitch", "0"});
  expect_invalid([&] { Screw(kA, kB, kGood, kGood, x, kGood, kGood, x, kNan); }, {"screw pitch", "nan"});
  expect_invalid([&] { Screw(kA, kB, kGood, kGood, kGood, kGood, kGood, x, 1); },
                 {"screw reference on A", "perpendicular"});
  expect_invalid([&] { Screw(kA, kB, kGood, kLong, x, kGood, kGood, x, 1); }, {"screw axis on A", "1.25"});
}

TEST(JointInput, Planar) {
  const Vec3 x = Vec3::UnitX();
  expect_invalid([&] { Planar(kA, kB, kNotFinite, kGood, x, kGood, kGood, x); },
                 {"planar anchor on A", "nan"});
  expect_invalid([&] { Planar(kA, kB, kGood, kLong, x, kGood, kGood, x); }, {"planar normal on A", "1.25"});
  expect_invalid([&] { Planar(kA, kB, kGood, kGood, x, kGood, kGood, kGood); }, {"planar x on B"});
}

TEST(JointInput, PointOnLine) {
  expect_invalid([] { PointOnLine(kA, kB, kGood, kLong, kGood); }, {"point-on-line axis on A", "1.25"});
  expect_invalid([] { PointOnLine(kA, kB, kGood, kGood, kNotFinite); }, {"point-on-line anchor on B", "nan"});
}

TEST(JointInput, Hinge2) {
  expect_invalid([] { Hinge2(kA, kB, kGood, kLong, kGood, kGood); }, {"hinge2 steering axis on A", "1.25"});
  expect_invalid([] { Hinge2(kA, kB, kGood, kGood, kGood, kLong); }, {"hinge2 spin axis on B", "1.25"});
  const World world = pair_of_bodies();
  expect_invalid([&] { Hinge2::at(world, kA, kB, kGood, kGood, Vec3(0.6, 0, 0.8)); },
                 {"hinge2 axes", "perpendicular", "0.8"});
}

TEST(JointInput, SixDof) {
  expect_invalid([] { SixDof(kA, kB, kNotFinite, kTurn, kGood, kTurn, {}); }, {"six-DOF anchor on A", "nan"});
  expect_invalid([] { SixDof(kA, kB, kGood, kTurn, kGood, kLongTurn, {}); },
                 {"six-DOF orientation on B", "1.25"});
}

TEST(JointInput, PointOnCurve) {
  const World world = pair_of_bodies();
  const auto through = [&](std::vector<Vec3> points, const Vec3& p, bool closed) {
    PointOnCurve::through(world, kA, kB, points, p, closed);
  };
  const Vec3 o = Vec3::Zero(), x = Vec3::UnitX(), y = Vec3::UnitY();
  expect_invalid([&] { through({o}, o, false); }, {"spline", "more points", "1"});
  expect_invalid([&] { through({o, o}, o, false); }, {"spline parameter 2", "exceed"});
  expect_invalid([&] { through({o, x, kNotFinite}, o, false); }, {"spline point 3", "nan"});
  expect_invalid([&] { through({o, x, y, x + y}, o, true); }, {"spline", "end where it starts"});
  expect_invalid([&] { through({o, x}, kNotFinite, false); }, {"point-on-curve anchor on B", "nan"});
}

TEST(JointInput, MissingBodiesAreNamed) {
  const World world = pair_of_bodies();
  expect_invalid([&] { Ball::at(world, kA, BodyId{7}, kGood); }, {"body id", "no such body", "7"});
}

}  // namespace
}  // namespace taut::joint_input_test
