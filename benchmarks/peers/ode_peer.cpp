#include <ode/ode.h>

#include <array>
#include <cstdarg>
#include <map>

#include "benchmarks/peers/peer.h"

/// ODE.  Methods: step (dense direct), quick (projected Gauss–Seidel: iters, default 20); erp, default 0.2;
/// cfm; layer [m], how deep contacts may be before they are pushed apart.
namespace {

using namespace taut;
using namespace taut::peers;

class OdeEngine final : public Engine {
 public:
  OdeEngine(const System& system, const Method& method, double dt) : dt_(dt), quick_(method.name == "quick") {
    if (!quick_ && method.name != "step") throw Unsupported("method " + method.name);
    dInitODE2(0);
    // It writes about every step whose LCP it could not solve; what that did is measured.
    dSetMessageHandler([](int, const char*, va_list) {});
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
    if (!system.has_contact()) return;
    require_plain_contact(system);
    shapes_of_ = system.world;
    space_ = dHashSpaceCreate(nullptr);
    contacts_ = dJointGroupCreate(0);
    dWorldSetContactSurfaceLayer(world_, method.get("layer", 0));
    for (int s = 0; s < shapes_of_->shape_count(); ++s) add_shape(s);
  }
  ~OdeEngine() override {
    if (space_) {
      dJointGroupDestroy(contacts_);
      dSpaceDestroy(space_);
    }
    dWorldDestroy(world_);
    dCloseODE();
  }
  OdeEngine(const OdeEngine&) = delete;
  OdeEngine& operator=(const OdeEngine&) = delete;

  void step() override {
    if (space_) {
      dJointGroupEmpty(contacts_);
      dSpaceCollide(space_, this,
                    [](void* engine, dGeomID a, dGeomID b) { static_cast<OdeEngine*>(engine)->touch(a, b); });
    }
    ok_ = quick_ ? dWorldQuickStep(world_, dt_) : dWorldStep(world_, dt_);
  }
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
  void add_shape(int index) {
    const ShapeRecord& record = shapes_of_->shape(ShapeId{index});
    const Vec3& p = record.pose.p;
    const dQuaternion q = {record.pose.q.w(), record.pose.q.x(), record.pose.q.y(), record.pose.q.z()};
    const bool ground = std::holds_alternative<HalfSpace>(*record.shape);
    dGeomID geom = nullptr;
    if (ground) {
      const Vec3 n = record.pose.q * Vec3::UnitZ();
      geom = dCreatePlane(space_, n.x(), n.y(), n.z(), n.dot(p));
    } else if (const auto* sphere = std::get_if<Sphere>(&*record.shape)) {
      geom = dCreateSphere(space_, sphere->radius);
    } else if (const auto* box = std::get_if<Box>(&*record.shape)) {
      geom = dCreateBox(space_, box->size.x(), box->size.y(), box->size.z());
    } else if (const auto* capsule = std::get_if<Capsule>(&*record.shape)) {
      geom = dCreateCapsule(space_, capsule->radius, capsule->length);
    } else if (const auto* cylinder = std::get_if<Cylinder>(&*record.shape)) {
      geom = dCreateCylinder(space_, cylinder->radius, cylinder->length);
    } else {
      throw Unsupported(shape_name(*record.shape));
    }
    shape_of_[geom] = ShapeId{index};
    if (record.body != kGround) {
      dGeomSetBody(geom, bodies_[record.body.index]);
      dGeomSetOffsetPosition(geom, p.x(), p.y(), p.z());
      dGeomSetOffsetQuaternion(geom, q);
    } else if (!ground) {
      dGeomSetPosition(geom, p.x(), p.y(), p.z());
      dGeomSetQuaternion(geom, q);
    }
  }
  /// Joints of the present step where two shapes touch.
  void touch(dGeomID a, dGeomID b) {
    constexpr int kPoints = 8;
    const ShapeId A = shape_of_.at(a), B = shape_of_.at(b);
    if (!shapes_of_->may_collide(A, B)) return;
    const Material material = shapes_of_->contact_material(A, B);
    std::array<dContact, kPoints> points{};
    const int count = dCollide(a, b, kPoints, &points[0].geom, sizeof(dContact));
    for (int i = 0; i < count; ++i) {
      dSurfaceParameters& surface = points[i].surface;
      surface.mode = dContactApprox1 | (material.rolling_friction > 0 ? dContactRolling : 0);
      surface.mu = material.dynamic_friction;
      surface.rho = material.rolling_friction;  // also about the normal
      dJointAttach(dJointCreateContact(world_, contacts_, &points[i]), dGeomGetBody(a), dGeomGetBody(b));
    }
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
  const World* shapes_of_ = nullptr;
  dSpaceID space_ = nullptr;  ///< none without shapes
  dJointGroupID contacts_ = nullptr;
  std::map<dGeomID, ShapeId> shape_of_;
  std::vector<dBodyID> bodies_{nullptr};  // 0 is the world
};

}  // namespace

int main(int argc, char** argv) {
  return peer_main(argc, argv, "ODE", [](const System& system, const Method& method, double dt) {
    return std::make_unique<OdeEngine>(system, method, dt);
  });
}
