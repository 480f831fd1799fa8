#include "scenes/export/mjcf_velocities.h"

#include <map>

namespace taut {
namespace {

/// A body moves as its joint lets it, but for this part of its velocity.
constexpr double kAsJointsLet = 1e-9;

class VelocityWriter {
 public:
  VelocityWriter(const World& world, const ModelTree& tree, std::vector<std::string>& notices)
      : world_(world), notices_(notices) {
    for (const TreeBody& body : tree.bodies) children_[body.parent].push_back(&body);
  }

  std::string write() {
    visit(kGround);
    return moves_ ? qvel_ : "";
  }

 private:
  void visit(BodyId parent) {
    const auto children = children_.find(parent);
    if (children == children_.end()) return;
    for (const TreeBody* body : children->second) {
      write_body(*body);
      visit(body->body);
    }
  }

  void add(double rate) {
    qvel_ += (qvel_.empty() ? "" : " ") + words(rate);
    moves_ = moves_ || rate != 0;
  }
  void add(const Vec3& v) {
    for (double x : v) add(x);
  }

  void write_body(const TreeBody& body) {
    const Twist twist = world_.twist(body.body);
    const Quat to_body = world_.pose(body.body).q.conjugate();
    if (body.free) {
      add(twist.v), add(to_body * twist.w);
      return;
    }
    const auto at_anchor = [&](BodyId id) { return world_.twist(id).at(body.anchor - world_.pose(id).p); };
    // Of the body against its parent, where the joint is; what is left is not the joint's.
    Vec3 w = twist.w - world_.twist(body.parent).w, v = at_anchor(body.body) - at_anchor(body.parent);
    const double scale = 1 + twist.w.norm() + twist.v.norm();
    if (body.ball) {
      add(to_body * w);
      w.setZero();
    }
    for (const TreeAxis& axis : body.axes) {
      const double rate = world_.axis_rate(axis.id);
      add(rate);
      (axis.angular ? w : v) -= rate * axis.direction;
    }
    if (w.norm() + v.norm() > kAsJointsLet * scale)
      notices_.push_back(world_.name(body.body) +
                         ": a velocity at the start that its joint does not allow has no counterpart");
  }

  const World& world_;
  std::vector<std::string>& notices_;
  std::map<BodyId, std::vector<const TreeBody*>> children_;
  std::string qvel_;
  bool moves_ = false;
};

}  // namespace

std::string mjcf_velocities(const World& world, const ModelTree& tree, std::vector<std::string>& notices) {
  return VelocityWriter(world, tree, notices).write();
}

}  // namespace taut
