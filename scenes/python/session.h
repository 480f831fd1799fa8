#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>

#include "scenes/python/access.h"
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

 private:
  /// What the work returns.
  template <typename Work>
  auto without_gil(Work work);

  World& world_;
  std::unique_ptr<KeyboardQuestion> keyboard_ = std::make_unique<KeyboardQuestion>();
  Simulator simulator_;
};

}  // namespace taut::python
