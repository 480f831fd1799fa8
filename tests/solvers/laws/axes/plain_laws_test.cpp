#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "solvers/laws/axes/axis_bound_law.h"
#include "solvers/laws/axes/axis_limit_law.h"
#include "solvers/laws/axes/axis_smooth_law.h"

/// Laws of properties that are in their headers, with made-up properties that no list has, along an axis of
/// mass m by itself, in the stages of RATTLE and Moreau–Jean.
namespace taut::plain_laws_test {
namespace {

/// U = k (1 − cos θ), with air whose drag has a part that depends on the place.
struct Swing {
  double k = 0, c = 0;
  bool stores_energy() const { return true; }
  double energy(double theta) const { return k * (1 - std::cos(theta)); }
  double force(double theta, double rate) const {
    return -k * std::sin(theta) - drag(theta) * rate * rate * rate;
  }
  double rate_slope(double theta, double rate) const { return -3 * drag(theta) * rate * rate; }
  double place_slope(double theta, double rate) const {
    return -k * std::cos(theta) - c * std::sin(2 * theta) * rate * rate * rate;
  }

 private:
  double drag(double theta) const { return c * (1 + std::sin(theta) * std::sin(theta)); }
};

/// A belt that carries along with a bounded force.
struct Belt {
  double most = 0, speed = 0;
  double bound(double theta) const { return most * (1 + 0.1 * std::tanh(theta)); }
  double kept_rate() const { return speed; }
};

static_assert(SmoothAxisProperty<Swing> && StoringAxisProperty<Swing> && !BoundedAxisProperty<Swing>);
static_assert(BoundedAxisProperty<Belt> && !SmoothAxisProperty<Belt> && PlainAxisProperty<Belt>);

/// Where the law finds it, in place of a member of AxisProperties, and says what it gives.
template <typename Property>
struct MadeUp {
  static inline std::optional<Property> property;
  static const std::optional<Property>& get(const AxisProperties&) { return property; }
  static constexpr double AxisImpulse::*kPart = &AxisImpulse::spring;
};

/// One axis with a law.
template <typename Law>
struct Axis {
  double m = 2, theta = 0, rate = 0;
  Law law{};
  AxisProperties none{};
  AxisImpact impact{};
  AxisReport works{};  // of both kicks
  int solves = 0;

  /// Solves a stage, w = `before` + λ/m, and adds its work at the mean of the rates.
  double solve(const AxisStep& step, const AxisStart& start, double before, auto set, auto mean_rate) {
    for (int again = 0;; ++again) {
      set();
      RowLaw row;
      law.add_to(row, none);
      const RowLaw::Point at = row.resolve(1 / m, before);
      ++solves;
      if (again < 100 && law.move(none, step, start, at.w, 1e-12)) continue;
      EXPECT_LT(again, 100);
      AxisImpulse impulse;
      double rest = at.lambda;
      law.split_lines(impulse, rest, at.w);
      law.split_beside(impulse, rest, at.w);
      law.split_on_step(impulse, rest, at.w);
      EXPECT_NEAR(rest, 0, 1e-11 * (1 + std::abs(at.lambda)));
      works.work.spring += impulse.spring * mean_rate(at.w);
      works.work.damping += impulse.damping * mean_rate(at.w);
      return at.w;
    }
  }
  void rattle(double h) {
    AxisStep step{.h = h};
    const AxisStart start{.theta = theta, .rate = rate, .effective_mass = m};
    AxisImpulse none_yet;
    AxisStage stage{none, step, start, impact, none_yet};
    law.begin(none, step, start);
    const double w = solve(
        step, start, rate, [&] { EXPECT_TRUE(law.set(stage)); },
        [&](double at) { return 0.5 * (rate + at); });
    theta += h * w;
    law.finish_first_kick(none, start, w);
    step.kick = Kick::kSecond;
    stage.theta = theta;
    rate = solve(
        step, start, w, [&] { EXPECT_TRUE(law.set(stage)); }, [&](double at) { return 0.5 * (w + at); });
  }
  void moreau_jean(double h, double weight) {
    const AxisStep step{.h = h, .kick = Kick::kSingle, .vartheta = weight};
    const AxisStart start{.theta = theta, .rate = rate, .effective_mass = m};
    AxisImpulse none_yet;
    AxisStage stage{none, step, start, impact, none_yet};
    law.begin(none, step, start);
    const double w = solve(
        step, start, rate, [&] { EXPECT_TRUE(law.set(stage)); },
        [&](double at) { return 0.5 * (rate + at); });
    theta += h * ((1 - weight) * rate + weight * w);
    rate = w;
  }
  double kinetic() const { return 0.5 * m * rate * rate; }
};
using SwingAxis = Axis<AxisSmoothLaw<Swing, MadeUp<Swing>>>;
using BeltAxis = Axis<AxisBoundLaw<Belt, MadeUp<Belt>>>;

/// The mean force over the way is that of the potential: energy is kept in steps of 2 rad, and over the top.
TEST(PlainLaws, KeepTheEnergyOfAPotential) {
  for (const double h : {0.01, 0.1, 0.2})
    for (const double rate : {1.0, 4.4, 9.0})
      for (const bool rattle : {true, false}) {
        MadeUp<Swing>::property = Swing{.k = 10};
        SwingAxis axis{.rate = rate};
        const double before = axis.kinetic();
        for (int i = 0; i < 400; ++i) {
          rattle ? axis.rattle(h) : axis.moreau_jean(h, 0.5);
          const double now = axis.kinetic() + MadeUp<Swing>::property->energy(axis.theta);
          ASSERT_NEAR(now, before, 1e-6 * before) << h << " " << rate << " " << rattle << " " << i;
        }
        EXPECT_NEAR(axis.works.work.spring, axis.kinetic() - before, 1e-9 * before);
        EXPECT_EQ(axis.works.work.damping, 0);
      }
}

/// Order 2: against a small oscillation's exact one by Richardson's extrapolation.
TEST(PlainLaws, AreOfOrderTwo) {
  for (const bool rattle : {true, false}) {
    const auto end = [&](int steps) {
      MadeUp<Swing>::property = Swing{.k = 10, .c = 0.3};
      SwingAxis axis{.theta = 1, .rate = 2};
      for (int i = 0; i < steps; ++i) rattle ? axis.rattle(1.0 / steps) : axis.moreau_jean(1.0 / steps, 0.5);
      return axis.theta;
    };
    const double a = end(100), b = end(200), c = end(400);
    EXPECT_NEAR(std::log2((a - b) / (b - c)), 2, 0.05) << rattle;
  }
}

/// What damps counts as damping beside a potential, and both works are all of the change.
TEST(PlainLaws, AccountForDampingBesideAPotential) {
  for (const double c : {0.3, 1e6})
    for (const bool rattle : {true, false}) {
      MadeUp<Swing>::property = Swing{.k = 10, .c = c};
      SwingAxis axis{.theta = 2, .rate = 3};
      const double before = axis.kinetic();
      const double stored = MadeUp<Swing>::property->energy(2);
      double last = axis.kinetic() + stored;
      for (int i = 0; i < 200; ++i) {
        rattle ? axis.rattle(0.02) : axis.moreau_jean(0.02, 0.5);
        const double now = axis.kinetic() + MadeUp<Swing>::property->energy(axis.theta);
        // Moreau–Jean takes stiff damping later than the mean rate, against which it works.
        ASSERT_LE(now, last + (rattle ? 1e-6 : 1e-3 * last)) << c << " " << rattle << " " << i;
        last = now;
      }
      EXPECT_NEAR(axis.works.work.spring + axis.works.work.damping, axis.kinetic() - before,
                  1e-8 * (before + stored));
      EXPECT_LT(axis.works.work.damping, 0);
    }
}

/// The belt pulls with what it has until the axis goes along with it, and then with nothing.
TEST(PlainLaws, HoldWithinABound) {
  for (const bool rattle : {true, false}) {
    MadeUp<Belt>::property = Belt{.most = 3, .speed = 0.7};
    BeltAxis axis{.rate = -1};
    for (int i = 0; i < 100; ++i) rattle ? axis.rattle(0.02) : axis.moreau_jean(0.02, 0.5);
    EXPECT_NEAR(axis.rate, 0.7, 1e-12) << rattle;
    // From −1 to 0.7 m/s with 3 N on 2 kg, a little less where θ < 0.
    EXPECT_NEAR(axis.works.work.spring, 0.5 * 2 * (0.49 - 1), 1e-9) << rattle;
  }
  MadeUp<Belt>::property.reset();
  BeltAxis free{.rate = -1};
  free.rattle(0.02);
  EXPECT_EQ(free.rate, -1);
}

/// What is not finite is left out and said to be so.
TEST(PlainLaws, LeaveOutWhatIsNotFinite) {
  const AxisProperties none;
  const AxisStep step{.h = 0.1};
  const AxisStart start{.theta = 0, .rate = 1e200, .effective_mass = 1};
  const AxisImpact impact;
  const AxisImpulse nothing;
  const AxisStage stage{none, step, start, impact, nothing};
  MadeUp<Swing>::property = Swing{.k = 1, .c = 1};
  AxisSmoothLaw<Swing, MadeUp<Swing>> swing;
  swing.begin(none, step, start);
  EXPECT_FALSE(swing.set(stage));
  EXPECT_EQ(swing.rest.slope, 0);
  MadeUp<Belt>::property = Belt{.most = INFINITY};
  AxisBoundLaw<Belt, MadeUp<Belt>> belt;
  EXPECT_FALSE(belt.set(stage));
  EXPECT_EQ(belt.bound, 0);
}

}  // namespace
}  // namespace taut::plain_laws_test
