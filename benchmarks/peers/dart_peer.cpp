#include <dart/constraint/BallJointConstraint.hpp>
#include <dart/constraint/ConstraintSolver.hpp>
#include <dart/constraint/WeldJointConstraint.hpp>
#include <dart/dynamics/BallJoint.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/WeldJoint.hpp>
#include <dart/simulation/World.hpp>

#include "benchmarks/peers/peer.h"

/// DART.  Methods: tree (reduced coordinates, constraints for loops), free (all bodies free, every joint a
/// constraint).  It has no constraint for a hinge.
namespace {

using namespace taut::peers;
using taut::Pose;
using taut::State;
using taut::Vec3;
namespace dd = dart::dynamics;
namespace dc = dart::constraint;

Eigen::Isometry3d isometry(const Pose& pose) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = pose.q.toRotationMatrix();
  X.translation() = pose.p;
  return X;
}

class DartEngine final : public Engine {
 public:
  DartEngine(const System& system, const Method& method, double dt)
      : world_(dart::simulation::World::create()), bodies_(system.body_count(), nullptr) {
    refuse_contact(system);
    const bool free = method.name == "free";
    if (!free && method.name != "tree") throw Unsupported("method " + method.name);
    world_->setTimeStep(dt);
    world_->setGravity(system.world->gravity());
    if (free) {
      for (int b = 1; b < system.body_count(); ++b) add_free(system, b);
      for (const PeerJoint& joint : system.joints) close(joint);
    } else {
      const auto skeleton = dd::Skeleton::create();
      for (const TreeEdge& edge : system.tree) add_link(*skeleton, system, edge);
      world_->addSkeleton(skeleton);
      for (int loop : system.loops) close(system.joints[loop]);
    }
  }

  void step() override { world_->step(); }
  void read(State& state) override {
    for (std::size_t b = 1; b < bodies_.size(); ++b) {
      const Eigen::Isometry3d& X = bodies_[b]->getWorldTransform();
      state.poses[b] = {taut::Quat(Eigen::Matrix3d(X.linear())).normalized(), X.translation()};
      state.twists[b] = {bodies_[b]->getAngularVelocity(), bodies_[b]->getLinearVelocity()};
    }
  }

 private:
  static dd::Inertia inertia(const System& system, int b) {
    return {system.mass(b), Vec3::Zero(), system.moments(b).asDiagonal().toDenseMatrix()};
  }
  void add_free(const System& system, int b) {
    const auto skeleton = dd::Skeleton::create(std::string("s").append(std::to_string(b)));
    const auto [joint, body] = skeleton->createJointAndBodyNodePair<dd::FreeJoint>();
    body->setInertia(inertia(system, b));
    joint->setPositions(dd::FreeJoint::convertToPositions(isometry(system.pose(b))));
    world_->addSkeleton(skeleton);
    bodies_[b] = body;
  }
  void add_link(dd::Skeleton& skeleton, const System& system, const TreeEdge& edge) {
    const PeerJoint& joint = system.joints[edge.joint];
    const Pose &P = system.pose(edge.parent), &C = system.pose(edge.child);
    dd::BodyNode* parent = bodies_[edge.parent];
    std::pair<dd::Joint*, dd::BodyNode*> made;
    if (joint.kind == JointKind::kBall)
      made = skeleton.createJointAndBodyNodePair<dd::BallJoint>(parent);
    else if (joint.kind == JointKind::kHinge)
      made = skeleton.createJointAndBodyNodePair<dd::RevoluteJoint>(parent);
    else
      made = skeleton.createJointAndBodyNodePair<dd::WeldJoint>(parent);
    // The joint frame stands at the anchor with the axes of the child.
    made.first->setTransformFromParentBodyNode(
        isometry({(P.q.conjugate() * C.q).normalized(), P.local(joint.p_W)}));
    made.first->setTransformFromChildBodyNode(isometry({taut::Quat::Identity(), C.local(joint.p_W)}));
    if (joint.kind == JointKind::kHinge)
      static_cast<dd::RevoluteJoint*>(made.first)->setAxis(C.q.conjugate() * joint.axis_W);
    made.second->setInertia(inertia(system, edge.child));
    bodies_[edge.child] = made.second;
  }
  void close(const PeerJoint& joint) {
    dd::BodyNode *one = bodies_[joint.b], *two = bodies_[joint.a];
    if (!one) std::swap(one, two);
    dc::ConstraintBasePtr made;
    if (joint.kind == JointKind::kBall)
      made = two ? std::make_shared<dc::BallJointConstraint>(one, two, joint.p_W)
                 : std::make_shared<dc::BallJointConstraint>(one, joint.p_W);
    else if (joint.kind == JointKind::kHinge)
      throw Unsupported("a hinge that closes a loop");
    else
      made = two ? std::make_shared<dc::WeldJointConstraint>(one, two)
                 : std::make_shared<dc::WeldJointConstraint>(one);
    world_->getConstraintSolver()->addConstraint(made);
  }

  dart::simulation::WorldPtr world_;
  std::vector<dd::BodyNode*> bodies_;
};

}  // namespace

int main(int argc, char** argv) {
  return peer_main(argc, argv, "DART", [](const System& system, const Method& method, double dt) {
    return std::make_unique<DartEngine>(system, method, dt);
  });
}
