#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <memory>
#include <thread>

#include "scenes/python/access.h"
#include "scenes/python/arrays.h"
#include "solvers/simulator/simulator.h"

namespace taut::python {

/// Whether Ctrl-C came: asked by Simulator from any thread, answered now and then by the main one.
class KeyboardQuestion {
 public:
  void begin();
  bool ask();
  /// @throws nb::python_error, KeyboardInterrupt as a rule, if the answer was yes.
  void raise_if_asked();

 private:
  std::atomic<bool> yes_{false};
  bool main_ = false;
  std::thread::id owner_;
  std::chrono::steady_clock::time_point next_;
  std::unique_ptr<nb::python_error> error_;
};

/// A Simulator as Python sees it: steps without the GIL, one at a time, that Ctrl-C ends.
class Session {
 public:
  Session(World& world, const Settings& settings);

  World& world() { return world_; }
  const World& world() const { return world_; }

  StepReport step(double dt);
  /// Up to so many steps; ends behind the first that has not advanced.
  StepReport run(long steps, double dt);
  RunReport run_until(double t, double h);
  StepReport assemble();

  /// An answer of the simulator, with the GIL.
  template <typename Ask>
  auto ask(Ask ask) {
    const StepScope scope(world_);
    keyboard_->begin();
    return ask(simulator_);
  }
  /// The same of what changes the simulator.
  template <typename Ask>
  auto change(Ask change) {
    ++changes_;
    return ask(change);
  }

  enum class When { kMean, kPresent };
  /// Torque and force of all joints, as rows in the order of their ids: read-only, filled once between two
  /// changes, and shown for good.
  ReadOnlyArray reactions(When when);

 private:
  /// Reactions as they were told last, and of which world and simulator.
  struct Told {
    std::shared_ptr<std::vector<double>> rows;
    std::array<std::int64_t, 6> of{};
  };
  void fill(std::vector<double>& rows, When when);

  /// What the work returns.
  template <typename Work>
  auto without_gil(Work work);

  World& world_;
  std::int64_t changes_ = 0;
  Told mean_, present_;
  std::unique_ptr<KeyboardQuestion> keyboard_ = std::make_unique<KeyboardQuestion>();
  Simulator simulator_;
};

}  // namespace taut::python
