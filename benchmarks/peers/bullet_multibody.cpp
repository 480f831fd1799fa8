#include "benchmarks/peers/bullet_multibody.h"

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

namespace taut::peers {
namespace {

btVector3 vector(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
btQuaternion quaternion(const Quat& q) { return {q.x(), q.y(), q.z(), q.w()}; }

class BulletMultibody final : public Engine {
 public:
  BulletMultibody(const System& system, const Method& method, double dt)
      : dt_(dt),
        world_(&dispatcher_, &broad_phase_, &solver_, &configuration_),
        link_of_(system.body_count(), -1) {
    refuse_contact(system);
    if (!system.loops.empty()) throw Unsupported("a mechanism with loops in reduced coordinates");
    world_.setGravity(vector(system.world->gravity()));
    const int links = static_cast<int>(system.tree.size());
    body_ = std::make_unique<btMultiBody>(links, 0, btVector3(0, 0, 0), true, false);
    for (int i = 0; i < links; ++i) add_link(system, i);
    body_->finalizeMultiDof();
    body_->setCanSleep(false);
    body_->setHasSelfCollision(false);
    body_->setUseGyroTerm(true);
    body_->setLinearDamping(0);
    body_->setAngularDamping(0);
    body_->setMaxCoordinateVelocity(1e10);
    body_->useRK4Integration(method.get("rk4", 0) > 0);
    world_.addMultiBody(body_.get());
  }
  ~BulletMultibody() override { world_.removeMultiBody(body_.get()); }
  BulletMultibody(const BulletMultibody&) = delete;
  BulletMultibody& operator=(const BulletMultibody&) = delete;

  void step() override { world_.stepSimulation(dt_, 0); }
  void read(State& state) override {
    btAlignedObjectArray<btQuaternion> rotations;
    btAlignedObjectArray<btVector3> origins, omega, velocity;
    body_->forwardKinematics(rotations, origins);
    omega.resize(body_->getNumLinks() + 1);
    velocity.resize(body_->getNumLinks() + 1);
    body_->compTreeLinkVelocities(&omega[0], &velocity[0]);
    for (std::size_t b = 1; b < link_of_.size(); ++b) {
      const int link = link_of_[b];
      const btTransform& X = body_->getLink(link).m_cachedWorldTransform;
      const btQuaternion q = X.getRotation();
      const btVector3 &p = X.getOrigin(), w = X.getBasis() * omega[link + 1],
                      v = X.getBasis() * velocity[link + 1];
      state.poses[b] = {Quat(q.w(), q.x(), q.y(), q.z()).normalized(), Vec3(p.x(), p.y(), p.z())};
      state.twists[b] = {Vec3(w.x(), w.y(), w.z()), Vec3(v.x(), v.y(), v.z())};
    }
  }

 private:
  void add_link(const System& system, int i) {
    const TreeEdge& edge = system.tree[i];
    const PeerJoint& joint = system.joints[edge.joint];
    const Pose &P = system.pose(edge.parent), &C = system.pose(edge.child);
    link_of_[edge.child] = i;
    const int parent = edge.parent == 0 ? -1 : link_of_[edge.parent];
    const btQuaternion to_child = quaternion(C.q.conjugate() * P.q);
    const btVector3 from_parent = vector(P.local(joint.p_W)), to_centre = vector(-C.local(joint.p_W));
    const double mass = system.mass(edge.child);
    const btVector3 moments = vector(system.moments(edge.child));
    if (joint.kind == JointKind::kBall)
      body_->setupSpherical(i, mass, moments, parent, to_child, from_parent, to_centre, true);
    else if (joint.kind == JointKind::kHinge)
      body_->setupRevolute(i, mass, moments, parent, to_child, vector(C.q.conjugate() * joint.axis_W),
                           from_parent, to_centre, true);
    else
      body_->setupFixed(i, mass, moments, parent, to_child, from_parent, to_centre);
  }

  double dt_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broad_phase_;
  btMultiBodyConstraintSolver solver_;
  btMultiBodyDynamicsWorld world_;
  std::unique_ptr<btMultiBody> body_;
  std::vector<int> link_of_;
};

}  // namespace

std::unique_ptr<Engine> make_bullet_multibody(const System& system, const Method& method, double dt) {
  return std::make_unique<BulletMultibody>(system, method, dt);
}

}  // namespace taut::peers
