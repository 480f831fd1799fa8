#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "scenes/accuracy/contact_truths.h"
#include "scenes/accuracy/reference_contacts.h"
#include "scenes/builders/contact_worlds.h"

namespace taut::reference {
namespace {

using namespace contact_worlds;

constexpr double kRadPerDegree = std::numbers::pi / 180;

/// The largest force that friction gave before the box slipped, over μ_s m g.
ContactCase belt_case() {
  const auto measure = [](double dt, LawRecord& laws) {
    const Belt belt = box_on_belt();
    const Pair pair{"belt", "box", belt.belt, belt.box};
    ContactCourse course(belt.world, dt, laws);
    double most = 0;
    const bool done = course.run(0.15, [&] {
      most = std::max(most, pair_contact(course.simulator(), pair).friction_on_b.norm());
      return true;
    });
    return std::vector{done ? most / belt.limit : std::nan("")};
  };
  const Belt belt = box_on_belt();
  return {.name = "belt",
          .what = "a box on a belt, held back by a spring until it slips",
          .steps = {4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4, 1.25e-4, 6.25e-5, 3.125e-5},
          // Forces are means of steps, in each of which the spring pulls harder by rate · h: one and a half
          // of these are missing where it reaches the limit just as a step ends, as it does at most of them.
          .truths = {{.what = "largest force of friction, over mu_s m g",
                      .source = "1",
                      .value = 1,
                      .allowed = 1.51 * belt.rate * 1e-3 / belt.limit,
                      .power = 1}},
          .measure = measure};
}

/// Normal force on the lower end of a rod that slides without turning: its end keeps its height.
double sliding_force(const World& world, double angle, double mu, double speed) {
  const MassProperties& mass = world.mass_properties(BodyId{1});
  const double half = 0.495, cap = 0.005, c = -half * std::cos(angle), d = -half * std::sin(angle) - cap;
  const double along = speed > 0 ? 1 : -1, inertia = mass.inertia_B()(1, 1);
  return mass.mass() * world.gravity().norm() / (1 + mass.mass() / inertia * (c * c + mu * along * c * d));
}

ContactCase rod_case() {
  const auto measure = [](double dt, LawRecord& laws) {
    double worst = 0, gained = -1;
    // Forces at the start, of the first two steps, where none is beyond what the rod can bear.
    for (const double degrees : {25.0, 40.0, 55.0, 70.0})
      for (const double speed : {-2.0, 2.0}) {
        const Rod rod{.angle = degrees * kRadPerDegree, .speed_x = speed};
        const double mu = 0.4, truth = sliding_force(sliding_rod(rod, 0, mu), rod.angle, mu, speed);
        ContactCourse course(sliding_rod(rod, 0, mu), dt, laws);
        std::vector<double> forces;
        const bool done = course.run(2 * dt, [&] {
          forces.push_back(
              pair_contact(course.simulator(), {"ground", "rod", kGround, BodyId{1}}).normal_sum);
          return true;
        });
        if (!done) return std::vector(2, std::nan(""));
        worst = std::max(worst, std::abs((1.5 * forces[0] - 0.5 * forces[1]) / truth - 1));
      }
    for (const double degrees : {25.0, 40.0, 55.0, 70.0})
      for (const double mu : {0.4, 1.0, 1.5, 2.5}) {
        const double angle = degrees * kRadPerDegree;
        const Rod rod{.angle = angle, .height = 0.015, .speed_z = -1, .spin = 1};
        ContactCourse course(sliding_rod(rod, 0.5, mu), dt, laws);
        const bool done = course.run(0.5, [&] {
          gained = std::max(gained, course.drift());
          return true;
        });
        if (!done) return std::vector(2, std::nan(""));
      }
    return std::vector{worst, gained};
  };
  return {.name = "painleve",
          .what = "a rod that slides on its end: mu = 0.4 ... 2.5, from above 4/3 with Painleve's paradoxes",
          .steps = {4e-3, 2e-3, 1e-3},
          .truths = {{.what = "normal force at the start over its truth - 1, furthest from 0",
                      .source = "m g/(1 + 3 cos(cos -+ mu sin))",
                      .allowed = 1e-4,
                      .power = 2},
                     energy_never_grows("friction and impacts take energy", 1e-5, 2)},
          .measure = measure};
}

/// Euler's disc: how its lean falls until it lies.
struct Spinning {
  std::vector<double> t, s;  ///< s = sin of the lean
  double rise = 0;           ///< largest rise of the energy above the least so far, over that at the start
  double stop = std::nan("");
};

Spinning spin_down(const World& world, double dt, double time, LawRecord& laws) {
  Spinning out;
  ContactCourse course(world, dt, laws);
  double least = 1;
  course.run(time, [&] {
    const double e = 1 + course.drift();
    out.rise = std::max(out.rise, e - least);
    least = std::min(least, e);
    const Vec3 axis = course.pose(1).q * Vec3::UnitZ();
    out.t.push_back(course.world().time());
    out.s.push_back(std::hypot(axis.x(), axis.y()));
    const bool lies = out.s.back() < 1e-4 && course.twist(1).w.norm() < 1e-6;
    if (lies) out.stop = out.t.back();
    return !lies;
  });
  return out;
}

/// Line t = a + b s^x of best fit to the times at which s is above `from`.
struct LineOfTimes {
  double slope, misfit;  ///< b [s], and the sum of squares that it leaves [s²]
};
LineOfTimes fit_times(const Spinning& spin, double from, double x) {
  double n = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0;
  for (std::size_t i = 0; i < spin.t.size() && spin.s[i] > from; ++i) {
    const double p = std::pow(spin.s[i], x), t = spin.t[i];
    n += 1, u += p, v += t, uu += p * p, uv += p * t, vv += t * t;
  }
  const double slope = (n * uv - u * v) / (n * uu - u * u);
  return {slope, (vv - v * v / n) - slope * (uv - u * v / n)};
}

/// The x of s^x whose line fits best, by golden section; s ~ (t₀ − t)^(1/x), whatever t₀ is.
double best_power(const Spinning& spin, double from) {
  double low = 0.1, high = 2;
  const double part = 1 / std::numbers::phi;
  while (high - low > 1e-6) {
    const double a = high - part * (high - low), b = low + part * (high - low);
    if (fit_times(spin, from, a).misfit < fit_times(spin, from, b).misfit)
      high = b;
    else
      low = a;
  }
  return 0.5 * (low + high);
}

/// E = 3/2 m g r s falls by the power arm · m g · Ω s of rolling friction, where the contact runs round at
/// Ω = 2 √(g/(r s)): √s falls at 2/3 arm/r √(g/r), so that s ~ (t₀ − t)² and Ω ~ (t₀ − t)⁻¹.
ContactCase euler_case() {
  const double lean = 0.15, arm = 2e-3, r = kEulerRadius, g = World().gravity().norm();
  const double rate = 2.0 / 3 * arm / r * std::sqrt(g / r);
  const auto measure = [=](double dt, LawRecord& laws) {
    const Spinning spin = spin_down(euler_disc(lean, arm), dt, 4, laws);
    // While the contact runs by less than a tenth of a radian in a step.
    const double from = 4 * g / r * dt * dt / 0.01;
    return std::vector{spin.rise, -1 / fit_times(spin, from, 0.5).slope / rate, -0.5 / best_power(spin, from),
                       spin.stop};
  };
  return {.name = "euler-disc",
          .what = "Euler's disc with rolling friction to its stop",
          .steps = {1e-3, 5e-4, 2.5e-4},
          .truths = {{.what = "rise of E above the least so far, over E0",
                      .source = "never",
                      .comparison = Comparison::kAtMost,
                      .allowed = 1e-6},
                     // The disc's thickness is a hundredth of its diameter, and its centre nearly rests.
                     {.what = "rate at which the root of sin(lean) falls, over its truth",
                      .source = "2/3 arm/r sqrt(g/r)",
                      .value = 1,
                      .allowed = 0.01},
                     {.what = "exponent of the spin-up of the contact's run over the time to the stop",
                      .source = "energy against rolling friction",
                      .value = -1,
                      .allowed = 0.05},
                     // The disc falls flat where its contact runs by more than a fifth of a radian in a step,
                     // 3 r/arm h over that before the truth: order 1.
                     {.what = "time until it lies at rest [s]",
                      .source = "root of sin(lean), over its rate",
                      .value = std::sqrt(std::sin(lean)) / rate,
                      .allowed = 3 * r / arm * 1e-3 / 0.2,
                      .power = 1,
                      .order = 0.9}},
          .measure = measure};
}

/// Speed of the front from the fourth domino to the ninth of ten, by the times at which they lean by 0.2.
ContactCase dominoes_case() {
  const auto measure = [](double dt, LawRecord& laws) {
    constexpr int kCount = 10, kFrom = 4, kTo = 9;
    ContactCourse course(dominoes(kCount), dt, laws);
    std::vector<double> lean(kCount + 1, 0), passed(kCount + 1, std::nan(""));
    double rise = -1;
    course.run(1, [&] {
      rise = std::max(rise, course.drift());
      for (int i = 1; i <= kCount; ++i) {
        const double before = std::exchange(lean[i], (course.pose(i).q * Vec3::UnitZ()).x());
        if (before < 0.2 && lean[i] >= 0.2 && std::isnan(passed[i]))
          passed[i] = course.world().time() - dt * (lean[i] - 0.2) / (lean[i] - before);
      }
      return std::isnan(passed[kTo]);
    });
    return std::vector{(kTo - kFrom) * kDominoPitch / (passed[kTo] - passed[kFrom]), rise};
  };
  // Impacts without restitution begin with their step: order 1.
  return {.name = "dominoes",
          .what = "ten dominoes, 80 mm high and 40 mm apart",
          .steps = {4e-3, 2e-3, 1e-3, 5e-4},
          .truths = {{.what = "speed of the front [m/s]",
                      .source = "converges as the step is halved",
                      .comparison = Comparison::kConverges,
                      .allowed = 2e-3,
                      .power = 1},
                     energy_never_grows("friction and impacts take energy", 1e-5, 2)},
          .measure = measure};
}

}  // namespace

std::vector<ContactCase> friction_cases() { return {belt_case(), rod_case(), euler_case(), dominoes_case()}; }

}  // namespace taut::reference
