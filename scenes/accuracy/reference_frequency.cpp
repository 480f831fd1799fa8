#include <algorithm>
#include <cmath>

#include "scenes/accuracy/reference_session.h"
#include "scenes/accuracy/small_oscillations.h"

/// Small oscillations of a reference case.  All such systems hang from one point, so that each mode exists in
/// two planes.
namespace taut::reference {
namespace {

/// Which mode a name such as omega_3, omega_max or mode_2_angles is about, and which number of it.
struct ModeName {
  std::string what;       ///< omega, angles or displacements
  std::size_t index = 0;  ///< of the slower of the two equal modes
};

std::optional<ModeName> parse(const std::string& name, std::size_t modes) {
  std::string what = "omega", which;
  if (name.rfind("omega_", 0) == 0) {
    which = name.substr(6);
  } else if (name.rfind("mode_", 0) == 0 && name.find('_', 5) != name.npos) {
    which = name.substr(5, name.find('_', 5) - 5);
    what = name.substr(name.find('_', 5) + 1);
  }
  if (what != "omega" && what != "angles" && what != "displacements") return std::nullopt;
  if (which == "max") return ModeName{what, modes - 2};
  if (which.empty() || which.find_first_not_of("0123456789") != which.npos || which.size() > 4)
    return std::nullopt;
  const std::size_t index = 2 * std::stoul(which);
  if (index < 2 || index > modes) return std::nullopt;
  return ModeName{what, index - 2};
}

/// Rotations or displacements of the first bodies in a mode along their common direction, the largest 1.
std::vector<double> shape_of(const Mode& mode, bool angles, std::size_t count) {
  const std::size_t end = std::min(count + 1, mode.shape.size());
  const auto part = [&](std::size_t b) { return angles ? mode.shape[b].w : mode.shape[b].v; };
  std::size_t largest = 0;
  for (std::size_t b = 1; b < end; ++b)
    if (part(b).norm() > part(largest).norm()) largest = b;
  const Vec3 direction = part(largest) / part(largest).squaredNorm();
  std::vector<double> shape;
  for (std::size_t b = 1; b < end; ++b) shape.push_back(part(b).dot(direction));
  return shape;
}

/// Frequency at which the simulator swings in a mode, from two upward zero crossings of the mode's
/// coordinate; 0 if it does not.
double simulated_frequency(Case c, const Mode& mode, const Settings& settings, double dt) {
  // Largest rotation [rad] or displacement [m] 1e-4: the frequency depends on the square of the amplitude, by
  // 3e-6 at most here (and by 3e-4 at ten times the amplitude).
  double largest = 0;
  for (const Twist& V : mode.shape) largest = std::max({largest, V.w.norm(), V.v.norm()});
  const double scale = 1e-4 * mode.omega / largest;
  State state = c.world.state();
  for (std::size_t b = 0; b < mode.shape.size(); ++b)
    state.twists[b] = {scale * mode.shape[b].w, scale * mode.shape[b].v};
  c.world.set_state(state);

  Simulator simulator(c.world, settings);
  std::vector<double> crossings;
  double before = scale;
  while (crossings.size() < 2) {
    if (!simulator.step(dt).exact() || simulator.world().time() > 20 / mode.omega) return 0;
    double x = 0;
    for (std::size_t b = 0; b < mode.shape.size(); ++b)
      x += mode.momentum[b].torque.dot(simulator.world().state().twists[b].w) +
           mode.momentum[b].force.dot(simulator.world().state().twists[b].v);
    // x is a sine, so that the crossing lies at the ratio of the arcs, not of the values.
    const double after_arc = std::asin(std::clamp(x / scale, -1.0, 1.0));
    const double before_arc = std::asin(std::clamp(before / scale, -1.0, 1.0));
    if (before < 0 && x >= 0)
      crossings.push_back(simulator.world().time() - dt * after_arc / (after_arc - before_arc));
    before = x;
  }
  return 2 * M_PI / (crossings[1] - crossings[0]);
}

}  // namespace

void run_frequency(const Case& reference, const RunPlan& plan, CaseRun& result) {
  const std::vector<Mode> modes = natural_modes(reference.world);
  const double dt = plan.step * reference.dt;
  for (std::size_t i = 0; i < reference.quantities.size(); ++i) {
    const Quantity& quantity = reference.quantities[i];
    const std::optional<ModeName> name = parse(quantity.name, modes.size());
    if (!name || !quantity.binding()) {
      result.quantities[i].reason = why_not_measured(quantity);
      continue;
    }
    const double limit = quantity.uncertainty + quantity.tolerance_limit;
    if (name->what != "omega") {
      compare(quantity, shape_of(modes[name->index], name->what == "angles", quantity.value.size()), limit,
              result.quantities[i]);
      continue;
    }
    compare(quantity, {simulated_frequency(reference, modes[name->index], plan.settings, dt)},
            allowed_error(reference, quantity, plan), result.quantities[i]);
    Measurement linear{.name = quantity.name + " (linearised)", .time = {}, .reference = quantity.value};
    for (std::size_t k : {name->index, name->index + 1}) compare(quantity, {modes[k].omega}, limit, linear);
    result.quantities.push_back(linear);
  }
}

}  // namespace taut::reference
