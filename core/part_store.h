#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/axis_parts.h"
#include "core/state.h"

/// Arrays of row parts of one kind, with the place of their rows: what Rows is made of.
namespace taut::detail {

/// Where a part's rows and Jacobian blocks are.
struct PartPlace {
  int body_a, body_b, first_row, jacobian_a, jacobian_b;
  int axis = -1;  ///< of an axis row: its entry in State::axes, which it is also unwrapped next to
};

class PartStoreBase {
 public:
  virtual ~PartStoreBase() = default;
  virtual void residual(const Configuration& at, double* phi) const = 0;
  virtual void jacobian(const Configuration& at, double* values) const = 0;
  virtual void bias(const Configuration& at, std::span<const Twist> twists, double* gamma) const = 0;
  virtual void stiffness(const Configuration& at, const double* lambda,
                         std::span<StiffnessBlocks> bodies) const = 0;
  /// Writes the coordinates of axis rows to their entries.
  virtual void update_axes(const Configuration& at, std::span<double> axes) const = 0;
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

  void residual(const Configuration& at, double* phi) const override {
    for (const Item& i : items) residual(i, at, phi + i.at.first_row);
  }
  void jacobian(const Configuration& at, double* values) const override {
    for (const Item& i : items)
      i.part.jacobian(at.poses[i.at.body_a], at.poses[i.at.body_b],
                      JacobianBlock<Part::kRows>(values + i.at.jacobian_a),
                      JacobianBlock<Part::kRows>(values + i.at.jacobian_b));
  }
  void bias(const Configuration& at, std::span<const Twist> twists, double* gamma) const override {
    for (const Item& i : items)
      i.part.bias(at.poses[i.at.body_a], at.poses[i.at.body_b], twists[i.at.body_a], twists[i.at.body_b],
                  gamma + i.at.first_row);
  }
  void stiffness(const Configuration& at, const double* lambda,
                 std::span<StiffnessBlocks> bodies) const override {
    for (const Item& i : items)
      i.part.stiffness(at.poses[i.at.body_a], at.poses[i.at.body_b], lambda + i.at.first_row,
                       bodies[i.at.body_a], bodies[i.at.body_b]);
  }
  void update_axes(const Configuration& at, std::span<double> axes) const override {
    for (const Item& i : items)
      if (i.at.axis >= 0) residual(i, at, &axes[i.at.axis]);
  }
  std::string row_name(int item, int row) const override { return items[item].part.row_name(row); }

 private:
  static void residual(const Item& i, const Configuration& at, double* out) {
    if constexpr (requires { Part::kPeriod; }) {
      const double near = at.near(i.at.axis);  // before `out`, which may be the same place
      i.part.residual(at.poses[i.at.body_a], at.poses[i.at.body_b], out);
      *out = unwrapped(*out, near, Part::kPeriod);
    } else {
      i.part.residual(at.poses[i.at.body_a], at.poses[i.at.body_b], out);
    }
  }
};

}  // namespace taut::detail
