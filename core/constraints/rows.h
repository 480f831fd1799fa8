#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <typeindex>
#include <typeinfo>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

#include "core/axes/axis.h"
#include "core/constraints/axis_parts.h"
#include "core/constraints/contact_part.h"
#include "core/constraints/part_store.h"
#include "core/constraints/row_parts.h"
#include "core/constraints/row_sinks.h"
#include "core/state/force.h"
#include "core/state/state.h"

/// All constraint rows of a World, compiled into contiguous arrays:
///
///   joint j  owns rows  first_row … first_row + row_count − 1, in the order of the World's joints: first its
///            equality rows, then one axis row for each free axis with properties (limits, motor, …); none if
///            it is detached
///   spring   behind the joints, if wanted, springs between two bodies, which own axis rows
///   contact  behind those, slots for contact points between two bodies, which own their rows
///   side s   one (joint, body) pair, A, B and further bodies; its Jacobian block has row_count rows by 6
///            columns, row-major, or is an arm of three numbers (Blocks)
///   values   Jacobian values of all sides, one behind the other
///
/// Parts of one kind stand side by side in one array, so that the loops over them are free of virtual calls.
/// The rows do not refer to the World that they were compiled from; they are good for any state of it until
/// its topology_version() changes.
namespace taut {

class World;

class Rows {  ///< The rows of a World, as the comment at the top of this file says.
 public:
  /// A slot of a contact, by its index.
  struct ContactIndex {
    int index = -1;  ///< −1: none
    friend auto operator<=>(ContactIndex, ContactIndex) = default;
  };
  /// What rows belong to: a joint, a spring between two bodies or a contact.
  using Owner = std::variant<JointId, ForceId, ContactIndex>;
  /// The rows of one of them, a block.
  struct JointRows {
    int first_row = 0, row_count = 0;    ///< of all its rows
    int first_side = 0, side_count = 0;  ///< in sides()
    int equality_count = 0;  ///< of the rows, in front, softened ones too; the others are axis rows
    Owner owner;             ///< whose rows they are
  };
  struct Side {     ///< The block of Jacobian values of one body of a joint.
    int body = 0;   ///< its index in the World
    int block = 0;  ///< index in joints(), which springs and contacts have, too: no JointId
    int first_row = 0, row_count = 0;  ///< of the block
    int offset = 0;                    ///< of its block in the Jacobian values
    int whole = 0;  ///< offset in values with row_count × 6 of each side, as J where no arms are kept
    /// ±1 where the block is an arm r of a CompactPoint, on its side B or A: J = ±(−[r]×, 1).
    int arm = 0;
    int value_count() const { return arm != 0 ? 3 : 6 * row_count; }  ///< of its block
  };
  enum class RowKind : char {  ///< What a row asks for.
    kEquality,                 ///< that its residual is 0
    kAxis,                     ///< what the properties of a free axis ask for
    kSoftened,                 ///< what its joint's compliance asks for in place of an equality
    kSpring,                   ///< what a spring between two bodies asks for
    kContact,                  ///< what a contact asks for
  };
  struct Row {                                     ///< What one row is made of.
    int block = 0;                                 ///< index in joints(), as of a Side
    bool angular = false;                          ///< in radians; otherwise in metres
    const detail::PartStoreBase* store = nullptr;  ///< where its part is
    int item = 0, row_in_part = 0;                 ///< the part in its store, and the row in the part
    RowKind kind = RowKind::kEquality;             ///< what it asks for
  };
  /// Row of a joint that gives way by the joint's compliance; its residual is the gap.
  struct SoftenedRow {
    JointId joint;  ///< whose equality row it would be
  };
  /// Row of a spring between two bodies.
  struct SpringRow {
    ForceId spring;        ///< whose row it is
    bool centred = false;  ///< of one of three displacements in axes of A, not of the length
  };
  /// A row that is no equality: that of a free axis, whose residual is the coordinate θ itself, or one of the
  /// above.
  struct AxisRow {
    int row = 0;                                        ///< its index
    std::variant<AxisId, SoftenedRow, SpringRow> what;  ///< what it belongs to
    /// The axis, or the spring, if it is the row of one.  @{
    const AxisId* axis() const { return std::get_if<AxisId>(&what); }
    const SpringRow* spring() const { return std::get_if<SpringRow>(&what); }  /// @}
    /// The joint that it is a row of, if it is one of a joint.
    std::optional<JointId> joint() const;
  };
  enum class AxisRows { kIncluded, kLeftOut };  ///< Whether free axes with properties have rows.
  enum class Joints {                           ///< Which joints have rows.
    kAll,                                       ///< that are attached
    kMoving,                                    ///< those with a body that moves (World::moves())
  };
  enum class Blocks {  ///< How Jacobian values are kept.
    kWhole,
    kLeverArms,  ///< joints of two points, as ball joints, keep arms: a sixth of the memory
  };
  /// A slot for a contact point between two bodies: 3 rows (normal, two tangents), with `twist` 3 more
  /// (spin, two of rolling).
  struct ContactSlot {
    int a = 0, b = 0;                                ///< indices of the bodies A and B
    bool twist = false;                              ///< it has rows of rotation
    int row_count() const { return twist ? 6 : 3; }  ///< of the contact
    friend bool operator==(const ContactSlot&, const ContactSlot&) = default;
  };

  explicit Rows(const World& world, AxisRows axis_rows = AxisRows::kIncluded,
                std::span<const ContactSlot> contacts = {}, Joints joints = Joints::kAll,
                Springs springs = Springs::kLeftOut, Blocks blocks = Blocks::kWhole);

  /// The rows of some joints, contacts too, in ascending order, by themselves: with bodies and rows counted
  /// anew, for Jacobians from elsewhere.  They know of no poses: residual(), jacobian() and the like do
  /// nothing.  `new_body`: of each body, ≥ 0 for those of the joints.
  Rows part(std::span<const int> joints, std::span<const int> new_body, int bodies) const;

  int row_count() const { return static_cast<int>(rows_.size()); }  ///< of all blocks
  int jacobian_size() const { return jacobian_size_; }              ///< number of values
  /// Number of values where each side has row_count × 6.
  int whole_size() const { return whole_size_; }
  const std::vector<JointRows>& joints() const {
    return joints_;
  }                                                          ///< springs and contacts too, in this order
  const std::vector<Side>& sides() const { return sides_; }  ///< of all blocks
  /// Sides of a body in the order of the joints; fixed bodies have theirs too.
  std::span<const int> sides_of(int body) const {
    return {body_sides_.data() + body_start_[body], body_sides_.data() + body_start_[body + 1]};
  }
  int body_count() const { return static_cast<int>(body_start_.size()) - 1; }  ///< with the ground
  /// Joints with rows whose last body, by index, this is: a loop over bodies can do them as soon as their
  /// twists or poses are there, and still near.
  std::span<const int> joints_due(int body) const {
    return {due_joints_.data() + due_start_[body], due_joints_.data() + due_start_[body + 1]};
  }
  /// The bodies in chunks of a few hundred, each with those of the parts that wait for no later body: what is
  /// done with a chunk, one thing after the other, is done with data that are still near.
  struct BodyChunk {
    int begin = 0, end = 0;                  ///< bodies
    int settled_begin = 0, settled_end = 0;  ///< bodies whose last parts are in this chunk
  };
  static constexpr int kChunkSize = 256;                            ///< bodies
  const std::vector<BodyChunk>& chunks() const { return chunks_; }  ///< in the order of the bodies
  const Row& row(int i) const { return rows_[i]; }                  ///< row i
  /// What row i belongs to.
  const Owner& owner(int i) const { return joints_[rows_[i].block].owner; }
  /// The joint that row i belongs to, if it is one of a joint.
  std::optional<JointId> joint_of(int i) const {
    const auto* joint = std::get_if<JointId>(&owner(i));
    return joint ? std::optional(*joint) : std::nullopt;
  }
  /// Unit of the gap of an equality row of a joint, kept beside the rows for loops over all of them.
  enum class Unit : char { kNone, kMetre, kRadian };
  Unit gap_unit(int i) const { return unit_[i]; }                                ///< of row i
  bool is_equality(int i) const { return rows_[i].kind == RowKind::kEquality; }  ///< of a joint
  /// Contact rows come last.
  bool is_contact(int i) const { return i >= first_contact_row_; }
  int first_contact_row() const { return first_contact_row_; }  ///< row_count() without contacts
  /// joints() has these first.
  int joint_count() const { return contact_joint(0) - spring_count_; }
  /// joints()[spring_joint(s)] is spring s of World::springs(); without rows if it joins a body to itself, or
  /// what does not move.
  int spring_joint(int s) const { return joint_count() + s; }
  int spring_count() const { return spring_count_; }                        ///< with rows or without
  int contact_count() const { return static_cast<int>(contacts_.size()); }  ///< slots of contacts
  /// joints()[contact_joint(k)] is slot k of contacts.
  int contact_joint(int k) const { return static_cast<int>(joints_.size()) - contact_count() + k; }
  /// From now on slot k is this contact.
  void set_contact(int k, const row_parts::ContactPoint& point);
  /// The rows that are not equalities, in ascending order, and what motion row i holds.  @{
  const std::vector<AxisRow>& axis_rows() const { return axis_rows_; }
  std::string row_name(int i) const { return rows_[i].store->row_name(rows_[i].item, rows_[i].row_in_part); }
  /// @}
  // Sizes of the spans below: poses, twists, wrenches and `bodies` have body_count() entries, φ, γ, λ and J V
  // row_count(), Jacobian values jacobian_size().

  /// φ(q) [m or rad] of equality rows, and the coordinate θ of axis rows: angles as the value next to the one
  /// in `at.axes`.
  void residual(const Configuration& at, std::span<double> phi) const;
  /// φ and θ of the rows of one chunk, of which the poses of all its bodies and of those before are there.
  void residual(const Configuration& at, std::span<double> phi, const BodyChunk& chunk) const;
  /// φ and θ of the rows of one block.
  void residual(const JointRows& block, const Configuration& at, std::span<double> phi) const;
  /// J(q), the values of all sides.
  void jacobian(const Configuration& at, std::span<double> values) const;
  void jacobian(const Configuration& at, std::span<double> values,
                const BodyChunk& chunk) const;  ///< of a chunk
  /// J(q), the values of the sides of one block.
  void jacobian(const JointRows& block, const Configuration& at, std::span<double> values) const;
  /// γ = φ̈ − J V̇: J̇ V, and what drivers add to it.
  void bias(const Configuration& at, std::span<const Twist> twists, std::span<double> gamma) const;
  /// Adds φ_t, the part of φ̇ = J V + φ_t that drivers make, to `out`.
  void add_rate(const Configuration& at, std::span<double> out) const;
  /// Whether any row follows the time.
  bool depends_on_time() const;
  /// Adds each body's block of K = −∂(Jᵀλ)/∂q to `bodies`, which the caller has zeroed.
  void stiffness(const Configuration& at, std::span<const double> lambda,
                 std::span<StiffnessBlocks> bodies) const;
  void stiffness(const Configuration& at, std::span<const double> lambda, std::span<StiffnessBlocks> bodies,
                 const BodyChunk& chunk) const;  ///< of the bodies of a chunk
  /// Writes the coordinates of the axis rows to their entries of State::axes, which is how a solver keeps the
  /// turns of angles after a step: update_axes(state, state.axes).
  void update_axes(const Configuration& at, std::span<double> axes) const;

  /// J V [m/s or rad/s], with the values that jacobian() gave.
  void apply(std::span<const double> jacobian, std::span<const Twist> twists, std::span<double> out) const;
  /// Jᵀ λ, the wrench of all joints on each body, fixed ones too; overwrites `out`.
  void apply_transpose(std::span<const double> jacobian, std::span<const double> lambda,
                       std::span<Wrench> out) const;
  /// Row i of a side's block.
  static Eigen::Matrix<double, 6, 1> block_row(const Side& side, std::span<const double> jacobian, int i);

 private:
  friend class RowSink;
  friend class AxisSink;
  Rows() = default;
  template <typename Part>
  void append(const Part& part, int joint, int row_in_joint, Between sides, RowKind kind,
              int axis_index = -1);
  void append_empty_block(const Owner& owner);
  void append_joint(const World& world, int j, AxisRows axis_rows, Joints joints, Blocks blocks);
  void append_spring(const World& world, ForceId id, Joints joints);
  void append_side(int body, int joint, int row_count, int arm = 0);
  void append_contact(const ContactSlot& slot);
  void clear_blocks(int joint);
  void sort_by_body(int bodies);
  void cut_into_chunks();
  template <typename Visit>
  void for_each_range(const BodyChunk& chunk, Visit visit) const;
  void note_axes(const detail::PartStoreBase* store);

  std::vector<JointRows> joints_;
  std::vector<Side> sides_;
  std::vector<Row> rows_;
  std::vector<Unit> unit_;
  std::vector<AxisRow> axis_rows_;
  // Items of slots of contacts in the stores of their parts; −1: no twist.
  struct ContactItems {
    int point = 0, twist = -1;
  };
  std::vector<ContactItems> contacts_;
  detail::PartStore<row_parts::ContactPoint>* contact_points_ = nullptr;
  detail::PartStore<row_parts::ContactTwist>* contact_twists_ = nullptr;
  int first_contact_row_ = 0, spring_count_ = 0;
  // Joints whose parts do not write all of their Jacobian: first value and count, zeroed each time.
  std::vector<std::pair<int, int>> cleared_;
  std::vector<int> body_start_, body_sides_;
  std::vector<int> due_start_, due_joints_;
  std::vector<BodyChunk> chunks_;
  std::vector<std::size_t> chunk_items_;  // of each chunk and store, the first
  std::vector<std::unique_ptr<detail::PartStoreBase>> stores_;
  std::unordered_map<std::type_index, detail::PartStoreBase*> store_of_type_;
  std::vector<const detail::PartStoreBase*> stores_with_axes_;  // those that update_axes() must ask
  int jacobian_size_ = 0, whole_size_ = 0;
};

template <typename Part>
void RowSink::add(const Part& part, Between sides) {
  if constexpr (std::is_same_v<Part, row_parts::Point>) {
    // In axes of A, so that an open joint leaves no couple and its damper sees no common turn.
    if (soft_translation_) {
      for (int k = 0; k < 3; ++k)
        add_here(row_parts::PointInPlane{part.p_AP, Vec3::Unit(k), part.p_BQ}, sides);
      return;
    }
  }
  add_here(part, sides);
}

template <typename Part>
void RowSink::add_here(const Part& part, Between sides) {
  if (!relocation_) return place(part, sides);
  place(detail::relocated(part, *relocation_, *source_, sides), detail::relocated(sides, *relocation_));
}

template <typename Part>
void RowSink::place(const Part& part, Between sides) {
  const bool soft = detail::is_angular(part) ? soft_rotation_ : soft_translation_;
  constexpr bool point = std::is_same_v<Part, row_parts::Point>;
  any_point_ = any_point_ || point;
  if (rows_)
    rows_->append(part, joint_, count_, sides, soft ? Rows::RowKind::kSoftened : Rows::RowKind::kEquality);
  if (groups_ && soft)
    groups_->push_back({detail::store_of_one(part, sides.a, sides.b, detail::body_indices(made_for_), -1),
                        Part::kRows, detail::is_angular(part)});
  count_ += Part::kRows;
}

template <typename Part>
void Rows::append(const Part& part, int joint, int row_in_joint, Between sides, RowKind kind,
                  int axis_index) {
  if constexpr (std::is_same_v<Part, row_parts::Point>) {
    Side* const joint_sides = sides_.data() + joints_[joint].first_side;
    if (joint_sides[0].arm != 0) {
      joint_sides[sides.a].arm = -1, joint_sides[sides.b].arm = 1;
      return append(row_parts::CompactPoint{part}, joint, row_in_joint, sides, kind, axis_index);
    }
  }
  if (kind == RowKind::kSoftened)
    for (int i = 0; i < Part::kRows; ++i) axis_rows_.push_back({row_count() + i, SoftenedRow{{joint}}});
  using Store = detail::StoreOf<Part>;
  auto& slot = store_of_type_[typeid(Part)];
  if (!slot) {
    stores_.push_back(std::make_unique<Store>());
    slot = stores_.back().get();
  }
  auto& items = static_cast<Store*>(slot)->items;
  const JointRows& place = joints_[joint];
  const int first_row = place.first_row + row_in_joint, item = static_cast<int>(items.size());
  for (int i = 0; i < Part::kRows; ++i)
    rows_.push_back({joint, detail::is_angular(part), slot, item, i, kind});
  unit_.resize(rows_.size(), kind != RowKind::kEquality ? Unit::kNone
                             : detail::is_angular(part) ? Unit::kRadian
                                                        : Unit::kMetre);
  const auto offset = [&](int side) { return sides_[place.first_side + side].offset + 6 * row_in_joint; };
  if (detail::kIsWide<Part> || axis_index >= 0) note_axes(slot);
  if constexpr (detail::kIsWide<Part>) {
    items.push_back({first_row, {}, axis_index, part});
    for (int s = 0; s < place.side_count; ++s) items.back().jacobian.push_back(offset(s));
    clear_blocks(joint);
  } else {
    const int a = sides_[place.first_side + sides.a].body, b = sides_[place.first_side + sides.b].body;
    items.push_back({{a, b, first_row, offset(sides.a), offset(sides.b), axis_index}, part});
    if (place.side_count > 2) clear_blocks(joint);
  }
}

template <typename Part>
void AxisSink::add(std::string_view name, const Part& part, Between sides) {
  if (!relocation_) return place(name, part, sides);
  place(name, detail::relocated(part, *relocation_, *source_, sides), detail::relocated(sides, *relocation_));
}

template <typename Part>
void AxisSink::place(std::string_view name, const Part& part, Between sides) {
  static_assert(Part::kRows == 1, "an axis is one coordinate");
  const int axis = count_++, index = first_index_ + axis;
  if (infos_) {
    std::vector<int> all = detail::body_indices(joint_);
    auto coordinate = detail::store_of_one(part, sides.a, sides.b, all, index);
    constexpr bool accumulates = requires { Part::kAccumulates; };
    infos_->push_back({std::string(name),
                       detail::is_angular(part),
                       accumulates,
                       {},
                       std::move(coordinate),
                       std::move(all)});
    if constexpr (requires { part.across; }) infos_->back().across = part.across;
  } else if (properties_ && properties_[axis].any()) {
    if (rows_) {
      rows_->axis_rows_.push_back({rows_->row_count(), AxisId{JointId{joint_index_}, axis}});
      rows_->append(part, joint_index_, row_in_joint_, sides, Rows::RowKind::kAxis, index);
    }
    ++row_in_joint_;
  }
}

}  // namespace taut
