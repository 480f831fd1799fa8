#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

namespace taut {

/// All that a simulation needs to go on as if it had never stopped: the state of its world, which joints are
/// detached, which bodies sleep, and what integrator, contacts, friction, active sets and sleep remember of
/// the steps before.  Simulator::checkpoint() makes one, Simulator::restore() takes it up.  A value of bytes
/// that can be kept in a file and read on any machine; the bits of the steps that follow are the same where
/// the program and its libraries are.
class Checkpoint {
 public:
  Checkpoint() = default;

  bool empty() const { return bytes_.empty(); }        ///< of no simulator
  const std::string& bytes() const { return bytes_; }  ///< for a file
  /// @throws std::invalid_argument if they are not those of a checkpoint of this version, whole and
  /// unchanged.
  static Checkpoint from_bytes(std::string bytes);
  friend bool operator==(const Checkpoint&, const Checkpoint&) = default;

 private:
  friend class Simulator;
  static Checkpoint of_payload(const std::string& payload);
  std::string payload() const;

  std::string bytes_;
};

/// The bytes, with their number in front.
std::ostream& operator<<(std::ostream& out, const Checkpoint& checkpoint);
/// @throws std::invalid_argument if they are not the bytes of a checkpoint of this version, whole and
/// unchanged.
std::istream& operator>>(std::istream& in, Checkpoint& checkpoint);

}  // namespace taut
