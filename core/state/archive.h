#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/check.h"
#include "core/state/state.h"

namespace taut {

/// Writes values to bytes, or reads them back, in one and the same order: a class lists what it remembers
/// once,
///
///     void transfer(Archive& archive) { archive(count_, impulses_); }
///
/// and is saved and restored by that.  Numbers keep their bits; bytes are little-endian, without padding.
/// What is read is not trusted: a count is believed only if as many bytes are there, numbers are not
/// NaN, and indices are for the reader to check, with require().
class Archive {
 public:
  /// To write to.
  Archive() = default;
  /// To read from; the bytes must live as long.
  explicit Archive(std::string_view bytes) : reads_(true), left_(bytes) {}

  bool reads() const { return reads_; }
  /// What has been written.
  const std::string& bytes() const { return written_; }
  /// What has been written can be read: none of it is NaN.
  bool is_sound() const { return sound_; }
  /// All has been read.
  bool at_end() const { return left_.empty(); }

  template <typename... Values>
  void operator()(Values&... values) {
    (transfer(values), ...);
  }
  /// A vector whose size is known to both sides.
  /// @throws std::invalid_argument if another one was written.
  template <typename Value>
  void sized(std::vector<Value>& values) {
    const std::size_t size = values.size();
    transfer(values);
    require(values.size() == size, "it has other sizes");
  }
  /// A vector, by a function that transfers one of its values.
  template <typename Value, typename Transfer>
  void each(std::vector<Value>& values, Transfer transfer_one) {
    resize(values);
    for (Value& value : values) transfer_one(value);
  }
  /// Transfers a vector of indices; @throws std::invalid_argument, when reading, for one outside [least,
  /// end).
  void indices(std::vector<int>& values, int least, int end) {
    transfer(values);
    for (int i : values) index(i, least, end);
  }
  static void index(int i, int least, int end) { require(i >= least && i < end, "an index is out of range"); }
  /// @throws std::invalid_argument with the reason unless it is good.
  static void require(bool good, const char* reason = "it is damaged") {
    if (!good) throw std::invalid_argument(std::string("checkpoint: ") + reason);
  }

 private:
  static_assert(std::endian::native == std::endian::little, "numbers are copied as they are");

  void raw(void* data, std::size_t size) {
    if (!reads_) {
      written_.append(static_cast<const char*>(data), size);
      return;
    }
    require(left_.size() >= size);
    if (size > 0) std::memcpy(data, left_.data(), size);
    left_.remove_prefix(size);
  }
  template <typename Number>
  void numbers(Number* data, std::size_t count) {
    raw(data, count * sizeof(Number));
    if constexpr (std::is_floating_point_v<Number>) {
      sound_ = sound_ && std::none_of(data, data + count, [](Number x) { return std::isnan(x); });
      require(sound_ || !reads_, "a value is no number");
    }
  }
  template <typename Value>
  requires(std::is_arithmetic_v<Value> || std::is_enum_v<Value>) void transfer(Value& value) {
    if constexpr (std::same_as<Value, bool>) {
      unsigned char byte = value;
      raw(&byte, 1);
      value = byte != 0;
    } else {
      numbers(&value, 1);
    }
  }
  template <typename Value>
  requires requires(Value& value, Archive& archive) { value.transfer(archive); }
  void transfer(Value& value) { value.transfer(*this); }
  /// For plain data: a function beside its type, found by its arguments.
  template <typename Value>
  requires requires(Value& value, Archive& archive) { transfer_fields(archive, value); }
  void transfer(Value& value) { transfer_fields(*this, value); }
  template <int Rows, int Columns>
  void transfer(Eigen::Matrix<double, Rows, Columns>& value) {
    static_assert(Rows > 0 && Columns > 0);
    numbers(value.data(), static_cast<std::size_t>(Rows * Columns));
  }
  void transfer(Quat& value) { numbers(value.coeffs().data(), 4); }
  void transfer(Pose& value) { (*this)(value.q, value.p); }
  void transfer(Twist& value) { (*this)(value.w, value.v); }
  void transfer(Wrench& value) { (*this)(value.torque, value.force); }
  void transfer(BodyId& value) { transfer(value.index); }
  void transfer(JointId& value) { transfer(value.index); }
  void transfer(AxisId& value) { (*this)(value.joint, value.axis); }
  void transfer(State& value) { (*this)(value.time, value.poses, value.twists, value.axes); }
  void transfer(std::string& value) {
    resize(value);
    raw(value.data(), value.size());
  }
  template <typename Value>
  void transfer(std::vector<Value>& values) {
    resize(values);
    if constexpr (std::is_arithmetic_v<Value>)
      numbers(values.data(), values.size());
    else
      for (Value& value : values) transfer(value);
  }
  template <typename Value, std::size_t n>
  void transfer(std::array<Value, n>& values) {
    for (Value& value : values) transfer(value);
  }
  template <typename First, typename Second>
  void transfer(std::pair<First, Second>& value) {
    (*this)(value.first, value.second);
  }
  template <typename Value>
  void transfer(std::optional<Value>& value) {
    bool there = value.has_value();
    transfer(there);
    if (reads_) there ? void(value.emplace()) : value.reset();
    if (there) transfer(*value);
  }
  template <typename Key, typename Value>
  void transfer(std::map<Key, Value>& values) {
    std::vector<std::pair<Key, Value>> entries(values.begin(), values.end());
    transfer(entries);
    if (reads_) values = std::map<Key, Value>(entries.begin(), entries.end());
  }
  /// Each element takes at least a byte.
  template <typename Container>
  void resize(Container& values) {
    std::uint64_t size = values.size();
    transfer(size);
    if (!reads_) return;
    using Value = typename Container::value_type;
    constexpr std::size_t least = std::is_arithmetic_v<Value> ? sizeof(Value) : 1;
    require(size <= left_.size() / least);
    values.resize(static_cast<std::size_t>(size));
  }

  const bool reads_ = false;
  bool sound_ = true;
  std::string written_;
  std::string_view left_;
};

}  // namespace taut
