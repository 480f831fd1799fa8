#include "solvers/common/setting_checks.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/joints/joints.h"

/// Settings that exclude each other, or do nothing, are named.
namespace taut::setting_checks_test {
namespace {

bool names(const std::vector<SettingConflict>& conflicts, const std::string& first,
           const std::string& second) {
  return std::any_of(conflicts.begin(), conflicts.end(), [&](const SettingConflict& conflict) {
    return conflict.first.setting == first && conflict.second.setting == second && !conflict.reason.empty();
  });
}

TEST(SettingChecks, NameBothOfWhatExcludesEachOther) {
  Settings settings;
  EXPECT_TRUE(setting_conflicts(settings).empty());
  settings.solver = Solver::kGaussSeidel;
  EXPECT_TRUE(setting_conflicts(settings).empty());
  settings.tension = TensionPolicy::kImplicit;
  EXPECT_TRUE(names(setting_conflicts(settings), "tension", "solver"));
  settings.integrator = Integrator::kMoreauJean;
  EXPECT_TRUE(names(setting_conflicts(settings), "integrator", "solver"));
  EXPECT_TRUE(names(setting_conflicts(settings), "tension", "integrator"));
  settings.drift_cure = DriftCure::kPenalty;
  EXPECT_TRUE(names(setting_conflicts(settings), "drift_cure", "integrator"));
  EXPECT_THROW(require_none(setting_conflicts(settings)), std::invalid_argument);
}

TEST(SettingChecks, NameWhatOfTheWorldTheyExclude) {
  World world;
  const BodyId body = world.add_body({.mass = {1, Vec3(1, 1, 1)}});
  const JointId joint = world.add("door", Hinge::at(world, kGround, body, Vec3::Zero(), Vec3::UnitZ()));
  Settings settings;
  settings.integrator = Integrator::kForceEuler;
  EXPECT_TRUE(setting_conflicts(settings, world).empty());
  world.set_friction(world.axis(joint, "angle"), AxisFriction{.static_friction = 1});
  EXPECT_TRUE(names(setting_conflicts(settings, world), "integrator", ""));
  EXPECT_EQ(setting_conflicts(settings, world)[0].reason,
            R"(joint door has friction, which needs "rattle" or "moreau-jean")");
  settings.integrator = Integrator::kRattle;
  EXPECT_TRUE(setting_conflicts(settings, world).empty());
  world.set_break(joint, BreakLimits{.force = 1});
  settings.integrator = Integrator::kMoreauJean;
  const std::vector<SettingConflict> found = setting_conflicts(settings, world);
  ASSERT_EQ(found.size(), 1);
  EXPECT_NE(found[0].reason.find("joint door may break"), std::string::npos) << found[0].reason;
}

TEST(SettingChecks, NameWhatHasNoEffect) {
  const auto unused = [](const Settings& settings, const std::string& name) {
    const std::vector<UnusedSetting> all = unused_settings(settings);
    return std::any_of(all.begin(), all.end(), [&](const UnusedSetting& one) { return one.setting == name; });
  };
  Settings settings;
  EXPECT_TRUE(unused(settings, "theta") && unused(settings, "erp") && unused(settings, "iterations"));
  settings.integrator = Integrator::kForceEuler;
  EXPECT_FALSE(unused(settings, "erp") || unused(settings, "cfm"));
  settings.drift_cure = DriftCure::kPenalty;
  EXPECT_FALSE(unused(settings, "penalty_frequency"));
  EXPECT_TRUE(unused(settings, "cfm"));
}

}  // namespace
}  // namespace taut::setting_checks_test
