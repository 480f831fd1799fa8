#include "solvers/common/setting_checks.h"

#include "core/base/check.h"
#include "core/constraints/rows.h"
#include "solvers/common/joint_tree.h"
#include "solvers/common/setting_names.h"

namespace taut {
namespace {

SettingConflict::Choice integrator_of(const Settings& s) {
  return {"integrator", name_of(s.integrator, kIntegratorNames)};
}

/// The first shape of a material that gives way, or none.
ShapeId compliant_shape(const World& world) {
  for (int i = 0; i < world.shape_count(); ++i)
    if (world.shape({i}).material.compliance > 0) return {i};
  return {};
}

/// Why a row is no equality.
std::string property_of(const World& world, const Rows::AxisRow& row) {
  if (!row.axis()) return "a compliance";
  const std::string own = world.axis_properties(*row.axis()).phrases();
  return own.empty() ? "friction or a spring of its swing" : own;
}

}  // namespace

bool is_force_level(Integrator integrator) {
  return integrator == Integrator::kForceEuler || integrator == Integrator::kForceRungeKutta;
}

bool is_lagrangian(Integrator integrator) {
  return integrator == Integrator::kLagrangian || integrator == Integrator::kLagrangianMidpoint;
}

bool is_midpoint(Integrator integrator) {
  return integrator == Integrator::kRecursiveMidpoint || integrator == Integrator::kLagrangianMidpoint;
}

bool is_reduced(Integrator integrator) {
  return is_lagrangian(integrator) || is_midpoint(integrator) || integrator == Integrator::kRecursive;
}

bool has_no_laws(Integrator integrator) { return is_force_level(integrator) || is_reduced(integrator); }

std::vector<SettingConflict> setting_conflicts(const Settings& s) {
  std::vector<SettingConflict> found;
  const SettingConflict::Choice integrator = integrator_of(s),
                                tension{"tension", name_of(s.tension, kTensionNames)},
                                solver{"solver", name_of(s.solver, kSolverNames)},
                                cure{"drift_cure", name_of(s.drift_cure, kDriftCureNames)};
  const bool moreau_jean = s.integrator == Integrator::kMoreauJean;
  const bool implicit = s.tension == TensionPolicy::kImplicit;
  if (s.solver != Solver::kDirect && s.integrator != Integrator::kRattle)
    found.push_back({integrator, solver, R"(iterative solvers need the integrator "rattle")"});
  if (s.solver != Solver::kDirect && implicit)
    found.push_back({tension, solver, "iterative solvers have no multipliers to tell the tension by"});
  if (is_reduced(s.integrator) && implicit)
    found.push_back({tension, integrator, "reduced coordinates take tension explicitly"});
  if (moreau_jean && implicit)
    found.push_back({tension, integrator, R"("moreau-jean" takes tension explicitly)"});
  if (moreau_jean && s.drift_cure != DriftCure::kAuto && s.drift_cure != DriftCure::kNone &&
      s.drift_cure != DriftCure::kPositionPush)
    found.push_back({cure, integrator, R"("moreau-jean" has "position-push" and "none" only)"});
  return found;
}

std::vector<SettingConflict> setting_conflicts(const Settings& s, const World& world) {
  std::vector<SettingConflict> found;
  if (s.factor == FactorChoice::kDense)
    if (const int rows = Rows(world).row_count(); rows > kMostDenseRows)
      found.push_back({{"factor", name_of(s.factor, kFactorNames)},
                       {},
                       "it takes at most " + std::to_string(kMostDenseRows) + " rows, and joints have " +
                           std::to_string(rows)});
  if (s.integrator == Integrator::kRattle) return found;
  const auto add = [&](const std::string& reason) { found.push_back({integrator_of(s), {}, reason}); };
  if (!world.breakable().empty())
    add("joint " + world.name(world.breakable().front().first) + R"( may break, which needs "rattle")");
  if (s.integrator == Integrator::kMoreauJean) {
    if (const ShapeId soft = compliant_shape(world); s.contacts && soft.index >= 0)
      add("the material of a shape of body " + world.name(world.shape(soft).body) +
          R"( has a compliance, which needs "rattle")");
    return found;
  }
  const Rows rows(world);
  if (is_reduced(s.integrator)) {
    if (const std::string problem = tree_problem(world, rows); !problem.empty())
      add(problem + R"(: "rattle" has that)");
  } else if (!rows.axis_rows().empty())
    add("joint " + world.name(*rows.axis_rows().front().joint()) + " has " +
        property_of(world, rows.axis_rows().front()) + R"(, which needs "rattle" or "moreau-jean")");
  if (s.contacts && world.shape_count() > 0)
    add(R"(bodies have shapes, whose contacts need "rattle" or "moreau-jean", or "contacts": false)");
  return found;
}

void require_none(const std::vector<SettingConflict>& conflicts) {
  if (conflicts.empty()) return;
  const auto& [first, second, reason] = conflicts.front();
  const std::string excluded =
      second.setting.empty() ? "cannot be" : "excludes " + second.setting + " \"" + second.value + "\"";
  fail("settings " + first.setting, excluded + ": " + reason, first.value);
}

std::vector<UnusedSetting> unused_settings(const Settings& s) {
  std::vector<UnusedSetting> unused;
  const auto unless = [&](bool used, std::initializer_list<const char*> settings, const char* reason) {
    for (const char* setting : settings)
      if (!used) unused.push_back({setting, reason});
  };
  const bool force_level = is_force_level(s.integrator),
             moreau_jean = s.integrator == Integrator::kMoreauJean, reduced = is_reduced(s.integrator);
  const bool iterative = s.solver != Solver::kDirect;
  const DriftCure cure = s.drift_cure == DriftCure::kAuto ? DriftCure::kBaumgarte : s.drift_cure;
  const bool baumgarte = cure == DriftCure::kBaumgarte;
  unless(moreau_jean, {"theta"}, R"(only the integrator "moreau-jean" uses it)");
  unless(moreau_jean || force_level, {"drift_cure"},
         R"(only the integrators "force-euler", "force-runge-kutta" and "moreau-jean" use it)");
  unless(
      force_level && (baumgarte || cure == DriftCure::kVelocityImpulse || cure == DriftCure::kPositionPush),
      {"erp"},
      R"(only the integrators "force-euler" and "force-runge-kutta" use it, )"
      R"(with the drift cures "baumgarte", "velocity-impulse" and "position-push")");
  unless(
      force_level && baumgarte, {"cfm"},
      R"(only the integrators "force-euler" and "force-runge-kutta" use it, with the drift cure "baumgarte")");
  unless(
      force_level && cure == DriftCure::kPenalty, {"penalty_frequency", "penalty_damping_ratio"},
      R"(only the integrators "force-euler" and "force-runge-kutta" use it, with the drift cure "penalty")");
  unless(
      !force_level, {"max_newton_iterations", "max_substeps", "max_rotation", "velocity_tolerance"},
      R"(the integrators "force-euler" and "force-runge-kutta" have no sub-steps and no Newton iterations)");
  unless(!reduced, {"max_newton_iterations", "velocity_tolerance"},
         "integrators in reduced coordinates close each joint by itself");
  unless(!force_level && !iterative, {"tension"},
         R"(only the solver "direct" uses it, not the integrators "force-euler" and "force-runge-kutta")");
  unless(!force_level && !iterative && s.tension != TensionPolicy::kIgnore, {"max_tension_number"},
         "the tension is not looked at");
  unless(iterative, {"iterations"},
         R"(only the solvers "gauss-seidel", "pairwise" and "propagation" use it)");
  unless(s.solver == Solver::kGaussSeidel, {"relaxation"}, R"(only the solver "gauss-seidel" uses it)");
  unless(s.integrator == Integrator::kRattle, {"locate_plastic_impacts"},
         R"(only the integrator "rattle" locates impacts)");
  unless(s.contacts, {"contact_margin", "max_contacts"}, R"("contacts" is false)");
  unless(s.sleep, {"sleep_speed", "sleep_time"}, R"(without "sleep" nothing falls asleep)");
  return unused;
}

}  // namespace taut
