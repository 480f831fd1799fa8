#include <atomic>
#include <cmath>
#include <limits>
#include <random>
#include <system_error>

#include "collision/contact_finder.h"
#include "core/base/thread_pool.h"
#include "tests/core/expect_invalid.h"

namespace taut::robust_collision_test {
namespace {

using testing::expect_invalid;

/// Starts `possible` threads, then fails as the system does where a limit is reached.
detail::ThreadStarter starts(int possible) {
  return [possible, started = std::make_shared<int>(0)](std::function<void()> work) {
    if (++*started > possible)
      throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again));
    return detail::start_thread(std::move(work));
  };
}

TEST(RobustThreads, PoolGoesOnWithThoseThatCouldBeStarted) {
  for (const int possible : {0, 1, 3}) {
    detail::ThreadPool pool(64, starts(possible));
    EXPECT_EQ(pool.size(), possible + 1);
    EXPECT_EQ(pool.missing(), 63 - possible);
    std::vector<std::atomic<int>> done(1000);
    pool.run(1000, [&](int task, int worker) {
      EXPECT_LE(worker, possible);
      ++done[task];
    });
    for (const auto& count : done) EXPECT_EQ(count, 1);
  }
}

TEST(RobustThreads, PoolThatIsNotMadeToItsEndEndsItsThreads) {
  const auto fails = [started = 0](std::function<void()> work) mutable {
    if (++started > 3) throw std::bad_alloc();
    return detail::start_thread(std::move(work));
  };
  EXPECT_THROW(detail::ThreadPool(8, fails), std::bad_alloc);
}

TEST(RobustThreads, TheirNumberIsBounded) {
  expect_invalid([] { ContactFinder({.threads = 1000000}); }, {"contact threads", "1024", "1000000"});
  expect_invalid([] { ContactFinder({.threads = -1}); }, {"contact threads", "-1"});
}

/// Bodies in one place.
World heap(int count, const Shape& shape) {
  World world;
  const auto shared = std::make_shared<const Shape>(shape);
  for (int i = 0; i < count; ++i) world.add_shape(world.add_body({}), shared);
  return world;
}

TEST(RobustCrowd, BodiesInOnePlaceAreToldInsteadOfSearched) {
  struct Case {
    int count;
    Shape shape;
  };
  for (const auto& [count, shape] : {Case{300, Sphere{0.1}}, Case{200, Box{Vec3(0.1, 0.2, 0.3)}},
                                     Case{3000, Box{Vec3(0.1, 0.2, 0.3)}}, Case{100000, Sphere{0.1}}}) {
    const World world = heap(count, shape);
    ContactFinder finder;
    EXPECT_TRUE(finder.find(world).empty());
    // Of contacts, or of pairs of boxes where there are too many of these already.
    EXPECT_EQ(finder.report().crowd.most, (10000 + 50 * count) * (count < 1000 ? 1 : 4));
    EXPECT_EQ(finder.report().crowd.shapes.size(), 4u);
    EXPECT_TRUE(finder.report().blind());
    // All pairs of the last would be 5e9.
    EXPECT_LE(finder.report().candidate_pairs, 4 * (10000 + 50 * count) + 1) << count;
  }
}

TEST(RobustCrowd, TheLimitCanBeSetAndIsOfPairsAndOfContacts) {
  const World balls = heap(20, Sphere{0.1});  // 190 pairs and contacts
  EXPECT_EQ(ContactFinder({.max_contacts = 190}).find(balls).size(), 190u);
  EXPECT_EQ(ContactFinder({.max_contacts = 189}).find(balls).size(), 0u);
  World boxes;  // two that lie on each other have four contacts
  for (const double z : {0.0, 1.0})
    boxes.add_shape(boxes.add_body({.pose = {Quat::Identity(), Vec3(0, 0, z)}}), Box{Vec3(1, 1, 1)});
  EXPECT_EQ(ContactFinder({.max_contacts = 4}).find(boxes).size(), 4u);
  ContactFinder finder({.max_contacts = 3});
  EXPECT_EQ(finder.find(boxes).size(), 0u);
  EXPECT_EQ(finder.report().candidate_pairs, 1);
  EXPECT_EQ(finder.report().crowd.shapes.size(), 2u);
  expect_invalid([] { ContactFinder({.max_contacts = -1}); }, {"max_contacts", "-1"});
}

TEST(RobustCrowd, FastBodiesOfAHeapAreNone) {
  // A lattice of boxes that falls apart: boxes on their way overlap with some 80 others in a step of 1/60 s.
  World world;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 p = 0.4 * Vec3(i % 10, i / 10 % 10, i / 100);
    const BodyId body = world.add_body(
        {.pose = {Quat::Identity(), p}, .twist = {Vec3::Zero(), Vec3(10, i % 3 * 10 - 10, i % 2 * 20 - 10)}});
    world.add_shape(body, Box{Vec3(0.39, 0.39, 0.39)});
  }
  ContactFinder finder;
  EXPECT_FALSE(finder.find(world, 1.0 / 60).empty());
  EXPECT_GT(finder.report().candidate_pairs, 30 * 1000);
  EXPECT_FALSE(finder.report().blind());
  std::cout << finder.report().candidate_pairs << " pairs, " << finder.contacts().size() << " contacts\n";
}

TEST(RobustCrowd, AFinderSeesAgainWhenTheCrowdHasLeft) {
  World world = heap(300, Sphere{0.1});
  ContactFinder finder;
  EXPECT_TRUE(finder.find(world).empty());
  State state = world.state();
  for (int b = 1; b < world.body_count(); ++b) state.poses[b].p.x() = 0.2 * b;
  EXPECT_EQ(finder.find(world, state).size(), 299u);
  EXPECT_FALSE(finder.report().blind());
  EXPECT_TRUE(finder.report().crowd.empty());
}

TEST(RobustReach, StatesThatAreNotAnywhereAreToldByName) {
  World world = heap(3, Sphere{0.1});
  ContactFinder finder;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinity, -infinity, 1e155, 1e300, -1e80}) {
    State state = world.state();
    state.poses[2].p.y() = bad;
    EXPECT_TRUE(finder.find(world, state).empty());
    EXPECT_EQ(finder.report().out_of_reach.index, 1) << bad;
    state = world.state();
    state.twists[3].v.z() = bad;
    EXPECT_TRUE(finder.find(world, state, 1).empty());
    EXPECT_EQ(finder.report().out_of_reach.index, 2) << bad;
    state = world.state();
    state.poses[1].q.x() = bad;
    if (!std::isfinite(bad)) {
      EXPECT_TRUE(finder.find(world, state).empty());
      EXPECT_EQ(finder.report().out_of_reach.index, 0) << bad;
    }
  }
  EXPECT_EQ(finder.find(world).size(), 3u);
  EXPECT_FALSE(finder.report().blind());
}

/// Numbers of any size, most of them such that shapes meet.
class Numbers {
 public:
  explicit Numbers(unsigned seed) : random_(seed) {}
  double any() {
    const double size = sized();
    return random_() % 2 ? size : -size;
  }
  double sized() {
    static constexpr double kSizes[] = {0,    4.9e-324, 1e-310, 1e-300, 1e-160, 1e-100, 1e-30, 1e-12,
                                        1e-3, 0.1,      1,      10,     1e6,    1e12,   1e29,  1e30};
    if (random_() % 3) return std::uniform_real_distribution<>(0, 2)(random_);
    return kSizes[random_() % std::size(kSizes)];
  }
  Vec3 vector() { return {any(), any(), any()}; }
  Quat turn() {
    Quat q(any(), any(), any(), any());
    return q.norm() > 1e-10 && std::isfinite(q.norm()) ? q.normalized() : Quat::Identity();
  }
  Shape shape() {
    const auto size = [this] { return sized(); };
    switch (random_() % 9) {
      case 0:
        return Sphere{size()};
      case 1:
        return Box{{size(), size(), size()}};
      case 2:
        return Capsule{size(), size()};
      case 3:
        return Cylinder{size(), size()};
      case 4:
        return Ellipsoid{{size(), size(), size()}};
      case 5:
        return Cone{size(), size()};
      case 6:
        return ConvexHull{{vector(), vector(), vector(), vector(), vector(), vector()}};
      case 7:
        return TriangleMesh{{vector(), vector(), vector(), vector()}, {{0, 1, 2}, {0, 2, 3}}};
      default:
        return HalfSpace{};
    }
  }
  double margin() { return random_() % 2 ? 0.005 : sized(); }
  double horizon() { return random_() % 2 ? 0.01 : sized(); }

 private:
  std::mt19937 random_;
};

TEST(RobustReach, AnyNumbersGiveFiniteContactsOrAReason) {
  long pairs = 0, contacts = 0, refused = 0;
  for (unsigned seed = 0; seed < 20000; ++seed) {
    Numbers numbers(seed);
    World world;
    for (int i = 0; i < 4; ++i) {
      try {
        const BodyId body = world.add_body(
            {.pose = {numbers.turn(), numbers.vector()}, .twist = {numbers.vector(), numbers.vector()}});
        world.add_shape(body, numbers.shape(), {numbers.turn(), numbers.vector()});
      } catch (const std::invalid_argument&) {
        ++refused;
      }
    }
    ContactFinder finder({.margin = numbers.margin(), .threads = 1});
    for (const Contact& c : finder.find(world, numbers.horizon())) {
      ++contacts;
      EXPECT_TRUE(std::isfinite(c.gap) && c.normal.allFinite() && c.p_AP.allFinite() && c.p_BQ.allFinite())
          << "seed " << seed << ", " << shape_name(*world.shape(c.a).shape) << " and "
          << shape_name(*world.shape(c.b).shape) << ", gap " << c.gap << ", normal " << c.normal.transpose()
          << ", P " << c.p_AP.transpose() << ", Q " << c.p_BQ.transpose();
      EXPECT_NEAR(c.normal.norm(), 1, 1e-6) << "seed " << seed << ", " << shape_name(*world.shape(c.a).shape)
                                            << " and " << shape_name(*world.shape(c.b).shape);
      if (::testing::Test::HasFailure()) return;
    }
    pairs += finder.report().candidate_pairs;
  }
  std::cout << pairs << " pairs, " << contacts << " contacts, " << refused << " refused\n";
  EXPECT_GT(pairs, 1000);
  EXPECT_GT(contacts, 100);
}

TEST(RobustPairs, WhatHasNoContactIsAskedOfTheShapes) {
  const Shape mesh = TriangleMesh{}, field = HeightField{}, ground = HalfSpace{};
  for (const Shape& convex : {Shape(Sphere{1}), Shape(Box{}), Shape(Capsule{}), Shape(Cylinder{}),
                              Shape(Ellipsoid{}), Shape(Cone{}), Shape(ConvexHull{})})
    for (const Shape& other : {mesh, field, ground, convex}) {
      EXPECT_TRUE(have_contacts(convex, other));
      EXPECT_TRUE(have_contacts(other, convex));
    }
  EXPECT_TRUE(have_contacts(mesh, ground));
  EXPECT_TRUE(have_contacts(ground, mesh));
  for (const auto& [a, b] : {std::pair(mesh, mesh), std::pair(mesh, field), std::pair(field, field),
                             std::pair(field, ground), std::pair(ground, ground)}) {
    EXPECT_FALSE(have_contacts(a, b));
    EXPECT_FALSE(have_contacts(b, a));
  }
}

}  // namespace
}  // namespace taut::robust_collision_test
