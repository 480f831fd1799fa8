#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/state/force.h"
#include "core/state/state.h"

namespace taut::detail {

/// Whether a law can have rows: a spring between two bodies.  One that pulls a body towards itself does
/// nothing.
bool has_rows(const Force& law);
/// Whether both have rows, and the same ones: one in place of the other changes values of a law only.
bool has_same_rows(const Force& one, const Force& other);

/// The force laws of a World, and what all of them are together.
class ForceLaws {
 public:
  using Law = std::shared_ptr<const Force>;

  int count() const { return static_cast<int>(laws_.size()); }
  /// Index of a law.  @throws std::invalid_argument if there is no such one.
  int checked(ForceId id) const;
  const std::vector<Law>& all() const { return laws_; }
  const Force& operator[](int law) const { return *laws_[law]; }
  const std::vector<ForceId>& springs() const { return springs_; }  ///< those that have rows, in their order
  bool depend_on_velocity(Springs springs) const { return traits(springs).velocity; }  ///< any of them
  bool are_dissipative(Springs springs) const {  ///< any of them, or what passes
    return passing_ || traits(springs).dissipative;
  }

  void add(Law law);
  void set(int index, Law law);
  /// One more that acts for a while, is not conservative, has no id and does not count; null: none.
  void set_passing(Law law) { passing_ = std::move(law); }
  /// All laws that act, and what passes behind them.
  std::vector<Law> acting() const;
  /// Other laws that come to the same as those that act in `like`, and are of the same kinds together.
  void replace(std::vector<Law> laws, const ForceLaws& like);

  /// Adds the wrenches of the laws [N·m, N].
  void accumulate(const State& state, std::span<Wrench> wrenches, Springs springs) const;
  /// Adds those of the laws that are not conservative; returns the potential energy that these state [J].
  double accumulate_dissipative(const State& state, std::span<Wrench> wrenches, Springs springs) const;
  /// Potential energy of the springs between bodies [J].
  double spring_energy(const State& state) const;

 private:
  struct Traits {
    bool velocity = false, dissipative = false;  // of any law
  };
  const Traits& traits(Springs springs) const {
    return springs == Springs::kIncluded ? all_ : without_springs_;
  }
  void classify(int index);

  std::vector<Law> laws_;
  Law passing_;
  std::vector<ForceId> springs_;
  Traits all_, without_springs_;
};

}  // namespace taut::detail
