#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/axes/axis.h"
#include "core/state/force.h"
#include "core/state/relocation.h"
#include "core/state/state.h"
#include "core/world/joint.h"
#include "core/world/joint_properties.h"
#include "core/world/material.h"
#include "core/world/rigid_body.h"
#include "core/world/shape.h"

namespace taut {

namespace detail {

class WorldIdentity;
struct WorldParts;

/// The parts of one World, as a value: a copy has copies of them, and those moved from have nothing in them.
/// @throws std::logic_error, and nothing has changed, by assigning to or moving from those of a world that is
/// held.
class OwnWorldParts {
 public:
  OwnWorldParts();
  OwnWorldParts(const OwnWorldParts& other);
  OwnWorldParts(OwnWorldParts&& other);                  // NOLINT(performance-noexcept-move-constructor)
  OwnWorldParts& operator=(const OwnWorldParts& other);  ///< becomes a copy
  OwnWorldParts& operator=(OwnWorldParts&& other);       // NOLINT(performance-noexcept-move-constructor)
  ~OwnWorldParts();
  /// The parts.  @{
  WorldParts* operator->() { return parts_.get(); }
  const WorldParts* operator->() const { return parts_.get(); }  /// @}

 private:
  std::unique_ptr<WorldParts> parts_;
};

}  // namespace detail

/// Something wrong with a World as a whole, found by validate().
struct Problem {
  std::string subject;  ///< name of the body or joint
  std::string message;  ///< what is wrong, with the value
};

/// What exists: bodies, joints, forces, gravity, and their present state.  It owns everything and never
/// steps. Ids are stable small integers: nothing is ever removed, but joints can be detached.  Names are
/// unique among bodies and among joints; an empty name is replaced by a free one (body_3, joint_7).  A copy
/// is an independent world that shares the immutable joints and force laws.  One that was moved from has
/// nothing, not even the ground, until it is assigned to.
///
/// Whatever throws leaves the world as it was.  A force law that changes the world while it is being asked
/// gets std::logic_error.
class World {
 public:
  World();

  /// Adds a body.  @throws std::invalid_argument for a duplicate name, a pose or twist that is not finite, a
  /// quaternion that is not of unit length, or a fixed body with a velocity.
  BodyId add_body(BodySpec spec);

  /// Adds a joint of any type:  world.add("elbow", Ball::at(world, upper, lower, p_W)).
  /// @throws std::invalid_argument for a duplicate name, a missing body, a body jointed to itself, or two
  /// fixed bodies.
  template <typename AnyJoint>
  JointId add(std::string name, AnyJoint joint) {
    return add_joint(std::move(name), std::make_shared<const AnyJoint>(std::move(joint)));
  }
  JointId add_joint(std::string name, std::shared_ptr<const Joint> joint);  ///< add() of a joint on the heap

  // Joints as a whole (world_joints.cpp).

  /// Strength of a joint; nullopt: it never breaks.  A joint that breaks is detached by the simulator.
  /// @throws std::invalid_argument for a missing joint or what check_joint() refuses.
  void set_break(JointId id, std::optional<BreakLimits> limits);
  /// The joints that can break, in ascending order.
  std::span<const std::pair<JointId, BreakLimits>> breakable() const;
  /// Elasticity of a joint; nullopt: rigid.  Rows that become soft or rigid are a change of topology.
  /// @throws std::invalid_argument for a missing joint or what check_joint() refuses.
  void set_compliance(JointId id, std::optional<JointCompliance> compliance);
  std::optional<JointCompliance> compliance(JointId id) const;  ///< none: rigid
  /// Takes a joint out; it keeps id, name, axes and properties, and holds nothing.  Joints that couple its
  /// axes (gears, drivers) go with it.  Nothing happens if it is out already.
  void detach(JointId id);
  /// Takes out all joints but these and those whose axes they couple.
  void detach_all_but(std::span<const JointId> joints);
  /// Puts a joint back.  It is closed where it was made to be: one that is open then is closed by the
  /// simulator before its next step.  A joint at the present poses is a new one, Ball::at() and its like.
  /// @throws std::invalid_argument for a joint that couples an axis of a detached one.
  void attach(JointId id);
  /// Has a joint of two bodies take a frame F on its body B, at X_BF, for B: it is closed where it was made
  /// to be with F in place of B.  It is always meant from the joint as it was added, so that the identity
  /// takes it back; closing_frame() (core/world/joint_frame.h) closes a joint where its bodies are.
  /// @throws std::invalid_argument for a missing joint, a pose that is not finite or not of unit length, and
  /// a joint of more than two bodies or that couples axes.
  void set_joint_frame(JointId id, const Pose& X_BF);
  bool is_attached(JointId id) const;  ///< not detached
  int detached_count() const;          ///< number of joints
  /// Energy in the springs, soft limits and compliance of one joint, detached or not [J].
  double spring_energy_of(JointId id, const State& state) const;

  // Free axes of joints and what acts along them.  nullopt takes a property away; an axis that gets its first
  // property, or loses its last, is a change of topology, a new value is not.

  /// A free axis by name.  @throws std::invalid_argument, which lists those of the joint, if there is none.
  AxisId axis(JointId joint, std::string_view name) const;
  int axis_count(JointId joint) const;         ///< number of its free axes
  const AxisInfo& axis_info(AxisId id) const;  ///< its name and kind
  /// Index of an axis in State::axes, and what acts along it.  @throws std::invalid_argument for none.  @{
  int axis_index(AxisId id) const;
  const AxisProperties& axis_properties(AxisId id) const;  /// @}
  bool has_axis_properties(JointId joint) const;           ///< any of its axes has one
  /// "elbow angle": joint and axis for messages.
  std::string axis_label(AxisId id) const;

  /// Sets what acts along an axis.  @throws std::invalid_argument for a missing axis, what check_axis()
  /// refuses, or limits, a spring or a position motor of an axis without positions (turn_x of a Ball).
  /// set_property() takes any of them, or an optional that may be empty, set_axis_properties() all of an axis
  /// at once.  @{
  void set_limits(AxisId id, std::optional<AxisLimits> limits) { set_property(id, std::move(limits)); }
  void set_motor(AxisId id, std::optional<AxisMotor> motor) { set_property(id, std::move(motor)); }
  void set_friction(AxisId id, std::optional<AxisFriction> friction) {
    set_property(id, std::move(friction));
  }
  void set_spring(AxisId id, std::optional<AxisSpring> spring) { set_property(id, std::move(spring)); }
  template <typename Property>
  void set_property(AxisId id, Property property) {
    AxisProperties changed = axis_properties(id);
    changed.set(std::move(property));
    set_axis_properties(id, std::move(changed));
  }
  void set_axis_properties(AxisId id, AxisProperties properties);  /// @}
  /// A new target for a motor that is there.  @throws std::invalid_argument if it is not, or not finite.
  void set_motor_target(AxisId id, double target);

  /// Coordinate θ of an axis [rad or m] in the present state, with the turns that the state counts.
  double axis_value(AxisId id) const;
  double axis_rate(AxisId id) const;  ///< θ̇ [rad/s or m/s]
  /// Says how many turns an angle has made: the value next to `value` that fits the poses is kept.
  /// @throws std::invalid_argument if it is not finite.
  void set_axis_turns(AxisId id, double value);

  /// Adds a force law:  world.add_force(SpringDamper(...)).
  template <typename AnyForce>
  ForceId add_force(AnyForce force) {
    return add_force(
        std::static_pointer_cast<const Force>(std::make_shared<const AnyForce>(std::move(force))));
  }
  /// Adds a force law.  @throws std::invalid_argument for null or a missing body.
  ForceId add_force(std::shared_ptr<const Force> force);
  /// Replaces a force law, for instance to change its value between steps.
  /// @throws std::invalid_argument for null, a missing body or a missing force.
  void set_force(ForceId id, std::shared_ptr<const Force> force);

  /// Adds all that another world has: bodies, joints with all that acts on and along them, forces, shapes
  /// with materials and filters, and the present state.  Every name gets `prefix` in front, and all is moved
  /// as a whole by X_WF, where F is the other's world frame.  What is fixed to its ground is then fixed to
  /// the ground of this world, or with a placement to a new fixed body `prefix`ground that has this pose.
  /// Forces in world axes turn with it; gravity and time stay those of this world.
  /// @return what its ids are here
  /// @throws std::invalid_argument for a name that is taken, or a placement that is not finite or not of unit
  /// length.
  Relocation append(const World& other, const std::string& prefix = "", const Pose& placement = {});

  /// Gives a body a shape at the pose X_BS in its frame; several shapes on one body are a compound.  Mass is
  /// the body's own affair: solid_of() gives it.
  /// @throws std::invalid_argument for a missing body, what check_shape() and check_material() refuse, or a
  /// pose that is not finite or not of unit length.
  ShapeId add_shape(BodyId body, Shape shape, const Pose& pose = {}, const Material& material = {},
                    CollisionFilter filter = {});
  /// Gives a body a shape that others may share, at a pose in the body's frame; it is checked again.
  /// @throws std::invalid_argument for a shape or material with bad numbers, and for a pose that is not
  /// finite or not of unit length.
  ShapeId add_shape(BodyId body, std::shared_ptr<const Shape> shape, const Pose& pose = {},
                    const Material& material = {}, CollisionFilter filter = {});
  int shape_count() const;                     ///< of all bodies
  const ShapeRecord& shape(ShapeId id) const;  ///< of this number, with its body, pose, material and filter
  /// Sets the material of a shape.  @throws std::invalid_argument for what check_material() refuses.
  void set_material(ShapeId id, const Material& material);
  /// A material with a name, which shapes can share and pairs can refer to.
  /// @throws std::invalid_argument for an empty name or one that is taken, and for what check_material()
  /// refuses.
  MaterialId add_material(std::string name, const Material& material);
  /// Makes a shape be of a material with a name.  @throws std::invalid_argument if there is no such one.
  void set_material(ShapeId id, MaterialId material);
  int material_count() const;                     ///< with a name
  const Material& material(MaterialId id) const;  ///< its values
  const std::string& name(MaterialId id) const;   ///< its name
  /// A material by name.  @throws std::invalid_argument if there is none.
  MaterialId material(std::string_view name) const;
  /// The material of a contact between two shapes, in place of combined(): order does not matter.
  void set_contact_material(ShapeId a, ShapeId b, const Material& material);
  /// The material of contacts between all shapes of two materials, or of one, in place of combined().
  void set_contact_material(MaterialId a, MaterialId b, const Material& material);
  /// Material of the contact of two shapes: as set for them, or for their materials, or combined().
  Material contact_material(ShapeId a, ShapeId b) const;
  /// Says whether two bodies may touch, in place of the rule that bodies with a common joint do not; two
  /// fixed ones never do.  @throws std::invalid_argument for a missing body or twice the same.
  void set_collision(BodyId a, BodyId b, bool may_collide);
  /// Whether two bodies may touch: never if both are fixed or one, else as set, else if no joint joins them.
  bool may_collide(BodyId a, BodyId b) const;
  /// Whether two shapes may touch: their bodies may, and their filters agree.
  bool may_collide(ShapeId a, ShapeId b) const;
  /// Changes whenever a shape is added; collision detection starts afresh then.  Who may collide is asked
  /// each time, so that joints and set_collision() need not count here.
  std::int64_t geometry_version() const;

  /// Gravitational acceleration [m/s²], (0, 0, −9.81) at first.
  void set_gravity(const Vec3& gravity);
  const Vec3& gravity() const { return gravity_; }  ///< [m/s²]

  int body_count() const { return static_cast<int>(state_.poses.size()); }  ///< with the ground
  int moving_body_count() const;                                            ///< not fixed
  int joint_count() const;                                                  ///< detached ones too
  int force_count() const;                                                  ///< without gravity

  const MassProperties& mass_properties(BodyId id) const;  ///< as given
  bool is_fixed(BodyId id) const;                          ///< never moves
  const std::string& name(BodyId id) const;                ///< its name
  const std::string& name(JointId id) const;               ///< its name
  const Joint& joint(JointId id) const;                    ///< of this number
  const Force& force(ForceId id) const;                    ///< of this number
  /// A body or joint by name, and whether it is there.  @throws std::invalid_argument if it is not.  @{
  BodyId body(std::string_view name) const;
  JointId joint(std::string_view name) const;
  bool has_body(std::string_view name) const;
  bool has_joint(std::string_view name) const;  /// @}

  const State& state() const { return state_; }  ///< at present
  const Pose& pose(BodyId id) const;             ///< X_WB
  const Twist& twist(BodyId id) const;           ///< V_WB
  double time() const { return state_.time; }    ///< [s]
  /// Moves a body, also a fixed one, between steps.  @throws std::invalid_argument for the ground, or a pose
  /// that add_body() would refuse.
  void set_pose(BodyId id, const Pose& pose);
  /// Sets V_WB.  @throws std::invalid_argument if it is not finite, or not zero for a fixed body.
  void set_twist(BodyId id, const Twist& twist);
  /// The whole state at once, bit for bit, as a solver or a restored recording leaves it.
  /// @throws std::invalid_argument if its sizes are not this world's, or for a time, pose or twist that is
  /// not finite, a quaternion that is not of unit length (to 1e-9), a moved ground or a fixed body with a
  /// velocity.
  void set_state(const State& state);
  /// Sets the state, with the checks of set_state(), and `state` becomes what it was before.
  void exchange_state(State& state);

  void set_time(double time);  ///< of the state [s]

  // Sleep (world_sleep.cpp): a simulator that is asked to (Settings::sleep) lets groups of bodies that have
  // come to rest stay where they are, at no cost, until something wakes them.

  bool is_asleep(BodyId id) const;  ///< it rests at no cost
  int asleep_count() const;         ///< number of bodies
  /// Counts how often a body was woken, asleep or not: its rest, if any, begins anew.
  int wake_count(BodyId id) const;
  /// Neither fixed nor asleep.
  bool moves(BodyId id) const;
  /// The body moves again, and with the next step all that fell asleep together with it.  What is set on a
  /// body, a joint of it or an axis of these wakes it without being asked; gravity, a force law that does not
  /// say on which bodies it acts, and what is set on a fixed body wake all.
  void wake(BodyId id);
  void wake_all();  ///< all bodies move again

  /// Sum of gravity and all force laws on each body, about its centre of mass, world axes.  Fixed bodies get
  /// what the laws put on them.  `wrenches` has body_count() entries [N·m, N] and is overwritten.
  void forces(const State& state, std::span<Wrench> wrenches, Springs springs = Springs::kIncluded) const;
  /// True if any force law reads velocities.
  bool forces_depend_on_velocity(Springs springs = Springs::kIncluded) const;
  /// The force laws that are springs between two bodies, in the order of their ids.
  std::span<const ForceId> springs() const;
  /// Adds the force laws that are not conservative, which `wrenches` need not be zeroed for, and returns the
  /// potential energy that these state (of a spring with a damper, for instance) [J].
  double add_dissipative_forces(const State& state, std::span<Wrench> wrenches,
                                Springs springs = Springs::kIncluded) const;
  bool has_dissipative_forces(Springs springs = Springs::kIncluded) const;  ///< laws not conservative
  /// Potential energy [J]: −Σ m g·p over the moving bodies, plus what force laws, springs, soft limits and
  /// soft joints state; detached joints have none.
  double potential_energy(const State& state) const;
  /// Part of potential_energy() in springs: of axes, soft limits, soft joints, and between bodies [J].
  double spring_energy(const State& state) const;

  /// Everything that a simulation of this world would trip over by more than `gap_tolerance` [m or rad]:
  /// joints that are open at the start, and axes beyond limits that are not soft.  Reports, never throws.
  std::vector<Problem> validate(double gap_tolerance = 1e-6) const;

  /// No two worlds have the same, not even copies, and one that is assigned to gets a new one: what was known
  /// of it, versions too, is then that of another world.
  std::uint64_t identity() const;
  /// While one lives, every function that changes the world throws std::logic_error.
  class Hold {
   public:
    explicit Hold(const World& world);
    ~Hold();  ///< The world may be changed again, if no other one lives.
    Hold(const Hold&) = delete;
    Hold& operator=(const Hold&) = delete;

   private:
    const detail::WorldIdentity& world_;
  };
  [[nodiscard]] Hold hold() const { return Hold(*this); }  ///< makes one
  /// Changes whenever a body, joint or spring between bodies is added, a spring gets other ends, a joint is
  /// detached or attached, becomes soft or rigid, or an axis gets its first property or loses its last;
  /// solvers rebuild their pattern then.
  std::int64_t topology_version() const;
  /// Changes whenever state, gravity or a force is set; solvers start afresh then.
  std::int64_t state_version() const;
  /// Changes whenever a property of an axis is set; solvers read the new values and go on.
  std::int64_t axis_version() const;
  /// Changes whenever a body falls asleep or wakes; solvers rebuild their pattern then.
  std::int64_t sleep_version() const;

 private:
  detail::OwnWorldParts parts_;  // first, so that an assignment that it refuses changes nothing
  State state_;
  Vec3 gravity_{0, 0, -9.81};

  void append_joints(const World& other, const std::string& prefix, const Relocation& to);
  void append_shapes(const World& other, const std::string& prefix, const Relocation& to);
  void check_state(const State& state) const;
  void put_to_sleep(BodyId id);
  void wake_or_all(const std::vector<BodyId>& bodies);
  void wake_bodies_of(JointId joint);
  void wake_moved(const State& state);

  friend class Rows;
  friend class MergedWorld;
  friend class PassingLoads;
  friend class Sleep;
};

/// Length of rope that a winch has let out [m] (AxisMotor::pulls_only): the entry of its axis in State::axes,
/// which the solvers carry on.  It is the upper limit of the rope when the winch is set, and again when it is
/// taken away; while the winch is there, it takes the place of that limit.
/// @throws std::invalid_argument if there is no winch.
double let_out(const World& world, AxisId id);

}  // namespace taut
