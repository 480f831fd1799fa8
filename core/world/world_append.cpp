#include "core/base/check.h"
#include "core/world/world.h"
#include "core/world/world_parts.h"

// A whole world as a part of another.
namespace taut {
namespace {

/// A joint of another world.  Its row parts are in axes of its bodies and stay as they are, but for the ids
/// that some of them hold.
class AppendedJoint final : public Joint {
 public:
  AppendedJoint(std::shared_ptr<const Joint> joint, const Relocation& to)
      : Joint(moved(joint->bodies(), to)), joint_(std::move(joint)), to_(to) {}

  std::string_view type() const override { return joint_->type(); }
  void append_rows(RowSink& rows) const override { rows.add_rows_of(*joint_, to_); }
  void append_axes(AxisSink& axes) const override { axes.add_axes_of(*joint_, to_); }
  Vec3 reaction_point_B() const override { return joint_->reaction_point_B(); }
  std::optional<Pose> rigid_pose() const override { return joint_->rigid_pose(); }
  std::vector<WirePoint> course() const override {
    std::vector<WirePoint> points = joint_->course();
    for (WirePoint& point : points) point.body = to_(point.body);
    return points;
  }
  int axes_needed() const override {
    const int needed = joint_->axes_needed();
    return needed == 0 ? 0 : needed + to_.axes;
  }
  std::vector<JointId> couples() const override {
    std::vector<JointId> joints = joint_->couples();
    for (JointId& joint : joints) joint = to_(joint);
    return joints;
  }

 private:
  static std::vector<BodyId> moved(std::span<const BodyId> bodies, const Relocation& to) {
    std::vector<BodyId> result;
    for (BodyId body : bodies) result.push_back(to(body));
    return result;
  }
  std::shared_ptr<const Joint> joint_;
  Relocation to_;
};

/// A force law of another world that cannot change its ids itself: it gets the state as its own world would
/// see it, from the frame of what its ground has become, and its wrenches are turned back.
class AppendedForce final : public Force {
 public:
  AppendedForce(std::shared_ptr<const Force> law, const Relocation& to, int body_count, int axis_count)
      : law_(std::move(law)), to_(to), body_count_(body_count), axis_count_(axis_count) {}

  void accumulate(const State& state, std::span<Wrench> wrenches) const override {
    std::vector<Wrench> own(body_count_);
    law_->accumulate(seen(state), own);
    const Quat& q = state.poses[to_.ground.index].q;
    for (int b = 0; b < body_count_; ++b) {
      Wrench& wrench = wrenches[to_.body(b)];
      wrench.torque += q * own[b].torque;
      wrench.force += q * own[b].force;
    }
  }
  double potential_energy(const State& state) const override { return law_->potential_energy(seen(state)); }
  bool depends_on_velocity() const override { return law_->depends_on_velocity(); }
  bool may_change() const override { return law_->may_change(); }
  bool conservative() const override { return law_->conservative(); }
  std::vector<BodyId> bodies() const override {
    std::vector<BodyId> bodies = law_->bodies();
    for (BodyId& body : bodies) body = to_(body);
    return bodies;
  }
  std::shared_ptr<const Force> relocated(const Relocation& further, const Pose&) const override {
    return std::make_shared<AppendedForce>(law_, further.after(to_), body_count_, axis_count_);
  }

 private:
  State seen(const State& state) const {
    const Pose& F = state.poses[to_.ground.index];
    const Quat q_FW = F.q.conjugate();
    State own;
    own.time = state.time;
    own.poses.resize(body_count_);
    own.twists.resize(body_count_);
    for (int b = 1; b < body_count_; ++b) {
      const Pose& B = state.poses[to_.body(b)];
      const Twist& V = state.twists[to_.body(b)];
      own.poses[b] = {q_FW * B.q, F.local(B.p)};
      own.twists[b] = {q_FW * V.w, q_FW * V.v};
    }
    own.axes.assign(state.axes.begin() + to_.axes, state.axes.begin() + to_.axes + axis_count_);
    return own;
  }
  std::shared_ptr<const Force> law_;
  Relocation to_;
  int body_count_, axis_count_;
};

bool is_identity(const Pose& pose) { return pose.p.isZero(0) && pose.q.vec().isZero(0); }

/// Names of the other world, with the prefix, that this one does not have yet.
void check_free_names(const World& world, const World& other, const std::string& prefix, int first_body) {
  for (int b = first_body; b < other.body_count(); ++b)
    if (const std::string name = prefix + other.name(BodyId{b}); world.has_body(name))
      fail("body", "name is already taken", name);
  for (int j = 0; j < other.joint_count(); ++j)
    if (const std::string name = prefix + other.name(JointId{j}); world.has_joint(name))
      fail("joint", "name is already taken", name);
  for (int m = 0; m < world.material_count(); ++m)
    for (int k = 0; k < other.material_count(); ++k)
      if (const std::string& name = world.name(MaterialId{m}); name == prefix + other.name(MaterialId{k}))
        fail("material", "name is already taken", name);
}

/// All but the ground, moved by X if that is given.
void append_bodies(World& world, const World& other, const std::string& prefix, const Pose* X) {
  for (int b = 1; b < other.body_count(); ++b) {
    const BodyId body{b};
    const Pose& pose = other.pose(body);
    const Twist& twist = other.twist(body);
    BodySpec spec;
    spec.name = prefix + other.name(body);
    spec.mass = other.mass_properties(body);
    spec.fixed = other.is_fixed(body);
    spec.pose = X ? Pose{(X->q * pose.q).normalized(), X->point(pose.p)} : pose;
    spec.twist = X ? Twist{X->q * twist.w, X->q * twist.v} : twist;
    world.add_body(spec);
  }
}

}  // namespace

Relocation World::append(const World& other, const std::string& prefix, const Pose& placement) {
  parts_->identity.require_free();
  if (&other == this) return append(World(other), prefix, placement);
  require_all_finite("position of " + prefix + "ground", placement.p);
  require_unit("orientation of " + prefix + "ground", placement.q.coeffs());
  const bool placed = !is_identity(placement);
  check_free_names(*this, other, prefix, placed ? 0 : 1);

  const Pose X{placement.q.normalized(), placement.p};
  Relocation to;
  if (placed) {
    BodySpec ground;
    ground.name = prefix + other.name(kGround);
    ground.pose = X;
    ground.fixed = true;
    to.ground = add_body(ground);
  }
  to.bodies = body_count() - 1;
  to.joints = joint_count();
  to.axes = parts_->axes.count();
  to.shapes = shape_count();
  to.forces = force_count();
  append_bodies(*this, other, prefix, placed ? &X : nullptr);
  append_joints(other, prefix, to);
  append_shapes(other, prefix, to);
  for (const auto& force : other.parts_->forces.all()) {
    auto moved = force->relocated(to, X);
    if (!moved)
      moved = std::make_shared<AppendedForce>(force, to, other.body_count(), other.parts_->axes.count());
    add_force(std::move(moved));
  }
  return to;
}

void World::append_joints(const World& other, const std::string& prefix, const Relocation& to) {
  for (int j = 0; j < other.joint_count(); ++j)
    add_joint(prefix + other.name(JointId{j}),
              std::make_shared<const AppendedJoint>(other.parts_->joints.shared(j), to));
  for (int k = 0; k < other.parts_->axes.count(); ++k) {
    parts_->axes.properties(to.axes + k) = other.parts_->axes.properties(k);
    state_.axes[to.axes + k] = other.state_.axes[k];
  }
  for (const auto& [joint, limits] : other.breakable()) set_break(to(joint), limits);
  for (const auto& [joint, compliance] : other.parts_->soft_joints.compliances())
    set_compliance(to(JointId{joint}), compliance);
  for (int joint : other.parts_->joints.detached()) detach(to(JointId{joint}));
}

void World::append_shapes(const World& other, const std::string& prefix, const Relocation& to) {
  const int first_material = material_count();
  const auto moved = [&](MaterialId id) { return id.index < 0 ? id : MaterialId{id.index + first_material}; };
  for (int m = 0; m < other.material_count(); ++m)
    add_material(prefix + other.name(MaterialId{m}), other.material(MaterialId{m}));
  for (const auto& [pair, material] : other.parts_->materials.pairs())
    set_contact_material(moved(pair.first), moved(pair.second), material);
  for (ShapeRecord record : other.parts_->shapes.all()) {
    record.body = to(record.body);
    record.owner = to(record.owner);
    record.named = moved(record.named);
    parts_->shapes.add(std::move(record));
  }
  for (const auto& [pair, material] : other.parts_->shapes.pairs())
    set_contact_material(to(pair.first), to(pair.second), material);
  for (const auto& [pair, may] : other.parts_->collisions.overrides())
    set_collision(to(pair.first), to(pair.second), may);
  if (other.shape_count() > 0) wake_all();
  ++parts_->versions.geometry;
}

}  // namespace taut
