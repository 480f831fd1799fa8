#include "core/force.h"

namespace taut {

PointForce::PointForce(BodyId body, const Vec3& p_BP, const Vec3& force, bool follows_body)
    : body_(body), p_BP_(p_BP), force_(force), follows_body_(follows_body) {
  require_all_finite("force point", p_BP);
  require_all_finite("force", force);
}

void PointForce::accumulate(const State& state, std::span<Wrench> wrenches) const {
  const Pose& B = state.poses[body_.index];
  const Vec3 f = follows_body_ ? Vec3(B.q * force_) : force_;
  wrenches[body_.index].force += f;
  wrenches[body_.index].torque += (B.q * p_BP_).cross(f);
}

double PointForce::potential_energy(const State& state) const {
  return follows_body_ ? 0 : -force_.dot(state.poses[body_.index].point(p_BP_));
}

std::shared_ptr<const Force> PointForce::relocated(const Relocation& to, const Pose& X) const {
  return std::make_shared<PointForce>(to(body_), p_BP_, follows_body_ ? force_ : Vec3(X.q * force_),
                                      follows_body_);
}

BodyTorque::BodyTorque(BodyId body, const Vec3& torque, bool follows_body)
    : body_(body), torque_(torque), follows_body_(follows_body) {
  require_all_finite("torque", torque);
}

void BodyTorque::accumulate(const State& state, std::span<Wrench> wrenches) const {
  wrenches[body_.index].torque += follows_body_ ? Vec3(state.poses[body_.index].q * torque_) : torque_;
}

std::shared_ptr<const Force> BodyTorque::relocated(const Relocation& to, const Pose& X) const {
  return std::make_shared<BodyTorque>(to(body_), follows_body_ ? torque_ : Vec3(X.q * torque_),
                                      follows_body_);
}

SpringDamper::SpringDamper(BodyId a, BodyId b, const Vec3& p_AP, const Vec3& p_BQ, double stiffness,
                           double rest_length, double damping)
    : a_(a), b_(b), p_AP_(p_AP), p_BQ_(p_BQ), k_(stiffness), rest_(rest_length), c_(damping) {
  require_all_finite("spring anchor on A", p_AP);
  require_all_finite("spring anchor on B", p_BQ);
  require_not_negative("spring stiffness", stiffness);
  require_not_negative("spring rest length", rest_length);
  require_not_negative("spring damping", damping);
}

SpringDamper::Pull SpringDamper::pull(const State& state) const {
  Pull pull{state.poses[a_.index].q * p_AP_, state.poses[b_.index].q * p_BQ_};
  const Vec3 d = (state.poses[b_.index].p - state.poses[a_.index].p) + (pull.r_B - pull.r_A);
  const double length = d.norm();
  if (length == 0) return pull;  // no direction to pull along
  pull.n = d / length;
  const double rate = pull.n.dot(state.twists[b_.index].at(pull.r_B) - state.twists[a_.index].at(pull.r_A));
  pull.tension = k_ * (length - rest_) + c_ * rate;
  return pull;
}

void SpringDamper::accumulate(const State& state, std::span<Wrench> wrenches) const {
  const auto [r_A, r_B, n, tension] = pull(state);
  const Vec3 on_B = -tension * n;
  wrenches[b_.index].force += on_B;
  wrenches[b_.index].torque += r_B.cross(on_B);
  wrenches[a_.index].force -= on_B;
  wrenches[a_.index].torque -= r_A.cross(on_B);
}

std::optional<LineForce> SpringDamper::line_force(const State& state) const {
  return LineForce{a_, b_, p_AP_, p_BQ_, pull(state).tension, k_ > 0};
}

double SpringDamper::potential_energy(const State& state) const {
  const double length = (state.poses[b_.index].point(p_BQ_) - state.poses[a_.index].point(p_AP_)).norm();
  return 0.5 * k_ * (length - rest_) * (length - rest_);
}

std::shared_ptr<const Force> SpringDamper::relocated(const Relocation& to, const Pose&) const {
  return std::make_shared<SpringDamper>(to(a_), to(b_), p_AP_, p_BQ_, k_, rest_, c_);
}

void ForceCallback::accumulate(const State& state, std::span<Wrench> wrenches) const {
  function_(state, wrenches);
}

double ForceCallback::potential_energy(const State& state) const {
  return potential_ ? potential_(state) : 0;
}

}  // namespace taut
