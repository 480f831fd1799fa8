#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "scenes/program/live_run.h"
#include "tests/run_program.h"
#include "tests/temporary.h"

namespace taut::testing::live_test {
namespace {

constexpr double kOmega = 4 * std::numbers::pi;

World one_body(const Pose& pose, const Twist& twist = {}) {
  World world;
  world.add_body(
      {.name = "body", .mass = MassProperties::box({0.3, 0.2, 0.1}, 2.0), .pose = pose, .twist = twist});
  return world;
}

TEST(LivePull, IsASpringOfTheMassAtTheCentre) {
  const Vec3 v(0.3, 0, -0.1);
  const World world = one_body({exp_so3(Vec3(1, 2, 3)), {1, 2, 3}}, {Vec3(4, 5, 6), v});
  const Vec3 f = pull_force(world, {{1}, Vec3::Zero(), {1.5, 2, 3}, 1}, 1e-4);
  const Vec3 expected = 2 * kOmega * kOmega * Vec3(0.5, 0, 0) - 2 * 0.7 * 2 * kOmega * v;
  EXPECT_LT((f - expected).norm(), 1e-12 * expected.norm());  // round-off
  const Vec3 strong = pull_force(world, {{1}, Vec3::Zero(), {1.5, 2, 3}, 100}, 1e-4);
  const Vec3 stronger = 100 * 2 * kOmega * kOmega * Vec3(0.5, 0, 0) - 10 * 2 * 0.7 * 2 * kOmega * v;
  EXPECT_LT((strong - stronger).norm(), 1e-12 * stronger.norm());
}

TEST(LivePull, IsStableAtAnyPointStrengthAndStep) {
  for (const double h : {1e-3, 1e-2, 0.1})
    for (const double strength : {1.0, 1000.0})
      for (const Vec3& p_BP : {Vec3(0, 0, 0), Vec3(0.15, 0.1, 0.05), Vec3(3, 0, 0)}) {
        World world = one_body({exp_so3(Vec3(0.1, 0.2, 0.3)), {0, 0, 0}});
        world.set_gravity(Vec3::Zero());
        Simulator simulator(world);
        const BodyId body{1};
        const Vec3 start = world.pose(body).point(p_BP), goal = start + Vec3(0.1, -0.05, 0.02);
        const double first = (goal - start).norm();
        double most = 0;
        for (int i = 0; i < 3000; ++i) {
          simulator.apply_force(body, p_BP, pull_force(world, {body, p_BP, goal, strength}, h));
          ASSERT_TRUE(simulator.step(h).ok());
          most = std::max(most, (world.pose(body).point(p_BP) - goal).norm());
        }
        EXPECT_LT(most, 1.2 * first) << h << ' ' << strength << ' ' << p_BP.transpose();
      }
}

TEST(LiveOptions, PortsAndAddressesThatAreNoneAreRefused) {
  if (!serves_live()) GTEST_SKIP() << "built without Boost.Beast";
  const auto error = [](const LiveOptions& options) -> std::string {
    try {
      (void)live_server_options(options);
    } catch (const std::invalid_argument& thrown) {
      return thrown.what();
    }
    return "";
  };
  for (const char* port :
       {"", "x", "80x", "-1", "65536", "99999999999999999999", "0.0.0.0", "0.0.0.0:80", "::"})
    EXPECT_NE(error({.port = port, .address = {}}).find("--live"), std::string::npos) << port;
  for (const char* address : {"", "example.org", "1.2.3", "300.1.1.1", "127.0.0.1:80"})
    EXPECT_NE(error({.port = {}, .address = address}).find("--live-address"), std::string::npos) << address;
  EXPECT_EQ(error({.port = "8000", .address = "localhost"}), "");
  EXPECT_EQ(live_server_options({.port = "8000", .address = {}}).address, "127.0.0.1");
  EXPECT_EQ(live_server_options({.port = "8000", .address = "::1"}).port, 8000);
  EXPECT_TRUE(is_loopback("127.0.0.1") && is_loopback("127.1.2.3") && is_loopback("::1"));
  EXPECT_FALSE(is_loopback("0.0.0.0") || is_loopback("::") || is_loopback("192.168.1.1"));
}

TEST(LiveOptions, APortInUseIsRefusedBeforeAnyFileIsTouched) {
  if (!serves_live()) GTEST_SKIP() << "built without Boost.Beast";
  const LiveServer other({}, "");
  const std::string url = other.url(), port = url.substr(url.rfind(':') + 1, url.size() - url.rfind(':') - 2);
  const std::string file = temporary("live.csv");
  const Outcome output = run_program({"run", "pendulum-ball", "--live=" + port, "--csv", file});
  EXPECT_EQ(output.exit_status, 2);
  EXPECT_NE(output.err.find("cannot listen there"), std::string::npos) << output.err;
  EXPECT_FALSE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace taut::testing::live_test
