#include <BulletDynamics/MLCPSolvers/btDantzigSolver.h>
#include <BulletDynamics/MLCPSolvers/btMLCPSolver.h>
#include <btBulletDynamicsCommon.h>

#include "benchmarks/peers/bullet_multibody.h"
#include "benchmarks/peers/peer.h"

/// Bullet in double precision.  Methods: si (sequential impulses: iters, default 10), mlcp (Dantzig), both
/// with erp, default 0.2; featherstone (rk4=1) for trees.
namespace {

using namespace taut;
using namespace taut::peers;

btVector3 vector(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

class BulletEngine final : public Engine {
 public:
  BulletEngine(const System& system, const Method& method, double dt) : dt_(dt) {
    if (method.name == "mlcp")
      solver_ = std::make_unique<btMLCPSolver>(&dantzig_);
    else if (method.name == "si")
      solver_ = std::make_unique<btSequentialImpulseConstraintSolver>();
    else
      throw Unsupported("method " + method.name);
    world_ = std::make_unique<btDiscreteDynamicsWorld>(&dispatcher_, &broad_phase_, solver_.get(),
                                                       &configuration_);
    world_->setGravity(vector(system.world->gravity()));
    world_->getSolverInfo().m_numIterations = static_cast<int>(method.get("iters", 10));
    world_->getSolverInfo().m_erp = method.get("erp", 0.2);
    for (int b = 0; b < system.body_count(); ++b) add_body(system, b);
    for (const PeerJoint& joint : system.joints) add_joint(system, joint);
  }
  ~BulletEngine() override {
    for (const auto& joint : joints_) world_->removeConstraint(joint.get());
    for (const auto& body : bodies_) world_->removeRigidBody(body.get());
  }
  BulletEngine(const BulletEngine&) = delete;
  BulletEngine& operator=(const BulletEngine&) = delete;

  void step() override { world_->stepSimulation(dt_, 0); }
  void read(State& state) override {
    for (std::size_t b = 1; b < bodies_.size(); ++b) {
      const btTransform& X = bodies_[b]->getWorldTransform();
      const btQuaternion q = X.getRotation();
      const btVector3 &p = X.getOrigin(), &v = bodies_[b]->getLinearVelocity(),
                      &w = bodies_[b]->getAngularVelocity();
      state.poses[b] = {Quat(q.w(), q.x(), q.y(), q.z()).normalized(), Vec3(p.x(), p.y(), p.z())};
      state.twists[b] = {Vec3(w.x(), w.y(), w.z()), Vec3(v.x(), v.y(), v.z())};
    }
  }

 private:
  void add_body(const System& system, int b) {
    const Pose& pose = system.pose(b);
    const btTransform X(btQuaternion(pose.q.x(), pose.q.y(), pose.q.z(), pose.q.w()), vector(pose.p));
    const double mass = b == 0 ? 0 : system.mass(b);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, &shape_,
                                                  b == 0 ? btVector3(0, 0, 0) : vector(system.moments(b)));
    info.m_startWorldTransform = X;
    info.m_linearDamping = info.m_angularDamping = 0;
    auto body = std::make_unique<btRigidBody>(info);
    body->setActivationState(DISABLE_DEACTIVATION);
    world_->addRigidBody(body.get(), 0, 0);
    bodies_.push_back(std::move(body));
  }
  void add_joint(const System& system, const PeerJoint& joint) {
    btRigidBody &A = *bodies_[joint.a], &B = *bodies_[joint.b];
    const btVector3 on_a = vector(joint.p_AP), on_b = vector(joint.p_BQ);
    const auto local = [&](int body) { return vector(system.pose(body).q.conjugate() * joint.axis_W); };
    if (joint.kind == JointKind::kBall)
      joints_.push_back(std::make_unique<btPoint2PointConstraint>(A, B, on_a, on_b));
    else if (joint.kind == JointKind::kHinge)
      joints_.push_back(
          std::make_unique<btHingeConstraint>(A, B, on_a, on_b, local(joint.a), local(joint.b)));
    else
      joints_.push_back(std::make_unique<btFixedConstraint>(
          A, B, btTransform(btQuaternion::getIdentity(), on_a),
          btTransform(B.getOrientation().inverse() * A.getOrientation(), on_b)));
    world_->addConstraint(joints_.back().get(), true);
  }

  double dt_;
  btEmptyShape shape_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broad_phase_;
  btDantzigSolver dantzig_;
  std::unique_ptr<btConstraintSolver> solver_;
  std::unique_ptr<btDiscreteDynamicsWorld> world_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::vector<std::unique_ptr<btTypedConstraint>> joints_;
};

}  // namespace

int main(int argc, char** argv) {
  return peer_main(argc, argv, "Bullet",
                   [](const System& system, const Method& method, double dt) -> std::unique_ptr<Engine> {
                     if (method.name == "featherstone") return make_bullet_multibody(system, method, dt);
                     return std::make_unique<BulletEngine>(system, method, dt);
                   });
}
