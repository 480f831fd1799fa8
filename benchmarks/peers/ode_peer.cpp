#include <ode/ode.h>

#include "benchmarks/peers/peer.h"

/// ODE.  Methods: step (dense direct), quick (projected Gauss–Seidel: iters, default 20); erp, default 0.2.
namespace {

using namespace taut;
using namespace taut::peers;

class OdeEngine final : public Engine {
 public:
  OdeEngine(const System& system, const Method& method, double dt) : dt_(dt), quick_(method.name == "quick") {
    if (!quick_ && method.name != "step") throw Unsupported("method " + method.name);
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    world_ = dWorldCreate();
    const Vec3& g = system.world->gravity();
    dWorldSetGravity(world_, g.x(), g.y(), g.z());
    dWorldSetERP(world_, method.get("erp", 0.2));
    dWorldSetCFM(world_, method.get("cfm", 1e-10));
    dWorldSetQuickStepNumIterations(world_, static_cast<int>(method.get("iters", 20)));
    dWorldSetAutoDisableFlag(world_, 0);
    for (int b = 1; b < system.body_count(); ++b) add_body(system, b);
    for (const PeerJoint& joint : system.joints) add_joint(joint);
  }
  ~OdeEngine() override {
    dWorldDestroy(world_);
    dCloseODE();
  }
  OdeEngine(const OdeEngine&) = delete;
  OdeEngine& operator=(const OdeEngine&) = delete;

  void step() override { ok_ = quick_ ? dWorldQuickStep(world_, dt_) : dWorldStep(world_, dt_); }
  std::string trouble() const override { return ok_ ? "" : "ODE could not allocate memory"; }
  void read(State& state) override {
    for (std::size_t b = 1; b < bodies_.size(); ++b) {
      const dReal *p = dBodyGetPosition(bodies_[b]), *q = dBodyGetQuaternion(bodies_[b]);
      const dReal *v = dBodyGetLinearVel(bodies_[b]), *w = dBodyGetAngularVel(bodies_[b]);
      state.poses[b] = {Quat(q[0], q[1], q[2], q[3]), Vec3(p[0], p[1], p[2])};
      state.twists[b] = {Vec3(w[0], w[1], w[2]), Vec3(v[0], v[1], v[2])};
    }
  }

 private:
  void add_body(const System& system, int b) {
    const Pose& pose = system.pose(b);
    const Vec3 moments = system.moments(b);
    dMass mass;
    dMassSetParameters(&mass, system.mass(b), 0, 0, 0, moments.x(), moments.y(), moments.z(), 0, 0, 0);
    dBodyID body = dBodyCreate(world_);
    dBodySetMass(body, &mass);
    dBodySetPosition(body, pose.p.x(), pose.p.y(), pose.p.z());
    const dQuaternion q = {pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z()};
    dBodySetQuaternion(body, q);
    bodies_.push_back(body);
  }
  void add_joint(const PeerJoint& joint) {
    dJointID id = nullptr;
    if (joint.kind == JointKind::kBall) id = dJointCreateBall(world_, nullptr);
    if (joint.kind == JointKind::kHinge) id = dJointCreateHinge(world_, nullptr);
    if (joint.kind == JointKind::kFixed) id = dJointCreateFixed(world_, nullptr);
    dJointAttach(id, bodies_[joint.a], bodies_[joint.b]);
    const Vec3& p = joint.p_W;
    if (joint.kind == JointKind::kBall) dJointSetBallAnchor(id, p.x(), p.y(), p.z());
    if (joint.kind == JointKind::kHinge) {
      dJointSetHingeAnchor(id, p.x(), p.y(), p.z());
      dJointSetHingeAxis(id, joint.axis_W.x(), joint.axis_W.y(), joint.axis_W.z());
    }
    if (joint.kind == JointKind::kFixed) dJointSetFixed(id);
  }

  double dt_;
  bool quick_;
  int ok_ = 1;
  dWorldID world_ = nullptr;
  std::vector<dBodyID> bodies_{nullptr};  // 0 is the world
};

}  // namespace

int main(int argc, char** argv) {
  return peer_main(argc, argv, "ODE", [](const System& system, const Method& method, double dt) {
    return std::make_unique<OdeEngine>(system, method, dt);
  });
}
