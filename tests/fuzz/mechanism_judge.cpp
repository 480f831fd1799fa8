#include <algorithm>
#include <cstdio>

#include "tests/fuzz/mechanism.h"

namespace taut::fuzz {
namespace {

using Json = nlohmann::json;
constexpr double kTurn = 2 * std::numbers::pi;

Vec3 vec(const Json& json) { return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()}; }
Quat quat(const Json& json) {
  return Quat(json[0].get<double>(), json[1].get<double>(), json[2].get<double>(), json[3].get<double>())
      .normalized();
}
Vec3 vec_or_zero(const Json& object, const char* key) {
  return object.contains(key) ? vec(object[key]) : Vec3(0, 0, 0);
}
std::string text(const char* format, auto... values) {
  char buffer[400];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

/// Component of v across a.
Vec3 off_axis(const Vec3& v, const Vec3& a) { return v - a * a.dot(v); }
/// Turn from q to r [rad].
double turn_between(const Quat& q, const Quat& r) {
  const Quat d = q.conjugate() * r;
  return 2 * std::atan2(d.vec().norm(), std::abs(d.w()));
}

/// Motions of make_mechanism().
double motion_at(const Json& motion, double t) {
  if (motion.is_number()) return motion;
  if (motion.contains("linear")) {
    const Json& m = motion["linear"];
    return m.value("value", 0.0) + m["rate"].get<double>() * (t - m.value("start", 0.0));
  }
  const Json& m = motion["harmonic"];
  return m.value("mean", 0.0) +
         m["amplitude"].get<double>() * std::sin(m["omega"].get<double>() * t + m.value("phase", 0.0));
}

bool softens(const Json& joint) { return joint.contains("compliance"); }

}  // namespace

int Judge::body(const std::string& name) const {
  for (std::size_t i = 0; i < names_.size(); ++i)
    if (names_[i] == name) return static_cast<int>(i);
  throw std::invalid_argument("no body " + name);
}

const Judge::Tie& Judge::tie(const std::string& name) const {
  for (const Tie& t : ties_)
    if (t.name == name) return t;
  throw std::invalid_argument("no joint " + name);
}

Judge::Judge(const Json& scene) {
  read_bodies(scene);
  for (const Json& joint : scene.value("joints", Json::array()))
    read_joint(joint, static_cast<int>(ties_.size()));
  forces_ = scene.value("forces", Json::array());
  gravity_ = scene.contains("gravity") ? vec(scene["gravity"]) : Vec3(0, 0, -9.81);

  const Json settings = scene.value("settings", Json::object());
  const std::string integrator = settings.value("integrator", "rattle"),
                    solver = settings.value("solver", "direct");
  const bool direct = solver == "direct", rattle = integrator.starts_with("rattle");
  const bool force_level = integrator.starts_with("force"), moreau = integrator == "moreau-jean";
  holds_joints_ = direct && (rattle || (moreau && settings.value("drift_cure", "auto") != "none"));

  // Nothing from outside: no gravity, no ground in joints, forces and contacts, nothing that is pushed in the
  // world.
  bool is_free = gravity_.norm() == 0 && !scene.contains("ground");
  bool conserves = true;
  for (const Tie& t : ties_) {
    if (t.type == "pose_driver" || t.type == "driver") is_free = conserves = false;
    if (t.type == "point_on_curve") conserves = false;  // where splines bend, it turns faster than it shows
    if (t.keys.contains("a") && t.keys["a"] == "ground") is_free = false;
    for (const auto& [at, point] : t.points) is_free = is_free && at != 0;
    if (softens(t.keys)) conserves = false;  // its springs are in the report only
    const Json axes = t.keys.value("axes", Json::object());
    for (const Json& properties : axes) {
      if (properties.contains("motor")) conserves = false;
      if (properties.contains("limits") && properties["limits"].contains("compliance")) conserves = false;
      if (properties.contains("spring")) conserves = false;
    }
  }
  for (const Json& force : forces_) {
    const std::string type = force["type"];
    if (type != "spring-damper" || force["a"] == "ground") is_free = false;
    for (const Json& point : force.value("table", Json::array()))
      internal_push_ = std::max(internal_push_, std::abs(point[1].get<double>()));
    if (type == "torque" || force.value("follows_body", false) || force.contains("table")) conserves = false;
  }
  // Iterative solvers meet laws as far as they come, and what falls asleep is stopped.
  meets_laws_ = direct;
  is_free = is_free && !settings.value("sleep", false);
  keeps_linear_ = is_free;
  keeps_angular_ = is_free && direct && rattle;
  bool touches = false;
  for (const Json& b : scene["bodies"]) touches = touches || b.contains("shapes");
  angular_bound_ = touches || integrator != "rattle" ? 1e-6 : 1e-7;
  keeps_energy_ = conserves && direct && rattle && !touches &&
                  settings.value("tension", "substep") != "ignore" && !force_level;
}

void Judge::read_bodies(const Json& scene) {
  bodies_.push_back({});
  bodies_[0].fixed = true;
  names_.push_back("ground");
  for (const Json& json : scene["bodies"]) {
    Body b;
    b.mass = json["mass"], b.moments = vec(json["inertia"]);
    b.start.p = vec_or_zero(json, "position");
    if (json.contains("orientation")) b.start.q = quat(json["orientation"]);
    b.fixed = json.value("fixed", false);
    if (!b.fixed) total_mass_ += b.mass;
    bodies_.push_back(b);
    names_.push_back(json["name"]);
  }
}

void Judge::read_joint(const Json& joint, int index) {
  Tie t;
  t.name = joint.value("name", "joint_" + std::to_string(index)), t.type = joint["type"], t.keys = joint;
  t.rigid = !softens(joint);
  if (joint.contains("a")) t.a = body(joint["a"]), t.b = body(joint["b"]);
  const Pose &A = bodies_[t.a].start, &B = bodies_[t.b].start;
  const bool curve = t.type == "point_on_curve";
  if (joint.contains("anchor")) t.p_A = A.local(vec(joint["anchor"])), t.p_B = B.local(vec(joint["anchor"]));
  if (joint.contains("anchor_a")) t.p_A = A.local(vec(joint["anchor_a"]));
  if (joint.contains("anchor_b")) t.p_B = B.local(vec(joint["anchor_b"]));
  const auto turned = [](const Pose& pose, const Json& axis) {
    return Vec3(pose.q.conjugate() * vec(axis).normalized());
  };
  if (joint.contains("axis")) t.axis_A = turned(A, joint["axis"]), t.axis_B = turned(B, joint["axis"]);
  if (joint.contains("axis_a")) t.axis_A = turned(A, joint["axis_a"]);
  if (joint.contains("axis_b")) t.axis_B = turned(B, joint["axis_b"]);
  t.q_AB = (A.q.conjugate() * B.q).normalized();
  if (joint.contains("frame_orientation")) {
    const Quat F = quat(joint["frame_orientation"]);
    t.q_AF = A.q.conjugate() * F, t.q_BG = B.q.conjugate() * F;
  }
  if (joint.contains("points"))
    for (const Json& point : joint["points"]) {
      const int at = curve ? t.a : body(point["body"]);
      t.points.emplace_back(at, bodies_[at].start.local(vec(curve ? point : point["point"])));
    }
  ties_.push_back(std::move(t));
}

/// The way along the points; the last section counts `last_weight` times, and the one on the sheaves not if
/// that is a pulley.
double Judge::wire_of(const Tie& t, const State& state, double last_weight) const {
  double way = 0;
  for (std::size_t i = 1; i < t.points.size(); ++i) {
    const auto& [a, p] = t.points[i - 1];
    const auto& [b, q] = t.points[i];
    const double section = (state.poses[b].point(q) - state.poses[a].point(p)).norm();
    const bool last = i + 1 == t.points.size();
    if (t.type == "pulley" && i == 2) continue;
    way += last ? last_weight * section : section;
  }
  return way;
}

/// Of a hinge, cylindrical or screw joint: turn of B about the axis since the start, within half a turn.
double Judge::angle_of(const Tie& t, const State& state) const {
  const Quat q_AB = state.poses[t.a].q.conjugate() * state.poses[t.b].q;
  const Quat turn = q_AB * t.q_AB.conjugate();  // in axes of A
  return 2 * std::atan2(turn.vec().dot(t.axis_A), turn.w());
}

double Judge::displacement_of(const Tie& t, const State& state) const {
  const Pose &A = state.poses[t.a], &B = state.poses[t.b];
  return (A.q * t.axis_A).dot(B.point(t.p_B) - A.point(t.p_A));
}

/// Couplings of axes of hinges, sliders and cylindrical joints, to whole turns of each of the angles; 0 for
/// others.
double Judge::coupling_gap(const Tie& t, const State& state) const {
  std::vector<std::pair<double, const Json*>> terms;
  double wanted = 0;
  if (t.type == "gear")
    terms = {{1, &t.keys["driven"]}, {-t.keys["ratio"].get<double>(), &t.keys["driving"]}};
  if (t.type == "rack_and_pinion")
    terms = {{1, &t.keys["rack"]}, {-t.keys["radius"].get<double>(), &t.keys["pinion"]}};
  if (t.type == "differential")
    terms = {{1, &t.keys["input"]}, {-0.5, &t.keys["left"]}, {-0.5, &t.keys["right"]}};
  if (t.type == "driver") terms = {{1, &t.keys["of"]}}, wanted = motion_at(t.keys["motion"], state.time);
  double sum = -wanted;
  std::vector<double> turns;
  for (const auto& [factor, axis] : terms) {
    const Tie& of = tie((*axis)["joint"]);
    const std::string name = (*axis)["axis"];
    if (of.type != "hinge" && of.type != "slider" && of.type != "cylindrical") return 0;
    if (!of.rigid) return 0;
    if (name == "angle") turns.push_back(factor * kTurn);
    sum += factor * (name == "angle" ? angle_of(of, state) : displacement_of(of, state));
  }
  double best = std::abs(sum);
  // Whole turns of each angle: of all but the last that many, of the last as many as fit.
  constexpr int kTurns = 20;
  const auto whole_turns = [&](auto&& self, std::size_t i, double s) -> void {
    if (i == turns.size()) return;
    if (i + 1 == turns.size()) {
      best = std::min(best, std::abs(std::remainder(s, turns[i])));
      return;
    }
    for (int k = -kTurns; k <= kTurns; ++k) self(self, i + 1, s + k * turns[i]);
  };
  whole_turns(whole_turns, 0, sum);
  return best;
}

double Judge::gap_of(const Tie& t, const World& world) const {
  const State& state = world.state();
  const Pose &A = state.poses[t.a], &B = state.poses[t.b];
  const Vec3 d = B.point(t.p_B) - A.point(t.p_A);
  const Vec3 a = A.q * t.axis_A, b = B.q * t.axis_B;
  const auto turn = [&] { return turn_between(A.q * t.q_AB, B.q); };
  const auto tilt = [&] { return std::atan2(a.cross(b).norm(), a.dot(b)); };
  if (t.type == "ball") return d.norm();
  if (t.type == "hinge") return std::max(d.norm(), tilt());
  if (t.type == "slider") return std::max(off_axis(d, a).norm(), turn());
  if (t.type == "fixed") return std::max(d.norm(), turn());
  if (t.type == "universal") return std::max(d.norm(), std::abs(a.dot(b)));
  if (t.type == "cylindrical") return std::max(off_axis(d, a).norm(), tilt());
  if (t.type == "planar") return std::max(std::abs(a.dot(d)), tilt());
  if (t.type == "point_on_line") return off_axis(d, a).norm();
  if (t.type == "hinge2") return std::max(off_axis(d, a).norm(), std::abs(a.dot(b)));
  if (t.type == "distance") {
    const double start = (bodies_[t.b].start.point(t.p_B) - bodies_[t.a].start.point(t.p_A)).norm();
    return std::abs(d.norm() - t.keys.value("length", start));
  }
  if (t.type == "screw") {
    const double pitch = t.keys["pitch"],
                 off = displacement_of(t, state) - pitch * angle_of(t, state) / kTurn;
    return std::max({off_axis(d, a).norm(), tilt(), std::abs(off - pitch * std::round(off / pitch))});
  }
  if (t.type == "six_dof") {
    const Mat3 F = (A.q * t.q_AF).toRotationMatrix(), G = (B.q * t.q_BG).toRotationMatrix();
    static constexpr const char* kNames[] = {"x", "y", "z", "angle_x", "angle_y", "angle_z"};
    bool locked[6];
    for (int i = 0; i < 6; ++i)
      locked[i] =
          std::find(t.keys["locked"].begin(), t.keys["locked"].end(), kNames[i]) != t.keys["locked"].end();
    double gap = 0;
    for (int i = 0; i < 3; ++i)
      if (locked[i]) gap = std::max(gap, std::abs(F.col(i).dot(d)));
    const int count = locked[3] + locked[4] + locked[5];
    if (count == 3) gap = std::max(gap, turn_between(A.q * t.q_AF, B.q * t.q_BG));
    for (int k = 0; k < 3; ++k) {
      if (count == 2 && !locked[3 + k]) gap = std::max(gap, F.col(k).cross(G.col(k)).norm());
      if (count == 1 && locked[3 + k])
        gap = std::max(gap, std::abs(F.col((k + 1) % 3).dot(G.col((k + 2) % 3))));
    }
    return gap;
  }
  if (t.type == "rope") {
    const double way = t.points.empty() ? d.norm() : wire_of(t, state, 1);
    return std::max(0.0, way - t.keys["length"].get<double>());
  }
  if (t.type == "pulley") {
    const double ratio = t.keys.value("ratio", 1.0);
    State start;
    for (const Body& each : bodies_) start.poses.push_back(each.start);
    return std::abs(wire_of(t, state, ratio) - wire_of(t, start, ratio));
  }
  if (t.type == "pose_driver") {
    Vec3 p(0, 0, 0);
    for (int i = 0; i < 3; ++i) p[i] = motion_at(t.keys["position"][i], state.time);
    Quat q = t.q_AB;
    if (t.keys.contains("turns")) {
      const double half = motion_at(t.keys["turns"][0]["angle"], state.time) / 2;
      const Vec3 v = std::sin(half) * vec(t.keys["turns"][0]["axis"]).normalized();
      q = t.q_AB * Quat(std::cos(half), v.x(), v.y(), v.z());
    }
    const double off = (A.local(B.p) - p).norm();
    return t.keys.contains("turns") ? off : std::max(off, turn_between(A.q * q, B.q));
  }
  if (t.type == "gear" || t.type == "rack_and_pinion" || t.type == "differential" || t.type == "driver")
    return coupling_gap(t, state);
  return 0;  // point_on_curve: no formula here
}

std::optional<Violation> Judge::judge_gaps(const World& world, const StepReport& report) const {
  double size = 0;
  for (const Pose& pose : world.state().poses) size = std::max(size, pose.p.norm());
  // Round-off of positions that far out.
  const double bound = 1e-9 + 1e-15 * size;
  for (std::size_t i = 0; i < ties_.size(); ++i) {
    const Tie& t = ties_[i];
    if (!t.rigid || !world.is_attached(JointId{static_cast<int>(i)})) continue;
    // Ropes with softened or iterated limits are no promise.
    const double gap = gap_of(t, world);
    const double reported = std::max(report.gap.metres, report.gap.radians);
    if (!std::isfinite(gap) || (holds_joints_ && gap > bound))
      return Violation{"gap",
                       t.type + " " + t.name + text(": open by %.3g, the report says %.3g", gap, reported)};
    if (gap > 4 * reported + bound)
      return Violation{"gap of the report",
                       t.type + " " + t.name + text(": open by %.3g, the report says %.3g", gap, reported)};
  }
  return {};
}

Judge::Momentum Judge::momentum(const State& state) const {
  Momentum m;
  Vec3 centre =
      Vec3::Zero();  // about a point near the bodies: far from the origin P × r would drown the rest
  for (std::size_t i = 1; i < bodies_.size(); ++i)
    centre += bodies_[i].start.p / static_cast<double>(bodies_.size() - 1);
  for (std::size_t i = 1; i < bodies_.size(); ++i) {
    const Body& b = bodies_[i];
    if (b.fixed) continue;
    const Pose& pose = state.poses[i];
    const Twist& V = state.twists[i];
    const Vec3 p = b.mass * V.v, r = pose.p - centre;
    const Vec3 w = pose.q.conjugate() * V.w;
    const Vec3 spin = pose.q * Vec3(b.moments.cwiseProduct(w));
    m.linear += p, m.angular += r.cross(p) + spin;
    m.linear_scale += p.norm(), m.angular_scale += r.norm() * p.norm() + spin.norm();
  }
  return m;
}

std::optional<Violation> Judge::judge_momentum(const World& world, const StepReport& report, double dt) {
  const Momentum now = momentum(world.state());
  // Round-off of positions is a motion, too, and what springs push with cancels to round-off.
  const double noise = 1e-14 * total_mass_ * size_ / dt + 1e-15 * internal_push_ * dt;
  // So is what happens within joints, which are closed to 1e-10 m in each sub-step, in mechanisms that cannot
  // move.
  const double jammed = 1e-10 * total_mass_ * size_ / dt * std::max(1, report.substeps);
  momentum_scale_ = std::max(momentum_scale_, now.linear_scale);
  angular_scale_ = std::max(angular_scale_, now.angular_scale);
  const double linear = (now.linear - before_.linear).norm(),
               angular = (now.angular - before_.angular).norm();
  // A force level that has torn its joints apart makes impulses far beyond all momenta.
  if (report.gap.metres > size_) keeps_linear_ = false;
  if (keeps_linear_ && !(linear <= 1e-12 * momentum_scale_ + noise))
    return Violation{"momentum", text("changed by %.3g of %.3g kg m/s", linear, momentum_scale_)};
  if (keeps_angular_ && !(angular <= angular_bound_ * angular_scale_ + jammed))
    return Violation{"angular momentum", text("changed by %.3g of %.3g kg m2/s", angular, angular_scale_)};
  return {};
}

double Judge::kinetic(const State& state) const {
  double twice = 0;
  for (std::size_t i = 1; i < bodies_.size(); ++i) {
    const Twist& V = state.twists[i];
    const Vec3 w = state.poses[i].q.conjugate() * V.w;
    twice += bodies_[i].mass * V.v.squaredNorm() + w.dot(Vec3(bodies_[i].moments.cwiseProduct(w)));
  }
  return twice / 2;
}

/// Of gravity, springs between bodies and forces in world axes; `push` [N]: what all of them push with.
double Judge::potential(const State& state, double& push) const {
  double energy = 0;
  push = total_mass_ * gravity_.norm();
  for (std::size_t i = 1; i < bodies_.size(); ++i) energy -= bodies_[i].mass * gravity_.dot(state.poses[i].p);
  for (const Json& force : forces_) {
    if (force["type"] == "point-force") {
      const int at = body(force["body"]);
      push += vec(force["force"]).norm();
      energy -= vec(force["force"]).dot(state.poses[at].point(vec_or_zero(force, "point")));
    }
    if (force["type"] != "spring-damper") continue;
    const int a = body(force["a"]), b = body(force["b"]);
    const Vec3 p = bodies_[a].start.local(vec(force["anchor_a"])),
               q = bodies_[b].start.local(vec(force["anchor_b"]));
    const double start = (vec(force["anchor_b"]) - vec(force["anchor_a"])).norm();
    const double stretch =
        (state.poses[b].point(q) - state.poses[a].point(p)).norm() - force.value("rest_length", start);
    const double stiffness = force.value("stiffness", 0.0);
    energy += stiffness / 2 * stretch * stretch;
    push += stiffness * std::abs(stretch);
  }
  return energy;
}

/// The fastest that anything in the mechanism turns or swings, in a step: bodies, rods about their ends, and
/// springs, by the inverse mass that their ends show [rad].
double Judge::fastest_angle(const State& state, double dt) const {
  double fastest = 0;
  const auto speed = [&](int a, const Vec3& p, int b, const Vec3& q) {
    const Twist &A = state.twists[a], &B = state.twists[b];
    return (B.at(state.poses[b].q * q) - A.at(state.poses[a].q * p)).norm();
  };
  const auto length = [&](int a, const Vec3& p, int b, const Vec3& q) {
    return (state.poses[b].point(q) - state.poses[a].point(p)).norm();
  };
  const auto lightness = [&](int i, const Vec3& p) {
    const Body& b = bodies_[i];
    return b.fixed ? 0 : 1 / b.mass + p.squaredNorm() / b.moments.minCoeff();
  };
  for (const Twist& V : state.twists) fastest = std::max(fastest, V.w.norm());
  for (const Tie& t : ties_) {
    if (t.type == "distance" || (t.type == "rope" && t.points.empty()))
      fastest = std::max(fastest, speed(t.a, t.p_A, t.b, t.p_B) / length(t.a, t.p_A, t.b, t.p_B));
    for (std::size_t i = 1; i < t.points.size(); ++i) {
      const auto& [a, p] = t.points[i - 1];
      const auto& [b, q] = t.points[i];
      if (a != b) fastest = std::max(fastest, speed(a, p, b, q) / length(a, p, b, q));
    }
  }
  for (const Json& force : forces_) {
    if (force["type"] != "spring-damper") continue;
    const int a = body(force["a"]), b = body(force["b"]);
    const Vec3 p = bodies_[a].start.local(vec(force["anchor_a"])),
               q = bodies_[b].start.local(vec(force["anchor_b"]));
    const double omega = std::sqrt(force.value("stiffness", 0.0) * (lightness(a, p) + lightness(b, q)));
    fastest = std::max({fastest, omega, speed(a, p, b, q) / length(a, p, b, q)});
  }
  return fastest * dt;
}

/// E may swing by (ω h)² of the energies that go to and fro, and not grow beyond: the order of the
/// integrators.  Joints are closed to 1e-10 m, over which weights and forces do work.
std::optional<Violation> Judge::judge_energy(const World& world, double dt) {
  double push = 0;
  const double T = kinetic(world.state()), U = potential(world.state(), push), E = T + U;
  angle_scale_ = std::max(angle_scale_, fastest_angle(world.state(), dt));
  // What turns from rest, or along a bend, shows by how its turning changes.
  for (std::size_t i = 0; i < twists_before_.size(); ++i) {
    const double change = (world.state().twists[i].w - twists_before_[i].w).norm();
    angle_scale_ = std::max(angle_scale_, std::sqrt(change * dt));
  }
  twists_before_ = world.state().twists;
  if (steps_ < 2) {  // the first step takes away the velocities that joints forbid
    least_energy_ = E, first_potential_ = U, energy_scale_ = T;
    return {};
  }
  energy_scale_ = std::max({energy_scale_, T, std::abs(U - first_potential_)});
  least_energy_ = std::min(least_energy_, E);
  push += energy_scale_ / size_ + total_mass_ * 1e-10 / (dt * dt);
  const double allowed =
      energy_scale_ * (1e-9 + 4 * angle_scale_ * angle_scale_) + 1e-12 * std::abs(E) + 1e-9 * push;
  if (angle_scale_ < 0.3 && !(E - least_energy_ <= allowed))
    return Violation{"energy", text("grew by %.3g J, of %.3g J at most that move; %.3g rad a step",
                                    E - least_energy_, energy_scale_, angle_scale_)};
  return {};
}

void Judge::start(const World& world) {
  before_ = momentum(world.state());
  for (std::size_t i = 1; i < bodies_.size(); ++i) size_ = std::max(size_, bodies_[i].start.p.norm());
}

std::optional<Violation> Judge::judge(const World& world, const StepReport& report, double dt) {
  ++steps_;
  for (const Pose& pose : world.state().poses)
    if (!pose.p.allFinite() || !pose.q.coeffs().allFinite())
      return Violation{"finite", "a pose is not finite"};
  for (const Twist& V : world.state().twists)
    if (!V.v.allFinite() || !V.w.allFinite()) return Violation{"finite", "a twist is not finite"};
  // Met to 1e-8 by the rates of the solve; those of the report are summed up from momenta.
  if (meets_laws_ && report.exact() && !(report.natural_residual <= 1.01e-8))
    return Violation{"natural residual", text("%.3g with success", report.natural_residual)};
  if (auto bad = judge_gaps(world, report)) return bad;
  if (auto bad = judge_momentum(world, report, dt)) return bad;
  if (keeps_energy_)
    if (auto bad = judge_energy(world, dt)) return bad;
  return {};
}

}  // namespace taut::fuzz
