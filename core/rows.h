#pragma once

#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <typeindex>
#include <typeinfo>
#include <unordered_map>
#include <vector>

#include "core/row_parts.h"
#include "core/state.h"

/// All constraint rows of a World, compiled into contiguous arrays:
///
///   joint j  owns rows  first_row … first_row + row_count − 1, in the order of the World's joints
///   side s   one (joint, body) pair, A then B; its Jacobian block has row_count rows by 6 columns, row-major
///   values   Jacobian values of all sides, one behind the other
///
/// Parts of one kind stand side by side in one array, so that the loops over them are free of virtual calls.
/// The rows do not refer to the World that they were compiled from; they are good for any state of it until
/// its topology_version() changes.
namespace taut {

class World;

namespace detail {

/// Where a part's rows and Jacobian blocks are.
struct PartPlace {
  int body_a, body_b, first_row, jacobian_a, jacobian_b;
};

class PartStoreBase {
 public:
  virtual ~PartStoreBase() = default;
  virtual void residual(std::span<const Pose> poses, double* phi) const = 0;
  virtual void jacobian(std::span<const Pose> poses, double* values) const = 0;
  virtual void bias(std::span<const Pose> poses, std::span<const Twist> twists, double* gamma) const = 0;
  virtual void stiffness(std::span<const Pose> poses, const double* lambda,
                         std::span<StiffnessBlocks> bodies) const = 0;
  virtual std::string row_name(int item, int row) const = 0;
};

template <typename Part>
class PartStore final : public PartStoreBase {
 public:
  struct Item {
    PartPlace at;
    Part part;
  };
  std::vector<Item> items;

  void residual(std::span<const Pose> poses, double* phi) const override {
    for (const Item& i : items) i.part.residual(poses[i.at.body_a], poses[i.at.body_b], phi + i.at.first_row);
  }
  void jacobian(std::span<const Pose> poses, double* values) const override {
    for (const Item& i : items)
      i.part.jacobian(poses[i.at.body_a], poses[i.at.body_b],
                      JacobianBlock<Part::kRows>(values + i.at.jacobian_a),
                      JacobianBlock<Part::kRows>(values + i.at.jacobian_b));
  }
  void bias(std::span<const Pose> poses, std::span<const Twist> twists, double* gamma) const override {
    for (const Item& i : items)
      i.part.bias(poses[i.at.body_a], poses[i.at.body_b], twists[i.at.body_a], twists[i.at.body_b],
                  gamma + i.at.first_row);
  }
  void stiffness(std::span<const Pose> poses, const double* lambda,
                 std::span<StiffnessBlocks> bodies) const override {
    for (const Item& i : items)
      i.part.stiffness(poses[i.at.body_a], poses[i.at.body_b], lambda + i.at.first_row, bodies[i.at.body_a],
                       bodies[i.at.body_b]);
  }
  std::string row_name(int item, int row) const override { return items[item].part.row_name(row); }
};

}  // namespace detail

/// What a joint hands its row parts to: once to count its rows, then once to place them.
class RowSink {
 public:
  template <typename Part>
  void add(const Part& part);

 private:
  friend class Rows;
  class Rows* rows_ = nullptr;  // null while counting
  int joint_ = 0;
  int count_ = 0;
};

class Rows {
 public:
  struct JointRows {
    int first_row = 0, row_count = 0;
    int first_side = 0, side_count = 0;
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
  };

  explicit Rows(const World& world);

  int row_count() const { return static_cast<int>(rows_.size()); }
  int jacobian_size() const { return jacobian_size_; }
  std::span<const JointRows> joints() const { return joints_; }
  std::span<const Side> sides() const { return sides_; }
  /// Sides of a body in the order of the joints; fixed bodies have theirs too.
  std::span<const int> sides_of(int body) const {
    return {body_sides_.data() + body_start_[body], body_sides_.data() + body_start_[body + 1]};
  }
  int body_count() const { return static_cast<int>(body_start_.size()) - 1; }
  const Row& row(int i) const { return rows_[i]; }
  std::string row_name(int i) const { return rows_[i].store->row_name(rows_[i].item, rows_[i].row_in_part); }

  // Sizes of the spans below: poses, twists, wrenches and `bodies` have body_count() entries, φ, γ, λ and J V
  // row_count(), Jacobian values jacobian_size().

  /// φ(q) [m or rad].
  void residual(std::span<const Pose> poses, std::span<double> phi) const;
  /// J(q), the values of all sides.
  void jacobian(std::span<const Pose> poses, std::span<double> values) const;
  /// γ = J̇ V, so that φ̈ = J V̇ + γ.
  void bias(std::span<const Pose> poses, std::span<const Twist> twists, std::span<double> gamma) const;
  /// Adds each body's block of K = −∂(Jᵀλ)/∂q to `bodies`, which the caller has zeroed.
  void stiffness(std::span<const Pose> poses, std::span<const double> lambda,
                 std::span<StiffnessBlocks> bodies) const;

  /// J V, with the values that jacobian() gave.
  void apply(std::span<const double> jacobian, std::span<const Twist> twists, std::span<double> out) const;
  /// Jᵀ λ, the wrench of all joints on each body, fixed ones too; overwrites `out`.
  void apply_transpose(std::span<const double> jacobian, std::span<const double> lambda,
                       std::span<Wrench> out) const;

 private:
  friend class RowSink;
  template <typename Part>
  void append(const Part& part, int joint, int row_in_joint);

  std::vector<JointRows> joints_;
  std::vector<Side> sides_;
  std::vector<Row> rows_;
  std::vector<int> body_start_, body_sides_;
  std::vector<std::unique_ptr<detail::PartStoreBase>> stores_;
  std::unordered_map<std::type_index, detail::PartStoreBase*> store_of_type_;
  int jacobian_size_ = 0;
};

template <typename Part>
void RowSink::add(const Part& part) {
  if (rows_) rows_->append(part, joint_, count_);
  count_ += Part::kRows;
}

template <typename Part>
void Rows::append(const Part& part, int joint, int row_in_joint) {
  auto& slot = store_of_type_[typeid(Part)];
  if (!slot) {
    stores_.push_back(std::make_unique<detail::PartStore<Part>>());
    slot = stores_.back().get();
  }
  auto& items = static_cast<detail::PartStore<Part>*>(slot)->items;
  const Side& a = sides_[joints_[joint].first_side];
  const Side& b = sides_[joints_[joint].first_side + 1];
  const int first_row = joints_[joint].first_row + row_in_joint;
  for (int i = 0; i < Part::kRows; ++i)
    rows_.push_back({joint, Part::kAngular, slot, static_cast<int>(items.size()), i});
  items.push_back(
      {{a.body, b.body, first_row, a.offset + 6 * row_in_joint, b.offset + 6 * row_in_joint}, part});
}

}  // namespace taut
