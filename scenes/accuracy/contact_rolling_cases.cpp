#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "scenes/accuracy/contact_truths.h"
#include "scenes/accuracy/reference_contacts.h"
#include "scenes/accuracy/rolling_body.h"
#include "scenes/builders/contact_worlds.h"

namespace taut::reference {
namespace {

using namespace contact_worlds;

/// The equations of rolling of body 1 of a world on the plane z = 0.
RollingBody rolling_body_of(const World& world, std::function<SurfacePoint(const Vec3& n)> surface) {
  const MassProperties& mass = world.mass_properties(BodyId{1});
  return {.mass = mass.mass(),
          .inertia = mass.inertia_B(),
          .gravity = world.gravity().norm(),
          .surface = std::move(surface)};
}

RollingState start_of(const World& world) {
  return {.pose = world.pose(BodyId{1}), .twist = world.twist(BodyId{1})};
}

RollingBody rolling_disc_body() {
  return rolling_body_of(rolling_disc(), [](const Vec3& n) { return on_rim(kDiscRadius, kDiscHalf, n); });
}

/// Largest |E/E₀ − 1| over a run, and the drift: the slope of the line of best fit times the time.
struct EnergyError {
  double most = 0, drift = 0;
};
EnergyError energy_error(ContactCourse& course, double time) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  EnergyError out;
  const bool done = course.run(time, [&] {
    const double t = course.world().time(), e = course.drift();
    out.most = std::max(out.most, std::abs(e));
    n += 1, x += t, y += e, xx += t * t, xy += t * e;
    return true;
  });
  if (!done) return {std::nan(""), std::nan("")};
  out.drift = std::abs((n * xy - x * y) / (n * xx - x * x)) * time;
  return out;
}

ContactCase disc_case() {
  const auto measure = [](double dt, LawRecord& laws) {
    const RollingState truth = roll(rolling_disc_body(), start_of(rolling_disc()), 1, 10000);
    ContactCourse brief(rolling_disc(), dt, laws);
    const bool done = brief.run(1);
    const double away = (brief.pose(1).p - truth.pose.p).norm();
    ContactCourse course(rolling_disc(), dt, laws);
    const EnergyError energy = energy_error(course, 20);
    return std::vector{energy.most, energy.drift, done ? away : std::nan("")};
  };
  return {.name = "rolling-disc",
          .what = "a disc that rolls on its rim without slip, 20 s",
          .steps = {4e-3, 2e-3, 1e-3},
          .truths = {energy_stays("rolling takes no energy", 1e-6, 2, 1.9),
                     {.what = "drift of E/E0, slope of the line of best fit times 20 s",
                      .source = "rolling takes no energy",
                      .allowed = 1e-6,
                      .power = 2},
                     {.what = "position after 1 s, distance from the truth [m]",
                      .source = "equations of rolling, Runge-Kutta",
                      .allowed = 1e-5,
                      .power = 2,
                      .order = 1.9}},
          .measure = measure};
}

/// θ̈ = g sin θ/R by Runge–Kutta: θ after `time` from rest at `start`.
double angle_on_dome(double start, double time) {
  const double g = World().gravity().norm(), R = kDomeReach;
  double theta = start, rate = 0;
  const int steps = 20000;
  const double h = time / steps;
  const auto f = [&](double x) { return g * std::sin(x) / R; };
  for (int i = 0; i < steps; ++i) {
    const double k1 = f(theta), k2 = f(theta + 0.5 * h * rate),
                 k3 = f(theta + 0.5 * h * rate + 0.25 * h * h * k1),
                 k4 = f(theta + h * rate + 0.5 * h * h * k2);
    theta += h * rate + h * h / 6 * (k1 + k2 + k3);
    rate += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return theta;
}

/// A ball that has come from rest at the top leaves where cos θ = 2/3: by the contact's force, which is
/// linear in cos θ and is extrapolated to 0 from the last two steps that it lasts, and by the gap.
std::pair<double, double> leaving_cosines(double dt, LawRecord& laws) {
  const double start = 0.3;
  const double rate = std::sqrt(2 * World().gravity().norm() * (1 - std::cos(start)) / kDomeReach);
  ContactCourse course(ball_on_dome(start, rate), dt, laws);
  const Pair pair{"ground", "b1", kGround, BodyId{1}};
  std::vector<std::pair<double, double>> pressed;  // cos θ in the middle of a step, and the force
  std::optional<double> open;
  double before = std::cos(start);
  const bool done = course.run(1.5, [&] {
    const double reach = course.pose(1).p.norm(), now = course.pose(1).p.z() / reach;
    const double force = pair_contact(course.simulator(), pair).normal_sum;
    if (force > 0 && !open) pressed.emplace_back(0.5 * (before + now), force);
    before = now;
    if (reach > kDomeReach + 1e-9) open = now;
    return !open;
  });
  if (!done || !open || pressed.size() < 4) return {std::nan(""), std::nan("")};
  // The last step may be one that the contact has left in its course.
  const auto [c1, f1] = pressed.end()[-3];
  const auto [c2, f2] = pressed.end()[-2];
  return {c2 - f2 * (c2 - c1) / (f2 - f1), *open};
}

ContactCase dome_case() {
  const auto measure = [](double dt, LawRecord& laws) {
    const double start = 10 * std::numbers::pi / 180, theta = angle_on_dome(start, 0.5);
    const auto [by_force, by_gap] = leaving_cosines(dt, laws);
    ContactCourse course(ball_on_dome(start), dt, laws);
    const bool done = course.run(0.5);
    const Vec3 truth = kDomeReach * Vec3(std::sin(theta), 0, std::cos(theta));
    return std::vector{done ? (course.pose(1).p - truth).norm() : std::nan(""), by_force, by_gap};
  };
  return {.name = "dome",
          .what = "a smooth ball down a fixed sphere",
          .steps = {4e-3, 2e-3, 1e-3},
          .truths = {{.what = "position after 0.5 s, distance from the truth [m]",
                      .source = "g sin(theta)/R, Runge-Kutta",
                      .allowed = 2e-7,
                      .power = 2,
                      .order = 1.9},
                     {.what = "cos of the angle where the contact's force ends",
                      .source = "2/3",
                      .value = 2.0 / 3,
                      .allowed = 1e-5,
                      .power = 2},
                     // 1.8 rad/s times the step, and half a millisecond until a gap of 1e-9 m opens.
                     {.what = "cos of the angle where a gap opens, at the end of that step",
                      .source = "2/3",
                      .value = 2.0 / 3,
                      .allowed = 4e-3,
                      .power = 1}},
          .measure = measure};
}

/// Each of the bowl's edges leaves the part of the speed along the next plane.
ContactCase bowl_case() {
  constexpr int kPlanes = 25;
  const double turn = 5 * std::numbers::pi / 180;
  const auto measure = [turn](double dt, LawRecord& laws) {
    ContactCourse course(ball_in_bowl(kPlanes, turn), dt, laws);
    return std::vector{course.run(2.6) ? course.twist(1).v.norm() : std::nan("")};
  };
  return {.name = "bowl",
          .what = "a smooth ball in a bowl of 25 planes, 5 degrees between each two, e = 0",
          .steps = {4e-3, 2e-3, 1e-3},
          .truths = {{.what = "speed behind the last edge, over that before the first",
                      .source = "cos(5 degrees)^24",
                      .value = std::pow(std::cos(turn), kPlanes - 1),
                      .allowed = 1e-8}},
          .measure = measure};
}

ContactCase roly_poly_case() {
  const auto measure = [](double dt, LawRecord& laws) {
    const World world = roly_poly();
    const RollingBody body = rolling_body_of(world, [](const Vec3& n) {
      return on_ellipsoid(Vec3::Constant(kRolyRadius), Vec3(0, 0, kRolyRise), n);
    });
    const RollingState truth = roll(body, start_of(world), 2, 20000);
    ContactCourse course(world, dt, laws);
    const double most = energy_error(course, 2).most;
    return std::vector{std::isnan(most) ? most : (course.pose(1).p - truth.pose.p).norm(), most};
  };
  return {.name = "roly-poly",
          .what = "a ball with a low centre of mass that rocks and rolls, 2 s: the smooth bowl",
          .steps = {4e-3, 2e-3, 1e-3},
          .truths = {{.what = "position at the end, distance from the truth [m]",
                      .source = "equations of rolling, Runge-Kutta",
                      .allowed = 1e-6,
                      .power = 2,
                      .order = 1.9},
                     energy_stays("rolling takes no energy", 2e-6, 2, 1.9)},
          .measure = measure};
}

/// What a celt is known for: its spin passes through zero, and comes back the other way.
struct Reversal {
  double time = std::nan("");  ///< of the first zero [s]
  double most = -1e300;        ///< largest spin after it [rad/s]
  double before = -1, last = 0;

  void see(double t, double spin) {
    if (std::isnan(time) && before < 0 && spin >= 0) time = t - (t - last) * spin / (spin - before);
    if (!std::isnan(time)) most = std::max(most, spin);
    before = spin;
    last = t;
  }
};

ContactCase rattleback_case() {
  constexpr double kEarly = 2, kEnd = 8;  // [s]
  const auto body_of = [](const World& world) {
    return rolling_body_of(world, [](const Vec3& n) {
      return on_ellipsoid(rattleback_radii(), Vec3(0, 0, kRattlebackRise), n);
    });
  };
  Reversal truth;
  const World celt = rattleback();
  roll(body_of(celt), start_of(celt), kEnd, 80000,
       [&](double t, const RollingState& state) { truth.see(t, state.twist.w.z()); });
  const auto measure = [body_of](double dt, LawRecord& laws) {
    const World world = rattleback();
    const RollingState early = roll(body_of(world), start_of(world), kEarly, 40000);
    ContactCourse course(world, dt, laws);
    Reversal reversal;
    double away = std::nan(""), most = -1;
    const bool done = course.run(kEnd, [&] {
      const double t = course.world().time();
      reversal.see(t, course.twist(1).w.z());
      if (std::abs(t - kEarly) < 0.1 * dt) away = (course.pose(1).p - early.pose.p).norm();
      most = std::max(most, course.drift());
      return true;
    });
    const double nan = std::nan("");
    return std::vector{away, done ? reversal.time : nan, done ? reversal.most : nan, done ? most : nan};
  };
  return {.name = "rattleback",
          .what = "a celt that spins at -5 rad/s and reverses, 8 s",
          .steps = {2e-3, 1e-3, 5e-4},
          .truths = {{.what = "position after 2 s, distance from the truth [m]",
                      .source = "equations of rolling, Runge-Kutta",
                      .allowed = 1e-5,
                      .power = 2,
                      .order = 1.9},
                     {.what = "time at which the spin reverses [s]",
                      .source = "equations of rolling, Runge-Kutta",
                      .value = truth.time,
                      .allowed = 0.1,
                      .power = 2},
                     {.what = "largest spin after that [rad/s]",
                      .source = "equations of rolling, Runge-Kutta",
                      .value = truth.most,
                      .allowed = 0.1,
                      .power = 2},
                     energy_never_grows("rolling gives no energy", 1e-4, 2)},
          .measure = measure};
}

}  // namespace

std::vector<ContactCase> rolling_cases() {
  return {disc_case(), dome_case(), bowl_case(), roly_poly_case(), rattleback_case()};
}

}  // namespace taut::reference
