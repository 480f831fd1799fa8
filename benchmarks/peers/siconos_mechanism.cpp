#include "benchmarks/peers/siconos_mechanism.h"

#include <SolverOptions.h>

#include <Equality.hpp>
#include <EqualityConditionNSL.hpp>
#include <FixedJointR.hpp>
#include <Interaction.hpp>
#include <KneeJointR.hpp>
#include <MLCPProjectOnConstraints.hpp>
#include <MoreauJeanDirectProjectionOSI.hpp>
#include <MoreauJeanOSI.hpp>
#include <NewtonEulerDS.hpp>
#include <NonSmoothDynamicalSystem.hpp>
#include <OSNSMatrix.hpp>
#include <PivotJointR.hpp>
#include <SiconosVector.hpp>
#include <SimpleMatrix.hpp>
#include <TimeDiscretisation.hpp>
#include <TimeStepping.hpp>
#include <TimeSteppingDirectProjection.hpp>
#include <boost/math/quaternion.hpp>
#include <cstdlib>
#include <utility>

// Its header wants that of MUMPS, which Siconos's packages do not bring.
extern "C" void NM_MUMPS(NumericsMatrix* matrix, int job);

namespace taut::peers {
namespace {

using Quaternion = boost::math::quaternion<double>;

template <std::size_t kSize>
SP::SiconosVector vector(const std::array<double, kSize>& values) {
  auto out = std::make_shared<SiconosVector>(kSize);
  for (std::size_t i = 0; i < kSize; ++i) out->setValue(static_cast<unsigned>(i), values[i]);
  return out;
}

std::array<double, 3> rotate(const Quaternion& q, const std::array<double, 3>& v) {
  const Quaternion r = q * Quaternion(0, v[0], v[1], v[2]) * conj(q);
  return {r.R_component_2(), r.R_component_3(), r.R_component_4()};
}

Quaternion quaternion(const std::array<double, 4>& q) { return Quaternion(q[0], q[1], q[2], q[3]); }

/// Siconos makes a matrix in each step and forgets what MUMPS holds of the last one, 2 MB on net-corners 20.
class VelocityProblem final : public Equality {
 public:
  int compute(double time) override {
    const int error = Equality::compute(time);
    constexpr int kEnd = -2;
    if (getMStorageType() == NM_SPARSE_BLOCK) NM_MUMPS(M()->numericsMatrix().get(), kEnd);
    return error;
  }
};

/// Siconos takes new work space for each solution and forgets the last one, 0.3 MB on net-flag 5.
class PositionProblem final : public MLCPProjectOnConstraints {
 public:
  int compute(double time) override {
    const int error = MLCPProjectOnConstraints::compute(time);
    SolverOptions& options = *numericsSolverOptions();
    std::free(std::exchange(options.iWork, nullptr));
    std::free(std::exchange(options.dWork, nullptr));
    options.iWorkSize = options.dWorkSize = 0;
    return error;
  }
};

/// Siconos calls a plain function with what its solver says.
int solver_error_of_last_step = 0;
void note_solver_error(int error, Simulation*) {
  if (error != 0) solver_error_of_last_step = error;
}

}  // namespace

class SiconosMechanism::Impl {
 public:
  Impl(const PlainSystem& system, const SiconosSettings& settings)
      : model_(std::make_shared<NonSmoothDynamicalSystem>(0, kEndOfTime)), bodies_(system.bodies.size()) {
    for (std::size_t b = 1; b < bodies_.size(); ++b) add_body(b, system.bodies[b], system.gravity);
    for (const PlainJoint& joint : system.tree) add_joint(joint);
    for (const PlainJoint& joint : system.loops) add_joint(joint);
    const auto velocities = std::make_shared<VelocityProblem>();
    velocities->setMStorageType(settings.blocks ? NM_SPARSE_BLOCK : NM_DENSE);
    const auto times = std::make_shared<TimeDiscretisation>(0, settings.dt);
    if (settings.projection) {
      const auto projected = std::make_shared<TimeSteppingDirectProjection>(
          model_, times, std::make_shared<MoreauJeanDirectProjectionOSI>(settings.theta), velocities,
          std::make_shared<PositionProblem>());
      projected->setConstraintTol(settings.constraint_tolerance);
      projected->setProjectionMaxIteration(static_cast<unsigned>(settings.projection_iterations));
      simulation_ = projected;
    } else {
      simulation_ = std::make_shared<TimeStepping>(
          model_, times, std::make_shared<MoreauJeanOSI>(settings.theta), velocities);
    }
    simulation_->setNewtonTolerance(settings.newton_tolerance);
    simulation_->setNewtonMaxIteration(static_cast<unsigned>(settings.newton_iterations));
    if (settings.newton_iterations == 1) simulation_->setNewtonOptions(SICONOS_TS_LINEAR);
    simulation_->setWarnOnNonConvergence(false);
    simulation_->setCheckSolverFunction(&note_solver_error);
  }

  void step() {
    solver_error_of_last_step = 0;
    simulation_->computeOneStep();
    simulation_->nextStep();
  }

  void read(std::vector<PlainMotion>& out) const {
    out.resize(bodies_.size());
    for (std::size_t b = 1; b < bodies_.size(); ++b) {
      const SiconosVector &q = *bodies_[b]->q(), &twist = *bodies_[b]->twist();
      for (unsigned i = 0; i < 7; ++i) out[b][i] = q(i);
      // The twist is v in world axes, then ω in body axes.
      const auto omega = rotate(Quaternion(q(3), q(4), q(5), q(6)), {twist(3), twist(4), twist(5)});
      for (unsigned i = 0; i < 3; ++i) out[b][7 + i] = omega[i], out[b][10 + i] = twist(i);
    }
  }

 private:
  static constexpr double kEndOfTime = 1e9;

  void add_body(std::size_t b, const PlainBody& body, const std::array<double, 3>& gravity) {
    const auto inertia = std::make_shared<SimpleMatrix>(3, 3);
    for (unsigned i = 0; i < 3; ++i) inertia->setValue(i, i, body.moments[i]);
    bodies_[b] = std::make_shared<NewtonEulerDS>(
        vector<7>({body.p[0], body.p[1], body.p[2], body.q[0], body.q[1], body.q[2], body.q[3]}),
        vector<6>({}), body.mass, inertia);
    bodies_[b]->setFExtPtr(
        vector<3>({body.mass * gravity[0], body.mass * gravity[1], body.mass * gravity[2]}));
    model_->insertDynamicalSystem(bodies_[b]);
  }

  /// Siconos wants the anchor and the axis in the frame of the first body, and finds them in the second from
  /// the poses at the start; without a second one it takes the ground.
  void add_joint(const PlainJoint& joint) {
    const bool b_first = joint.b != 0;
    const SP::NewtonEulerDS first = bodies_[b_first ? joint.b : joint.a],
                            second = bodies_[b_first ? joint.a : joint.b];
    const SP::SiconosVector anchor = vector(b_first ? joint.p_B : joint.p_A);
    SP::NewtonEulerJointR relation;
    if (joint.kind == PlainJoint::kFixed) {
      relation = std::make_shared<FixedJointR>(first, second);
    } else if (joint.kind == PlainJoint::kBall) {
      relation = std::make_shared<KneeJointR>(anchor, false, first, second);
    } else {
      const auto axis = rotate(quaternion(b_first ? joint.q_B : joint.q_A), {0, 0, 1});
      relation = std::make_shared<PivotJointR>(anchor, vector(axis), false, first, second);
    }
    const auto law = std::make_shared<EqualityConditionNSL>(relation->numberOfConstraints());
    model_->link(std::make_shared<Interaction>(law, relation), first, second);
  }

  SP::NonSmoothDynamicalSystem model_;
  std::vector<SP::NewtonEulerDS> bodies_;  // 0, the ground, is none
  SP::TimeStepping simulation_;
};

SiconosMechanism::SiconosMechanism(const PlainSystem& system, const SiconosSettings& settings)
    : impl_(std::make_unique<Impl>(system, settings)) {}
SiconosMechanism::~SiconosMechanism() = default;
void SiconosMechanism::step() { impl_->step(); }
int SiconosMechanism::solver_error() const { return solver_error_of_last_step; }
void SiconosMechanism::read(std::vector<PlainMotion>& bodies) const { impl_->read(bodies); }

}  // namespace taut::peers
