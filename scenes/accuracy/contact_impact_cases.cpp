#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>

#include "core/world/diagnostics.h"
#include "scenes/accuracy/contact_truths.h"
#include "scenes/builders/contact_worlds.h"

namespace taut::reference {
namespace {

using namespace contact_worlds;

/// Runs a world whose energy is kept: the largest |E/E₀ − 1| at any time, NaN if a step failed.
double largest_drift(World world, double dt, double time, LawRecord& laws) {
  ContactCourse course(std::move(world), dt, laws);
  double most = 0;
  const bool done = course.run(time, [&] {
    most = std::max(most, std::abs(course.drift()));
    return true;
  });
  return done ? most : std::nan("");
}

constexpr const char* kElastic = "e = 1 without friction";

ContactCase tumbling_box_case() {
  return {.name = "tumbling-box",
          .what = "smooth elastic box that tumbles on a smooth floor, 4 s",
          .steps = {4e-3, 1e-3, 2.5e-4},
          // That of the split rotation between impacts, of order 2.
          .truths = {energy_stays(kElastic, 1e-4, 2, 1.9)},
          .measure = [](double dt, LawRecord& laws) {
            return std::vector{largest_drift(tumbling_box(), dt, 4, laws)};
          }};
}

ContactCase gas_case(bool boxes) {
  return {.name = boxes ? "gas-of-boxes" : "gas-of-balls",
          .what = boxes ? "27 smooth elastic boxes in a cube, 2 s" : "27 smooth elastic balls in a cube, 2 s",
          .steps = {4e-3, 2e-3, 1e-3, 5e-4},
          .truths = {energy_stays(kElastic, 1e-3, 0)},
          .measure = [boxes](double dt, LawRecord& laws) {
            return std::vector{largest_drift(gas(boxes), dt, 2, laws)};
          }};
}

/// What is known of a line or a plane of balls: energy and momentum along x.
ContactCase break_case() {
  const auto measure = [](double dt, LawRecord& laws) {
    ContactCourse course(ball_break(), dt, laws);
    const double before = linear_momentum(course.world(), course.world().state()).x();
    const bool done = course.run(0.5);
    const double nan = std::nan("");
    return std::vector{done ? std::abs(course.drift()) : nan,
                       done ? linear_momentum(course.world(), course.world().state()).x() / before : nan};
  };
  return {.name = "break",
          .what = "a ball strikes fifteen that touch each other, smooth and elastic",
          .steps = {4e-3, 2e-3, 1e-3},
          // Impacts slower than Settings::resting_speed, 1 mm/s of 5 m/s, have no restitution.
          .truths = {energy_stays(kElastic, 1e-6, 0),
                     {.what = "momentum at the end over that at the start",
                      .source = "1",
                      .value = 1,
                      .allowed = 1e-9}},
          .measure = measure};
}

/// Speeds of the first and the last of five balls in a line, over that of the first before.
std::vector<double> cradle_speeds(double gap, double dt, LawRecord& laws) {
  ContactCourse course(cradle(gap), dt, laws);
  const double before = course.twist(1).v.x();
  const double nan = std::nan("");
  if (!course.run(0.2)) return {nan, nan, nan};
  return {course.twist(1).v.x() / before, course.twist(5).v.x() / before, std::abs(course.drift())};
}

ContactCase cradle_case(bool touching) {
  const double first = touching ? -0.6 : 0, last = touching ? 0.4 : 1;
  const char* source = touching ? "simultaneous impacts, (2 - 5)/5 and 2/5" : "one impact after the other";
  return {.name = touching ? "cradle-touching" : "cradle",
          .what = touching ? "Newton's cradle of five balls that touch: simultaneous impacts"
                           : "Newton's cradle of five balls with gaps of 0.1 mm",
          .steps = {4e-3, 2e-3, 1e-3},
          .truths = {{.what = "speed of the first ball after, over before",
                      .source = source,
                      .value = first,
                      .allowed = 1e-8},
                     {.what = "speed of the last ball after, over before",
                      .source = source,
                      .value = last,
                      .allowed = 1e-8},
                     energy_stays(kElastic, 1e-9, 0)},
          .measure = [touching](double dt, LawRecord& laws) {
            return cradle_speeds(touching ? 0 : 1e-4, dt, laws);
          }};
}

ContactCase two_balls_case() {
  const auto measure = [](double dt, LawRecord& laws) {
    ContactCourse course(two_balls(), dt, laws);
    const double nan = std::nan("");
    if (!course.run(0.4)) return std::vector{nan, nan};
    return std::vector{std::abs(course.drift()), course.twist(2).v.x() / 3};
  };
  return {.name = "two-balls",
          .what = "two smooth elastic balls off centre, 0.19 m at a distance of centres of 0.2 m",
          .steps = {4e-3, 2e-3, 1e-3},
          .truths = {energy_stays(kElastic, 1e-12, 0),
                     {.what = "speed along x of the ball that was struck, over that of the other before",
                      .source = "1 - 0.95^2",
                      .value = 1 - 0.95 * 0.95,
                      .allowed = 1e-6}},
          .measure = measure};
}

/// Of a ball after an oblique impact: J_n = (1 + e) m v_n and J_t = min(μ J_n, 2/7 m |slip|).
std::array<double, 3> struck(const Oblique& ball, double e, double mu) {
  const double slip = ball.speed_x - ball.radius * ball.spin;  // of the lowest point
  const double impulse =
      std::copysign(std::min(mu * (1 + e) * -ball.speed_z, 2.0 / 7 * std::abs(slip)), slip);
  return {-e * ball.speed_z, ball.speed_x - impulse, ball.spin + 2.5 * impulse / ball.radius};
}

/// What is furthest from the closed form over restitutions, five frictions and three spins.
struct Furthest {
  double speed = 0, spin = 0;  ///< [m/s], [rad/s]
  double gained = -1;          ///< E/E₀ − 1
};
Furthest furthest_of_impacts(const std::vector<double>& restitutions, double dt, LawRecord& laws) {
  const double nan = std::nan("");
  Furthest out;
  for (const double e : restitutions)
    for (const double mu : {0.0, 0.1, 0.3, 0.6, 1.0})
      for (const double turns : {-40.0, 4.0, 60.0}) {
        const Oblique ball{.spin = turns};
        ContactCourse course(oblique_ball(ball, e, mu), dt, laws);
        if (!course.run(0.02)) return {nan, nan, nan};
        const auto [vz, vx, wy] = struck(ball, e, mu);
        const Twist& V = course.twist(1);
        out.speed = std::max({out.speed, std::abs(V.v.z() - vz), std::abs(V.v.x() - vx)});
        out.spin = std::max(out.spin, std::abs(V.w.y() - wy));
        out.gained = std::max(out.gained, course.drift());
      }
  return out;
}

ContactCase oblique_case() {
  const auto measure = [](double dt, LawRecord& laws) {
    const Furthest bounces = furthest_of_impacts({0.25, 0.5, 0.75, 1}, dt, laws);
    const Furthest stays = furthest_of_impacts({0}, dt, laws);
    return std::vector{bounces.speed, bounces.spin, stays.speed, stays.spin,
                       std::max(bounces.gained, stays.gained)};
  };
  const auto at_most_off = [](const char* what, const char* source, double allowed, int power) {
    return Truth{.what = what, .source = source, .allowed = allowed, .power = power};
  };
  // Without restitution an impact begins with its step, where the ball is up to v h = 2 mm higher at 1 ms: so
  // much longer is its arm, at 60 rad/s.
  const double higher = 2.0 / 7 * 60 * 2e-3;
  return {
      .name = "oblique",
      .what = "a ball strikes a floor: e = 0 ... 1, mu = 0 ... 1, three spins, 75 impacts",
      .steps = {4e-3, 2e-3, 1e-3, 1e-4},
      .truths = {at_most_off("e > 0: speed after, furthest from its truth [m/s]",
                             "(1 + e) m v, min(mu J, 2/7 m slip)", 1e-8, 0),
                 at_most_off("e > 0: spin after, furthest from its truth [rad/s]", "5/2 J/(m r)", 1e-6, 0),
                 at_most_off("e = 0: speed after, furthest from its truth [m/s]",
                             "m v, min(mu J, 2/7 m slip)", higher, 1),
                 at_most_off("e = 0: spin after, furthest from its truth [rad/s]", "5/2 J/(m r)", 25 * higher,
                             1),
                 {.what = "E/E0 - 1, largest",
                  .source = "no impact gives energy",
                  .comparison = Comparison::kAtMost,
                  .allowed = 1e-12}},
      .measure = measure};
}

/// Rods and boxes that strike with a corner: Newton's law with friction would give energy in some of these.
ContactCase thrown_case() {
  const auto measure = [](double dt, LawRecord& laws) {
    double gained = -1;
    for (const double e : {0.0, 0.5, 1.0})
      for (const double mu : {0.1, 0.3, 1.0}) {
        std::mt19937 random(11);
        for (int i = 0; i < 6; ++i) {
          ContactCourse course(thrown_box(random, i % 2 == 0, e, mu), dt, laws);
          double most = -1;
          const bool done = course.run(0.6, [&] {
            most = std::max(most, course.drift());
            return true;
          });
          if (!done) return std::vector{std::nan("")};
          gained = std::max(gained, most);
        }
      }
    return std::vector{gained};
  };
  return {.name = "thrown",
          .what = "rods and boxes thrown at a rough floor: e = 0 ... 1, mu = 0.1 ... 1, 54 runs of 0.6 s",
          .steps = {4e-3, 2e-3, 1e-3},
          // Of the flow between impacts, of order 2.
          .truths = {energy_never_grows("no impact gives energy", 5e-5, 2)},
          .measure = measure};
}

}  // namespace

std::vector<ContactCase> impact_cases() {
  return {tumbling_box_case(), gas_case(false),  gas_case(true), break_case(), cradle_case(false),
          cradle_case(true),   two_balls_case(), oblique_case(), thrown_case()};
}

}  // namespace taut::reference
