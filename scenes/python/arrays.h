#pragma once

#include <memory>
#include <span>

#include "core/state/state.h"
#include "scenes/python/casters.h"

/// Arrays of a state as NumPy sees them, and results that own their memory.
namespace taut::python {

using Array = nb::ndarray<nb::numpy, double>;
/// The policy of properties that return arrays with an owner.
inline constexpr auto kOwned = nb::rv_policy::automatic;
using ReadOnlyArray = nb::ndarray<nb::numpy, const double>;

static_assert(sizeof(Pose) == 7 * sizeof(double) && sizeof(Twist) == 6 * sizeof(double) &&
                  sizeof(Wrench) == 6 * sizeof(double),
              "the arrays below take each as a row of doubles, without gaps");

/// What keeps the memory of an array alive.
template <typename Held>
nb::capsule keep(Held held) {
  auto* const on_heap = new Held(std::move(held));
  return nb::capsule(on_heap, [](void* p) noexcept { delete static_cast<Held*>(p); });
}

/// Rows of `columns` doubles, `stride` doubles apart, from the one at `first` doubles on.
template <typename Item>
auto view(std::span<Item> items, std::size_t columns, std::size_t first, nb::handle owner) {
  using Value = std::conditional_t<std::is_const_v<Item>, const double, double>;
  constexpr auto stride = static_cast<std::int64_t>(sizeof(Item) / sizeof(double));
  auto* const start = reinterpret_cast<Value*>(items.data());
  const std::size_t shape[] = {items.size(), columns};
  const std::int64_t strides[] = {stride, 1};
  return nb::ndarray<nb::numpy, Value>(start + first, 2, shape, owner, strides);
}

/// An array of its own.
template <typename Value>
nb::ndarray<nb::numpy, Value> owning(std::vector<Value> values, std::size_t columns = 0) {
  auto held = std::make_unique<std::vector<Value>>(std::move(values));
  const std::size_t shape[] = {columns == 0 ? held->size() : held->size() / columns, columns};
  Value* const data = held->data();
  return nb::ndarray<nb::numpy, Value>(data, columns == 0 ? 1 : 2, shape, keep(std::move(held)));
}

/// n×6: angular, then linear.
inline Array twist_array(const std::vector<Twist>& twists) {
  const auto* const first = reinterpret_cast<const double*>(twists.data());
  return owning(std::vector<double>(first, first + 6 * twists.size()), 6);
}

/// Quaternions w, x, y, z of poses, and with `positions` x, y, z behind them.
std::vector<double> pose_rows(std::span<const Pose> poses, bool positions);

}  // namespace taut::python
