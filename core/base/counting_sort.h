#pragma once

#include <cstddef>
#include <numeric>
#include <vector>

namespace taut {

/// Items 0 … count − 1 by their keys 0 … keys − 1, in their order where keys are equal: the values of those
/// of key k come to sorted[start[k]] … sorted[start[k + 1] − 1].  A negative key leaves an item out. Both
/// functions are asked for the items in ascending order.
template <typename KeyOf, typename ValueOf, typename Value>
void counting_sort(std::size_t count, int keys, KeyOf&& key_of, ValueOf&& value_of, std::vector<int>& start,
                   std::vector<Value>& sorted) {
  start.assign(static_cast<std::size_t>(keys) + 1, 0);
  for (std::size_t i = 0; i < count; ++i)
    if (const int key = key_of(i); key >= 0) ++start[key + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<int> next(start.begin(), start.end() - 1);
  sorted.resize(start.back());
  for (std::size_t i = 0; i < count; ++i)
    if (const int key = key_of(i); key >= 0) sorted[next[key]++] = value_of(i);
}

}  // namespace taut
