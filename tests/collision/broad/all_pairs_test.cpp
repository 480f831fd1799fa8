#include <cmath>
#include <numbers>

#include "solvers/simulator/simulator.h"
#include "tests/collision/narrow/pair_of_shapes.h"

/// Gaps of all pairs of convex shapes, as steps report them, against a search over directions that
/// knows nothing of contacts.
namespace taut::all_pairs_test {
namespace {

using testing::convex_shapes;
using testing::Random;
using testing::support_point;

struct Placed {
  const Shape& shape;
  Pose pose;
  double reach(const Vec3& n) const {
    return n.dot(pose.p + pose.q * support_point(shape, pose.q.conjugate() * n));
  }
};

/// How far B is beyond A along n.  Two convex bodies are apart by the largest of all n, or in each other by
/// it.
double apart(const Placed& A, const Placed& B, const Vec3& n) { return -B.reach(-n) - A.reach(n); }

/// The largest near n, by ever smaller circles about the best.
double climb(const Placed& A, const Placed& B, Vec3 n) {
  double best = apart(A, B, n);
  for (double size = 0.3; size > 1e-9;) {
    Vec3 u, v;
    complete_frame(n, u, v);
    bool better = false;
    for (int k = 0; k < 16; ++k) {
      const double angle = k * std::numbers::pi / 8;
      const Vec3 m = (n + size * (std::cos(angle) * u + std::sin(angle) * v)).normalized();
      if (const double there = apart(A, B, m); there > best) best = there, n = m, better = true;
    }
    if (!better) size *= 0.6;
  }
  return best;
}

/// From a direction that is told, and from those of a coarse net: a lower bound of the gap, and nearly always
/// it.
double searched_gap(const Placed& A, const Placed& B, const Vec3& told) {
  double best = climb(A, B, told);
  constexpr int kDirections = 200, kStarts = 3;
  std::vector<std::pair<double, Vec3>> net;
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1 - (2 * i + 1.0) / kDirections, r = std::sqrt(1 - z * z), golden = 2.399963229728653;
    const Vec3 n(r * std::cos(golden * i), r * std::sin(golden * i), z);
    net.emplace_back(apart(A, B, n), n);
  }
  std::sort(net.begin(), net.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  for (int i = 0; i < kStarts; ++i) best = std::max(best, climb(A, B, net[i].second));
  return best;
}

/// Bodies without weight that tumble against each other: after each step the least gap that
/// Simulator::contacts() tells is that of the shapes where they are.
TEST(AllPairs, ContactsOfASimulatorAreWhereTheBodiesAre) {
  Random random(52);
  const auto shapes = convex_shapes();
  int compared = 0;
  for (const Shape& a : shapes)
    for (const Shape& b : shapes) {
      const Vec3 n = random.unit();
      const Pose X_A = random.pose();
      const Quat q = random.rotation();
      const Placed A{a, X_A};
      const Vec3 p =
          X_A.p + (A.reach(n) - n.dot(X_A.p) + 0.004 - n.dot(q * support_point(b, -(q.conjugate() * n)))) * n;
      testing::ShapePair pair(a, X_A, b, {q, p});
      pair.world.set_gravity(Vec3(0, 0, 0));
      pair.world.set_twist(pair.A, {random.vector(2), n});
      pair.world.set_twist(pair.B, {random.vector(2), -n});
      Simulator simulator(pair.world);
      for (int step = 0; step < 10; ++step) {
        const StepReport& report = simulator.step(4e-3);
        ASSERT_TRUE(report.ok()) << report.message;
        const Contact* nearest = nullptr;
        const auto reports = simulator.contacts();
        for (const ContactReport& it : reports)
          if (!nearest || it.contact.gap < nearest->gap) nearest = &it.contact;
        if (!nearest || nearest->gap > 0.005) continue;
        const double gap =
            searched_gap({a, pair.world.pose(pair.A)}, {b, pair.world.pose(pair.B)}, nearest->normal);
        EXPECT_NEAR(nearest->gap, gap, 1e-7) << shape_name(a) << " " << shape_name(b) << " step " << step;
        ++compared;
      }
    }
  EXPECT_GT(compared, 100);
}

}  // namespace
}  // namespace taut::all_pairs_test
