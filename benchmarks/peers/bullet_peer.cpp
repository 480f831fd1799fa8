#include <BulletDynamics/MLCPSolvers/btDantzigSolver.h>
#include <BulletDynamics/MLCPSolvers/btMLCPSolver.h>
#include <btBulletDynamicsCommon.h>

#include <cmath>

#include "benchmarks/peers/bullet_multibody.h"
#include "benchmarks/peers/peer.h"

/// Bullet in double precision.  Methods: si (sequential impulses: iters, default 10), mlcp (Dantzig), both
/// with erp, default 0.2; featherstone (rk4=1) for trees.
namespace {

using namespace taut;
using namespace taut::peers;

btVector3 vector(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// Sizes of shapes with an axis are those of z, as in taut.
std::unique_ptr<btCollisionShape> shape_of(const Shape& shape) {
  if (std::holds_alternative<HalfSpace>(shape))
    return std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), 0);
  if (const auto* sphere = std::get_if<Sphere>(&shape))
    return std::make_unique<btSphereShape>(sphere->radius);
  if (const auto* box = std::get_if<Box>(&shape))
    return std::make_unique<btBoxShape>(vector(0.5 * box->size));
  if (const auto* capsule = std::get_if<Capsule>(&shape))
    return std::make_unique<btCapsuleShapeZ>(capsule->radius, capsule->length);
  if (const auto* cylinder = std::get_if<Cylinder>(&shape))
    return std::make_unique<btCylinderShapeZ>(
        btVector3(cylinder->radius, cylinder->radius, 0.5 * cylinder->length));
  throw Unsupported(shape_name(shape));
}

btTransform transform(const Pose& pose) {
  return btTransform(btQuaternion(pose.q.x(), pose.q.y(), pose.q.z(), pose.q.w()), vector(pose.p));
}

/// Asks the World who may touch whom; objects carry the number of their shape.
struct WorldFilter final : btOverlapFilterCallback {
  const World* world = nullptr;
  bool needBroadphaseCollision(btBroadphaseProxy* a, btBroadphaseProxy* b) const override {
    const auto id = [](btBroadphaseProxy* proxy) {
      return ShapeId{static_cast<const btCollisionObject*>(proxy->m_clientObject)->getUserIndex()};
    };
    return id(a).index >= 0 && id(b).index >= 0 && world->may_collide(id(a), id(b));
  }
};

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
    world_->getSolverInfo().m_erp = world_->getSolverInfo().m_erp2 = method.get("erp", 0.2);
    configuration_.setPlaneConvexMultipointIterations();
    require_plain_contact(system);
    filter_.world = system.world;
    broad_phase_.getOverlappingPairCache()->setOverlapFilterCallback(&filter_);
    shape_on_.resize(system.body_count());
    for (int s = 0; s < system.world->shape_count(); ++s) add_shape(*system.world, ShapeId{s});
    for (int b = 0; b < system.body_count(); ++b) add_body(system, b);
    for (const PeerJoint& joint : system.joints) add_joint(system, joint);
  }
  ~BulletEngine() override {
    for (const auto& joint : joints_) world_->removeConstraint(joint.get());
    for (const auto& body : bodies_) world_->removeRigidBody(body.get());
    for (const auto& body : ground_) world_->removeRigidBody(body.get());
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
  /// Shapes of the ground are objects of their own, since planes fit in no compound.
  void add_shape(const World& world, ShapeId id) {
    const ShapeRecord& record = world.shape(id);
    shapes_.push_back(shape_of(*record.shape));
    if (record.body != kGround) {
      if (shape_on_[record.body.index]) throw Unsupported("compound bodies");
      if (!record.pose.p.isZero()) throw Unsupported("shapes off the centre of mass");
      if (!record.pose.q.isApprox(Quat::Identity())) {
        auto turned = std::make_unique<btCompoundShape>();
        turned->addChildShape(transform(record.pose), shapes_.back().get());
        shapes_.push_back(std::move(turned));
      }
      shape_on_[record.body.index] = {shapes_.back().get(), id};
      return;
    }
    const btRigidBody::btRigidBodyConstructionInfo info(0, nullptr, shapes_.back().get());
    ground_.push_back(std::make_unique<btRigidBody>(info));
    ground_.back()->setWorldTransform(transform(record.pose));
    set_material(*ground_.back(), world, id);
    world_->addRigidBody(ground_.back().get());
  }
  /// Bullet multiplies the coefficients of two bodies.
  static void set_material(btRigidBody& body, const World& world, ShapeId id) {
    body.setUserIndex(id.index);
    body.setFriction(std::sqrt(world.shape(id).material.dynamic_friction));
  }
  void add_body(const System& system, int b) {
    const btTransform X = transform(system.pose(b));
    const ShapeOn& on = shape_on_[b];
    const double mass = b == 0 ? 0 : system.mass(b);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, on ? on.shape : &no_shape_,
                                                  b == 0 ? btVector3(0, 0, 0) : vector(system.moments(b)));
    info.m_startWorldTransform = X;
    info.m_linearDamping = info.m_angularDamping = 0;
    auto body = std::make_unique<btRigidBody>(info);
    body->setActivationState(DISABLE_DEACTIVATION);
    if (on) {
      set_material(*body, *system.world, on.id);
      world_->addRigidBody(body.get());
    } else {
      world_->addRigidBody(body.get(), 0, 0);
    }
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

  struct ShapeOn {
    btCollisionShape* shape = nullptr;
    ShapeId id{};
    explicit operator bool() const { return shape != nullptr; }
  };

  double dt_;
  btEmptyShape no_shape_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<ShapeOn> shape_on_;  ///< by body
  WorldFilter filter_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broad_phase_;
  btDantzigSolver dantzig_;
  std::unique_ptr<btConstraintSolver> solver_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_, ground_;
  std::vector<std::unique_ptr<btTypedConstraint>> joints_;
  std::unique_ptr<btDiscreteDynamicsWorld> world_;  // looks at them as it goes
};

}  // namespace

int main(int argc, char** argv) {
  return peer_main(argc, argv, "Bullet",
                   [](const System& system, const Method& method, double dt) -> std::unique_ptr<Engine> {
                     if (method.name == "featherstone") return make_bullet_multibody(system, method, dt);
                     return std::make_unique<BulletEngine>(system, method, dt);
                   });
}
