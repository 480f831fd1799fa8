#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "core/base/check.h"
#include "core/math/so3.h"
#include "core/state/relocation.h"
#include "core/state/state.h"

/// What row parts (row_parts.h) are written in terms of, and arrays of parts of one kind with the place of
/// their rows, which Rows is made of.  They are compiled beside the bodies of the parts, or where a part from
/// elsewhere is added to rows (core/constraints/rows.h).
namespace taut {

/// One row-major block of N rows by 6 columns (ω, v).
template <int N>
using JacobianBlock = Eigen::Map<Eigen::Matrix<double, N, 6, Eigen::RowMajor>>;

/// Geometric stiffness that a joint's load gives to one of its bodies: rotation–rotation [N·m/rad] and
/// translation–translation [N/m] block, symmetric parts.
struct StiffnessBlocks {
  Mat3 rotation = Mat3::Zero();     ///< [N·m/rad]
  Mat3 translation = Mat3::Zero();  ///< [N/m]
};

/// The value next to `near` among value + k period; an infinite period leaves it alone.
inline double unwrapped(double value, double near, double period) {
  if (!std::isfinite(period)) return value;
  return value + period * std::round((near - value) / period);
}

namespace detail {

/// The Jacobian blocks of a wide part by side of its joint, each kRows × 6 row-major.
struct SideBlocks {
  double* values;
  const int* offset;
  double* operator[](int side) const { return values + offset[side]; }
};

/// Where a part's rows and Jacobian blocks are.
struct PartPlace {
  int body_a, body_b, first_row, jacobian_a, jacobian_b;
  int axis = -1;  ///< of an axis row: its entry in State::axes, which it is also unwrapped next to
};

/// A part as it is between the bodies that carry A and B, on which these have the poses X_CA and X_CB.
/// @throws std::invalid_argument if the type of part has no carried() of its own to say so.
template <typename Part>
Part carried(const Part& part, const Pose& X_CA, const Pose& X_CB) {
  if constexpr (requires {
                  { part.carried(X_CA, X_CB) } -> std::same_as<Part>;
                })
    return part.carried(X_CA, X_CB);
  else
    fail("row part", "has no carried(), which merging of bodies needs", part.row_name(0));
}
/// A wide part with other ids, and in axes of the bodies that carry its own.
/// @throws std::invalid_argument if there are such and it does not declare `kCarried`, that it respects them.
template <typename Part>
Part relocated(const Part& part, const Relocation& to) {
  if constexpr (!requires { Part::kCarried; })
    if (to.carriers) fail("row part", "has no kCarried, which merging of bodies needs", part.row_name(0));
  return part.relocated(to);
}

/// Items of a store, in its order; all of them if nothing else is said.
struct ItemRange {
  std::size_t begin = 0, end = std::numeric_limits<std::size_t>::max();

  template <typename Item>
  std::span<const Item> of(const std::vector<Item>& items) const {
    return std::span(items).subspan(begin, std::min(end, items.size()) - begin);
  }
};

class PartStoreBase {
 public:
  virtual ~PartStoreBase() = default;
  virtual void residual(const Configuration& at, double* phi, ItemRange range = {}) const = 0;
  virtual void jacobian(const Configuration& at, double* values, ItemRange range = {}) const = 0;
  virtual void bias(const Configuration& at, std::span<const Twist> twists, double* gamma) const = 0;
  virtual void stiffness(const Configuration& at, const double* lambda, std::span<StiffnessBlocks> bodies,
                         ItemRange range = {}) const = 0;
  /// Adds φ_t, the rate of φ at rest.
  virtual void add_rate(const Configuration&, double*) const {}
  virtual bool depends_on_time() const { return false; }
  /// Writes the coordinates of axis rows to their entries.
  virtual void update_axes(const Configuration& at, std::span<double> axes) const = 0;
  virtual std::string row_name(int item, int row) const = 0;
  /// A copy with the indices of bodies and axes changed, and in axes of what carries the bodies.
  virtual std::shared_ptr<const PartStoreBase> relocated(const Relocation& to) const = 0;
};

template <typename Part>
class PartStore final : public PartStoreBase {
 public:
  struct Item {
    PartPlace at;
    Part part;
  };
  std::vector<Item> items;

  void residual(const Configuration& at, double* phi, ItemRange range) const override {
    for (const Item& i : range.of(items)) residual(i, at, phi + i.at.first_row);
  }
  void jacobian(const Configuration& at, double* values, ItemRange range) const override {
    for (const Item& i : range.of(items)) {
      const Pose &A = at.poses[i.at.body_a], &B = at.poses[i.at.body_b];
      double *J_A = values + i.at.jacobian_a, *J_B = values + i.at.jacobian_b;
      if constexpr (requires { i.part.arms(A, B, J_A, J_B); })
        i.part.arms(A, B, J_A, J_B);
      else
        i.part.jacobian(A, B, JacobianBlock<Part::kRows>(J_A), JacobianBlock<Part::kRows>(J_B));
    }
  }
  void bias(const Configuration& at, std::span<const Twist> twists, double* gamma) const override {
    for (const Item& i : items)
      i.part.bias(at.poses[i.at.body_a], at.poses[i.at.body_b], twists[i.at.body_a], twists[i.at.body_b],
                  gamma + i.at.first_row);
  }
  void stiffness(const Configuration& at, const double* lambda, std::span<StiffnessBlocks> bodies,
                 ItemRange range) const override {
    for (const Item& i : range.of(items))
      i.part.stiffness(at.poses[i.at.body_a], at.poses[i.at.body_b], lambda + i.at.first_row,
                       bodies[i.at.body_a], bodies[i.at.body_b]);
  }
  void update_axes(const Configuration& at, std::span<double> axes) const override {
    for (const Item& i : items)
      if (i.at.axis >= 0) residual(i, at, &axes[i.at.axis]);
  }
  std::string row_name(int item, int row) const override { return items[item].part.row_name(row); }
  std::shared_ptr<const PartStoreBase> relocated(const Relocation& to) const override {
    auto copy = std::make_shared<PartStore>(*this);
    for (Item& i : copy->items) {
      if (to.carriers) i.part = carried(i.part, to.frame(BodyId{i.at.body_a}), to.frame(BodyId{i.at.body_b}));
      i.at.body_a = to.body(i.at.body_a), i.at.body_b = to.body(i.at.body_b);
      i.at.axis = to.axis(i.at.axis);
    }
    return copy;
  }

 private:
  static void residual(const Item& i, const Configuration& at, double* out) {
    if constexpr (requires { Part::kAccumulates; }) {  // only its increments are known
      *out = at.near(i.at.axis);
      if (!at.from.empty())
        *out += i.part.increment(at.from[i.at.body_a], at.from[i.at.body_b], at.poses[i.at.body_a],
                                 at.poses[i.at.body_b]);
    } else if constexpr (requires { i.part.period(); }) {
      const double near = at.near(i.at.axis);  // before `out`, which may be the same place
      i.part.residual(at.poses[i.at.body_a], at.poses[i.at.body_b], out);
      *out = unwrapped(*out, near, i.part.period());
    } else if constexpr (requires { Part::kSigned; }) {
      const Pose &A = at.poses[i.at.body_a], &B = at.poses[i.at.body_b];
      i.part.residual(A, B, out);
      if (!at.from.empty() && i.part.turned_round(at.from[i.at.body_a], at.from[i.at.body_b], A, B))
        *out = -*out;
    } else {
      i.part.residual(at.poses[i.at.body_a], at.poses[i.at.body_b], out);
    }
  }
};

/// Parts that tie more than two bodies together or change with time (`kWide`): they know the indices of their
/// bodies in the world, which relocated() changes, and get one Jacobian block per side of their joint, zero
/// at first.
template <typename Part>
class WideStore final : public PartStoreBase {
 public:
  struct Item {
    int first_row = 0;
    std::vector<int> jacobian;  ///< one per side
    int axis = -1;              ///< of an axis row: its entry in State::axes
    Part part;
  };
  std::vector<Item> items;

  void residual(const Configuration& at, double* phi, ItemRange range) const override {
    for (const Item& i : range.of(items)) i.part.residual(at, phi + i.first_row);
  }
  void jacobian(const Configuration& at, double* values, ItemRange range) const override {
    for (const Item& i : range.of(items)) i.part.jacobian(at, SideBlocks{values, i.jacobian.data()});
  }
  void bias(const Configuration& at, std::span<const Twist> twists, double* gamma) const override {
    for (const Item& i : items) i.part.bias(at, twists, gamma + i.first_row);
  }
  void stiffness(const Configuration& at, const double* lambda, std::span<StiffnessBlocks> bodies,
                 ItemRange range) const override {
    for (const Item& i : range.of(items)) i.part.stiffness(at, lambda + i.first_row, bodies);
  }
  void add_rate(const Configuration& at, double* out) const override {
    if constexpr (kTimed)
      for (const Item& i : items) i.part.add_rate(at, out + i.first_row);
  }
  bool depends_on_time() const override { return kTimed; }
  void update_axes(const Configuration& at, std::span<double> axes) const override {
    for (const Item& i : items) {
      if constexpr (requires { i.part.update_axes(at, axes); }) i.part.update_axes(at, axes);
      if (i.axis >= 0) i.part.residual(at, &axes[i.axis]);
    }
  }
  std::string row_name(int item, int row) const override { return items[item].part.row_name(row); }
  std::shared_ptr<const PartStoreBase> relocated(const Relocation& to) const override {
    auto copy = std::make_shared<WideStore>(*this);
    for (Item& i : copy->items) i.part = detail::relocated(i.part, to), i.axis = to.axis(i.axis);
    return copy;
  }

 private:
  static constexpr bool kTimed = requires(const Part& part, const Configuration& at, double* out) {
    part.add_rate(at, out);
  };
};

template <typename Part>
inline constexpr bool kIsWide = requires {
  Part::kWide;
};
template <typename Part>
using StoreOf = std::conditional_t<kIsWide<Part>, WideStore<Part>, PartStore<Part>>;

/// A part by itself between bodies `a` and `b` of `bodies`, with one Jacobian block of six columns for each
/// body; `axis` is its entry in State::axes.
template <typename Part>
std::shared_ptr<const PartStoreBase> store_of_one(const Part& part, int a, int b,
                                                  const std::vector<int>& bodies, int axis) {
  auto store = std::make_shared<StoreOf<Part>>();
  const auto offset = [](int side) { return 6 * Part::kRows * side; };
  if constexpr (kIsWide<Part>) {
    std::vector<int> offsets;
    for (std::size_t side = 0; side < bodies.size(); ++side)
      offsets.push_back(offset(static_cast<int>(side)));
    store->items.push_back({0, std::move(offsets), axis, part});
  } else {
    store->items.push_back({{bodies[a], bodies[b], 0, offset(a), offset(b), axis}, part});
  }
  return store;
}

/// Whether a part's rows are angles; a coupling knows only at run time.
template <typename Part>
bool is_angular(const Part& part) {
  if constexpr (requires { part.angular(); })
    return part.angular();
  else
    return Part::kAngular;
}

}  // namespace detail
}  // namespace taut
