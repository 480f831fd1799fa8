#pragma once

#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <typeindex>
#include <typeinfo>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/axis.h"
#include "core/axis_parts.h"
#include "core/contact_part.h"
#include "core/force.h"
#include "core/part_store.h"
#include "core/row_parts.h"
#include "core/state.h"

/// All constraint rows of a World, compiled into contiguous arrays:
///
///   joint j  owns rows  first_row … first_row + row_count − 1, in the order of the World's joints: first its
///            equality rows, then one axis row for each free axis with properties (limits, motor, …); none if
///            it is detached
///   spring   behind the joints, if wanted, springs between two bodies, likewise with axis rows
///   contact  behind those, places for contact points between two bodies, likewise with their rows
///   side s   one (joint, body) pair, A, B and further bodies; its Jacobian block has row_count rows by 6
///   columns, row-major values   Jacobian values of all sides, one behind the other
///
/// Parts of one kind stand side by side in one array, so that the loops over them are free of virtual calls.
/// The rows do not refer to the World that they were compiled from; they are good for any state of it until
/// its topology_version() changes.
namespace taut {

class World;
class Joint;
class Rows;

/// A twist or wrench in pairs, for products with rows of a Jacobian block.
class SixVector {
 public:
  SixVector(const Vec3& a, const Vec3& b) : first_(a[0], a[1]), second_(a[2], b[0]), third_(b[1], b[2]) {}
  double dot(const double* row) const {
    using Pair = Eigen::Map<const Eigen::Vector2d>;
    return (first_.cwiseProduct(Pair(row)) + second_.cwiseProduct(Pair(row + 2)) +
            third_.cwiseProduct(Pair(row + 4)))
        .sum();
  }

 private:
  Eigen::Vector2d first_, second_, third_;
};
/// Two bodies of a joint by their place in Joint::bodies(): the A and B of a row part.
struct Between {
  int a = 0, b = 1;
};

namespace detail {
/// A part by itself, with its rows from 0 on.
struct RowGroup {
  std::shared_ptr<const PartStoreBase> part;
  int rows = 0;
  bool angular = false;
};
std::vector<int> body_indices(const Joint* joint);
/// X_CB of a body of the joint, by its place in Joint::bodies().
Pose carrier_frame(const Relocation& to, const Joint& joint, int side);
/// The places of the two bodies in the joint as relocated.
inline Between relocated(const Between& sides, const Relocation& to) {
  return {to.side(sides.a), to.side(sides.b)};
}
/// A part of `joint` as the relocation changes it.
template <typename Part>
Part relocated(const Part& part, const Relocation& to, const Joint& joint, const Between& sides) {
  if constexpr (kIsWide<Part>)
    return relocated(part, to);
  else if (to.carriers)
    return carried(part, carrier_frame(to, joint, sides.a), carrier_frame(to, joint, sides.b));
  else
    return part;
}
}  // namespace detail

/// What a joint hands its row parts to: once to count its rows, then once to place them.
class RowSink {
 public:
  template <typename Part>
  void add(const Part& part, Between sides = {});
  /// All parts of a joint of another world, as World::append() or merging has changed its ids and bodies.
  void add_rows_of(const Joint& joint, const Relocation& to);

 private:
  friend class Rows;
  friend class World;
  template <typename Part>
  void add_here(const Part& part, Between sides);
  template <typename Part>
  void place(const Part& part, Between sides);
  Rows* rows_ = nullptr;                                   // null while counting
  std::vector<detail::RowGroup>* groups_ = nullptr;        // … or where to keep the parts by themselves
  const class Joint* made_for_ = nullptr;                  // with groups_
  bool soft_translation_ = false, soft_rotation_ = false;  // that a compliance softens
  const Relocation* relocation_ = nullptr;                 // null: parts stay as they are
  const class Joint* source_ = nullptr;                    // … that this joint lists
  int joint_ = 0;
  int count_ = 0;
};

/// A free axis as its joint lists it.
struct AxisInfo {
  std::string name;
  bool angular = false;
  bool accumulates = false;  ///< only its increments are known: no place for limits and springs
  AxisLimits limits;         ///< that the axis has from the start, as a rope; without effect if infinite
  /// The coordinate as a single row, with one Jacobian block of six for each of `bodies`.
  std::shared_ptr<const detail::PartStoreBase> coordinate;
  std::vector<int> bodies;
};

/// What a joint lists its free axes in: names for the World, or rows for Rows.
class AxisSink {
 public:
  /// An axis with the coordinate of `part`, a row part of one row (core/axis_parts.h).
  template <typename Part>
  void add(std::string_view name, const Part& part, Between sides = {});
  /// All axes of a joint of another world, as World::append() or merging has changed its ids and bodies.
  void add_axes_of(const Joint& joint, const Relocation& to);
  /// The axis added last has these limits from the start.
  void limit(const AxisLimits& limits) {
    if (infos_) infos_->back().limits = limits;
  }

 private:
  friend class Rows;
  friend class World;
  template <typename Part>
  void place(std::string_view name, const Part& part, Between sides);
  const Relocation* relocation_ = nullptr;  // null: parts stay as they are
  const class Joint* source_ = nullptr;     // … that this joint lists
  const class Joint* joint_ = nullptr;
  std::vector<AxisInfo>* infos_ = nullptr;  // where to describe the axes …
  Rows* rows_ = nullptr;                    // … or to place the next of them that has properties
  const AxisProperties* properties_ = nullptr;
  int joint_index_ = 0, first_index_ = 0, row_in_joint_ = 0;
  int count_ = 0;
};

class Rows {
 public:
  struct JointRows {
    int first_row = 0, row_count = 0;
    int first_side = 0, side_count = 0;
    int equality_count = 0;  ///< of the rows, in front, softened ones too; the others are axis rows
  };
  struct Side {
    int body = 0, joint = 0;
    int first_row = 0, row_count = 0;
    int offset = 0;  ///< of its block in the Jacobian values
  };
  struct Row {
    int joint = 0;
    bool angular = false;
    const detail::PartStoreBase* store = nullptr;
    int item = 0, row_in_part = 0;
    int axis = kEquality;  ///< of the joint, or one of the following
  };
  static constexpr int kEquality = -1;
  static constexpr int kSpring = -3;    ///< of a spring between two bodies
  static constexpr int kSoftened = -2;  ///< an equality row that gives way by its joint's compliance
  /// A row that is no equality: that of a free axis, whose residual is the coordinate θ itself, or a row of a
  /// joint that its compliance softens, whose residual is the gap.
  struct AxisRow {
    int row = 0;
    AxisId axis;           ///< its `axis` is negative for a softened row
    int index = 0;         ///< of θ in State::axes; negative for a softened row
    ForceId spring{-1};    ///< whose row it is; then `axis` is none
    bool centred = false;  ///< … of its three displacements in axes of A, not of its length
  };
  enum class AxisRows { kIncluded, kLeftOut };
  enum class Joints {
    kAll,     ///< that are attached
    kMoving,  ///< … and have a body that moves (World::moves())
  };
  /// A place for a contact point between two bodies: 3 rows (normal, two tangents), with `twist` 3 more
  /// (spin, two of rolling).
  struct ContactPlace {
    int a = 0, b = 0;
    bool twist = false;
    friend bool operator==(const ContactPlace&, const ContactPlace&) = default;
  };

  explicit Rows(const World& world, AxisRows axis_rows = AxisRows::kIncluded,
                std::span<const ContactPlace> contacts = {}, Joints joints = Joints::kAll,
                Springs springs = Springs::kLeftOut);

  /// The rows of some joints, contacts too, in ascending order, by themselves: with bodies and rows counted
  /// anew, for Jacobians from elsewhere.  They know of no poses: residual(), jacobian() and the like do
  /// nothing.  `new_body`: of each body, ≥ 0 for those of the joints.
  Rows part(std::span<const int> joints, std::span<const int> new_body, int bodies) const;

  int row_count() const { return static_cast<int>(rows_.size()); }
  int jacobian_size() const { return jacobian_size_; }
  std::span<const JointRows> joints() const { return joints_; }
  std::span<const Side> sides() const { return sides_; }
  /// Sides of a body in the order of the joints; fixed bodies have theirs too.
  std::span<const int> sides_of(int body) const {
    return {body_sides_.data() + body_start_[body], body_sides_.data() + body_start_[body + 1]};
  }
  int body_count() const { return static_cast<int>(body_start_.size()) - 1; }
  /// Joints with rows whose last body, by index, this is: a loop over bodies can do them as soon as their
  /// twists or poses are there, and still near.
  std::span<const int> joints_due(int body) const {
    return {due_joints_.data() + due_start_[body], due_joints_.data() + due_start_[body + 1]};
  }
  const Row& row(int i) const { return rows_[i]; }
  /// In what the gap of an equality row of a joint is, beside the rows, for loops over all of them.
  enum class Unit : char { kNone, kMetre, kRadian };
  Unit gap_unit(int i) const { return unit_[i]; }
  bool is_equality(int i) const { return rows_[i].axis == kEquality && !is_contact(i); }
  /// Contact rows come last.
  bool is_contact(int i) const { return i >= first_contact_row_; }
  int first_contact_row() const { return first_contact_row_; }
  /// joints() has these first.
  int joint_count() const { return contact_joint(0) - spring_count_; }
  /// joints()[spring_joint(s)] is spring s of World::springs(); without rows if it joins a body to itself, or
  /// what does not move.
  int spring_joint(int s) const { return joint_count() + s; }
  int spring_count() const { return spring_count_; }
  int contact_count() const { return static_cast<int>(contacts_.size()); }
  /// joints()[contact_joint(k)] is contact place k.
  int contact_joint(int k) const { return static_cast<int>(joints_.size()) - contact_count() + k; }
  /// From now on place k is this contact.
  void set_contact(int k, const row_parts::ContactPoint& point);
  /// The rows that are not equalities, in ascending order.
  std::span<const AxisRow> axis_rows() const { return axis_rows_; }
  std::string row_name(int i) const { return rows_[i].store->row_name(rows_[i].item, rows_[i].row_in_part); }

  // Sizes of the spans below: poses, twists, wrenches and `bodies` have body_count() entries, φ, γ, λ and J V
  // row_count(), Jacobian values jacobian_size().

  /// φ(q) [m or rad] of equality rows, and the coordinate θ of axis rows: angles as the value next to the one
  /// in `at.axes`.
  void residual(const Configuration& at, std::span<double> phi) const;
  /// J(q), the values of all sides.
  void jacobian(const Configuration& at, std::span<double> values) const;
  /// γ = φ̈ − J V̇: J̇ V, and what drivers add to it.
  void bias(const Configuration& at, std::span<const Twist> twists, std::span<double> gamma) const;
  /// Adds φ_t, the part of φ̇ = J V + φ_t that drivers make, to `out`.
  void add_rate(const Configuration& at, std::span<double> out) const;
  /// Whether any row follows the time.
  bool depends_on_time() const;
  /// Adds each body's block of K = −∂(Jᵀλ)/∂q to `bodies`, which the caller has zeroed.
  void stiffness(const Configuration& at, std::span<const double> lambda,
                 std::span<StiffnessBlocks> bodies) const;
  /// Writes the coordinates of the axis rows to their entries of State::axes, which is how a solver keeps the
  /// turns of angles after a step: update_axes(state, state.axes).
  void update_axes(const Configuration& at, std::span<double> axes) const;

  /// J V, with the values that jacobian() gave.
  void apply(std::span<const double> jacobian, std::span<const Twist> twists, std::span<double> out) const;
  /// The same for one joint.
  void apply(const JointRows& joint, std::span<const double> jacobian, std::span<const Twist> twists,
             std::span<double> out) const {
    double* rates = out.data() + joint.first_row;
    for (int s = joint.first_side; s < joint.first_side + joint.side_count; ++s) {
      const Twist& twist = twists[sides_[s].body];
      const SixVector V(twist.w, twist.v);
      const double* J = jacobian.data() + sides_[s].offset;
      const bool first = s == joint.first_side;
      for (int i = 0; i < joint.row_count; ++i, J += 6) rates[i] = V.dot(J) + (first ? 0 : rates[i]);
    }
  }
  /// Jᵀ λ, the wrench of all joints on each body, fixed ones too; overwrites `out`.
  void apply_transpose(std::span<const double> jacobian, std::span<const double> lambda,
                       std::span<Wrench> out) const;
  /// The same for one body.
  Wrench wrench_on(int body, std::span<const double> jacobian, std::span<const double> lambda) const {
    using Six = Eigen::Matrix<double, 6, 1>;
    Six sum = Six::Zero();
    for (int s : sides_of(body)) {
      const Side& side = sides_[s];
      const double *J = jacobian.data() + side.offset, *force = lambda.data() + side.first_row;
      for (int i = 0; i < side.row_count; ++i, J += 6) sum += force[i] * Eigen::Map<const Six>(J);
    }
    return {Vec3(sum[0], sum[1], sum[2]), Vec3(sum[3], sum[4], sum[5])};
  }

 private:
  friend class RowSink;
  friend class AxisSink;
  Rows() = default;
  template <typename Part>
  void append(const Part& part, int joint, int row_in_joint, Between sides, int axis, int axis_index = -1);
  void append_axis_row(AxisId axis, int index);
  void append_joint(const World& world, int j, AxisRows axis_rows, Joints joints);
  void append_spring(const World& world, ForceId id, Joints joints);
  void append_contact(const ContactPlace& place);
  void clear_blocks(int joint);
  void sort_by_body(int bodies);
  void note_axes(const detail::PartStoreBase* store);

  std::vector<JointRows> joints_;
  std::vector<Side> sides_;
  std::vector<Row> rows_;
  std::vector<Unit> unit_;
  std::vector<AxisRow> axis_rows_;
  // Items of contact places in the stores of their parts; −1: no twist.
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
  std::vector<std::unique_ptr<detail::PartStoreBase>> stores_;
  std::unordered_map<std::type_index, detail::PartStoreBase*> store_of_type_;
  std::vector<const detail::PartStoreBase*> stores_with_axes_;  // those that update_axes() must ask
  int jacobian_size_ = 0;
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
  if (rows_) rows_->append(part, joint_, count_, sides, soft ? Rows::kSoftened : Rows::kEquality);
  if (groups_ && soft)
    groups_->push_back({detail::store_of_one(part, sides.a, sides.b, detail::body_indices(made_for_), -1),
                        Part::kRows, detail::is_angular(part)});
  count_ += Part::kRows;
}

template <typename Part>
void Rows::append(const Part& part, int joint, int row_in_joint, Between sides, int axis, int axis_index) {
  if (axis == kSoftened)
    for (int i = 0; i < Part::kRows; ++i)
      axis_rows_.push_back({static_cast<int>(rows_.size()) + i, {JointId{joint}, kSoftened}, kSoftened});
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
    rows_.push_back({joint, detail::is_angular(part), slot, item, i, axis});
  unit_.resize(rows_.size(), axis != kEquality          ? Unit::kNone
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
  } else if (properties_ && properties_[axis].any()) {
    if (rows_) {
      rows_->append(part, joint_index_, row_in_joint_, sides, axis, index);
      rows_->append_axis_row({JointId{joint_index_}, axis}, index);
    }
    ++row_in_joint_;
  }
}

}  // namespace taut
