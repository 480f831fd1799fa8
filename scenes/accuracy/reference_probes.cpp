#include "scenes/accuracy/reference_probes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/world/diagnostics.h"

namespace taut::reference {
namespace {

using Json = nlohmann::json;
using Values = Probes::Values;

Values values_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// Rotation angle of q about an axis, up to whole turns: the twist of its swing–twist decomposition.
double twist_angle(const Quat& q, const Vec3& axis) { return 2 * std::atan2(axis.dot(q.vec()), q.w()); }

/// Cubic through four samples (Neville).
double cubic(const std::vector<double>& t, std::vector<double> x, double at) {
  for (int order = 1; order < 4; ++order)
    for (int i = 0; i + order < 4; ++i)
      x[i] = ((at - t[i + order]) * x[i] + (t[i] - at) * x[i + 1]) / (t[i] - t[i + order]);
  return x[0];
}

/// Root of the cubic between the two middle samples, by bisection.
double cubic_root(const std::vector<double>& t, const std::vector<double>& x) {
  double low = t[1], high = t[2];
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (cubic(t, x, middle) < 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Largest value of the parabola through the last three samples if its top lies between them.
double parabola_top(double a, double b, double c) {
  const double curvature = a - 2 * b + c, slope = 0.5 * (c - a);
  return b >= a && b >= c && curvature < 0 ? b - 0.5 * slope * slope / curvature : b;
}

bool is_traced(const Json& probe) {
  return probe.at("kind") == "crossing_period" || probe.at("kind") == "extremum_in_time";
}
bool is_angle(const Json& probe) {
  return probe.at("kind") == "angle" || probe.at("kind") == "relative_angle";
}

}  // namespace

const std::map<std::string, Probes::Measure>& Probes::measures() {
  static const std::map<std::string, Measure> table = {
      {"point", &Probes::point},
      {"angular_velocity", &Probes::angular_velocity},
      {"angular_acceleration", &Probes::angular_acceleration},
      {"rotation_matrix", &Probes::rotation_matrix},
      {"angle", &Probes::angle},
      {"relative_angle", &Probes::angle},
      {"joint_force", &Probes::joint_force},
      {"joint_torque", &Probes::joint_torque},
      {"joint_tension", &Probes::joint_tension},
      {"energy", &Probes::energy},
      {"kinetic_energy", &Probes::kinetic},
      {"energy_drift", &Probes::energy_drift},
      {"linear_momentum", &Probes::momentum},
      {"angular_momentum", &Probes::moment_of_momentum},
      {"centre_of_mass", &Probes::centre},
      {"radial_speed", &Probes::radial_speed},
      {"crossing_period", &Probes::crossing_period},
      {"extremum_in_time", &Probes::extremum_in_time},
      {"multiplier", &Probes::multiplier},
      {"motor_torque", &Probes::motor_torque},
      {"limit_torque", &Probes::limit_torque},
      {"rest_time", &Probes::rest_time},
      {"impact_time", &Probes::impact_time},
      {"before_impact", &Probes::at_impact},
      {"after_impact", &Probes::at_impact},
      {"turning_time", &Probes::turning_time},
      {"turning_value", &Probes::turning_value},
      {"final_value", &Probes::final_value},
      {"first_value", &Probes::first_value},
      {"initial_rate", &Probes::initial_rate},
      {"crossing_time", &Probes::crossing_time},
      {"at_crossing", &Probes::at_crossing},
      {"impact_count", &Probes::impact_count},
      {"impact_order", &Probes::impact_order},
      {"contact_force", &Probes::contact_force},
      {"contact_normal_sum", &Probes::contact_normal_sum},
      {"contact_sliding", &Probes::contact_sliding},
      {"centre_of_pressure", &Probes::centre_of_pressure},
      {"axial_force", &Probes::axial_force},
      {"direction", &Probes::direction},
      {"ratio", &Probes::ratio},
      {"constant", &Probes::constant},
      {"time", &Probes::time},
      {"list", &Probes::list},
      {"sum", &Probes::sum},
      {"extremum", &Probes::extremum},
      {"norm", &Probes::norm},
  };
  return table;
}

bool Probes::knows(const Json& probe) {
  if (!measures().contains(probe.at("kind"))) return false;
  if (probe.contains("of") && !knows(probe.at("of"))) return false;
  if (probe.contains("crossing") && !knows(probe.at("crossing").at("of"))) return false;
  if (probe.contains("items"))
    for (const Json& item : probe.at("items"))
      if (!knows(item)) return false;
  return true;
}

Probes::Probes(const Case& reference, Simulator& simulator)
    : case_(reference),
      simulator_(simulator),
      start_(simulator.world().state()),
      start_energy_(total_energy(simulator.world(), start_) - energy_of_carriers(false)) {
  for (const Quantity& quantity : case_.quantities)
    if (quantity.has_probe() && knows(quantity.probe)) subscribe(quantity.probe);
}

void Probes::subscribe(const Json& probe) {
  if (is_angle(probe)) {
    Angle angle;
    angle.body = find_body(case_.world, probe.at("body"));
    angle.other = find_body(case_.world, probe.value("relative_to", "world"));
    angle.axis = vector_of(probe, "axis");
    angle.start = relative_rotation(angle);
    angles_[probe.dump()] = angle;
  }
  if (probe.contains("items"))
    for (const Json& item : probe.at("items")) subscribe(item);
  if (probe.contains("of")) subscribe(probe.at("of"));
  if (probe.contains("crossing")) subscribe(probe.at("crossing").at("of"));
  if (is_traced(probe)) {
    Trace trace;
    trace.of = probe.at("of");
    trace.level = probe.value("level", 0.0);
    trace.minimum = HUGE_VAL;
    trace.maximum = -HUGE_VAL;
    sample(trace);
    traces_[probe.dump()] = trace;
  }
  subscribe_events(probe);
}

void Probes::observe() {
  for (auto& [key, angle] : angles_) {
    const double now = twist_angle(relative_rotation(angle) * angle.start.conjugate(), angle.axis);
    angle.value = now - 2 * std::numbers::pi * std::round((now - angle.value) / (2 * std::numbers::pi));
  }
  for (auto& [key, trace] : traces_) sample(trace);
  observe_events();
}

void Probes::sample(Trace& trace) {
  auto& [of, level, t, x, crossings, minimum, maximum] = trace;
  if (t.size() == 4) {
    t.erase(t.begin());
    x.erase(x.begin());
  }
  t.push_back(state().time);
  x.push_back(evaluate(of).at(0) - level);
  const std::size_t n = x.size();
  minimum = std::min(minimum, x.back());
  maximum = std::max(maximum, x.back());
  if (n >= 3) {
    maximum = std::max(maximum, parabola_top(x[n - 3], x[n - 2], x[n - 1]));
    minimum = std::min(minimum, -parabola_top(-x[n - 3], -x[n - 2], -x[n - 1]));
  }
  if (n == 4 && x[1] < 0 && x[2] >= 0) crossings.push_back(cubic_root(t, x));
}

Quat Probes::relative_rotation(const Angle& angle) const {
  return state().poses[angle.other.index].q.conjugate() * state().poses[angle.body.index].q;
}

Twist Probes::acceleration(BodyId body) {
  const World& world = simulator_.world();
  std::vector<Wrench> wrenches(world.body_count());
  world.forces(state(), wrenches);
  Vec3 force = wrenches[body.index].force, torque = wrenches[body.index].torque;
  const Pose& pose = state().poses[body.index];
  for (int j = 0; j < world.joint_count(); ++j) {
    const Joint& j_body = world.joint(JointId{j});
    const auto coupling = case_.couplings.find(world.name(JointId{j}));
    if (coupling != case_.couplings.end()) {
      const double multiplier = multiplier_of(coupling->first);
      for (const auto& [hinge, coef] : coupling->second.terms) {
        const Vec3 axis = state().poses[hinge.a.index].q * hinge.axis_A;
        if (hinge.b == body) torque += coef * multiplier * axis;
        if (hinge.a == body) torque -= coef * multiplier * axis;
      }
      continue;
    }
    if (j_body.a() != body && j_body.b() != body) continue;
    const Reaction reaction = simulator_.reaction(JointId{j});
    // Both bodies see the wrench at the same world point, which is B's anchor.
    const Vec3 arm = state().poses[j_body.b().index].point(j_body.reaction_point_B()) - pose.p;
    const double sign = j_body.b() == body ? 1 : -1;
    force += sign * reaction.force;
    torque += sign * (reaction.torque + arm.cross(reaction.force));
  }
  const MassProperties& mass = world.mass_properties(body);
  const Mat3 R = pose.q.toRotationMatrix();
  const Mat3 I_W = R * mass.inertia_B() * R.transpose();
  const Vec3& w = state().twists[body.index].w;
  return {I_W.inverse() * (torque - w.cross(I_W * w)), force / mass.mass()};
}

JointId Probes::joint(const Json& probe) const {
  return simulator_.world().joint(probe.at("joint").get<std::string>());
}

double Probes::sign_on(const Json& probe) const {
  const BodyId on = find_body(simulator_.world(), probe.at("on"));
  const Joint& of = simulator_.world().joint(joint(probe));
  if (on != of.a() && on != of.b()) fail("probe", "the joint does not act on this body", probe.dump());
  return on == of.b() ? 1 : -1;
}

Values Probes::evaluate(const Json& probe) {
  if (!measures().contains(probe.at("kind")))
    throw NotMeasured("probe of unknown kind " + probe.at("kind").dump());
  Values values = (this->*measures().at(probe.at("kind")))(probe);
  if (probe.contains("along")) {
    const Vec3 direction = vector_of(probe, "along");
    values = {direction.dot(Vec3(values.at(0), values.at(1), values.at(2)))};
  }
  if (!probe.contains("components")) return values;
  Values picked;
  for (const Json& i : probe.at("components")) picked.push_back(values.at(i.get<std::size_t>()));
  return picked;
}

Values Probes::point(const Json& probe) {
  const BodyId body = find_body(case_.world, probe.at("body"));
  const Pose& start = start_.poses[body.index];
  const Pose& now = state().poses[body.index];
  const Twist& twist = state().twists[body.index];
  const Vec3 p_WP = probe.contains("point_at_t0") ? vector_of(probe, "point_at_t0") : start.p;
  const Vec3 p_BP = start.local(p_WP), arm = now.q * p_BP;
  const std::string what = probe.at("what");
  if (what == "position") return values_of(now.point(p_BP));
  if (what == "displacement") return values_of(now.point(p_BP) - p_WP);
  if (what == "velocity") return values_of(twist.at(arm));
  if (what != "acceleration") fail("probe", "unknown kind of point motion", what);
  const Twist A = acceleration(body);
  return values_of(A.at(arm) + twist.w.cross(twist.w.cross(arm)));
}

Values Probes::angular_velocity(const Json& probe) {
  const BodyId body = find_body(case_.world, probe.at("body"));
  const Vec3& w = state().twists[body.index].w;
  return values_of(probe.at("frame") == "body" ? state().poses[body.index].q.conjugate() * w : w);
}

Values Probes::angular_acceleration(const Json& probe) {
  const BodyId body = find_body(case_.world, probe.at("body"));
  const Vec3 a = acceleration(body).w;
  return values_of(probe.value("frame", "world") == "body" ? state().poses[body.index].q.conjugate() * a : a);
}

Values Probes::rotation_matrix(const Json& probe) {
  const Mat3 R = state().poses[find_body(case_.world, probe.at("body")).index].q.toRotationMatrix();
  Values values;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) values.push_back(R(i, j));
  return values;
}

Values Probes::angle(const Json& probe) {
  return {angles_.at(probe.dump()).value + probe.at("offset").get<double>()};
}

Values Probes::joint_force(const Json& probe) {
  return values_of(sign_on(probe) * simulator_.reaction(joint(probe)).force);
}

Values Probes::joint_torque(const Json& probe) {
  return values_of(sign_on(probe) * simulator_.reaction(joint(probe)).torque);
}

Values Probes::joint_tension(const Json& probe) {
  const Anchors& at = case_.anchors.at(probe.at("joint"));
  const Vec3 from_a_to_b =
      state().poses[at.b.index].point(at.p_BQ) - state().poses[at.a.index].point(at.p_AP);
  return {-simulator_.reaction(joint(probe)).force.dot(from_a_to_b.normalized())};
}

/// What the bodies that stand for moving parts of the world add to the World's own sums.
double Probes::energy_of_carriers(bool kinetic_only) const {
  const World& world = simulator_.world();
  double sum = 0;
  for (BodyId id : case_.carriers) {
    const Pose& pose = state().poses[id.index];
    const Twist& twist = state().twists[id.index];
    const MassProperties& mass = world.mass_properties(id);
    sum += 0.5 * mass.mass() * twist.v.squaredNorm() +
           0.5 * twist.w.dot(angular_momentum_about_centre(mass, pose, twist.w));
    if (!kinetic_only) sum -= mass.mass() * world.gravity().dot(pose.p);
  }
  return sum;
}

Values Probes::energy(const Json&) {
  return {total_energy(simulator_.world(), state()) - energy_of_carriers(false)};
}
Values Probes::kinetic(const Json&) {
  return {kinetic_energy(simulator_.world(), state()) - energy_of_carriers(true)};
}
Values Probes::energy_drift(const Json& probe) { return {energy(probe)[0] - start_energy_}; }

Values Probes::momentum(const Json&) {
  Vec3 sum = linear_momentum(simulator_.world(), state());
  for (BodyId id : case_.carriers)
    sum -= simulator_.world().mass_properties(id).mass() * state().twists[id.index].v;
  return values_of(sum);
}

Values Probes::centre(const Json&) {
  const World& world = simulator_.world();
  double mass = 0;
  Vec3 moment = Vec3::Zero();
  for (int b = 1; b < world.body_count(); ++b) {
    if (world.is_fixed(BodyId{b}) || case_.carriers.contains(BodyId{b})) continue;
    const double m = world.mass_properties(BodyId{b}).mass();
    mass += m;
    moment += m * state().poses[b].p;
  }
  return values_of(moment / mass);
}

Values Probes::moment_of_momentum(const Json& probe) {
  const World& world = simulator_.world();
  Vec3 about;
  if (probe.at("about").is_string()) {
    const Values c = centre(probe);
    about = Vec3(c[0], c[1], c[2]);
  } else {
    about = vector_of(probe, "about");
  }
  Vec3 sum = angular_momentum(world, state(), about);
  for (BodyId id : case_.carriers) {
    const Pose& pose = state().poses[id.index];
    const Twist& twist = state().twists[id.index];
    const MassProperties& mass = world.mass_properties(id);
    sum -= (pose.p - about).cross(mass.mass() * twist.v) + angular_momentum_about_centre(mass, pose, twist.w);
  }
  return values_of(sum);
}

Values Probes::radial_speed(const Json& probe) {
  const BodyId body = find_body(case_.world, probe.at("body"));
  const Vec3 r = state().poses[body.index].p - vector_of(probe, "centre");
  return {r.normalized().dot(state().twists[body.index].v)};
}

Values Probes::crossing_period(const Json& probe) {
  const std::vector<double>& crossings = traces_.at(probe.dump()).crossings;
  if (crossings.size() < 2) throw std::runtime_error("fewer than two crossings in the run: " + probe.dump());
  return {crossings[1] - crossings[0]};
}

Values Probes::extremum_in_time(const Json& probe) {
  const Trace& trace = traces_.at(probe.dump());
  return {(probe.at("op") == "max" ? trace.maximum : trace.minimum) + trace.level};
}

Values Probes::list(const Json& probe) {
  Values all;
  for (const Json& item : probe.at("items")) {
    const Values values = evaluate(item);
    all.insert(all.end(), values.begin(), values.end());
  }
  return all;
}

Values Probes::sum(const Json& probe) {
  Values total;
  for (const Json& item : probe.at("items")) {
    const Values values = evaluate(item);
    total.resize(values.size(), 0.0);
    for (std::size_t i = 0; i < values.size(); ++i) total[i] += values[i];
  }
  for (double& value : total) value *= probe.value("factor", 1.0);
  return total;
}

Values Probes::extremum(const Json& probe) {
  const Values values = evaluate(probe.at("of"));
  return {probe.at("op") == "max" ? *std::max_element(values.begin(), values.end())
                                  : *std::min_element(values.begin(), values.end())};
}

Values Probes::norm(const Json& probe) {
  double sum = 0;
  for (double value : evaluate(probe.at("of"))) sum += value * value;
  return {std::sqrt(sum)};
}

/// Half of what the joints at both ends pull with: the weight of the body between them is shared.
Values Probes::axial_force(const Json& probe) {
  const World& world = simulator_.world();
  const BodyId body = find_body(world, probe.at("body"));
  const Pose& pose = state().poses[body.index];
  const Vec3 axis = pose.q * vector_of(probe, "axis");
  double sum = 0;
  for (int j = 0; j < world.joint_count(); ++j) {
    const Joint& of = world.joint(JointId{j});
    if (of.a() != body && of.b() != body) continue;
    const Vec3 arm = state().poses[of.b().index].point(of.reaction_point_B()) - pose.p;
    const double pull = (of.b() == body ? 1 : -1) * simulator_.reaction(JointId{j}).force.dot(axis);
    sum += arm.dot(axis) < 0 ? -pull : pull;
  }
  return {0.5 * sum};
}

/// Angle of the vector `of` − `about` in a plane, from `from` to `to`.
Values Probes::direction(const Json& probe) {
  const Values v = evaluate(probe.at("of"));
  Vec3 x(v.at(0), v.at(1), v.at(2));
  if (probe.contains("about")) x -= vector_of(probe, "about");
  return {std::atan2(x.dot(vector_of(probe, "to")), x.dot(vector_of(probe, "from")))};
}

Values Probes::ratio(const Json& probe) {
  return {evaluate(probe.at("items").at(0)).at(0) / evaluate(probe.at("items").at(1)).at(0)};
}

Values Probes::constant(const Json& probe) {
  const Json& value = probe.at("value");
  return value.is_array() ? value.get<Values>() : Values{value.get<double>()};
}

}  // namespace taut::reference
