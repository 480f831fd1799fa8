#include "benchmarks/peers/plain.h"

namespace taut::peers {
namespace {

std::array<double, 3> plain(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
std::array<double, 4> plain(const Quat& q) { return {q.w(), q.x(), q.y(), q.z()}; }

PlainJoint joint_of(const System& system, const PeerJoint& joint, int a, int b) {
  Quat q_WF = Quat::Identity();
  if (joint.kind == JointKind::kHinge) q_WF = Quat::FromTwoVectors(Vec3::UnitZ(), joint.axis_W);
  const Pose &A = system.pose(a), &B = system.pose(b);
  PlainJoint out;
  out.kind = joint.kind == JointKind::kBall    ? PlainJoint::kBall
             : joint.kind == JointKind::kHinge ? PlainJoint::kHinge
                                               : PlainJoint::kFixed;
  out.a = a, out.b = b;
  out.p_A = plain(A.local(joint.p_W)), out.p_B = plain(B.local(joint.p_W));
  out.q_A = plain((A.q.conjugate() * q_WF).normalized()),
  out.q_B = plain((B.q.conjugate() * q_WF).normalized());
  return out;
}

}  // namespace

PlainSystem plain(const System& system) {
  refuse_contact(system);
  PlainSystem out;
  out.gravity = plain(system.world->gravity());
  out.bodies.resize(1);
  for (int b = 1; b < system.body_count(); ++b)
    out.bodies.push_back(
        {system.mass(b), plain(system.moments(b)), plain(system.pose(b).p), plain(system.pose(b).q)});
  for (const TreeEdge& edge : system.tree)
    out.tree.push_back(joint_of(system, system.joints[edge.joint], edge.parent, edge.child));
  for (int loop : system.loops)
    out.loops.push_back(joint_of(system, system.joints[loop], system.joints[loop].a, system.joints[loop].b));
  return out;
}

void set_motion(const std::vector<PlainMotion>& bodies, State& state) {
  for (std::size_t b = 1; b < bodies.size(); ++b) {
    const PlainMotion& x = bodies[b];
    state.poses[b] = {Quat(x[3], x[4], x[5], x[6]).normalized(), Vec3(x[0], x[1], x[2])};
    state.twists[b] = {Vec3(x[7], x[8], x[9]), Vec3(x[10], x[11], x[12])};
  }
}

}  // namespace taut::peers
