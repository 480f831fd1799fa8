#include "scenes/python/session.h"

#include <utility>

#include "core/base/check.h"

namespace taut::python {
namespace {

/// Between two questions; each takes the GIL.
constexpr std::chrono::milliseconds kPeriod{20};

bool is_main_thread() {
  static const unsigned long main =
      nb::cast<unsigned long>(nb::module_::import_("threading").attr("main_thread")().attr("ident"));
  return PyThread_get_thread_ident() == main;
}

}  // namespace

void KeyboardQuestion::begin() {
  yes_ = false;
  error_.reset();
  main_ = is_main_thread();
  owner_ = std::this_thread::get_id();
  next_ = std::chrono::steady_clock::now() + kPeriod;
}

bool KeyboardQuestion::ask() {
  if (yes_) return true;
  if (!main_ || std::this_thread::get_id() != owner_) return false;  // only there are signals handled
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return false;
  next_ = now + kPeriod;
  const nb::gil_scoped_acquire gil;
  if (PyErr_CheckSignals() == 0) return false;
  error_ = std::make_unique<nb::python_error>();  // takes it
  yes_ = true;
  return true;
}

void KeyboardQuestion::raise_if_asked() {
  if (!yes_) return;
  yes_ = false;
  const std::unique_ptr<nb::python_error> error = std::move(error_);
  throw nb::python_error(*error);
}

Session::Session(World& world, const Settings& settings) : world_(world), simulator_(world, settings) {
  simulator_.set_interrupt([question = keyboard_.get()] { return question->ask(); });
}

template <typename Work>
auto Session::without_gil(Work work) {
  const StepScope scope(world_);
  ++changes_;
  keyboard_->begin();
  auto result = [&] {
    const nb::gil_scoped_release released;
    return work();
  }();
  keyboard_->raise_if_asked();
  return result;
}

StepReport Session::step(double dt) {
  return without_gil([&] { return StepReport(simulator_.step(dt)); });
}

StepReport Session::run(long steps, double dt) {
  if (steps < 1) fail("run steps", "must be positive", steps);
  return without_gil([&] {
    for (long i = 0; i < steps && simulator_.step(dt).ok() && !keyboard_->ask(); ++i)
      ;
    return StepReport(simulator_.report());
  });
}

RunReport Session::run_until(double t, double h) {
  return without_gil([&] { return simulator_.run_until(t, h); });
}

StepReport Session::assemble() {
  return without_gil([&] { return StepReport(simulator_.assemble()); });
}

void Session::fill(std::vector<double>& rows, When when) {
  rows.clear();
  rows.reserve(6 * world_.joint_count());
  for (int j = 0; j < world_.joint_count(); ++j) {
    const JointId joint{j};
    const Reaction reaction =
        when == When::kMean ? simulator_.mean_reaction(joint) : simulator_.reaction(joint);
    rows.insert(rows.end(), reaction.torque.begin(), reaction.torque.end());
    rows.insert(rows.end(), reaction.force.begin(), reaction.force.end());
  }
}

ReadOnlyArray Session::reactions(When when) {
  return ask([&](Simulator&) {
    Told& told = when == When::kMean ? mean_ : present_;
    const auto now = [&] {
      return std::array{changes_,
                        static_cast<std::int64_t>(world_.identity()),
                        world_.topology_version(),
                        world_.state_version(),
                        world_.axis_version(),
                        world_.sleep_version()};
    };
    if (!told.rows || told.of != now()) {
      // Memory that no array shows any more is taken again.
      auto rows = told.rows && told.rows.use_count() == 1 ? std::exchange(told.rows, nullptr)
                                                          : std::make_shared<std::vector<double>>();
      fill(*rows, when);
      told = {std::move(rows), now()};  // asking may have set a version
    }
    const std::size_t shape[] = {told.rows->size() / 6, 6};
    return ReadOnlyArray(told.rows->data(), 2, shape, keep(told.rows));
  });
}

}  // namespace taut::python
