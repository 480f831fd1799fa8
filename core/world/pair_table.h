#pragma once

#include <map>
#include <utility>

namespace taut::detail {

/// Two ids with the smaller one first: a pair without an order.
template <typename Id>
std::pair<Id, Id> unordered(Id a, Id b) {
  return a < b ? std::pair(a, b) : std::pair(b, a);
}

/// Values of pairs of ids; the order in a pair does not matter.
template <typename Id, typename Value>
class PairTable {
 public:
  /// Null for a pair without a value.
  const Value* find(Id a, Id b) const {
    if (values_.empty()) return nullptr;
    const auto found = values_.find(unordered(a, b));
    return found == values_.end() ? nullptr : &found->second;
  }
  void set(Id a, Id b, const Value& value) { values_[unordered(a, b)] = value; }
  auto begin() const { return values_.begin(); }  ///< in ascending order
  auto end() const { return values_.end(); }      ///< of the pairs

 private:
  std::map<std::pair<Id, Id>, Value> values_;
};

}  // namespace taut::detail
