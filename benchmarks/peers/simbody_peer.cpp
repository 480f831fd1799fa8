#include "benchmarks/peers/peer.h"
#include "benchmarks/peers/simbody_mechanism.h"

/// Simbody: reduced coordinates of the spanning tree, loops closed by constraints and projection.  Methods:
/// rkm (Runge–Kutta–Merson with error control: acc, default 1e-3), euler (semi-explicit, fixed step); ctol.
namespace {

using namespace taut;
using namespace taut::peers;

std::array<double, 3> plain(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
std::array<double, 4> plain(const Quat& q) { return {q.w(), q.x(), q.y(), q.z()}; }

SimbodyJoint joint_of(const System& system, const PeerJoint& joint, int a, int b) {
  Quat q_WF = Quat::Identity();
  if (joint.kind == JointKind::kHinge) q_WF = Quat::FromTwoVectors(Vec3::UnitZ(), joint.axis_W);
  const Pose &A = system.pose(a), &B = system.pose(b);
  SimbodyJoint out;
  out.kind = joint.kind == JointKind::kBall    ? SimbodyJoint::kBall
             : joint.kind == JointKind::kHinge ? SimbodyJoint::kHinge
                                               : SimbodyJoint::kFixed;
  out.a = a, out.b = b;
  out.p_A = plain(A.local(joint.p_W)), out.p_B = plain(B.local(joint.p_W));
  out.q_A = plain((A.q.conjugate() * q_WF).normalized()),
  out.q_B = plain((B.q.conjugate() * q_WF).normalized());
  return out;
}

SimbodySystem plain(const System& system) {
  SimbodySystem out;
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

SimbodySettings settings_of(const Method& method, double dt) {
  if (method.name != "rkm" && method.name != "euler") throw Unsupported("method " + method.name);
  return {method.name == "euler", method.get("acc", 1e-3), method.get("ctol", 0), dt};
}

class SimbodyEngine final : public Engine {
 public:
  SimbodyEngine(const System& system, const Method& method, double dt)
      : dt_(dt), mechanism_(plain(system), settings_of(method, dt)) {}

  void step() override {
    try {
      mechanism_.step_to(++steps_ * dt_);
    } catch (const std::exception& error) {
      trouble_ = std::string("diverged: ").append(error.what()).substr(0, 160);
    }
  }
  std::string trouble() const override { return trouble_; }
  void read(State& state) override {
    mechanism_.read(bodies_);
    for (std::size_t b = 1; b < bodies_.size(); ++b) {
      const auto& x = bodies_[b];
      state.poses[b] = {Quat(x[3], x[4], x[5], x[6]).normalized(), Vec3(x[0], x[1], x[2])};
      state.twists[b] = {Vec3(x[7], x[8], x[9]), Vec3(x[10], x[11], x[12])};
    }
  }

 private:
  double dt_;
  int steps_ = 0;
  std::string trouble_;
  SimbodyMechanism mechanism_;
  std::vector<std::array<double, 13>> bodies_;
};

}  // namespace

int main(int argc, char** argv) {
  return peer_main(argc, argv, "Simbody", [](const System& system, const Method& method, double dt) {
    return std::make_unique<SimbodyEngine>(system, method, dt);
  });
}
