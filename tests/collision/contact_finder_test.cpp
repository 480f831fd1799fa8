#include "collision/contact_finder.h"

#include <cstring>
#include <map>
#include <numbers>

#include "core/joints/joints.h"
#include "tests/allocation_counter.h"
#include "tests/collision/narrow/pair_of_shapes.h"
#include "tests/core/expect_invalid.h"

namespace taut::contact_finder_test {
namespace {

using testing::convex_shapes;
using testing::expect_invalid;
using testing::Random;

/// Bodies of all kinds in a cube, dense enough that each touches some.
World heap(int count, double edge, unsigned seed) {
  Random random(seed);
  World world;
  const auto shapes = convex_shapes();
  for (int i = 0; i < count; ++i) {
    const Quat q = random.rotation();
    const BodyId body = world.add_body({.pose = {q, random.vector(edge / 2)}, .twist = random.twist()});
    world.add_shape(body, shapes[static_cast<std::size_t>(i) % shapes.size()]);
  }
  world.add_shape(kGround, HalfSpace{}, {Quat::Identity(), Vec3(0, 0, -edge / 2)});
  return world;
}

void expect_same_bits(const std::vector<Contact>& x, const std::vector<Contact>& y) {
  ASSERT_EQ(x.size(), y.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_EQ(x[i].a, y[i].a);
    EXPECT_EQ(x[i].b, y[i].b);
    EXPECT_EQ(x[i].feature, y[i].feature);
    EXPECT_EQ(std::memcmp(&x[i].gap, &y[i].gap, sizeof(double)), 0);
    EXPECT_EQ(x[i].p_AP, y[i].p_AP);
    EXPECT_EQ(x[i].p_BQ, y[i].p_BQ);
    EXPECT_EQ(x[i].normal, y[i].normal);
  }
}

TEST(ContactFinder, FindsWhatTryingAllPairsFinds) {
  // The oracle asks a fresh finder about each pair alone.  1000 shapes: 499,500 pairs, those with distant
  // centres left out by their bounding spheres, of radius 0.62 m at most.
  World world = heap(1000, 7, 21);
  ContactFinder finder({.margin = 0.02});
  Random random(22);
  for (int round = 0; round < 2; ++round) {
    std::map<std::pair<int, int>, std::vector<Contact>> found;
    for (const Contact& c : finder.find(world)) found[{c.a.index, c.b.index}].push_back(c);
    std::size_t touching = 0;
    for (int i = 0; i < 1000; ++i)
      for (int j = i + 1; j < 1001; ++j) {
        const bool ground = j == 1000;
        const Pose &X_A = world.pose({i + 1}), X_B = ground ? Pose{} : world.pose({j + 1});
        if (!ground && (X_A.p - X_B.p).norm() > 1.3) continue;
        if (ground && X_A.p.z() > -3.5 + 0.7) continue;
        World pair;
        pair.add_shape(pair.add_body({.pose = X_A}), world.shape({i}).shape);
        const BodyId second = ground ? kGround : pair.add_body({.pose = X_B});
        pair.add_shape(second, world.shape({j}).shape, world.shape({j}).pose);
        ContactFinder alone({.margin = 0.02, .threads = 1});
        const auto& expected = alone.find(pair);
        const auto& got = found[{i, j}];
        ASSERT_EQ(got.size(), expected.size()) << i << " " << j;
        for (std::size_t k = 0; k < got.size() && round == 0; ++k) {
          // The World normalises quaternions, which moves their last bit.
          EXPECT_NEAR(got[k].gap, expected[k].gap, 1e-11);
          EXPECT_LT((got[k].normal - expected[k].normal).norm(), 1e-5);
        }
        touching += !expected.empty();
      }
    EXPECT_GT(touching, 1000u);
    EXPECT_EQ(finder.report().touching_pairs, static_cast<int>(touching));
    EXPECT_FALSE(finder.report().blind());
    // Far enough that many boxes of the tree are left, near enough that some are not.
    for (int i = 1; i <= 1000; ++i)
      world.set_pose({i}, testing::moved(world.pose({i}), random.vector(0.1), random.vector(0.1)));
  }
}

TEST(ContactFinder, SameBitsWithAnyNumberOfThreads) {
  World world = heap(600, 5, 23);
  ContactFinder one({.threads = 1}), two({.threads = 2}), four({.threads = 4}), all;
  Random random(24);
  for (int step = 0; step < 5; ++step) {
    const auto& expected = one.find(world, 0.01);
    ASSERT_GT(expected.size(), 1000u);
    expect_same_bits(two.find(world, 0.01), expected);
    expect_same_bits(four.find(world, 0.01), expected);
    expect_same_bits(all.find(world, 0.01), expected);
    for (int i = 1; i <= 600; ++i)
      world.set_pose({i}, testing::moved(world.pose({i}), random.vector(0.02), random.vector(0.02)));
  }
}

TEST(ContactFinder, HistoryChangesNothingButFeatures) {
  World world = heap(300, 4, 25);
  ContactFinder old({.threads = 1});
  Random random(26);
  for (int step = 0; step < 20; ++step) {
    old.find(world);
    for (int i = 1; i <= 300; ++i)
      world.set_pose({i}, testing::moved(world.pose({i}), random.vector(0.05), random.vector(0.05)));
  }
  ContactFinder fresh({.threads = 1});
  const auto key = [](const Contact& x, const Contact& y) {
    return std::tuple(x.a, x.b, x.gap, x.p_AP.x()) < std::tuple(y.a, y.b, y.gap, y.p_AP.x());
  };
  auto x = old.find(world), y = fresh.find(world);
  std::sort(x.begin(), x.end(), key), std::sort(y.begin(), y.end(), key);
  for (Contact& c : x) c.feature = 0;
  for (Contact& c : y) c.feature = 0;
  expect_same_bits(x, y);
}

TEST(ContactFinder, ContactsAreThereBeforeTheTouchAndWithinTheMarginOnly) {
  for (const Shape& shape : convex_shapes()) {
    World world;
    const BodyId ball = world.add_body({});
    world.add_shape(ball, Sphere{0.1});
    world.add_shape(world.add_body({}), shape);
    ContactFinder finder({.margin = 0.01, .threads = 1});
    const Vec3 edge = testing::support_point(shape, Vec3(1, 0, 0)) + Vec3(0.1, 0, 0);
    world.set_pose(ball, {Quat::Identity(), edge + Vec3(0.00999, 0, 0)});
    EXPECT_FALSE(finder.find(world).empty()) << shape_name(shape);
    world.set_pose(ball, {Quat::Identity(), edge + Vec3(0.01001, 0, 0)});
    EXPECT_TRUE(finder.find(world).empty()) << shape_name(shape);
  }
}

TEST(ContactFinder, NothingFastAndThinPassesThrough) {
  // Moved by whole steps of 1/60 s at 200 m/s, 3.3 m a step, a contact must be there before a plate of 1 mm
  // is behind, with gap + h n·v_rel < 0 if it would be passed within the step.
  Random random(27);
  const double h = 1.0 / 60;
  for (const Shape& bullet : convex_shapes())
    for (const Shape& plate : {Shape(Box{Vec3(8, 8, 1e-3)}), Shape(HalfSpace{}), Shape(Cylinder{5, 1e-3})})
      for (int trial = 0; trial < 20; ++trial) {
        World world;
        Twist V = {random.vector(30), Vec3(random.uniform(-30, 30), random.uniform(-30, 30), -200)};
        const double start = random.uniform(1, 1 + 200 * h);
        const BodyId body = world.add_body({.pose = {random.rotation(), Vec3(0, 0, start)}, .twist = V});
        world.add_shape(body, bullet);
        world.add_shape(kGround, plate);
        ContactFinder finder({.threads = 1});
        bool stopped = false;
        for (int step = 0; step < 3 && !stopped; ++step) {
          for (const Contact& c : finder.find(world, h)) {
            const Vec3 v_P = c.A == body ? V.at(world.pose(body).q * c.p_AP) : Vec3(Vec3::Zero());
            const Vec3 v_Q = c.B == body ? V.at(world.pose(body).q * c.p_BQ) : Vec3(Vec3::Zero());
            stopped |= c.gap + h * c.normal.dot(v_Q - v_P) < 0;
          }
          world.set_pose(body, testing::moved(world.pose(body), h * V.w, h * V.v));
        }
        EXPECT_TRUE(stopped) << shape_name(bullet) << " " << shape_name(plate);
      }
}

TEST(ContactFinder, JointedBodiesIgnoreEachOtherUnlessAsked) {
  World world;
  const BodyId a = world.add_body({}), b = world.add_body({.pose = {Quat::Identity(), Vec3(0.1, 0, 0)}});
  world.add_shape(a, Sphere{0.1});
  world.add_shape(b, Sphere{0.1});
  ContactFinder finder({.threads = 1});
  EXPECT_EQ(finder.find(world).size(), 1u);
  world.add("pin", Ball::at(world, a, b, Vec3::Zero()));
  EXPECT_EQ(finder.find(world).size(), 0u);
  world.set_collision(b, a, true);
  EXPECT_EQ(finder.find(world).size(), 1u);
  world.set_collision(a, b, false);
  EXPECT_EQ(finder.find(world).size(), 0u);
}

TEST(ContactFinder, GroupsAndMasksDecideTogether) {
  const auto count = [](CollisionFilter x, CollisionFilter y) {
    World world;
    world.add_shape(world.add_body({}), Sphere{0.1}, {}, {}, x);
    world.add_shape(world.add_body({}), Sphere{0.1}, {}, {}, y);
    return ContactFinder({.threads = 1}).find(world).size();
  };
  EXPECT_EQ(count({1, ~0u}, {1, ~0u}), 1u);
  EXPECT_EQ(count({1, ~1u}, {1, ~0u}), 0u);
  EXPECT_EQ(count({1, ~0u}, {2, 4}), 0u);
  EXPECT_EQ(count({4, 2}, {2, 4}), 1u);
}

TEST(ContactFinder, CompoundsAndFixedBodies) {
  World world;
  const BodyId dumbbell = world.add_body({.pose = {Quat::Identity(), Vec3(0, 0, 0.1)}});
  world.add_shape(dumbbell, Sphere{0.1}, {Quat::Identity(), Vec3(1, 0, 0)});
  world.add_shape(dumbbell, Sphere{0.1}, {Quat::Identity(), Vec3(-1, 0, 0)});
  world.add_shape(dumbbell, Box{Vec3(3, 3, 0.01)});  // parts of one body do not touch
  world.add_shape(kGround, HalfSpace{});
  const BodyId post = world.add_body({.fixed = true});
  world.add_shape(post, Box{Vec3(0.1, 0.1, 0.1)});  // nor do fixed bodies and the ground
  const BodyId far = world.add_body({.pose = {Quat::Identity(), Vec3(10, 0, 9)}});
  world.add_shape(far, Sphere{0.1});
  ContactFinder finder({.threads = 1});
  const auto& contacts = finder.find(world);
  ASSERT_EQ(contacts.size(), 2u);
  EXPECT_NEAR(contacts[0].p_AP.x(), 1, 1e-15);
  EXPECT_NEAR(contacts[1].p_AP.x(), -1, 1e-15);
  // A fixed body that was moved is found where it is now, and a shape that was added is, too.
  world.set_pose(post, {Quat::Identity(), Vec3(10, 0, 9.14)});
  EXPECT_EQ(finder.find(world).size(), 3u);
  world.add_shape(far, Sphere{0.1}, {Quat::Identity(), Vec3(0, 0, -8.9)});
  EXPECT_EQ(finder.find(world).size(), 4u);
}

TEST(ContactFinder, FeaturesStayWhileABallRollsAndABoxSlides) {
  World world;
  const BodyId ball = world.add_body({.pose = {Quat::Identity(), Vec3(0, 0, 0.1)}});
  const BodyId box = world.add_body({.pose = {exp_so3(Vec3(0, 0, 0.3)), Vec3(0, 2, 0.25)}});
  world.add_shape(ball, Sphere{0.1});
  world.add_shape(box, Box{Vec3(0.5, 0.5, 0.5)});
  world.add_shape(kGround, HeightField{81, 81, 0.1, 0.1, std::vector<double>(81 * 81, 0.0)});
  ContactFinder finder({.threads = 1});
  auto last = finder.find(world);
  ASSERT_EQ(last.size(), 5u);
  for (int step = 0; step < 500; ++step) {
    world.set_pose(ball, testing::moved(world.pose(ball), Vec3(0, 0.01, 0), Vec3(0.001, 0, 0)));
    world.set_pose(box, testing::moved(world.pose(box), Vec3::Zero(), Vec3(0.001, 0.0003, 0)));
    const auto now = finder.find(world);
    ASSERT_EQ(now.size(), 5u) << step;
    for (std::size_t i = 0; i < 5; ++i) ASSERT_EQ(now[i].feature, last[i].feature) << step;
    last = now;
  }
}

TEST(ContactFinder, SaysWhichPairsItCannotDo) {
  TriangleMesh triangle{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, {{0, 1, 2}}};
  World world;
  world.add_shape(world.add_body({}), triangle);
  world.add_shape(world.add_body({}), triangle);
  world.add_shape(world.add_body({.pose = {Quat::Identity(), Vec3(9, 9, 9)}}), triangle);
  ContactFinder finder({.threads = 1});
  EXPECT_TRUE(finder.find(world).empty());
  ASSERT_EQ(finder.report().unsupported.size(), 1u);
  EXPECT_EQ(finder.report().unsupported[0], std::pair(ShapeId{0}, ShapeId{1}));
}

TEST(ContactFinder, BadInput) {
  expect_invalid([] { ContactFinder({.margin = -1}); }, {"contact margin", "-1"});
  expect_invalid([] { ContactFinder({.margin = std::nan("")}); }, {"contact margin", "nan"});
  expect_invalid([] { ContactFinder({.threads = -2}); }, {"contact threads", "-2"});
  expect_invalid([] { ContactFinder({.max_points = 3}); }, {"max_points", "3"});
  World world;
  ContactFinder finder;
  expect_invalid([&] { finder.find(world, -0.1); }, {"horizon", "-0.1"});
  expect_invalid([&] { finder.find(world, State{}); }, {"state", "pose"});
  EXPECT_TRUE(finder.find(world).empty());
}

TEST(ContactFinder, ASettledHeapAllocatesNothing) {
  World world = heap(300, 4, 28);
  ContactFinder finder({.threads = 1});  // another one allocates when it first gets work
  for (int i = 0; i < 3; ++i) finder.find(world, 0.001);
  const long before = allocation_count();
  finder.find(world, 0.001);
  EXPECT_EQ(allocation_count(), before);
  EXPECT_GT(finder.report().candidate_pairs, 1000);
}

}  // namespace
}  // namespace taut::contact_finder_test
