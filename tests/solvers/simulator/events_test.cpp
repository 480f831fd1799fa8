#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "core/joints/joints.h"
#include "core/state/motion.h"
#include "core/world/diagnostics.h"
#include "core/world/joint_frame.h"
#include "solvers/simulator/event.h"
#include "solvers/simulator/simulator.h"
#include "tests/refusal.h"

// Events: when they happen, what they do, what the ledger says of it, and that they survive a checkpoint.
namespace taut::events_test {
namespace {

using testing::refusal;
using Way = WhenPasses::Way;
using Where = AttachJoint::Where;

/// A stone of 2 kg, thrown up from the origin, and a scale beside it.
struct Thrown {
  World world;
  BodyId stone, scale;
  explicit Thrown(const Vec3& velocity = Vec3(0, 0, 5)) {
    stone = world.add_body({.name = "stone", .mass = MassProperties(2, Vec3(0.1, 0.2, 0.3))});
    world.set_twist(stone, {Vec3::Zero(), velocity});
    scale = world.add_body({.name = "scale",
                            .mass = MassProperties(1, Vec3(1, 1, 1)),
                            .pose = {.p = Vec3(3, 0, 0)},
                            .fixed = true});
  }
};

bool same_bits(const State& a, const State& b) {
  for (std::size_t i = 0; i < a.poses.size(); ++i)
    if (a.poses[i].p != b.poses[i].p || a.poses[i].q.coeffs() != b.poses[i].q.coeffs() ||
        a.twists[i].v != b.twists[i].v || a.twists[i].w != b.twists[i].w)
      return false;
  return a.time == b.time && a.axes == b.axes;
}

TEST(Events, OfATimeEndsAPartAtItsTimeToTheBit) {
  for (const double time : {0.05, 0.1234567, 0.2, 0.3, 0.30000000000000004, 0.7 / 3, 0.1 + 1e-9}) {
    Thrown t;
    Simulator simulator(t.world);
    simulator.set_events({{"weightless", AtTime{time}, {SetGravity{}}}});
    while (t.world.time() < 0.45) {
      const StepReport& report = simulator.step(0.1);
      ASSERT_TRUE(report.exact()) << report.message;
      EXPECT_EQ(report.dt, 0.1);
      EXPECT_NEAR(report.ledger.start + report.ledger.total(), report.energy(), 1e-13);
      EXPECT_NEAR(report.ledger.change(), report.ledger.total(), 1e-13);
    }
    ASSERT_EQ(simulator.events_happened().size(), 1u);
    EXPECT_EQ(simulator.events_happened()[0].time, time);
    EXPECT_EQ(simulator.events_happened()[0].what, "gravity [0, 0, 0]");
    // Free fall is exact; the grid is kept but for a millionth of a step.
    EXPECT_NEAR(t.world.time(), 0.5, 1.1e-7);
    EXPECT_NEAR(t.world.twist(t.stone).v.z(), 5 - 9.81 * time, 1e-12);
  }
}

TEST(Events, OfATimeThatHasPassedHappenAtOnce) {
  Thrown t;
  t.world.set_time(3);
  Simulator simulator(t.world);
  simulator.set_events({{"late", AtTime{1}, {SetGravity{}}}});
  const StepReport& report = simulator.step(0.1);
  ASSERT_EQ(report.events.size(), 1u);
  EXPECT_EQ(report.events[0].time, 3);
  EXPECT_NEAR(t.world.twist(t.stone).v.z(), 5, 1e-14);
  EXPECT_TRUE(simulator.step(0.1).events.empty());
}

/// z = 5 t − g t²/2 passes 1 m upward at t₁ and downward at t₂.
TEST(Events, ThatPassAThresholdAreLocatedToAMillionthOfAStep) {
  const double root = std::sqrt(25 - 2 * 9.81), up = (5 - root) / 9.81, down = (5 + root) / 9.81;
  for (const double h : {0.1, 0.03, 0.001}) {
    Thrown t;
    Simulator simulator(t.world);
    const Watch height = Watch::position(t.world, t.stone, Vec3::Zero(), Vec3(Vec3::UnitZ()));
    simulator.set_events(
        {{"up", WhenPasses{height, 1, Way::kRising}, {SetGravity{Vec3(0, 0, -9.81)}}},
         {"down", WhenPasses{height, 1, Way::kFalling}, {SetGravity{Vec3(0, 0, -9.81)}}},
         {"any", WhenPasses{height, 1, Way::kEither, true}, {SetGravity{Vec3(0, 0, -9.81)}}}});
    ASSERT_TRUE(simulator.run_until(1, h).exact());
    const std::vector<EventRecord>& happened = simulator.events_happened();
    ASSERT_EQ(happened.size(), 4u);
    const double times[] = {up, up, down, down};
    const char* names[] = {"up", "any", "down", "any"};
    for (int k = 0; k < 4; ++k) {
      EXPECT_EQ(happened[k].name, names[k]);
      EXPECT_GE(happened[k].time, times[k] - 1e-12) << h;
      EXPECT_LE(happened[k].time, times[k] + 1e-6 * h + 1e-12) << h;
    }
    EXPECT_EQ(t.world.time(), 1);
    EXPECT_NEAR(t.world.pose(t.stone).p.z(), 5 - 0.5 * 9.81, 1e-9);  // nothing was lost over the trials
  }
}

/// A pendulum, whose motion has an error of order 2, so that its events have one, too.
TEST(Events, LocatedHaveTheOrderOfTheMotion) {
  const auto time_of_bottom = [](double h) {
    World world;
    const BodyId rod =
        world.add_body({.mass = MassProperties(1, Vec3(0.01, 0.1, 0.1)), .pose = {.p = Vec3(1, 0, 0)}});
    const JointId pivot = world.add("pivot", Hinge::at(world, kGround, rod, Vec3::Zero(), Vec3::UnitY()));
    world.set_friction(world.axis(pivot, "angle"), AxisFriction{});
    Simulator simulator(world);
    simulator.set_events({{"bottom",
                           WhenPasses{Watch::axis(world, world.axis(pivot, "angle")), std::numbers::pi / 2},
                           {EndRun{}}}});
    EXPECT_TRUE(simulator.run_until(2, h).ok());
    EXPECT_EQ(simulator.ended_by(), "bottom");
    EXPECT_EQ(simulator.events_happened().at(0).time, world.time());
    return world.time();
  };
  // A quarter of the period at 90° of amplitude: √(I/(m g)) K(sin 45°), I = 1.1 kg m² about the pivot.
  const double exact = std::sqrt(1.1 / 9.81) * std::comp_ellint_1(std::sqrt(0.5));
  const double coarse = time_of_bottom(0.02) - exact, fine = time_of_bottom(0.005) - exact;
  EXPECT_LT(std::abs(fine), 2e-5);
  EXPECT_NEAR(coarse / fine, 16, 1.5);
}

TEST(Events, OfAReactionAreAtTheEndOfTheStep) {
  Thrown t(Vec3::Zero());
  const JointId hook = t.world.add("hook", Ball::at(t.world, kGround, t.stone, Vec3::Zero()));
  Simulator simulator(t.world);
  simulator.set_events({{"pulled", AtTime{0.25}, {ApplyLoad{.body = t.stone, .force = Vec3(0, 0, -30)}}},
                        {"tears",
                         WhenPasses{Watch::reaction_force(t.world, hook, {}), 40, Way::kRising},
                         {DetachJoint{hook}}}});
  ASSERT_TRUE(simulator.run_until(0.5, 0.1).exact());
  const std::vector<EventRecord>& happened = simulator.events_happened();
  ASSERT_EQ(happened.size(), 2u);
  EXPECT_EQ(happened[1].time, 0.1 + 0.1 + 0.1);  // of the part that began at 0.25
  EXPECT_NEAR(*happened[1].value, 2 * 9.81 + 30, 1e-9);
  EXPECT_FALSE(t.world.is_attached(hook));
  EXPECT_NEAR(t.world.twist(t.stone).v.z(), -(9.81 + 15) * 0.2, 1e-9);
}

/// A load of an interval gives its impulse and no more, wherever its ends lie in steps.
TEST(Events, LoadsGiveTheirImpulse) {
  for (const double duration : {0.05, 0.1, 0.333}) {
    Thrown t(Vec3::Zero());
    t.world.set_gravity(Vec3::Zero());
    Simulator simulator(t.world);
    simulator.set_events(
        {{"pull", AtTime{0.123}, {ApplyLoad{.body = t.stone, .force = Vec3(4, 0, 0), .duration = duration}}},
         {"spin", AtTime{0.2}, {ApplyLoad{.body = t.stone, .torque = Vec3(0, 0, 3), .duration = duration}}}});
    EnergyLedger sum;
    for (int i = 0; i < 8; ++i) {
      const StepReport& report = simulator.step(0.1);
      ASSERT_TRUE(report.exact());
      sum += report.ledger;
    }
    EXPECT_NEAR(t.world.twist(t.stone).v.x(), 4 * duration / 2, 1e-14);
    EXPECT_NEAR(t.world.twist(t.stone).w.z(), 3 * duration / 0.3, 1e-13);
    EXPECT_NEAR(sum.forces, kinetic_energy(t.world, t.world.state()), 1e-13);  // their work is all there is
  }
}

/// Forces that the user gives for one step act in all of its parts.
TEST(Events, DoNotCutShortWhatIsAppliedForAStep) {
  Thrown t(Vec3::Zero());
  t.world.set_gravity(Vec3::Zero());
  Simulator simulator(t.world);
  simulator.set_events({{"one", AtTime{0.03}, {SetGravity{}}}, {"two", AtTime{0.07}, {SetGravity{}}}});
  simulator.apply_force(t.stone, {Vec3::Zero(), Vec3(10, 0, 0)});
  ASSERT_EQ(simulator.step(0.1).events.size(), 2u);
  EXPECT_NEAR(t.world.twist(t.stone).v.x(), 0.5, 1e-14);
  ASSERT_TRUE(simulator.step(0.1).exact());
  EXPECT_NEAR(t.world.twist(t.stone).v.x(), 0.5, 1e-14);
}

/// Two bodies in flight that are joined: a plastic impact keeps momenta, and what it takes is the event's.
TEST(Events, AJointThatIsAttachedInMotionIsAPlasticImpact) {
  World world;
  world.set_gravity(Vec3::Zero());
  const BodyId a = world.add_body({.name = "a", .mass = MassProperties(2, Vec3(0.3, 0.2, 0.1))});
  const BodyId b = world.add_body(
      {.name = "b", .mass = MassProperties(3, Vec3(0.3, 0.4, 0.2)), .pose = {.p = Vec3(1, 0.2, 0)}});
  world.set_twist(a, {Vec3(0.3, 0, 1), Vec3(1, 0, 0)});
  world.set_twist(b, {Vec3(0, -1, 0), Vec3(-1, 0.5, 0.2)});
  const JointId coupling = world.add("coupling", Fixed::at(world, a, b, Vec3(0.5, 0, 0)));
  world.detach(coupling);
  Simulator simulator(world);
  simulator.set_events({{"couple", AtTime{0.25}, {AttachJoint{coupling, Where::kAsIs}}},
                        {"part", AtTime{0.55}, {DetachJoint{coupling}}}});
  const Vec3 p = linear_momentum(world, world.state()), L = angular_momentum(world, world.state());
  ASSERT_TRUE(simulator.run_until(0.25, 0.01).exact());
  ASSERT_TRUE(world.is_attached(coupling));
  // What is left to a rigid body of both: ½ m v² + ½ L·I⁻¹ L about the common centre.
  Vec3 centre = Vec3::Zero();
  Mat3 inertia = Mat3::Zero();
  for (const BodyId body : {a, b}) centre += world.mass_properties(body).mass() / 5 * world.pose(body).p;
  for (const BodyId body : {a, b}) {
    const Mat3 R = world.pose(body).q.toRotationMatrix();
    const Vec3 r = world.pose(body).p - centre;
    inertia += R * world.mass_properties(body).inertia_B() * R.transpose() +
               world.mass_properties(body).mass() * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
  }
  const Vec3 spin = angular_momentum(world, world.state(), centre);
  const double left = 0.5 * p.squaredNorm() / 5 + 0.5 * spin.dot(inertia.inverse() * spin);
  const double before = kinetic_energy(world, world.state());
  const StepReport impact = simulator.step(0.01);
  ASSERT_TRUE(impact.exact());
  EXPECT_LT(impact.ledger.events, -0.5);
  EXPECT_NEAR(impact.ledger.events, left - before, 1e-12);  // round-off
  EXPECT_EQ(impact.ledger.stabilisation, 0);
  EXPECT_NEAR(impact.ledger.start, before, 1e-14);
  EXPECT_NEAR(impact.ledger.start + impact.ledger.total(), impact.energy(), 1e-13);
  while (world.time() < 1) {
    const StepReport& report = simulator.step(0.01);
    ASSERT_TRUE(report.exact()) << report.message;
    EXPECT_EQ(report.ledger.events, 0);  // at parting nothing is lost
    EXPECT_NEAR(report.ledger.start + report.ledger.total(), report.energy(), 1e-12);
    EXPECT_NEAR((linear_momentum(world, world.state()) - p).norm(), 0, 1e-11);  // sums of round-off
    EXPECT_NEAR((angular_momentum(world, world.state()) - L).norm(), 0,
                1e-10);  // and of the joint's tolerance
  }
  EXPECT_FALSE(world.is_attached(coupling));
}

/// At rest nothing is lost, and a spring that leaves takes its energy along.
TEST(Events, DetachingTakesTheEnergyOfSprings) {
  World world;
  world.set_gravity(Vec3::Zero());
  const BodyId cart = world.add_body({.name = "cart", .mass = MassProperties(1, Vec3(1, 1, 1))});
  const JointId rail = world.add("rail", Slider::at(world, kGround, cart, Vec3::Zero(), Vec3::UnitX()));
  const AxisId x = world.axis(rail, "displacement");
  world.set_spring(x, AxisSpring{.stiffness = 100, .rest = 0.1});
  Simulator simulator(world);
  const Watch place = Watch::axis(world, x);
  simulator.set_events({{"off", WhenPasses{place, 0.05, Way::kRising}, {DetachJoint{rail}}}});
  double events = 0;
  for (int i = 0; i < 100; ++i) {
    const StepReport& report = simulator.step(1e-2);
    ASSERT_TRUE(report.exact());
    EXPECT_NEAR(report.ledger.start + report.ledger.total(), report.energy(), 1e-13);
    events += report.ledger.events;
  }
  ASSERT_EQ(simulator.events_happened().size(), 1u);
  EXPECT_NEAR(events, -0.5 * 100 * 0.05 * 0.05, 1e-6);  // located to 1e-8 s at 1 m/s
  EXPECT_NEAR(simulator.report().kinetic_energy, 0.5 * 100 * (0.01 - 0.0025),
              3e-3);  // of order 2 in h ω = 0.1
}

TEST(Events, AJointWithEndsApartIsRefusedOrAttachedAsItIs) {
  for (const bool as_is : {false, true}) {
    Thrown t(Vec3(0, 1, 0));
    t.world.set_gravity(Vec3::Zero());
    const JointId hook = t.world.add("hook", Ball::at(t.world, t.scale, t.stone, Vec3(3, 0, 0)));
    t.world.detach(hook);
    Simulator simulator(t.world);
    simulator.set_events(
        {{"take", AtTime{0.25}, {AttachJoint{hook, as_is ? Where::kAsIs : Where::kClosed}}}});
    if (!as_is) {
      ASSERT_TRUE(simulator.step(0.2).exact());
      for (int again = 0; again < 2; ++again) {
        const StepReport& report = simulator.step(0.1);
        EXPECT_EQ(report.status, Status::kContradiction);
        EXPECT_NE(report.message.find("take: ball hook cannot be attached, since it is open by 0.25 m"),
                  std::string::npos)
            << report.message;
        EXPECT_EQ(t.world.time(), 0.25);
        EXPECT_FALSE(t.world.is_attached(hook));
        EXPECT_TRUE(simulator.events_happened().empty());
      }
      continue;
    }
    ASSERT_TRUE(simulator.run_until(1, 0.1).exact());
    // The ball is where its anchor on A is; the stone's point there has come to rest.
    EXPECT_LT(simulator.report().gap.metres, 1e-10);
    const Vec3 point = t.world.joint(hook).reaction_point_B();
    EXPECT_NEAR((t.world.pose(t.stone).point(point) - Vec3(3, 0, 0)).norm(), 0, 1e-10);
    EXPECT_NEAR((point - Vec3(3, -0.25, 0)).norm(), 0, 1e-9);
  }
}

/// Each type of joint, open by an arbitrary pose, is closed where it is, with no turn about its free axes.
TEST(Events, ClosingFramesCloseJointsOfAllTypes) {
  World world;
  const BodyId a = world.add_body({.name = "a", .mass = MassProperties(1, Vec3(1, 1, 1))});
  const BodyId b =
      world.add_body({.name = "b", .mass = MassProperties(1, Vec3(1, 1, 1)), .pose = {.p = Vec3(1, 0, 0)}});
  const Vec3 p(0.4, 0.1, 0), axis(0, 0.6, 0.8);
  const JointId joints[] = {
      world.add("ball", Ball::at(world, a, b, p)),
      world.add("hinge", Hinge::at(world, a, b, p, axis)),
      world.add("slider", Slider::at(world, a, b, p, axis)),
      world.add("fixed", Fixed::at(world, a, b, p)),
      world.add("cylindrical", Cylindrical::at(world, a, b, p, axis)),
      world.add("universal", Universal::at(world, a, b, p, Vec3::UnitX(), Vec3::UnitY())),
      world.add("distance", Distance(a, b, Vec3(0.1, 0, 0), Vec3(0, 0.2, 0), 0.7)),
  };
  for (const JointId joint : joints) world.detach(joint);
  world.set_pose(b, {exp_so3(Vec3(0.3, -0.2, 0.5)), Vec3(1.3, 0.4, -0.2)});
  for (const JointId joint : joints) {
    SCOPED_TRACE(world.name(joint));
    EXPECT_GT(gap_of(world, joint).metres + gap_of(world, joint).radians, 0.05);
    world.set_joint_frame(joint, closing_frame(world, joint));
    const Gap closed = gap_of(world, joint);
    EXPECT_LT(closed.metres, 1e-11);
    EXPECT_LT(closed.radians, 1e-11);
    world.set_joint_frame(joint, {});  // as it was added
    EXPECT_GT(gap_of(world, joint).metres + gap_of(world, joint).radians, 0.05);
  }
}

/// A crane in small: take a load as it is, hoist, change gravity, drop the load at a height.
struct Crane {
  World world;
  BodyId trolley, load;
  JointId rail, hook;
  AxisId lift;
  std::vector<Event> events;
  explicit Crane(bool weld = false) {
    trolley = world.add_body(
        {.name = "trolley", .mass = MassProperties(5, Vec3(1, 1, 1)), .pose = {.p = Vec3(0, 0, 1)}});
    load = world.add_body(
        {.name = "load", .mass = MassProperties(3, Vec3(0.2, 0.3, 0.4)), .pose = {.p = Vec3(0.1, 0, 0.4)}});
    rail = world.add("rail", Slider::at(world, kGround, trolley, Vec3(0, 0, 1), Vec3::UnitZ()));
    const JointId pad = world.add("pad", Ball::at(world, kGround, load, Vec3(0.1, 0, 0.4)));
    hook = weld ? world.add("hook", Fixed::at(world, trolley, load, Vec3(0, 0, 0.8)))
                : world.add("hook", Hinge::at(world, trolley, load, Vec3(0, 0, 0.8), Vec3::UnitY()));
    world.detach(hook);
    lift = world.axis(rail, "displacement");
    world.set_motor(lift, AxisMotor{.target = 0, .max_force = 500});
    const Watch height = Watch::position(world, load, Vec3::Zero(), Vec3(Vec3::UnitZ()));
    events = {
        {"take", AtTime{0.1}, {AttachJoint{hook, Where::kAsIs}, DetachJoint{pad}}},
        {"hoist", AtTime{0.2}, {SetMotor{lift, 0.5, 300}}},
        {"gust",
         AtTime{0.31},
         {ApplyLoad{.body = load,
                    .p_BP = Vec3(0, 0, 0.1),
                    .force = Vec3(6, 1, 0),
                    .duration = 0.22,
                    .factor = gust_motion(1, 0, 0.22)}}},
        {"moon", AtTime{0.45}, {SetGravity{Vec3(0, 0, -1.6)}}},
        {"drop",
         WhenPasses{height, 0.6, Way::kRising},
         {DetachJoint{hook}, SetMotor{.axis = lift, .remove = true}}},
        {"end", WhenPasses{height, 0.3, Way::kFalling}, {EndRun{}}},
    };
  }
};

/// A run that goes on from a checkpoint, in a fresh world too, is the one that was not interrupted; what has
/// happened does not happen again.
TEST(Events, SurviveACheckpointToTheBit) {
  for (const bool weld : {false, true}) {
    Settings settings;
    settings.merge_fixed_joints = weld;
    Crane whole(weld);
    Simulator simulator(whole.world, settings);
    simulator.set_events(whole.events);
    std::vector<State> states;
    std::vector<Checkpoint> checkpoints;
    for (int i = 0; i < 100; ++i) {
      ASSERT_TRUE(simulator.step(0.02).exact()) << simulator.report().message;
      states.push_back(whole.world.state());
      checkpoints.push_back(simulator.checkpoint());
    }
    ASSERT_EQ(simulator.events_happened().size(), 6u);
    EXPECT_EQ(simulator.ended_by(), "end");
    for (std::size_t from = 4; from < checkpoints.size(); from += 5) {
      Crane other(weld);
      Simulator again(other.world, settings);
      again.set_events(other.events);
      again.restore(checkpoints[from]);
      for (std::size_t i = from + 1; i < states.size(); ++i) {
        ASSERT_TRUE(again.step(0.02).exact()) << again.report().message;
        ASSERT_TRUE(same_bits(other.world.state(), states[i])) << weld << ' ' << from << ' ' << i;
      }
      ASSERT_EQ(again.events_happened().size(), 6u);
      for (int k = 0; k < 6; ++k)
        EXPECT_EQ(again.events_happened()[k].time, simulator.events_happened()[k].time);
      EXPECT_EQ(other.world.gravity(), whole.world.gravity());
    }
    // Back in the same world: what events have set is taken back.
    simulator.restore(checkpoints[3]);
    EXPECT_EQ(whole.world.gravity(), Vec3(0, 0, -9.81));
    EXPECT_EQ(whole.world.axis_properties(whole.lift).motor->target, 0);
    EXPECT_TRUE(simulator.ended_by().empty());
    for (std::size_t i = 4; i < states.size(); ++i) {
      ASSERT_TRUE(simulator.step(0.02).exact()) << simulator.report().message;
      ASSERT_TRUE(same_bits(whole.world.state(), states[i])) << weld << ' ' << i;
    }
  }
}

TEST(Events, ACheckpointOfOtherEventsIsRefused) {
  Crane crane;
  Simulator simulator(crane.world);
  simulator.set_events(crane.events);
  ASSERT_TRUE(simulator.step(0.15).exact());
  const Checkpoint checkpoint = simulator.checkpoint();
  Crane other;
  Simulator none(other.world), fewer(other.world);
  other.events.pop_back();
  fewer.set_events(other.events);
  for (Simulator* it : {&none, &fewer})
    EXPECT_NE(refusal([&] { it->restore(checkpoint); }).find("other events"), std::string::npos);
  EXPECT_EQ(other.world.time(), 0);
}

/// A run of which nobody asks for checkpoints is the same, and a checkpoint of what was restored is that one.
TEST(Events, CheckpointsAreOnlyAsked) {
  for (const bool located : {false, true}) {
    Crane asked, other, restored;
    for (Crane* c : {&asked, &other, &restored})
      for (Event& event : c->events)
        if (WhenPasses* when = std::get_if<WhenPasses>(&event.when)) when->located = located;
    Simulator one(asked.world), two(other.world), three(restored.world);
    one.set_events(asked.events), two.set_events(other.events), three.set_events(restored.events);
    for (int i = 0; i < 100; ++i) {
      ASSERT_TRUE(one.step(0.02).exact());
      ASSERT_TRUE(two.step(0.02).exact());
      const Checkpoint checkpoint = one.checkpoint();
      ASSERT_TRUE(same_bits(asked.world.state(), other.world.state())) << located << i;
      three.restore(checkpoint);
      EXPECT_TRUE(three.checkpoint() == checkpoint) << i;
      EXPECT_EQ(restored.world.is_attached(restored.hook), asked.world.is_attached(asked.hook));
    }
    EXPECT_EQ(one.events_happened().size(), 6u);
  }
}

/// The same motion, with threads or without, and twice.
TEST(Events, TakeThemselvesBackFromTrials) {
  State first;
  for (const int threads : {1, 2, 1}) {
    Crane crane;
    Settings settings;
    settings.threads = threads;
    Simulator simulator(crane.world, settings);
    simulator.set_events(crane.events);
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(simulator.step(0.05).exact());
    if (first.poses.empty()) first = crane.world.state();
    EXPECT_TRUE(same_bits(crane.world.state(), first)) << threads;
  }
}

TEST(Events, ARunEndsWithTheEventThatEndsIt) {
  Thrown t;
  Simulator simulator(t.world);
  simulator.set_events({{"half", AtTime{0.55}, {EndRun{}}}});
  const RunReport run = simulator.run_until(2, 0.1);
  EXPECT_TRUE(run.ok());
  EXPECT_EQ(run.steps, 6);
  EXPECT_EQ(t.world.time(), 0.55);
  EXPECT_EQ(simulator.ended_by(), "half");
  EXPECT_EQ(simulator.run_until(1, 0.1).last.time, 1);  // whoever goes on may
}

/// A rod on a hinge, which a symplectic Euler method without a cure of drift opens by a little each step.
struct Drifting {
  World world;
  JointId pivot;
  Drifting() {
    const BodyId rod = world.add_body(
        {.name = "rod", .mass = MassProperties(10, Vec3(0.1, 0.9, 0.9)), .pose = {.p = Vec3(0.5, 0, 0)}});
    pivot = world.add("pivot", Hinge::at(world, kGround, rod, Vec3::Zero(), Vec3::UnitY()));
  }
  std::vector<Event> limits() const {
    const Watch gap = Watch::joint_gap(world, pivot);
    return {{"opens", WhenPasses{gap, 1e-3, Way::kRising}, {}},
            {"is lost", WhenPasses{gap, 1e-2, Way::kRising}, {DetachJoint{pivot}}}};
  }
};

/// An error limit: a gap is told of at first, and further on the joint is given up.
TEST(Events, ErrorLimitsWarnAndBreak) {
  Drifting d;
  Simulator simulator(d.world, {.integrator = Integrator::kForceEuler, .drift_cure = DriftCure::kNone});
  simulator.set_events(d.limits());
  double before = 0;
  while (simulator.events_happened().size() < 2 && d.world.time() < 20) {
    ASSERT_TRUE(simulator.step(0.01).ok());
    if (simulator.events_happened().empty()) before = simulator.report().gap.metres;
  }
  ASSERT_EQ(simulator.events_happened().size(), 2u);
  const EventRecord &warning = simulator.events_happened()[0], &loss = simulator.events_happened()[1];
  EXPECT_EQ(warning.name, "opens");
  EXPECT_EQ(warning.what, "");
  EXPECT_LT(before, 1e-3);
  EXPECT_NEAR(warning.value.value(), 1e-3, 1e-8);
  EXPECT_EQ(loss.what, "detach pivot");
  EXPECT_NEAR(loss.value.value(), 1e-2, 1e-7);
  EXPECT_LT(warning.time, loss.time);
  EXPECT_FALSE(d.world.is_attached(d.pivot));
}

TEST(Events, ErrorLimitsAreNotReachedByMethodsThatCloseJoints) {
  for (const Settings& settings : {Settings{}, Settings{.integrator = Integrator::kForceEuler,
                                               .drift_cure = DriftCure::kPositionPush}}) {
    Drifting d;
    Simulator simulator(d.world, settings);
    simulator.set_events(d.limits());
    ASSERT_TRUE(simulator.run_until(5, 0.01).ok());
    EXPECT_TRUE(simulator.events_happened().empty());
    EXPECT_TRUE(d.world.is_attached(d.pivot));
  }
}

TEST(Events, BadOnesAreRefusedByName) {
  Crane c;
  Simulator simulator(c.world);
  const auto told = [&](Event event) { return refusal([&] { simulator.set_events({std::move(event)}); }); };
  const double nan = std::nan("");
  const Watch watch = Watch::axis(c.world, c.lift);
  EXPECT_EQ(told({"", AtTime{1}, {EndRun{}}}), "event: must have a name (value: )");
  EXPECT_EQ(told({"x", AtTime{nan}, {EndRun{}}}), "event x: time: must be finite (value: nan)");
  EXPECT_EQ(told({"x", AtTime{1}, {}}), "event x: must do something (value: no action)");
  EXPECT_EQ(told({"x", WhenPasses{watch, nan}, {EndRun{}}}),
            "event x: threshold: must be finite (value: nan)");
  EXPECT_EQ(told({"x", WhenPasses{{}, 1}, {EndRun{}}}),
            "event x: watch: must be callable (value: empty function)");
  EXPECT_EQ(told({"x", AtTime{1}, {SetMotor{c.world.axis(c.hook, "angle"), 1}}}),
            "event x: motor of hook angle: is not there (value: none)");
  EXPECT_NE(told({"x", AtTime{1}, {SetMotor{c.lift}}}).find("needs a target"), std::string::npos);
  EXPECT_NE(told({"x", AtTime{1}, {SetMotor{c.lift, nan}}}).find("motor of rail displacement"),
            std::string::npos);
  EXPECT_NE(told({"x", AtTime{1}, {DetachJoint{{77}}}}).find("77"), std::string::npos);
  EXPECT_NE(told({"x", AtTime{1}, {AttachJoint{c.hook, Where::kClosed, -1}}}).find("tolerance"),
            std::string::npos);
  EXPECT_NE(told({"x", AtTime{1}, {ApplyLoad{.body = c.load, .duration = 0}}}).find("load on load: duration"),
            std::string::npos);
  EXPECT_NE(refusal([&] {
              simulator.set_events({{"x", AtTime{1}, {EndRun{}}}, {"x", AtTime{2}, {EndRun{}}}});
            }).find("already taken"),
            std::string::npos);
}

}  // namespace
}  // namespace taut::events_test
