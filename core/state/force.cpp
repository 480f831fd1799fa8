#include "core/state/force.h"

namespace taut {

namespace {

double value_at(const Motion& factor, double time) { return factor ? factor(time).value : 1; }

}  // namespace

PointForce::PointForce(BodyId body, const Vec3& p_BP, const Vec3& force, bool follows_body, Motion factor)
    : body_(body), p_BP_(p_BP), force_(force), follows_body_(follows_body), factor_(std::move(factor)) {
  require_all_finite("force point", p_BP);
  require_all_finite("force", force);
}

void PointForce::accumulate(const State& state, std::span<Wrench> wrenches) const {
  const Pose& B = state.poses[body_.index];
  const Vec3 f = value_at(factor_, state.time) * (follows_body_ ? Vec3(B.q * force_) : force_);
  wrenches[body_.index].force += f;
  wrenches[body_.index].torque += (B.q * p_BP_).cross(f);
}

double PointForce::potential_energy(const State& state) const {
  return conservative() ? -force_.dot(state.poses[body_.index].point(p_BP_)) : 0;
}

std::shared_ptr<const Force> PointForce::relocated(const Relocation& to, const Pose& X) const {
  return std::make_shared<PointForce>(to(body_), p_BP_, follows_body_ ? force_ : Vec3(X.q * force_),
                                      follows_body_, factor_);
}

BodyTorque::BodyTorque(BodyId body, const Vec3& torque, bool follows_body, Motion factor)
    : body_(body), torque_(torque), follows_body_(follows_body), factor_(std::move(factor)) {
  require_all_finite("torque", torque);
}

void BodyTorque::accumulate(const State& state, std::span<Wrench> wrenches) const {
  const Vec3 torque = follows_body_ ? Vec3(state.poses[body_.index].q * torque_) : torque_;
  wrenches[body_.index].torque += value_at(factor_, state.time) * torque;
}

std::shared_ptr<const Force> BodyTorque::relocated(const Relocation& to, const Pose& X) const {
  return std::make_shared<BodyTorque>(to(body_), follows_body_ ? torque_ : Vec3(X.q * torque_), follows_body_,
                                      factor_);
}

AccelerationField::AccelerationField(std::vector<FieldMass> masses, const Vec3& acceleration, Motion factor)
    : masses_(std::move(masses)), acceleration_(acceleration), factor_(std::move(factor)) {
  require_all_finite("acceleration field", acceleration);
  for (const FieldMass& its : masses_) require_not_negative("mass in acceleration field", its.mass);
}

void AccelerationField::accumulate(const State& state, std::span<Wrench> wrenches) const {
  const Vec3 a = value_at(factor_, state.time) * acceleration_;
  for (const FieldMass& its : masses_) wrenches[its.body.index].force += its.mass * a;
}

double AccelerationField::potential_energy(const State& state) const {
  double energy = 0;
  if (conservative())
    for (const FieldMass& its : masses_)
      energy -= its.mass * acceleration_.dot(state.poses[its.body.index].p);
  return energy;
}

std::vector<BodyId> AccelerationField::bodies() const {
  std::vector<BodyId> bodies;
  for (const FieldMass& its : masses_) bodies.push_back(its.body);
  return bodies;
}

std::shared_ptr<const Force> AccelerationField::relocated(const Relocation& to, const Pose& X) const {
  std::vector<FieldMass> masses = masses_;
  for (FieldMass& its : masses) its.body = to(its.body);
  return std::make_shared<AccelerationField>(std::move(masses), X.q * acceleration_, factor_);
}

SpringDamper::SpringDamper(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& p_BQ, double stiffness,
                           double rest_length, double damping)
    : SpringDamper(a, b, p_AP, p_BQ,
                   AxisSpring{.stiffness = stiffness, .damping = damping, .rest = rest_length}) {}

SpringDamper::SpringDamper(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& p_BQ, AxisSpring law)
    : spring_{a, b, p_AP, p_BQ, std::move(law)} {
  require_all_finite("spring anchor on A", p_AP);
  require_all_finite("spring anchor on B", p_BQ);
  require_not_negative("spring stiffness", spring_.law.stiffness);
  require_not_negative("spring rest length", spring_.law.rest);
  require_not_negative("spring damping", spring_.law.damping);
  check_axis("spring-damper", spring_.law);
}

SpringDamper::Pull SpringDamper::pull(const State& state) const {
  const Pose &A = state.poses[spring_.a.index], &B = state.poses[spring_.b.index];
  Pull pull{A.q * spring_.p_AP, B.q * spring_.p_BQ};
  const Vec3 d = (B.p - A.p) + (pull.r_B - pull.r_A);
  const double length = d.norm();
  if (length == 0) return pull;  // no direction to pull along
  pull.n = d / length;
  const double rate =
      pull.n.dot(state.twists[spring_.b.index].at(pull.r_B) - state.twists[spring_.a.index].at(pull.r_A));
  pull.tension = -spring_force(spring_.law, length) - damping_force(spring_.law, rate);
  return pull;
}

void SpringDamper::accumulate(const State& state, std::span<Wrench> wrenches) const {
  const auto [r_A, r_B, n, tension] = pull(state);
  const Vec3 on_B = -tension * n;
  Wrench &A = wrenches[spring_.a.index], &B = wrenches[spring_.b.index];
  B.force += on_B;
  B.torque += r_B.cross(on_B);
  A.force -= on_B;
  A.torque -= r_A.cross(on_B);
}

std::optional<LineForce> SpringDamper::line_force(const State& state) const {
  const bool elastic = spring_.law.stiffness > 0 || spring_.law.table;
  return LineForce{spring_.a, spring_.b, spring_.p_AP, spring_.p_BQ, pull(state).tension, elastic};
}

double SpringDamper::potential_energy(const State& state) const {
  const Pose &A = state.poses[spring_.a.index], &B = state.poses[spring_.b.index];
  return spring_energy(spring_.law, (B.point(spring_.p_BQ) - A.point(spring_.p_AP)).norm());
}

std::shared_ptr<const Force> SpringDamper::relocated(const Relocation& to, const Pose&) const {
  return std::make_shared<SpringDamper>(to(spring_.a), to(spring_.b), spring_.p_AP, spring_.p_BQ,
                                        spring_.law);
}

void ForceCallback::accumulate(const State& state, std::span<Wrench> wrenches) const {
  function_(state, wrenches);
}

double ForceCallback::potential_energy(const State& state) const {
  return potential_ ? potential_(state) : 0;
}

}  // namespace taut
