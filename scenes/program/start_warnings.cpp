#include "scenes/program/start_warnings.h"

#include <algorithm>

#include "scenes/support/format.h"
#include "solvers/common/report_names.h"
#include "solvers/common/setting_checks.h"
#include "solvers/common/setting_names.h"
#include "solvers/common/step_report.h"
#include "solvers/diagnosis/start_checks.h"

namespace taut {
namespace {

constexpr std::size_t kShown = 4;

/// "hinge elbow, ball tip and 3 more"
std::string names_of(const World& world, const std::vector<JointId>& joints) {
  return first_of(joints, kShown, [&](JointId joint) {
    return std::string(world.joint(joint).type()) + " " + world.name(joint);
  });
}

/// A sentence on springs that the integrator takes explicitly and that the step does not resolve, or none.
std::string fast_springs(const World& world, const Settings& settings, double dt) {
  if (settings.integrator == Integrator::kRattle || settings.integrator == Integrator::kMoreauJean) return {};
  const std::vector<SpringFrequency> springs = too_fast_springs(world, dt);
  if (springs.empty()) return {};
  const std::string names = first_of(springs, kShown, [&](const SpringFrequency& fast) {
    const LineSpring& spring = *world.force(fast.spring).spring();
    return format("%s to %s (%.3g)", world.name(spring.a).c_str(), world.name(spring.b).c_str(),
                  fast.omega * dt);
  });
  return std::string("springs are too stiff for this step with the integrator \"") +
         name_of(settings.integrator, kIntegratorNames) +
         "\", which takes them explicitly, as omega dt exceeds 2, and will gain energy: " + names +
         "; \"rattle\" and \"moreau-jean\" do not";
}

/// A sentence on bodies that start in each other, or none.
std::string overlaps(const World& world) {
  const std::vector<StartOverlap> found = start_overlaps(world);
  if (found.empty()) return {};
  return format("bodies are in each other at the start, by up to %.3g m: ", found.front().depth) +
         first_of(found, kShown,
                  [&](const StartOverlap& overlap) {
                    return world.name(overlap.a) + " and " + world.name(overlap.b) +
                           format(" (%.3g)", overlap.depth);
                  }) +
         "; contacts push them apart, or fail where joints hold them: move them or, if they are meant to be "
         "so, let them not touch, in the scene file by \"pairs\": [{\"a\": \"" +
         world.name(found.front().a) + "\", \"b\": \"" + world.name(found.front().b) +
         "\", \"collide\": false}]";
}

}  // namespace

std::string passing_warning(const World& world, const Settings& settings) {
  if (!settings.contacts || has_no_laws(settings.integrator)) return {};
  const UnsupportedPairs pairs = unsupported_pairs(world);
  if (pairs.count == 0) return {};
  std::vector<std::string> names;
  for (std::size_t i = 0; i < std::min(kShown, pairs.first.size()); ++i)
    names.push_back(name_of(pairs.first[i], world));
  const std::int64_t more = pairs.count - static_cast<std::int64_t>(names.size());
  return "there is no contact between two surfaces of triangles or two grounds: these pass through each "
         "other: " +
         list_of(names) + (more > 0 ? format(" and %lld more pairs", static_cast<long long>(more)) : "") +
         "; a body of convex hulls touches both";
}

std::vector<std::string> start_warnings(const World& world, const Settings& settings, double dt) {
  std::vector<std::string> warnings;
  if (const ForbiddenVelocity forbidden = forbidden_velocity(world); !forbidden.empty()) {
    warnings.push_back(
        format("joints forbid velocities at the start, of up to %.3g m/s and %.3g rad/s, ", forbidden.speed,
               forbidden.spin) +
        (is_force_level(settings.integrator) ? "which open them: " : "which the first step takes away: ") +
        names_of(world, forbidden.joints));
  }
  if (const double spacing = coarsest_position(world); spacing > settings.position_tolerance)
    warnings.push_back(
        format("bodies are so far from the origin that positions are multiples of %.2g m, which is "
               "more than position_tolerance, %.2g m: joints may not close",
               spacing, settings.position_tolerance));
  if (const std::string pairs = passing_warning(world, settings); !pairs.empty()) warnings.push_back(pairs);
  if (const std::string deep = overlaps(world); !deep.empty()) warnings.push_back(deep);
  if (const std::string springs = fast_springs(world, settings, dt); !springs.empty())
    warnings.push_back(springs);
  return warnings;
}

}  // namespace taut
