#include "scenes/scene_merge.h"

#include "core/check.h"

namespace taut {
namespace {

/// A joint of one world between bodies of another: its row parts are all in body axes, so they stay as they
/// are.
class JointBetween final : public Joint {
 public:
  JointBetween(std::shared_ptr<const Joint> joint, BodyId a, BodyId b)
      : Joint(a, b), joint_(std::move(joint)) {}
  std::string_view type() const override { return joint_->type(); }
  void append_rows(RowSink& rows) const override { joint_->append_rows(rows); }
  Vec3 reaction_point_B() const override { return joint_->reaction_point_B(); }
  std::vector<WirePoint> course() const override {
    std::vector<WirePoint> points = joint_->course();
    for (WirePoint& point : points) point.body = point.body == joint_->a() ? a() : b();
    return points;
  }

 private:
  std::shared_ptr<const Joint> joint_;
};

bool is_identity(const Pose& pose) { return pose.p.isZero(0) && pose.q.vec().isZero(0); }

/// Bodies of the block get consecutive ids; the ground of the block becomes `first`.
BodyId add_bodies(World& world, const World& block, const std::string& prefix, const Pose& X) {
  BodyId ground = kGround;
  if (!is_identity(X)) {
    BodySpec spec;
    spec.name = prefix + "ground";
    spec.pose = X;
    spec.fixed = true;
    ground = world.add_body(spec);
  }
  for (int b = 1; b < block.body_count(); ++b) {
    const BodyId id{b};
    const Pose& pose = block.pose(id);
    const Twist& twist = block.twist(id);
    BodySpec spec;
    spec.name = prefix + block.name(id);
    spec.mass = block.mass_properties(id);
    spec.pose = {(X.q * pose.q).normalized(), X.point(pose.p)};
    spec.twist = {X.q * twist.w, X.q * twist.v};
    spec.fixed = block.is_fixed(id);
    world.add_body(spec);
  }
  return ground;
}

}  // namespace

void append_scene(Scene& scene, const Scene& block, const std::string& prefix, const Pose& placement) {
  if (block.world.force_count() > 0)
    fail("block", "has forces and can only be the first one, without prefix and placement", block.name);
  World& world = scene.world;
  const auto source = std::make_shared<const World>(block.world);  // keeps its joints alive
  const BodyId ground = add_bodies(world, *source, prefix, placement);
  const int offset = world.body_count() - source->body_count();
  const auto moved = [&](BodyId id) { return id == kGround ? ground : BodyId{id.index + offset}; };

  const int first_joint = world.joint_count();
  for (int j = 0; j < source->joint_count(); ++j) {
    const Joint& joint = source->joint(JointId{j});
    world.add_joint(prefix + source->name(JointId{j}),
                    std::make_shared<const JointBetween>(std::shared_ptr<const Joint>(source, &joint),
                                                         moved(joint.a()), moved(joint.b())));
  }
  for (Probe probe : block.probes) {
    probe.name = prefix + probe.name;
    for (const Probe& other : scene.probes)
      if (other.name == probe.name) fail("probe", "name is already taken", probe.name);
    probe.body = moved(probe.body);
    if (probe.joint.index >= 0) probe.joint.index += first_joint;
    scene.probes.push_back(std::move(probe));
  }
  for (const Drawing& drawing : block.drawings)
    scene.drawings.push_back({moved(drawing.body), drawing.shape});
  scene.assemble = scene.assemble || block.assemble;
  for (const auto& [name, value] : block.parameters) scene.parameters[prefix + name] = value;
}

}  // namespace taut
