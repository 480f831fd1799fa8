#include "benchmarks/peers/simbody_mechanism.h"

#include <Simbody.h>

namespace taut::peers {
namespace {

SimTK::Vec3 vector(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }
SimTK::Transform frame(const std::array<double, 4>& q, const std::array<double, 3>& p) {
  return {SimTK::Rotation(SimTK::Quaternion(q[0], q[1], q[2], q[3])), vector(p)};
}

}  // namespace

class SimbodyMechanism::Impl {
 public:
  Impl(const PlainSystem& system, const SimbodySettings& settings)
      : matter_(system_), forces_(system_), bodies_(system.bodies.size()) {
    gravity_ = std::make_unique<SimTK::Force::UniformGravity>(forces_, matter_, vector(system.gravity));
    bodies_[0] = matter_.updGround();
    for (const PlainJoint& joint : system.tree) add_body(joint, system.bodies[joint.b]);
    for (const PlainJoint& joint : system.loops) close(joint);
    const SimTK::State start = system_.realizeTopology();
    if (settings.euler) {
      integrator_ = std::make_unique<SimTK::SemiExplicitEulerIntegrator>(system_, settings.dt);
    } else {
      integrator_ = std::make_unique<SimTK::RungeKuttaMersonIntegrator>(system_);
      integrator_->setAccuracy(settings.accuracy);
    }
    if (settings.constraint_tolerance > 0) integrator_->setConstraintTolerance(settings.constraint_tolerance);
    stepper_ = std::make_unique<SimTK::TimeStepper>(system_, *integrator_);
    stepper_->initialize(start);
  }

  void step_to(double time) { stepper_->stepTo(time); }

  void read(std::vector<PlainMotion>& out) const {
    const SimTK::State& s = stepper_->getState();
    system_.realize(s, SimTK::Stage::Velocity);
    out.resize(bodies_.size());
    for (std::size_t b = 1; b < bodies_.size(); ++b) {
      const SimTK::Transform& X = bodies_[b].getBodyTransform(s);
      const SimTK::SpatialVec& V = bodies_[b].getBodyVelocity(s);
      const SimTK::Quaternion q = X.R().convertRotationToQuaternion();
      for (int i = 0; i < 3; ++i) out[b][i] = X.p()[i], out[b][7 + i] = V[0][i], out[b][10 + i] = V[1][i];
      for (int i = 0; i < 4; ++i) out[b][3 + i] = q[i];
    }
  }

 private:
  void add_body(const PlainJoint& joint, const PlainBody& body) {
    const auto& I = body.moments;
    const SimTK::Body::Rigid info(
        SimTK::MassProperties(body.mass, SimTK::Vec3(0), SimTK::Inertia(I[0], I[1], I[2])));
    const SimTK::Transform on_a = frame(joint.q_A, joint.p_A), on_b = frame(joint.q_B, joint.p_B);
    SimTK::MobilizedBody& parent = bodies_[joint.a];
    if (joint.kind == PlainJoint::kBall)
      bodies_[joint.b] = SimTK::MobilizedBody::Ball(parent, on_a, info, on_b);
    else if (joint.kind == PlainJoint::kHinge)
      bodies_[joint.b] = SimTK::MobilizedBody::Pin(parent, on_a, info, on_b);
    else
      bodies_[joint.b] = SimTK::MobilizedBody::Weld(parent, on_a, info, on_b);
  }
  void close(const PlainJoint& joint) {
    SimTK::MobilizedBody &A = bodies_[joint.a], &B = bodies_[joint.b];
    const SimTK::Transform on_a = frame(joint.q_A, joint.p_A), on_b = frame(joint.q_B, joint.p_B);
    if (joint.kind == PlainJoint::kFixed) {
      SimTK::Constraint::Weld(A, on_a, B, on_b);
      return;
    }
    SimTK::Constraint::Ball(A, vector(joint.p_A), B, vector(joint.p_B));
    if (joint.kind == PlainJoint::kBall) return;
    // The axis of B stays across two directions of A.
    SimTK::Constraint::ConstantAngle(A, on_a.x(), B, on_b.z(), SimTK::Pi / 2);
    SimTK::Constraint::ConstantAngle(A, on_a.y(), B, on_b.z(), SimTK::Pi / 2);
  }

  SimTK::MultibodySystem system_;
  SimTK::SimbodyMatterSubsystem matter_;
  SimTK::GeneralForceSubsystem forces_;
  std::unique_ptr<SimTK::Force::UniformGravity> gravity_;
  std::vector<SimTK::MobilizedBody> bodies_;
  std::unique_ptr<SimTK::Integrator> integrator_;
  std::unique_ptr<SimTK::TimeStepper> stepper_;
};

SimbodyMechanism::SimbodyMechanism(const PlainSystem& system, const SimbodySettings& settings)
    : impl_(std::make_unique<Impl>(system, settings)) {}
SimbodyMechanism::~SimbodyMechanism() = default;
void SimbodyMechanism::step_to(double time) { impl_->step_to(time); }
void SimbodyMechanism::read(std::vector<PlainMotion>& bodies) const { impl_->read(bodies); }

}  // namespace taut::peers
