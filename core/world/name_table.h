#pragma once

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace taut::detail {

/// The names of things of one kind, by their indices 0, 1, …, and back.  No two are equal, and none is empty.
class NameTable {
 public:
  explicit NameTable(const char* kind) : kind_(kind) {}

  const std::string& operator[](int index) const { return names_[index]; }
  bool contains(std::string_view name) const;
  /// @throws std::invalid_argument if there is none of this name.
  int index_of(std::string_view name) const;
  /// What to call the next thing in messages before it is added: its name, or body_3.
  std::string shown(const std::string& name) const;
  /// The next thing has this name, or for an empty one a free one: body_3, or body_3_ where that is taken.
  /// @throws std::invalid_argument if it is taken.
  void add(std::string name);

 private:
  const char* kind_;  // for messages, and of names that are made up
  std::vector<std::string> names_;
  std::unordered_map<std::string, int> index_of_name_;
};

}  // namespace taut::detail
