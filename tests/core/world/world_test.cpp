#include "core/world/world.h"

#include <limits>
#include <stdexcept>
#include <utility>

#include "core/joints/joints.h"
#include "tests/core/expect_invalid.h"
#include "tests/core/random_state.h"

namespace taut::world_test {
namespace {

using testing::expect_invalid;
using testing::Random;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Two moving bodies, a fixed one, a joint and a force.
struct Small {
  World world;
  BodyId arm, hand, wall;
  JointId elbow;
  ForceId pull;

  Small() {
    arm = world.add_body({.name = "arm", .mass = {2, Vec3(1, 2, 2.5)}});
    hand = world.add_body({.name = "hand", .pose = {exp_so3(Vec3(0.1, 0.2, 0.3)), Vec3(1, 0, 0)}});
    wall = world.add_body({.name = "wall", .pose = {Quat::Identity(), Vec3(-1, 0, 0)}, .fixed = true});
    elbow = world.add("elbow", Ball::at(world, arm, hand, Vec3(0.5, 0, 0)));
    pull = world.add_force(PointForce(hand, Vec3::Zero(), Vec3(1, 0, 0)));
  }
};

TEST(World, StartsWithTheGround) {
  const World world;
  EXPECT_EQ(world.body_count(), 1);
  EXPECT_EQ(world.moving_body_count(), 0);
  EXPECT_EQ(world.name(kGround), "ground");
  EXPECT_TRUE(world.is_fixed(kGround));
  EXPECT_EQ(world.body("ground"), kGround);
  EXPECT_EQ(world.gravity(), Vec3(0, 0, -9.81));
}

TEST(World, FindsWhatWasAddedByIdAndByName) {
  const Small s;
  EXPECT_EQ(s.world.body_count(), 4);
  EXPECT_EQ(s.world.moving_body_count(), 2);
  EXPECT_EQ(s.world.joint_count(), 1);
  EXPECT_EQ(s.world.force_count(), 1);
  EXPECT_EQ(s.world.body("hand"), s.hand);
  EXPECT_EQ(s.world.name(s.hand), "hand");
  EXPECT_TRUE(s.world.has_body("wall"));
  EXPECT_FALSE(s.world.has_body("elbow"));
  EXPECT_EQ(s.world.joint("elbow"), s.elbow);
  EXPECT_EQ(s.world.name(s.elbow), "elbow");
  EXPECT_TRUE(s.world.has_joint("elbow"));
  EXPECT_EQ(s.world.joint(s.elbow).b(), s.hand);
  EXPECT_EQ(s.world.mass_properties(s.arm).mass(), 2);
  EXPECT_TRUE(s.world.is_fixed(s.wall));
  EXPECT_EQ(s.world.pose(s.hand).p, Vec3(1, 0, 0));
}

TEST(World, MakesUpNamesThatAreFree) {
  World world;
  const BodyId first = world.add_body({});
  EXPECT_EQ(world.name(first), "body_1");
  world.add_body({.name = "body_3"});
  // The third body would be body_3, which the user took.
  const BodyId third = world.add_body({});
  EXPECT_NE(world.name(third), "body_3");
  EXPECT_EQ(world.body(world.name(third)), third);
  const JointId joint = world.add("", Ball::at(world, first, third, Vec3::Zero()));
  EXPECT_EQ(world.name(joint), "joint_0");
  EXPECT_EQ(world.joint("joint_0"), joint);
}

TEST(World, TopologyVersionChangesWithBodiesAndJointsOnly) {
  Small s;
  const int before = s.world.topology_version();
  s.world.set_pose(s.arm, {});
  s.world.set_gravity(Vec3::Zero());
  s.world.add_force(PointForce(s.arm, Vec3::Zero(), Vec3::Zero()));
  EXPECT_EQ(s.world.topology_version(), before);
  const BodyId body = s.world.add_body({});
  EXPECT_NE(s.world.topology_version(), before);
  const int with_body = s.world.topology_version();
  s.world.add("", Ball::at(s.world, s.arm, body, Vec3::Zero()));
  EXPECT_NE(s.world.topology_version(), with_body);
}

TEST(World, CopiesAreIndependent) {
  Small s;
  World copy = s.world;
  copy.set_pose(s.arm, {Quat::Identity(), Vec3(7, 0, 0)});
  copy.add_body({.name = "extra"});
  EXPECT_EQ(s.world.pose(s.arm).p, Vec3::Zero());
  EXPECT_FALSE(s.world.has_body("extra"));
}

/// Everything that can be seen of a world.
std::string snapshot(const World& world) {
  std::ostringstream out;
  out.precision(17);
  out << world.body_count() << ' ' << world.moving_body_count() << ' ' << world.joint_count() << ' '
      << world.force_count() << ' ' << world.topology_version() << ' ' << world.forces_depend_on_velocity()
      << ' ' << world.gravity().transpose() << ' ' << world.state().poses.size() << ' '
      << world.state().twists.size() << ' ' << world.time() << '\n';
  for (int b = 0; b < world.body_count(); ++b) {
    const BodyId id{b};
    out << world.name(id) << ' ' << world.body(world.name(id)).index << ' ' << world.is_fixed(id) << ' '
        << world.mass_properties(id).mass() << ' ' << world.pose(id).q.coeffs().transpose() << ' '
        << world.pose(id).p.transpose() << ' ' << world.twist(id).w.transpose() << ' '
        << world.twist(id).v.transpose() << '\n';
  }
  for (int j = 0; j < world.joint_count(); ++j)
    out << world.name(JointId{j}) << ' ' << world.joint(world.name(JointId{j})).index << '\n';
  std::vector<Wrench> wrenches(world.body_count());
  world.forces(world.state(), wrenches);
  for (const Wrench& w : wrenches) out << w.torque.transpose() << ' ' << w.force.transpose() << '\n';
  return out.str();
}

/// A refused call says why and leaves the world as it was, ready for the corrected call.
class WorldRefuses : public ::testing::Test {
 protected:
  Small s;
  World& world = s.world;

  template <typename Action>
  void refuses(Action&& action, std::initializer_list<const char*> parts) {
    const std::string before = snapshot(world);
    expect_invalid(action, parts);
    EXPECT_EQ(snapshot(world), before);
  }
};

TEST_F(WorldRefuses, BadBodies) {
  const auto add = [&](const BodySpec& spec) { return [&, spec] { world.add_body(spec); }; };
  refuses(add({.name = "arm"}), {"body", "already taken", "arm"});
  refuses(add({.name = "ground"}), {"body", "already taken", "ground"});
  refuses(add({.name = "x", .pose = {Quat::Identity(), Vec3(0, kNan, 0)}}), {"position of x", "nan"});
  refuses(add({.name = "x", .pose = {Quat(1.25, 0, 0, 0), Vec3::Zero()}}), {"orientation of x", "1.25"});
  refuses(add({.name = "x", .pose = {Quat(kNan, 0, 0, 0), Vec3::Zero()}}), {"orientation of x", "nan"});
  refuses(add({.name = "x", .twist = {Vec3(kNan, 0, 0), Vec3::Zero()}}), {"angular velocity of x", "nan"});
  refuses(add({.name = "x", .twist = {Vec3::Zero(), Vec3(kNan, 0, 0)}}), {"velocity of x", "nan"});
  refuses(add({.name = "x", .twist = {Vec3::Zero(), Vec3(1.5, 0, 0)}, .fixed = true}),
          {"velocity of x", "fixed body cannot move", "1.5"});
  refuses(add({.name = "x", .twist = {Vec3(2.5, 0, 0), Vec3::Zero()}, .fixed = true}),
          {"velocity of x", "fixed body cannot move", "2.5"});
  // The name was not used up.
  EXPECT_EQ(world.add_body({.name = "x"}).index, 4);
}

TEST_F(WorldRefuses, BadJoints) {
  const auto ball = [](BodyId a, BodyId b) { return Ball(a, b, Vec3::Zero(), Vec3::Zero()); };
  refuses([&] { world.add("elbow", ball(s.arm, s.hand)); }, {"joint", "already taken", "elbow"});
  refuses([&] { world.add("x", ball(s.arm, BodyId{9})); }, {"joint x", "no such body", "9"});
  refuses([&] { world.add("x", ball(BodyId{-1}, s.arm)); }, {"joint x", "no such body", "-1"});
  refuses([&] { world.add("x", ball(s.arm, s.arm)); }, {"joint x", "itself", "arm"});
  refuses([&] { world.add("x", ball(s.wall, kGround)); }, {"joint x", "two fixed bodies", "wall", "ground"});
  refuses([&] { world.add_joint("x", nullptr); }, {"joint x", "null"});
  EXPECT_EQ(world.add("x", ball(kGround, s.arm)).index, 1);
}

TEST_F(WorldRefuses, BadForces) {
  refuses([&] { world.add_force(PointForce(BodyId{9}, Vec3::Zero(), Vec3::Zero())); },
          {"force", "no such body", "9"});
  refuses([&] { world.add_force(SpringDamper(s.arm, BodyId{-2}, Vec3::Zero(), Vec3::Zero(), 1, 1, 1)); },
          {"force", "no such body", "-2"});
  refuses([&] { world.add_force(std::shared_ptr<const Force>()); }, {"force", "null"});
  refuses([&] { world.set_force(s.pull, nullptr); }, {"force", "null"});
  refuses([&] { world.set_force(ForceId{3}, std::make_shared<BodyTorque>(s.arm, Vec3::Zero())); },
          {"force id", "no such force", "3"});
  refuses([&] { world.set_gravity(Vec3(0, 0, kNan)); }, {"gravity", "nan"});
  refuses([&] { world.add_force(PointForce(s.arm, Vec3(kNan, 0, 0), Vec3::Zero())); },
          {"force point", "nan"});
  refuses([&] { world.add_force(PointForce(s.arm, Vec3::Zero(), Vec3(kNan, 0, 0))); }, {"force", "nan"});
  refuses([&] { world.add_force(BodyTorque(s.arm, Vec3(kNan, 0, 0))); }, {"torque", "nan"});
  const auto spring = [&](double k, double rest, double c) {
    return
        [=, this] { world.add_force(SpringDamper(s.arm, s.hand, Vec3::Zero(), Vec3::Zero(), k, rest, c)); };
  };
  refuses(spring(-1.5, 1, 1), {"spring stiffness", "-1.5"});
  refuses(spring(1, -1.5, 1), {"spring rest length", "-1.5"});
  refuses(spring(1, 1, kNan), {"spring damping", "nan"});
  refuses([&] { world.add_force(ForceCallback(ForceCallback::Function())); }, {"force callback", "callable"});
}

TEST_F(WorldRefuses, WrongIdsAndNames) {
  refuses([&] { (void)world.body("nobody"); }, {"body", "nobody"});
  refuses([&] { (void)world.joint("none"); }, {"joint", "none"});
  refuses([&] { (void)world.pose(BodyId{4}); }, {"body id", "4"});
  refuses([&] { (void)world.name(BodyId{-1}); }, {"body id", "-1"});
  refuses([&] { (void)world.joint(JointId{}); }, {"joint id", "-1"});
}

TEST_F(WorldRefuses, BadStates) {
  refuses([&] { world.set_pose(s.arm, {Quat(2.5, 0, 0, 0), Vec3::Zero()}); }, {"orientation of arm", "2.5"});
  refuses([&] { world.set_pose(kGround, {}); }, {"pose of ground", "cannot be changed"});
  refuses([&] { world.set_twist(s.wall, {Vec3::Zero(), Vec3(3.5, 0, 0)}); }, {"velocity of wall", "3.5"});
  refuses([&] { world.set_twist(s.arm, {Vec3::Zero(), Vec3(kNan, 0, 0)}); }, {"velocity of arm", "nan"});

  const auto set = [&](auto&& change) {
    return [&, change] {
      State state = world.state();
      change(state);
      world.set_state(state);
    };
  };
  refuses(set([](State& x) { x.poses.pop_back(); }), {"state", "one pose", "3"});
  refuses(set([](State& x) { x.twists.push_back({}); }), {"state", "one twist", "5"});
  refuses(set([](State& x) { x.time = kNan; }), {"time", "nan"});
  refuses(set([](State& x) { x.poses[1].p.x() = kNan; }), {"position of arm", "nan"});
  refuses(set([](State& x) { x.poses[1].q.w() = 1.25; }), {"orientation of arm", "1.25"});
  refuses(set([](State& x) { x.twists[2].w.x() = kNan; }), {"angular velocity of hand", "nan"});
  refuses(set([](State& x) { x.twists[3].v.x() = 1.5; }),
          {"velocity of wall", "fixed body cannot move", "1.5"});
  refuses(set([](State& x) { x.poses[0].p.x() = 1.5; }), {"pose of ground", "cannot be changed", "1.5"});
}

TEST(World, TakesAWholeState) {
  Small s;
  Random random(31);
  State state = s.world.state();
  state.time = 2.5;
  for (BodyId body : {s.arm, s.hand}) {
    state.poses[body.index] = random.pose();
    state.twists[body.index] = random.twist();
  }
  s.world.set_state(state);
  EXPECT_EQ(s.world.time(), 2.5);
  EXPECT_EQ(s.world.pose(s.hand).p, state.poses[s.hand.index].p);
  EXPECT_EQ(s.world.twist(s.arm).w, state.twists[s.arm.index].w);
}

TEST(World, ReportsOpenJointsInMetresAndRadians) {
  World world;
  const BodyId a = world.add_body({}), b = world.add_body({});
  world.add("shut", Ball::at(world, a, b, Vec3(1, 0, 0)));
  world.add("apart", Ball(kGround, a, Vec3(0.25, 0, 0), Vec3::Zero()));
  const Quat turn = exp_so3(Vec3(0, 0, 0.5));
  world.add("skew", Fixed(kGround, b, Vec3::Zero(), Vec3::Zero(), turn));
  world.add("both", Fixed(kGround, b, Vec3(0, 0.125, 0), Vec3::Zero(), turn));
  const std::vector<Problem> problems = world.validate();
  ASSERT_EQ(problems.size(), 3u);
  EXPECT_EQ(problems[0].subject, "ball apart");
  EXPECT_EQ(problems[0].message, "is open at the start by 0.25 m");
  EXPECT_EQ(problems[1].subject, "fixed skew");
  EXPECT_EQ(problems[1].message, "is open at the start by 0.494808 rad");  // 2 sin(0.25)
  EXPECT_EQ(problems[2].message, "is open at the start by 0.125 m and 0.494808 rad");
  EXPECT_EQ(world.validate(0.3).size(), 2u);
  EXPECT_TRUE(world.validate(1).empty());
}

TEST(World, ReportsAGapThatIsNotANumber) {
  World world;
  const BodyId body = world.add_body({.pose = {exp_so3(Vec3(1, 2, 3)), Vec3::Zero()}});
  // Finite anchors, but turning them overflows to ∞ − ∞.
  const double huge = std::numeric_limits<double>::max();
  world.add("far", Ball(kGround, body, Vec3::Zero(), Vec3(huge, huge, -huge)));
  const std::vector<Problem> problems = world.validate();
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_NE(problems[0].message.find("nan"), std::string::npos) << problems[0].message;
}

TEST(World, CopiesAreIndependentAndHaveIdentitiesOfTheirOwn) {
  Small s;
  const World& original = s.world;
  World copy = original;
  EXPECT_NE(copy.identity(), original.identity());
  EXPECT_EQ(copy.topology_version(), original.topology_version());
  EXPECT_EQ(&copy.joint(s.elbow), &original.joint(s.elbow));  // immutable, and shared
  copy.set_pose(s.arm, {Quat::Identity(), Vec3(0, 0, 3)});
  copy.detach(s.elbow);
  copy.add_body({.name = "foot"});
  EXPECT_EQ(original.pose(s.arm).p, Vec3(0, 0, 0));
  EXPECT_TRUE(original.is_attached(s.elbow));
  EXPECT_FALSE(original.has_body("foot"));

  const std::uint64_t before = copy.identity();
  copy = original;
  EXPECT_NE(copy.identity(), before);
  EXPECT_NE(copy.identity(), original.identity());
  EXPECT_TRUE(copy.is_attached(s.elbow));
  EXPECT_FALSE(copy.has_body("foot"));
  World& same = copy;
  copy = same;
  EXPECT_EQ(copy.name(s.hand), "hand");
}

TEST(World, MovesAllThatItHasAndCanBeAssignedToAfterwards) {
  Small s;
  const Joint* elbow = &s.world.joint(s.elbow);
  const std::uint64_t before = s.world.identity();
  World moved = std::move(s.world);
  EXPECT_EQ(&moved.joint(s.elbow), elbow);
  EXPECT_EQ(moved.body("wall"), s.wall);
  EXPECT_EQ(moved.force_count(), 1);
  EXPECT_EQ(s.world.body_count(), 0);
  EXPECT_EQ(s.world.joint_count(), 0);
  EXPECT_FALSE(s.world.has_body("arm"));
  EXPECT_NE(s.world.identity(), before);  // nobody takes it for the one that it was
  EXPECT_NE(s.world.identity(), moved.identity());

  s.world = World();
  EXPECT_EQ(s.world.body_count(), 1);
  s.world.add_body({.name = "foot"});
  s.world = std::move(moved);
  EXPECT_EQ(s.world.name(s.hand), "hand");
  EXPECT_EQ(s.world.twist(s.arm).v, Vec3(0, 0, 0));
  World other = std::move(s.world);
  s.world = other;
  EXPECT_EQ(s.world.name(s.hand), "hand");

  World& same = other;
  other = std::move(same);  // moved from, too
  EXPECT_EQ(other.body_count(), 0);
  EXPECT_EQ(other.moving_body_count(), 0);
  EXPECT_EQ(other.joint_count(), 0);
  other = s.world;
  EXPECT_EQ(other.name(s.hand), "hand");
  EXPECT_EQ(other.pose(s.wall).p, Vec3(-1, 0, 0));
}

TEST(World, WhileHeldItIsNeitherChangedNorAssignedToNorMovedFrom) {
  Small s, t;
  t.world.set_gravity({0, 0, 0});
  const std::uint64_t identity = s.world.identity();
  {
    const World::Hold held = s.world.hold(), again = s.world.hold();
    EXPECT_THROW(s.world = t.world, std::logic_error);
    EXPECT_THROW(s.world = std::move(t.world), std::logic_error);
    EXPECT_THROW(t.world = std::move(s.world), std::logic_error);
    EXPECT_THROW(World(std::move(s.world)), std::logic_error);
    EXPECT_THROW(s.world.set_time(1), std::logic_error);
    EXPECT_EQ(World(s.world).body_count(), 4);  // a copy changes nothing
  }
  EXPECT_EQ(s.world.identity(), identity);
  EXPECT_EQ(s.world.gravity().z(), -9.81);
  EXPECT_EQ(s.world.name(s.hand), "hand");
  EXPECT_EQ(t.world.name(s.hand), "hand");
  EXPECT_EQ(t.world.gravity().z(), 0);
  s.world = t.world;
  EXPECT_EQ(s.world.gravity().z(), 0);
}

}  // namespace
}  // namespace taut::world_test
